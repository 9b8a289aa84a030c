#!/usr/bin/env python3
"""Compares fresh results with accepted ones and tells a merge request of it: the script of action.yml.

All it is told stands in the environment, so that nothing of a branch or a record is ever part of a shell's line.
Python's own library suffices. Exit: that of `crumple diff` (0 same, 1 different, 2 trouble), 0 for fail-on: never.
"""

import json
import os
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path

MARK = "<!-- crumple: "
MOST = 65_000  # GitHub refuses a comment of more than 65,536 characters.


def main(env=os.environ) -> int:
    out = Path(env.get("CRUMPLE_OUT") or "crumple-review")
    out.mkdir(parents=True, exist_ok=True)
    markdown, junit, report = out / "review.md", out / "review.xml", out / "review.json"
    for old in (markdown, junit, report):
        old.unlink(missing_ok=True)
    command = [env.get("CRUMPLE_PROGRAM") or "crumple", "diff", env.get("CRUMPLE_EXPECTED") or "expected",
               env.get("CRUMPLE_FRESH") or "runs", "--markdown", markdown, "--junit", junit, f"--json={report}", "--github"]
    if env.get("CRUMPLE_TOLERANCE"):
        command += ["--tolerance", env["CRUMPLE_TOLERANCE"]]
    code = subprocess.run(command, check=False).returncode
    if not markdown.is_file():
        markdown.write_text(f"{MARK}trouble -->\n### Results could not be compared\n\nSee the log of this step.\n")
    text = markdown.read_text(encoding="utf-8")
    for name, line in (("GITHUB_STEP_SUMMARY", text), ("GITHUB_OUTPUT", outputs(code, report, markdown))):
        if env.get(name):
            with open(env[name], "a", encoding="utf-8") as file:
                file.write(line)
    if env.get("CRUMPLE_COMMENT", "true") == "true":
        comment(env, text, code)
    return 0 if env.get("CRUMPLE_FAIL_ON") == "never" and code == 1 else code


def outputs(code: int, report: Path, markdown: Path) -> str:
    causes = []
    if report.is_file():
        causes = [cause["name"] for run in json.loads(report.read_text())["summary"] for cause in run["causes"]]
    one_line = " ".join(" ".join(causes[:1]).split())
    return f"identical={'true' if code == 0 else 'false'}\ncause={one_line}\nreport={markdown}\n"


def comment(env, text: str, code: int) -> None:
    """Edits its own comment in place; makes one where results differ. Without the right to, it says so and goes on."""
    token, event = env.get("GITHUB_TOKEN"), env.get("GITHUB_EVENT_PATH")
    if not token or not event or not Path(event).is_file():
        return
    number = (json.loads(Path(event).read_text()).get("pull_request") or {}).get("number")
    if not isinstance(number, int):
        return
    base = f"{env.get('GITHUB_API_URL', 'https://api.github.com')}/repos/{env['GITHUB_REPOSITORY']}/issues"

    def ask(method: str, url: str, body=None):
        data = None if body is None else json.dumps({"body": body}).encode()
        request = urllib.request.Request(url, data, method=method)
        request.add_header("Authorization", f"Bearer {token}")
        request.add_header("Accept", "application/vnd.github+json")
        with urllib.request.urlopen(request, timeout=30) as answer:
            return json.load(answer)

    try:
        author = env.get("CRUMPLE_AUTHOR") or "github-actions[bot]"
        mine, page = None, 1
        while mine is None:
            comments = ask("GET", f"{base}/{number}/comments?per_page=100&page={page}")
            own = [one for one in comments if one["user"]["login"] == author and one["body"].startswith(MARK)]
            mine = own[0]["id"] if own else None
            if mine is not None or len(comments) < 100:
                break
            page += 1
        if len(text) > MOST:
            text = text[: text.index("\n") + 1] + "The review is too long for a comment; the artifact of this job has it.\n"
        if mine is not None:
            ask("PATCH", f"{base}/comments/{mine}", text)
        elif code != 0:
            ask("POST", f"{base}/{number}/comments", text)
    except (urllib.error.URLError, OSError, ValueError, KeyError) as error:
        print(f"no comment: {error}; the step summary and the artifact have the review", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
