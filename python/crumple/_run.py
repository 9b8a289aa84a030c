"""Runs: a record through all stages, and what its folder holds."""

from __future__ import annotations

import functools
import json
import operator
import os
import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._artifact import Record, Wave, read
from ._program import CrumpleError, NoResult, Usage, call, flags, program, quantity, text

if TYPE_CHECKING:
    import pandas

Paths = str | os.PathLike[str]
Quantity = float | str | None
REMARK = ("code", "stage", "about", "weight", "text")


class Remarks(list[Record]):
    """The remarks of a run, strongest first; a table in a notebook."""

    def table(self) -> pandas.DataFrame:
        """A row a remark: code, stage, about, weight, text."""
        import pandas

        return pandas.DataFrame([{name: one[name] for name in REMARK} for one in self], columns=list(REMARK))

    def _repr_html_(self) -> str:
        from html import escape

        rows = ("<tr>" + "".join(f"<td>{escape(str(one[name]))}" for name in REMARK) for one in self)
        return "<table><tr>" + "".join(f"<th>{name}" for name in REMARK) + "".join(rows) + "</table>"


class Run:
    """A run folder. One that nobody named is temporary: it goes with the last reference to the run; `save` keeps it."""

    def __init__(self, folder: Paths, *, temporary: Path | None = None) -> None:
        self.folder = Path(folder).absolute()
        self.report = self.folder / "report.html"
        if temporary:
            weakref.finalize(self, shutil.rmtree, temporary, ignore_errors=True)

    def __repr__(self) -> str:
        return f"<crumple.Run {self.folder}>"

    @functools.cached_property
    def summary(self) -> dict[str, Any]:
        """`summary.json`, unchanged: every number is the program's own; what is unknown is `None`."""
        found: dict[str, Any] = json.loads((self.folder / "summary.json").read_text("utf-8"))
        return found

    @property
    def verdict(self) -> str:
        """The status with its reason, then the sentences of the first screen, a line each."""
        verdict = self.summary.get("verdict")
        if not verdict:
            return str(self.summary["recommended_because"])
        return "\n".join([verdict["status_sentence"], *verdict["sentences"]])

    @property
    def record(self) -> str:
        """Whether the record is sound: `sound`, `check` or `wrong`; empty where an earlier version made the run."""
        return str(self.summary["verdict"].get("record") or "")

    @property
    def good_for(self) -> list[dict[str, Any]]:
        """What the answers are good for, e.g. `[{"kind": "measured-quantities"}, ...]`; empty: for nothing."""
        return list(self.summary["verdict"].get("good_for", ()))

    @property
    def candidates(self) -> list[Record]:
        """Every model that was solved for."""
        return [Record("crumple.summary.v1", **one) for one in self.summary["candidates"]]

    @property
    def recommended(self) -> Record | None:
        """The candidate for predictions, if there is one to be used."""
        return next((one for one in self.candidates if one.id == self.summary["recommended"]), None)

    @property
    def notes(self) -> list[str]:
        """Warnings and remarks of all stages as texts."""
        return list(self.summary["notes"])

    @property
    def remarks(self) -> Remarks:
        """What the run remarks, strongest first: `code`, `stage`, `about`, `weight`, `values`, `text`, `remedy`."""
        return Remarks(Record("crumple.summary.v1", **one) for one in self.summary["remarks"])

    @functools.cached_property
    def _waves(self) -> dict[str, Wave]:
        from concurrent.futures import ThreadPoolExecutor

        program()  # found before the threads start: the first call of sysconfig is not safe in several
        with ThreadPoolExecutor() as pool:
            found = pool.map(read, sorted(self.folder.glob("[0-9]-*.mcap")))
            return functools.reduce(operator.or_, (artifact.waves for artifact in found), {})

    def waves(self) -> dict[str, Wave]:
        """Every waveform by its id; of one that several artifacts have, that of the last."""
        return dict(self._waves)

    def wave(self, id: str) -> Wave:
        """The waveform `accel_g`, `accel_g/displacement`, `kelvin/direct-fit/1/velocity`, ..."""
        if id in self._waves:
            return self._waves[id]
        from difflib import get_close_matches

        near = ", ".join(get_close_matches(id, self._waves, 3, 0.3))
        raise Usage(f"no waveform {id} in {self.folder}" + (f"\n  hint: the nearest are {near}" if near else ""))

    def table(self, *ids: str) -> pandas.DataFrame:
        """Waveforms as columns over time, s. Without ids: acceleration, velocity and crush of the pulse."""
        try:
            import pandas
        except ImportError as error:
            raise CrumpleError("table() needs pandas\n  hint: pip install crumple[pandas]") from error
        pulse = "" if ids else self.summary["test"]["channel"]
        waves = {id: self.wave(id) for id in ids or (pulse, f"{pulse}/velocity", f"{pulse}/displacement")}
        columns = [pandas.Series(wave.samples, pandas.Index(wave.time, name="time_s")) for wave in waves.values()]
        table = pandas.concat(columns, axis=1, keys=list(waves))
        table.attrs["units"] = {id: wave.unit for id, wave in waves.items()}
        return table

    def save(self, folder: Paths) -> Run:
        """Copies the folder to a place where nothing is yet."""
        return Run(shutil.copytree(self.folder, folder))

    def _repr_html_(self) -> str:
        from html import escape

        known = [one for one in self.summary.get("key_numbers", ()) if one["value"] is not None]
        rows = (f"<tr><td>{one['name']}<td>{one['value']:.5g}<td>{escape(one['unit'])}" for one in known)
        return f"<p>{'<br>'.join(map(escape, self.verdict.splitlines()))}</p><table>{''.join(rows)}</table>"


