"""The script of the action against a server that answers as GitHub does: `python3 -m unittest discover ci`."""

import json
import os
import subprocess
import tempfile
import threading
import time
import unittest
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import review


class Server(BaseHTTPRequestHandler):
    def answer(self):
        length = int(self.headers.get("Content-Length") or 0)
        body = json.loads(self.rfile.read(length))["body"] if length else None
        self.server.asked.append((self.command, self.path, body))
        code, value = self.server.answers(self.command, self.path)
        self.send_response(code)
        self.end_headers()
        self.wfile.write(json.dumps(value).encode())

    do_GET = do_POST = do_PATCH = answer

    def log_message(self, *_):
        pass


def run(answers, code=1, text="<!-- crumple: a -->\n### a: results changed\n", number=7, **more):
    """What the script did: its exit code, what it asked the server for, step summary and outputs."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        program = folder / "crumple"
        # Stands in for the program: writes the Markdown that it was asked for.
        program.write_text(f"#!/bin/sh\nwhile [ $# -gt 0 ]; do case $1 in --markdown) shift; cp '{folder}/text' \"$1\";; "
                           f"esac; shift; done\nexit {code}\n")
        program.chmod(0o755)
        (folder / "text").write_text(text)
        (folder / "event").write_text(json.dumps({"pull_request": {"number": number, "title": "$(touch hacked)"}}))
        server = HTTPServer(("127.0.0.1", 0), Server)
        server.asked, server.answers = [], answers
        threading.Thread(target=server.serve_forever, daemon=True).start()
        env = {"CRUMPLE_PROGRAM": str(program), "CRUMPLE_OUT": str(folder / "out"), "GITHUB_TOKEN": "t",
               "GITHUB_EVENT_PATH": str(folder / "event"), "GITHUB_REPOSITORY": "o/r",
               "GITHUB_API_URL": f"http://127.0.0.1:{server.server_port}",
               "GITHUB_STEP_SUMMARY": str(folder / "summary"), "GITHUB_OUTPUT": str(folder / "output"), **more}
        ended = review.main(env)
        server.shutdown()
        server.server_close()
        return ended, server.asked, (folder / "summary").read_text(), (folder / "output").read_text()


def said(login, body, number=1):
    return {"id": number, "user": {"login": login}, "body": body}


@unittest.skipUnless(os.environ.get("CRUMPLE_PROGRAM"), "SKIPPED end to end: CRUMPLE_PROGRAM names no program")
class EndToEnd(unittest.TestCase):
    def test_a_change_of_an_option_is_told_by_the_program_itself(self):
        program = str(Path(os.environ["CRUMPLE_PROGRAM"]).resolve())
        record = Path(__file__).parents[1] / "fixtures/noisy/crash.csv"
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)

            def step(name, *words):
                started = time.monotonic()
                subprocess.run([program, *map(str, words)], check=True, cwd=folder, stdout=subprocess.DEVNULL)
                print(f"{name}: {time.monotonic() - started:.2f} s")

            step("run", "run", record, "-q")
            step("accept", "accept", "runs")
            step("run of the change", "run", record, "-q", "--set", "filter.cfc=180")
            review_of = {"CRUMPLE_PROGRAM": program, "CRUMPLE_EXPECTED": str(folder / "expected"),
                         "CRUMPLE_FRESH": str(folder / "runs"), "CRUMPLE_OUT": str(folder / "review")}
            started = time.monotonic()
            ended, asked, summary, output = run(lambda *_: (200, []), **review_of)
            print(f"script of the action: {time.monotonic() - started:.2f} s")
            self.assertEqual((ended, [method for method, *_ in asked]), (1, ["GET", "POST"]))
            comment = (folder / "review/review.md").read_text()
            self.assertEqual((asked[-1][2], summary), (comment, comment))
            self.assertIn("`filter.cfc` 60 → 180", comment)
            self.assertIn("cause=filter.cfc", output)
            for file in [*(folder / "review").iterdir(), *(folder / "expected").iterdir()]:
                print(f"{file.name}: {file.stat().st_size} bytes")
            own = [said("github-actions[bot]", comment, 42)]
            step("run of the base again", "run", record, "-q")
            ended, asked, *_ = run(lambda *_: (200, own), **review_of)
            self.assertEqual((ended, asked[-1][0]), (0, "PATCH"))


class Comments(unittest.TestCase):
    def test_a_comment_is_made_where_there_is_none_and_edited_where_there_is(self):
        ended, asked, summary, output = run(lambda *_: (200, []))
        self.assertEqual((ended, [method for method, *_ in asked]), (1, ["GET", "POST"]))
        self.assertIn("results changed", summary)
        self.assertIn("identical=false", output)
        own = [said("someone", review.MARK + "a -->"), said("github-actions[bot]", review.MARK + "a -->", 42)]
        _, asked, *_ = run(lambda *_: (200, own))
        self.assertEqual([(method, path) for method, path, _ in asked][1], ("PATCH", "/repos/o/r/issues/comments/42"))

    def test_the_second_page_is_read_too(self):
        def answers(method, path):
            first = [said("someone", "hello")] * 100
            return 200, (first if path.endswith("page=1") else [said("github-actions[bot]", review.MARK + "a -->", 9)])
        _, asked, *_ = run(answers)
        self.assertEqual(asked[-1][:2], ("PATCH", "/repos/o/r/issues/comments/9"))

    def test_the_same_results_make_no_comment_and_edit_an_old_one(self):
        ended, asked, *_ = run(lambda *_: (200, []), code=0)
        self.assertEqual((ended, len(asked)), (0, 1))
        _, asked, *_ = run(lambda *_: (200, [said("github-actions[bot]", review.MARK + "a -->", 3)]), code=0)
        self.assertEqual(asked[-1][0], "PATCH")

    def test_without_the_right_to_comment_the_step_goes_on(self):
        for refusal in (403, 404, 422):
            answers = lambda method, _, code=refusal: (200, []) if method == "GET" else (code, {})
            ended, _, summary, _ = run(answers)
            self.assertEqual(ended, 1)
            self.assertIn("results changed", summary)

    def test_a_long_review_is_cut_and_trouble_is_told(self):
        _, asked, summary, _ = run(lambda *_: (200, []), text="<!-- crumple: a -->\n" + "x" * 70_000)
        self.assertLess(len(asked[-1][2]), 200)
        self.assertGreater(len(summary), 70_000)
        ended, *_ = run(lambda *_: (200, []), code=2)
        self.assertEqual(ended, 2)
        ended, *_ = run(lambda *_: (200, []), CRUMPLE_FAIL_ON="never")
        self.assertEqual(ended, 0)

    def test_nothing_of_an_event_is_run_and_no_request_means_no_comment(self):
        run(lambda *_: (200, []))
        self.assertFalse(Path("hacked").exists())
        ended, asked, *_ = run(lambda *_: (200, []), number="7; touch hacked")
        self.assertEqual((ended, asked), (1, []))


if __name__ == "__main__":
    unittest.main()
