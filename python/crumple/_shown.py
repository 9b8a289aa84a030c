"""What a prompt and a notebook show: three lines, tables, figures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ._program import CrumpleError

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

    from ._run import Run

WIDTH = 100
G, KMH, MILLI, KILO = 1 / 9.80665, 3.6, 1e3, 1e-3


def in_lines(*lines: str) -> str:
    """Lines of a prompt, each cut where it is too wide."""
    return "\n".join(line if len(line) <= WIDTH else line[: WIDTH - 1] + "\u2026" for line in lines if line)


def of_mapping(found: Mapping[str, Any]) -> str:
    """Numbers and words of a record in one line; of lists and tables their names."""
    plain = ((name, one) for name, one in found.items() if isinstance(one, (str, float, int)) and one != "")
    return ", ".join(f"{name} {one:.6g}" if isinstance(one, float) else f"{name} {one}" for name, one in plain)


def table_of(rows: Iterable[Mapping[str, Any]], columns: Sequence[str]) -> pandas.DataFrame:
    """A DataFrame with a row a record."""
    try:
        import pandas
    except ImportError as error:
        raise CrumpleError("table() needs pandas\n  hint: pip install crumple[pandas]") from error
    return pandas.DataFrame([{name: one.get(name) for name in columns} for one in rows], columns=list(columns))


def html_table(rows: Iterable[Sequence[object]], head: Sequence[str] = ()) -> str:
    """A table of a notebook."""
    from html import escape

    titles = "".join(f"<th>{escape(name)}" for name in head)
    cells = ("<tr>" + "".join(f"<td>{escape(_cell(one))}" for one in row) for row in rows)
    return f"<table>{'<tr>' + titles if titles else ''}{''.join(cells)}</table>"


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.5g}"
    if isinstance(value, Mapping):
        return of_mapping(value)
    return "" if value is None else str(value)


def figure(run: Run) -> Figure:
    """Pulse, force over crush, predicted crush over speed: what the run has of them."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise CrumpleError("plot() needs matplotlib\n  hint: pip install crumple[plot]") from error
    draw = [_draw_pulse, _draw_force, _draw_predictions]
    drawn = Figure(figsize=(12, 3.6), layout="constrained")
    for axes, one in zip(drawn.subplots(1, 3), draw, strict=True):
        one(axes, run)
        if axes.lines or axes.collections:
            axes.legend(fontsize="small", frameon=False)
        else:
            axes.text(0.5, 0.5, "not in this run", ha="center", transform=axes.transAxes)
    return drawn


def _pulse(run: Run) -> str:
    return str(run.summary["test"]["channel"] or "")


def _draw_pulse(axes: Any, run: Run) -> None:
    axes.set(title="Pulse", xlabel="time after contact, ms", ylabel="acceleration, g")
    waves, pulse, best = run.waves(), _pulse(run), run.recommended
    for name, label in ((pulse, "test"), (best and f"{best.id}/acceleration", "model")):
        if wave := waves.get(name or ""):
            axes.plot(MILLI * wave.time, G * wave.samples, label=label)
    crush = (run.summary.get("events") or {}).get("time_of_dynamic_crush_s")
    if crush:
        axes.set_xlim(-0.3 * MILLI * crush, 3 * MILLI * crush)


def _draw_force(axes: Any, run: Run) -> None:
    mass, pulse, best, waves = run.summary["test"]["mass_kg"], _pulse(run), run.recommended, run.waves()
    axes.set(title="Force over crush", xlabel="crush, mm", ylabel="force, kN" if mass else "deceleration, g")
    factor = KILO * mass if mass else G
    until = (run.summary.get("events") or {}).get("time_of_rebound_s") or float("inf")
    for name, of, label in (
        (pulse, f"{pulse}/displacement", "test"),
        (best and f"{best.id}/acceleration", best and f"{best.id}/displacement", "model"),
    ):
        acceleration, displacement = waves.get(name or ""), waves.get(of or "")
        if acceleration is None or displacement is None or len(acceleration.samples) != len(displacement.samples):
            continue
        shown = (displacement.time >= 0) & (displacement.time <= until)
        axes.plot(MILLI * displacement.samples[shown], -factor * acceleration.samples[shown], label=label)


def _draw_predictions(axes: Any, run: Run) -> None:
    axes.set(title="Predictions", xlabel="impact speed, km/h", ylabel="dynamic crush, mm")
    of_best = [one for one in run.summary["predictions"] if one["recommended"] and one["dynamic_crush_m"] is not None]
    for one in of_best:
        ends = next((known for known in one["intervals"] if known["name"] == "dynamic_crush_m"), None)
        if ends:
            speed = KMH * one["impact_speed_m_per_s"]
            axes.plot([speed, speed], [MILLI * ends["low"], MILLI * ends["high"]], color="C1", alpha=0.5)
    if of_best:
        speeds, crush = ([factor * one[name] for one in of_best] for factor, name in
                         ((KMH, "impact_speed_m_per_s"), (MILLI, "dynamic_crush_m")))
        axes.plot(speeds, crush, "o", color="C1", label="model, 90 % interval")
    test, events = run.summary["test"], run.summary.get("events") or {}
    if test["impact_speed_m_per_s"] and events.get("dynamic_crush_m"):
        axes.plot(KMH * test["impact_speed_m_per_s"], MILLI * events["dynamic_crush_m"], "ko", label="test")