def run(
    record: Paths, *, mass: Quantity = None, impact_speed: Quantity = None, out: Paths | None = None,
    pipeline: Paths | Mapping[str, Any] | None = None, set: Mapping[str, object] | None = None, force: bool = False,
    **options: object,
) -> Run:
    """Runs a record through all stages.

    `mass` is in kg and `impact_speed` in m/s; texts carry their unit, `"1200 kg"`, `"50 km/h"`. `pipeline` is a name,
    a file, or tables of options by stage; `set` has single options, `{"filter.cfc": 180}`. Other options are flags of
    ingest, `channel="94"`. Without `out` the folder is temporary.
    """
    known = {"mass": quantity("mass", mass, "kg"), "impact_speed": quantity("impact_speed", impact_speed, "m/s")}
    words = flags({**known, **options})
    with tempfile.TemporaryDirectory() as scratch:
        if isinstance(pipeline, Mapping):
            lines = [f"{_toml(stage)} = {_toml(table)}\n" for stage, table in pipeline.items()]
            pipeline = Path(scratch, "pipeline.toml")
            pipeline.write_text("".join(lines), "utf-8")
        own = [] if pipeline is None else ["--pipeline", os.fspath(pipeline)]
        own += [word for key, value in (set or {}).items() for word in ("--set", f"{key}={text(value)}")]
        own += ["--force"] if force else []
        return _into_folder("run", out, Path(record).stem, lambda to: [*own, "--out", to, _there(record), *words])


def together(records: Iterable[Paths | Run], *, out: Paths | None = None, **options: object) -> Run:
    """One model for several tests: records, or runs made before. Other options are those of `crumple predict`."""
    given = [_there(one) for one in records]
    return _into_folder("together", out, "together", lambda to: ["--out", to, *given, *flags(options)])


def open_run(folder: Paths) -> Run:
    """A run folder that was made before."""
    if not Path(folder, "summary.json").is_file():
        raise Usage(f"{folder} is no run folder: it has no summary.json")
    return Run(folder)


def predict(
    run: Run, speeds: float | str | Iterable[float | str], *, mass: Quantity = None, candidate: str | None = None,
    partner: str | Run | None = None, **options: object,
) -> list[Record]:
    """Impacts at other speeds (m/s, or texts with unit), with the models of a run; the run stays as it is.

    `mass` as in `run`. `partner` is another run, or `mpdb`, `"barrier mass=1400kg ..."`. Other options are those of
    `crumple predict`.
    """
    listed = [speeds] if isinstance(speeds, (float, int, str)) else speeds
    words = {
        "speeds": [quantity("speed", speed, "m/s") for speed in listed], "mass": quantity("mass", mass, "kg"),
        "candidate": candidate, "partner": partner.folder if isinstance(partner, Run) else partner, **options,
    }
    with tempfile.TemporaryDirectory() as scratch:
        inputs = [str(run.folder / name) for name in ("3-integrate.mcap", "5-parameter-solve.mcap")]
        pipeline = ["--pipeline", str(run.folder / "0-pipeline.toml")]
        call("predict", *inputs, "-o", f"{scratch}/7-predict.mcap", *pipeline, *flags(words))
        found = read(f"{scratch}/7-predict.mcap").below("/prediction/")
    return [found[number] for number in sorted(found, key=int)]


def diff(
    a: Run | Paths, b: Run | Paths, *, tolerance: Paths | None = None, rounding: bool = False
) -> dict[str, Any]:
    """Compares two runs or artifacts by what an engineer calls the same: `["same"]`, and a report of the rest.

    With `rounding` only results of another processor are the same; `tolerance` is a file of tolerances.
    """
    sides = [_there(one) for one in (a, b)]
    words = [*flags({"tolerance": tolerance}), *(["--rounding"] if rounding else []), "--json"]
    found: dict[str, Any] = json.loads(call("diff", *sides, *words, allowed=(0, 1))[1])
    return found


def _into_folder(command: str, out: Paths | None, name: str, words: Callable[[str], list[str]]) -> Run:
    """Calls a command that fills a folder; a temporary one is removed where it fails."""
    temporary = Path(tempfile.mkdtemp(prefix="crumple-")) if out is None else None
    folder = temporary / name if temporary else Path(out or "").absolute()
    try:
        # Runs of the single tests go to `runs/` of the folder where `together` is called.
        call(command, *words(str(folder)), cwd=temporary if command == "together" else None)
    except NoResult as error:
        error.run = Run(folder, temporary=temporary)
        raise
    except BaseException:
        if temporary:
            shutil.rmtree(temporary, ignore_errors=True)
        raise
    return Run(folder, temporary=temporary)


def _toml(value: object) -> str:
    """A value of a pipeline file, tables inline."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_toml(key)} = {_toml(one)}" for key, one in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False, default=lambda scalar: scalar.item())


def _there(path: Paths | Run) -> str:
    """A path that no one takes for a flag."""
    return str(path.folder if isinstance(path, Run) else Path(path).absolute())
