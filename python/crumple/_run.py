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

import numpy as np

from ._artifact import Array, Record, Wave, read
from ._program import CrumpleError, NoResult, Usage, call, flags, number, program, quantity, text
from ._shown import figure, html_table, in_lines, table_of

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

Paths = str | os.PathLike[str]
Samples = Any  # a DataFrame, a Series, or what numpy takes for an array
Quantity = float | str | None
REMARK = ("code", "stage", "about", "weight", "text")
PREDICTION = (
    "impact_speed_m_per_s", "mass_kg", "candidate", "dynamic_crush_m", "low", "high", "delta_v_m_per_s",
    "peak_acceleration_m_per_s2", "extrapolates",
)


class Remarks(list[Record]):
    """The remarks of a run, strongest first; a table in a notebook."""

    def table(self) -> pandas.DataFrame:
        """A row a remark: code, stage, about, weight, text."""
        return table_of(self, REMARK)

    def __repr__(self) -> str:
        return in_lines(f"<crumple.Remarks, {len(self)}>", *(f"{one.code} {one.text}" for one in self[:2]))

    def _repr_html_(self) -> str:
        return html_table(([one[name] for name in REMARK] for one in self), REMARK)


class Predictions(list[Record]):
    """Impacts that were predicted; a table in a notebook."""

    def table(self) -> pandas.DataFrame:
        """A row an impact, SI, with the 90 % interval of its crush."""
        return table_of(map(_with_interval, self), PREDICTION)

    def __repr__(self) -> str:
        lines = (f"{3.6 * one.impact_speed_m_per_s:.1f} km/h: crush {_in_mm(one)}, {one.candidate}" for one in self[:2])
        return in_lines(f"<crumple.Predictions, {len(self)}>", *lines)

    def _repr_html_(self) -> str:
        return html_table(([one.get(name) for name in PREDICTION] for one in map(_with_interval, self)), PREDICTION)


def _with_interval(one: Record) -> dict[str, Any]:
    of_crush = (known for known in one["intervals"] if known["name"] == "dynamic_crush_m")
    ends = next(of_crush, {"low": None, "high": None})
    return {**one, "low": ends["low"], "high": ends["high"]}


def _in_mm(one: Record) -> str:
    return "not reached" if one.dynamic_crush_m is None else f"{1e3 * one.dynamic_crush_m:.0f} mm"


class Run:
    """A run folder. One that nobody named is temporary: it goes with the last reference to the run; `save` keeps it."""

    def __init__(self, folder: Paths, *, temporary: Path | None = None) -> None:
        self.folder = Path(folder).absolute()
        self.report = self.folder / "report.html"
        if temporary:
            weakref.finalize(self, shutil.rmtree, temporary, ignore_errors=True)

    def __repr__(self) -> str:
        known = [one for one in self.summary.get("key_numbers", ()) if one["value"] is not None]
        numbers = ", ".join(f"{one['name']} {one['value']:.4g} {one['unit']}" for one in known)
        return in_lines(f"<crumple.Run {self.folder}>", self.verdict.splitlines()[0], numbers)

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

    def _why(self) -> str:
        """The status with its reason, and the strongest remark with what to do: why there is no result."""
        lines = self.verdict.splitlines()[:1]
        for first in self.remarks[:1]:
            lines.append(f"  {first.text} [{first.code}]")
            lines += [f"  hint: {first.remedy}"] if first.remedy else []
        return "\n".join(lines)

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

    def predict(
        self, speed: float | str | Iterable[float | str], *, mass: Quantity = None, **options: Any
    ) -> Predictions:
        """Impacts at other speeds, m/s or texts with unit, and masses: see `crumple.predict`."""
        return predict(self, speed, mass=mass, **options)

    def plot(self) -> Figure:
        """Pulse, force over crush and predictions of the recommended model, by matplotlib."""
        return figure(self)

    def save(self, folder: Paths) -> Run:
        """Copies the folder to a place where nothing is yet."""
        return Run(shutil.copytree(self.folder, folder))

    def _repr_html_(self) -> str:
        from html import escape

        known = [one for one in self.summary.get("key_numbers", ()) if one["value"] is not None]
        rows = ([one["name"], one["value"], one["unit"]] for one in known)
        return f"<p>{'<br>'.join(map(escape, self.verdict.splitlines()))}</p>{html_table(rows)}"


