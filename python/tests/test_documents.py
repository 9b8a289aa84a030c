"""Code in documents runs and gives what they show: docs/python.md, stages of docs/write-a-stage.md, the notebook."""

import ast
import contextlib
import doctest
import io
import json
import os
import shutil
import sys
from pathlib import Path

import crumple
import pytest

ROOT = Path(__file__).parents[2]
RECORD = ROOT / "fixtures/elastoplastic/crash.csv"
NOTEBOOKS = sorted((ROOT / "docs/examples").glob("*.ipynb"))


class PlainSpaces(doctest.OutputChecker):
    """Spaces between number and unit do not break: they are plain ones in a document."""

    def check_output(self, want, got, flags):
        return super().check_output(want, got.replace("\xa0", " "), flags)


def test_the_page_of_the_package(tmp_path, monkeypatch):
    pytest.importorskip("pandas")
    shutil.copy(RECORD, tmp_path)
    monkeypatch.chdir(tmp_path)
    # doctest takes the fence behind a block for output.
    page = (ROOT / "docs/python.md").read_text("utf-8").replace("```", "")
    examples = doctest.DocTestParser().get_doctest(page, {}, "python.md", None, 0)
    result = doctest.DocTestRunner(PlainSpaces()).run(examples)
    assert result.attempted > 20 and result.failed == 0


def test_a_function_as_a_stage(tmp_path, monkeypatch):
    page = (ROOT / "docs/write-a-stage.md").read_text("utf-8")
    file = tmp_path / "moving_average.py"
    file.write_text(page.split("```python\n")[1].split("```")[0], "utf-8")
    monkeypatch.setenv("CRUMPLE_FILTER", f"'{sys.executable}' '{file}'")
    run = crumple.run(RECORD)
    measured, smooth = (crumple.read(run.folder / f).waves["accel_g"] for f in ("1-ingest.mcap", "2-filter.mcap"))
    assert smooth.samples[900] == pytest.approx(measured.samples[878:923].mean(), rel=1e-12)
    assert run.summary["events"]["start"] == "record-start"
    assert run.verdict


@pytest.mark.parametrize("stage", ["filter", "integrate", "identify", "parameter-solve", "simulate", "predict"])
def test_the_kit_of_a_stage(stage, monkeypatch):
    file = ROOT / f"crates/artifact-cli/kit/python/{stage}.py"
    monkeypatch.setenv(f"CRUMPLE_{stage.upper().replace('-', '_')}", f"'{sys.executable}' '{file}'")
    run = crumple.run(RECORD)
    assert run.summary["events"]["dynamic_crush_m"] == pytest.approx(0.6956, rel=0.01)


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_shows_what_it_gives(file, monkeypatch):
    """`CRUMPLE_WRITE_NOTEBOOK=1` writes the outputs."""
    pytest.importorskip("pandas")
    monkeypatch.chdir(file.parent)
    notebook, names = json.loads(file.read_text("utf-8")), {}
    before = json.dumps(notebook)
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                shown = execute("".join(cell["source"]), names)
            lines = (printed.getvalue() + shown).replace("\xa0", " ").splitlines(keepends=True)
            cell["outputs"] = [{"name": "stdout", "output_type": "stream", "text": lines}] if lines else []
    if os.environ.get("CRUMPLE_WRITE_NOTEBOOK"):
        file.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", "utf-8")
    else:
        assert json.dumps(notebook) == before


def execute(source, names):
    """Runs a cell; returns what its last expression is shown as."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, "cell", "exec"), names)
    value = last and eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    return "" if value is None else repr(value)