def run(
    record: Paths | Samples, *, dt: float | None = None, mass: Quantity = None, impact_speed: Quantity = None,
    out: Paths | None = None, pipeline: Paths | Mapping[str, Any] | None = None,
    set: Mapping[str, object] | None = None, force: bool = False,
    **options: object,
) -> Run:
    """Runs a record through all stages: a file, a DataFrame, a Series, or an array of one acceleration.

    A DataFrame has its time, s, as index or in a column, else `dt` is its step, s; an array needs `dt`. What no column
    name states, `unit` does: `unit="g"`; an array needs it. An array of two columns is time, s, and acceleration.

    `mass` is in kg and `impact_speed` in m/s; texts carry their unit, `"1200 kg"`, `"50 km/h"`. `pipeline` is a name,
    a file, or tables of options by stage; `set` has single options, `{"filter.cfc": 180}`. Other options are flags of
    ingest, `channel="94"`. Without `out` the folder is temporary.
    """
    known = {"mass": quantity("mass", mass, "kg"), "impact_speed": quantity("impact_speed", impact_speed, "m/s")}
    words = flags({**known, **options})
    with tempfile.TemporaryDirectory() as scratch:
        if not isinstance(record, (str, os.PathLike)):
            record = _as_file(record, dt, options.get("unit"), Path(scratch, "array.csv"))
        elif dt is not None:
            raise Usage("dt is of an array; a file states its time\n  hint: rate=\"10kHz\"")
        if isinstance(pipeline, Mapping):
            lines = [f"{_toml(stage)} = {_toml(table)}\n" for stage, table in pipeline.items()]
            pipeline = Path(scratch, "pipeline.toml")
            pipeline.write_text("".join(lines), "utf-8")
        own = [] if pipeline is None else ["--pipeline", os.fspath(pipeline)]
        own += [word for key, value in (set or {}).items() for word in ("--set", f"{key}={text(value)}")]
        own += ["--force"] if force else []
        return _into_folder("run", out, Path(record).stem, lambda to: [*own, "--out", to, _there(record), *words])


def _as_file(given: Samples, dt: float | None, unit: object, path: Path) -> Path:
    """A table of samples as a file that any program reads, every digit kept."""
    frame, columns = given, getattr(given, "columns", None)
    is_series = columns is None and hasattr(given, "to_frame")
    if is_series:
        frame = given.to_frame(given.name or "acceleration")
    if columns is None and not is_series:
        if dt is None and np.ndim(given) == 2 and np.shape(given)[1] == 2 and unit is not None:
            time, given = np.asarray(given, float).T
            if not (np.isfinite(time).all() and (np.diff(time) > 0).all()):
                raise Usage("the first of two columns does not rise\n  hint: time in s, then acceleration; or dt=1e-4")
            return _write(path, time, _samples("the record", given))
        if unit is None or dt is None:
            lacks = "unit" if unit is None else "dt"
            raise Usage(f"an array does not state its {lacks}\n  hint: crumple.run(a, dt=1e-4, unit=\"g\")")
        samples = _samples("the record", given)
        return _write(path, np.arange(len(samples)) * number("dt", dt, positive=True), samples)
    frame = frame.copy()
    if dt is not None:
        frame.insert(0, "time_s", np.arange(len(frame)) * number("dt", dt, positive=True))
    elif frame.index.dtype.kind == "m":
        frame.insert(0, "time_s", frame.index.total_seconds())
    elif frame.index.dtype.kind == "f":
        frame.insert(0, frame.index.name or "time_s", frame.index.to_numpy())
    elif is_series:
        raise Usage("the series has no time\n  hint: an index in seconds, or dt=1e-4")
    frame.to_csv(path, index=False)
    return path


def _write(path: Path, time: Array, samples: Array) -> Path:
    lines = (f"{at!r},{one!r}\n" for at, one in zip(time.tolist(), samples.tolist(), strict=True))
    path.write_text("time_s,acceleration\n" + "".join(lines), "utf-8")
    return path


def _samples(name: str, values: Any) -> Array:
    from ._kernels import samples

    return samples(name, values)


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
) -> Predictions:
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
    return Predictions(found[place] for place in sorted(found, key=int))


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


def compare(
    test: Run | Paths, *simulations: Run | Paths, require: Iterable[str] = (), page: Paths | None = None,
    **options: object,
) -> dict[str, Any]:
    """Simulations against their test: `crumple compare --validate`. Runs, or records with their flags as options.

    `require` has limits, `["crush<=20mm"]`; one that is not held is in `["simulations"][k]["required"]`. `page` is the
    HTML page to write.
    """
    with tempfile.TemporaryDirectory() as scratch:
        sides = [_there(one) for one in (test, *simulations)]
        page = Path(page).absolute() if page else Path(scratch, "compare.html")
        if limits := options.pop("limits", None):
            options["limits"] = _there(str(limits))
        own = ["--validate", "--json", "-o", str(page), *(f"--require={one}" for one in require)]
        found: dict[str, Any] = json.loads(
            call("compare", *sides, *own, *flags(options), allowed=(0, 1), cwd=scratch)[1]
        )
    return found


def damage(*, test: str | Iterable[str] = (), **options: object) -> dict[str, Any]:
    """Speed from damage, SI: `crumple damage --json`. Options are its flags: `profile="10,25,38,40,31,12cm"`.

    `test` is a barrier test, `"1400kg,56km/h,48cm,150cm"`, or several.
    """
    tests = [test] if isinstance(test, str) else test
    words = [*(f"--test={one}" for one in tests), *flags(options)]
    found: dict[str, Any] = json.loads(call("damage", *words, "--json")[1])
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
        if not str(error):
            error.args = (error.run._why(),)
        raise
    except BaseException as error:
        if temporary:
            shutil.rmtree(temporary, ignore_errors=True)
        if isinstance(error, CrumpleError) and hasattr(error, "add_note"):  # Python 3.11
            error.add_note('In Python a flag is a keyword: --time-zero 5ms is time_zero="5ms".')
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
