"""What public programs make of the same five records: writes docs/peers.md. `just peers` makes environment and cars.

Run as `peers.py CRUMPLE CARS SHARED PAGE`: the program, a folder of made cars with their truth (`crumple-testkit
make-cars`), the folder of reference records, the page. Every number is computed here or read from what a program
wrote; what a package cannot do is an empty cell, what it refuses says so.
"""

import json
import logging
import subprocess
import sys
import tempfile
import textwrap
import time
import warnings
from importlib.metadata import version
from pathlib import Path

import aeroid
import numpy as np
import pandas as pd
import pyisomme
from crashmetrics import acceleration as cm_acceleration
from crashmetrics import energy as cm_energy
from crashmetrics import pulse as cm_pulse
from crashmetrics import signals as cm_signals
from endaq.calc import filters as endaq_filters
from endaq.calc import integrate as endaq_integrate
from nptdms import TdmsFile
from objective_rating_metrics.rating import ISO18571
from pyisomme.calculate.hic import calculate_hic
from pyisomme.calculate.olc import calculate_olc
from pyisomme.calculate.xms import calculate_xms
from pyisomme.channel import Channel
from scipy.integrate import cumulative_trapezoid
from scipy.optimize import least_squares
from scipy.signal import lfilter

warnings.simplefilter("ignore")
logging.disable(logging.CRITICAL)

G = 9.80665
CRUMPLE, SCIPY, NORMAL_95 = "Crumple", "scipy by hand", 1.959964
PACKAGES = {
    "pyisomme": "pyisomme",
    "crashmetrics": "crashmetrics",
    "endaq": "endaq",
    "aeroid": "AeroID",
    "objective-rating-metrics": "objective-rating-metrics",
    "scipy": SCIPY,
}
UNITS = {"g": 1 / G, "km/h": 3.6, "mm": 1e3, "kN/m": 1e-3, "": 1.0}


class Record:
    """Times from contact in s, accelerations in m/s² without their mean before contact, what a user states."""

    def __init__(self, times, accelerations, speed=0.0, mass=None, remove_zero=True):
        self.t = np.asarray(times, float)
        a = np.asarray(accelerations, float)
        before = self.t < -1e-9
        self.a = a - (a[before].mean() if remove_zero and before.any() else 0.0)
        self.speed, self.mass = speed, mass
        self.dt = float(np.median(np.diff(self.t)))
        self.after = self.t >= -1e-9

    def channel(self, code="10VEHCCG0000ACXP"):
        return Channel(code, pd.DataFrame({code: self.a}, index=self.t), "m/s^2")

    def frame(self):
        return pd.DataFrame({"a": self.a}, index=pd.Index(self.t, name="time"))


def cfc_by_hand(a, dt, wanted):
    """Both passes of the filter of SAE J211, appendix C."""
    w = np.tan(np.pi * wanted * 2.0775 * dt)
    a0 = w * w / (1 + np.sqrt(2) * w + w * w)
    b = [-2 * (w * w - 1) / (1 + np.sqrt(2) * w + w * w), (-1 + np.sqrt(2) * w - w * w) / (1 + np.sqrt(2) * w + w * w)]
    one_way = lambda x: lfilter([a0, 2 * a0, a0], [1, -b[0], -b[1]], x)
    return one_way(one_way(a)[::-1])[::-1]


def motion(v, x):
    """Loss of velocity up to the end of the rebound, and largest way."""
    stop = int(np.argmax(x))
    return {"delta-v": float(v[0] - v[stop:].min()), "crush": float(x.max())}


def by_scipy(record):
    a, t = cfc_by_hand(record.a, record.dt, 60)[record.after], record.t[record.after]
    v = record.speed + cumulative_trapezoid(a, t, initial=0)
    return {"peak": float(np.abs(a).max())} | motion(v, cumulative_trapezoid(v, t, initial=0))


def by_pyisomme(record):
    """Its class D is CFC 60."""
    a = record.channel().cfc("D")
    v = a.integrate(record.speed)
    x = v.integrate(0)
    values = lambda channel: np.asarray(channel.get_data(), float)[record.after]
    return {"peak": float(np.abs(values(a)).max())} | motion(values(v), values(x))


def olc_by_pyisomme(record):
    velocity = record.channel().cfc("D").crop(0, None).integrate(record.speed)
    return {"OLC": of_channel(calculate_olc(velocity)[0].convert_unit("m/s^2"))}


def of_channel(channel):
    return float(np.asarray(channel.get_data(), float).ravel()[0])


def by_crashmetrics(record):
    a, t = cm_signals.cfc_filter(record.t, record.a, 60)[record.after], record.t[record.after]
    return {"peak": float(np.abs(a).max())} | motion(*cm_energy.integrate_acceleration(t, a, record.speed))


def olc_by_crashmetrics(record):
    """It gives g."""
    a, t = cm_signals.cfc_filter(record.t, record.a, 60)[record.after], record.t[record.after]
    return {"OLC": float(cm_pulse.olc(t, a, record.speed).value) * G}


def by_endaq(record):
    """It has no channel class: a low-pass of 100 Hz stands for CFC 60."""
    low = endaq_filters.butterworth(record.frame(), low_cutoff=None, high_cutoff=100.0)
    after = low[record.after]
    _, v, x = endaq_integrate.integrals(after, n=2)
    v = record.speed + v["a"].to_numpy()
    x = x["a"].to_numpy() + record.speed * (after.index.to_numpy() - after.index[0])
    return {"peak": float(after["a"].abs().max())} | motion(v, x)


def head_by_hand(record):
    """HIC15 over all pairs of samples, and the 3 ms value that every sample of a stretch reaches."""
    a, t = np.abs(record.a) / G, record.t
    area = cumulative_trapezoid(a, t, initial=0)
    best = 0.0
    for k in range(1, int(round(0.015 / record.dt)) + 1):
        mean = (area[k:] - area[:-k]) / (k * record.dt)
        best = max(best, k * record.dt * float(np.maximum(mean, 0).max()) ** 2.5)
    width = int(round(0.003 / record.dt))
    stretches = np.lib.stride_tricks.sliding_window_view(a, width + 1)
    return {"HIC15": best, "3 ms": float(stretches.min(axis=1).max()) * G}


def head_by_pyisomme(record):
    magnitude = Record(record.t, np.abs(record.a), remove_zero=False).channel("11HEADCG00H3ACRA")
    level = calculate_xms(magnitude, 3, "S").convert_unit("m/s^2")
    return {"HIC15": of_channel(calculate_hic(magnitude, 15)), "3 ms": of_channel(level)}


def head_by_crashmetrics(record):
    return {"3 ms": float(cm_acceleration.clip_3ms(record.t, np.abs(record.a), mode="continuous"))}


def kelvin_motion(record, stiffness, damping, t):
    """Acceleration of mass, spring and damper from contact on, until they part."""
    w = np.sqrt(stiffness / record.mass)
    z = damping / (2 * np.sqrt(stiffness * record.mass))
    d = w * np.sqrt(max(1e-12, 1 - z * z))
    x = record.speed / d * np.exp(-z * w * t) * np.sin(d * t)
    v = record.speed * np.exp(-z * w * t) * (np.cos(d * t) - z * w / d * np.sin(d * t))
    return -(w * w * x + 2 * z * w * v)


def window(record):
    """From contact to the largest crush, by the record's own velocity."""
    after = record.after
    t, a = record.t[after], record.a[after]
    v = record.speed + cumulative_trapezoid(a, t, initial=0)
    end = int(np.argmax(v <= 0)) or len(t)
    return t[:end], a[:end]


def stiffness_by_scipy(record):
    t, a = window(record)
    start = [record.mass * 400.0, record.mass * 9.0]
    fit = least_squares(lambda p: kelvin_motion(record, p[0], p[1], t) - a, start, x_scale=start, bounds=(0, np.inf))
    covariance = np.linalg.inv(fit.jac.T @ fit.jac) * 2 * fit.cost / (len(t) - 2)
    half = NORMAL_95 * np.sqrt(np.diag(covariance))
    return {"stiffness": (fit.x[0], fit.x[0] - half[0], fit.x[0] + half[0])}


def aeroid_intervals(record):
    """Output error over the accelerations, as its first example does it, on every fifth sample."""
    t, a = (values[::5] for values in window(record))

    def dynamics(_, x, __, p):
        return np.array([x[1], -(p["k"] * x[0] + p["c"] * x[1]) / record.mass])

    def measured(_, x, __, p):
        return np.array([-(p["k"] * x[0] + p["c"] * x[1]) / record.mass])

    model = aeroid.Model(
        states=["x", "v"],
        controls=[],
        parameters={"k": record.mass * 400.0, "c": record.mass * 9.0},
        dynamics=dynamics,
        outputs=["a"],
        measurement=measured,
    )
    data = aeroid.FlightData(time=t, channels={"a": a})
    fit = aeroid.identify(model, data, ["k", "c"], x0=[0.0, record.speed], bounds={"k": (0, np.inf), "c": (0, np.inf)})
    half = {n: NORMAL_95 * fit.stderr[n] for n in "kc"}
    return {n: (value, value - half[n], value + half[n]) for n, value in fit.parameters.items() if n in half}


def stiffness_by_aeroid(record):
    return {"stiffness": aeroid_intervals(record)["k"]}


def crumple(program, folder, path, flags):
    out = Path(folder) / Path(path).stem
    command = [program, "run", str(path), "-o", str(out), "-q", *flags]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 4):
        raise RuntimeError(done.stderr.strip().splitlines()[0])
    return json.loads((out / "summary.json").read_text()), out


def of_summary(summary):
    metrics = summary["metrics"]
    names = {
        "peak": "peak_acceleration",
        "delta-v": "delta_v",
        "crush": "dynamic_crush",
        "OLC": "olc",
        "HIC15": "hic15",
        "3 ms": "clip_3ms_contiguous",
    }
    found = {row: metrics[name] for row, name in names.items() if metrics.get(name, {}).get("value") is not None}
    out = {}
    for row, metric in found.items():
        ends = (metric.get("low"), metric.get("high"))
        out[row] = abs(metric["value"]) if None in ends else (abs(metric["value"]), *sorted(map(abs, ends)))
    for candidate in summary["candidates"]:
        if candidate["id"] == "kelvin/direct-fit/1":
            known, name = candidate.get("uncertainty") or {}, "stiffness_n_per_m"
            ends = (known.get("interval_low", {}).get(name), known.get("interval_high", {}).get(name))
            value = candidate["parameters"][name]
            out["stiffness"] = value if None in ends else (value, *ends)
    return out


def rating(program, summary, out):
    """The score that Crumple gives its recommended model, and that of the package for the same two curves."""
    for number in ("3-integrate", "2-filter", "6-simulate"):
        unpack = [program, "artifact", "unpack", f"{out}/{number}.mcap", f"{out}/{number}"]
        subprocess.run(unpack, check=True, capture_output=True)

    def wave(number, name):
        for line in (out / number / "waves.ndjson").read_text().splitlines():
            wave = json.loads(line)
            if wave["id"] == name:
                samples = np.fromfile(out / number / wave["file"])
                return wave["t0_s"] + wave["dt_s"] * np.arange(len(samples)), samples
        raise KeyError(name)

    recommended = summary["recommended"]
    simulation = next(c["simulation"] for c in summary["candidates"] if c["id"] == recommended)
    t_test, test = wave("2-filter", summary["test"]["channel"])
    t_model, model = wave("6-simulate", f"{recommended}/acceleration")
    t = np.arange(simulation["from_s"], simulation["to_s"] + 1e-9, 1e-4)
    curves = [np.column_stack([t, np.interp(t, *pair)]) for pair in ((t_test, test), (t_model, model))]
    start = time.perf_counter()
    score = float(ISO18571(*curves).overall_rating())
    return {"rating": simulation["iso18571_score"]}, {"rating": score}, time.perf_counter() - start


def timed(function, *arguments):
    start = time.perf_counter()
    try:
        found = function(*arguments)
    except Exception as error:  # What a package refuses is a cell of the page.
        return {"error": f"{type(error).__name__}: {error}".splitlines()[0][:90]}, time.perf_counter() - start
    return found, time.perf_counter() - start


def shown(value, factor):
    if value is None:
        return ""
    digits = lambda x: f"{factor * x:.4g}" if abs(factor * x) < 1e4 else f"{factor * x:.0f}"
    if isinstance(value, tuple):
        return f"{digits(value[0])} ({digits(value[1])} to {digits(value[2])})"
    return digits(value)


def table(title, rows, truth, found, times):
    """Rows: name and unit. `found`: by tool what it gives."""
    text = f"\n## {title}\n\n| | truth | {' | '.join(found)} |\n|---|---|{'---|' * len(found)}\n"
    for row, unit in rows:
        cells = [shown(values.get(row), UNITS[unit]) for values in found.values()]
        name, known = row + (f", {unit}" if unit else ""), shown(truth.get(row), UNITS[unit]) or "-"
        text += f"| {name} | {known} | {' | '.join(cells)} |\n"
    text += f"| time, ms | | {' | '.join(f'{1e3 * times[tool]:.0f}' for tool in found)} |\n"
    refused = [f"- {tool}: {values['error']}" for tool, values in found.items() if "error" in values]
    return text + ("\n" + "\n".join(refused) + "\n" if refused else "")


PULSE_TOOLS = [
    ("pyisomme", by_pyisomme),
    ("pyisomme", olc_by_pyisomme),
    ("crashmetrics", by_crashmetrics),
    ("crashmetrics", olc_by_crashmetrics),
    ("endaq", by_endaq),
    (SCIPY, by_scipy),
]
FIT_TOOLS = [("AeroID", stiffness_by_aeroid), (SCIPY, stiffness_by_scipy)]
HEAD_TOOLS = [("pyisomme", head_by_pyisomme), ("crashmetrics", head_by_crashmetrics), (SCIPY, head_by_hand)]
PULSE_ROWS = [("peak", "g"), ("delta-v", "km/h"), ("crush", "mm"), ("OLC", "g")]


def compared(record, tools, summary_and_time):
    """What each tool gives, its time; a tool of both lists has both."""
    found, times = {}, {}
    for tool, function in tools:
        values, seconds = timed(function, record)
        found[tool] = found.get(tool, {}) | values
        times[tool] = times.get(tool, 0.0) + seconds
    summary, seconds = summary_and_time
    found[CRUMPLE], times[CRUMPLE] = (of_summary(summary[0]) if isinstance(summary, tuple) else summary), seconds
    return found, times


def made_car(folder, number):
    text = (folder / f"{number}.csv").read_text().splitlines()
    truth = json.loads((folder / f"{number}.json").read_text())
    rows = [line for line in text if line and line[0] in "-0123456789"]
    t, a = np.array([[float(cell) for cell in line.split(",")[:2]] for line in rows]).T
    mass = truth["parameters"]["mass_kg"]
    return Record(t, a * G, round(3.6 * truth["impact_speed_m_per_s"]) / 3.6, mass), truth


FLAGS = ["--time-zero", "0s", "--channel", "accel"]


def holds(interval, truth):
    """An end that is not known is open."""
    if interval is None:
        return False
    _, low, high = interval
    return (low is None or low <= truth) and (high is None or truth <= high)


def cover(program, work, cars):
    """How many 95 % intervals of stiffness and damping hold the truth, by who made them."""
    numbers = sorted(int(path.stem) for path in cars.glob("*.json"))
    names = {"k": "stiffness_n_per_m", "c": "damping_n_s_per_m"}
    held = {tool: dict.fromkeys(names, 0) for tool in ("AeroID", CRUMPLE)}
    both, widths, seconds = dict.fromkeys(held, 0), {tool: [] for tool in held}, dict.fromkeys(held, 0.0)
    for number in numbers:
        record, truth = made_car(cars, number)
        made = {"AeroID": timed(aeroid_intervals, record)}
        summary, spent = timed(crumple, program, work, cars / f"{number}.csv", FLAGS)
        ours = {}
        for candidate in summary[0]["candidates"] if isinstance(summary, tuple) else []:
            if candidate["id"] == "kelvin/direct-fit/1":
                known, values = candidate["uncertainty"], candidate["parameters"]
                ends = lambda f: (values[f], known["interval_low"][f], known["interval_high"][f])
                ours = {n: ends(f) for n, f in names.items()}
        made[CRUMPLE] = (ours, spent)
        for tool, (intervals, spent) in made.items():
            inside = {n: holds(intervals.get(n), truth["parameters"][f]) for n, f in names.items()}
            for n in names:
                held[tool][n] += inside[n]
            both[tool] += all(inside.values())
            seconds[tool] += spent
            if "k" in intervals and None not in intervals["k"]:
                widths[tool].append((intervals["k"][2] - intervals["k"][1]) / truth["parameters"][names["k"]])
    text = f"""
## Do the intervals hold?
{len(numbers)} made cars on a spring and a damper, recorded [as a laboratory
does](methods/prediction.md#records-as-a-laboratory-measures-them): trigger, stated speed, zero level, noise and filter
err. The 95 % interval is the value with 1.96 standard errors of AeroID, and `interval_low`, `interval_high` of Crumple.

| | stiffness held | damping held | both | median width of stiffness, % | time a car, ms |
|---|---|---|---|---|---|
"""
    for tool in held:
        width = 100 * float(np.median(widths[tool])) if widths[tool] else float("nan")
        text += (
            f"| {tool} | {held[tool]['k']} of {len(numbers)} | {held[tool]['c']} of {len(numbers)} | {both[tool]} | "
            f"{width:.2f} | {1e3 * seconds[tool] / len(numbers):.0f} |\n"
        )
    return text + (
        "\nAeroID counts white noise alone: trigger, speed and what a filter leaves have no error there. It is made\n"
        "for flight tests, whose records are longer and start at rest.\n"
    )


HEAD = """# The same records through other programs

<!-- Written by `just peers`; do not edit. -->

Five records through the public packages that a crash engineer would take, `scipy` by hand and Crumple. Every number is
computed by the command, from the same samples, without their mean before contact. An empty cell: the package has no
such function. *By hand* are some lines of `scripts/peers.py`.
Crumple's time is that of a whole run with all models, report and predictions.
"""


def main(program, cars, shared, page):
    cars, shared = Path(cars), Path(shared)
    versions = ", ".join(f"{name} {version(package)}" for package, name in PACKAGES.items())
    ours = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    made_by = f"{versions}, {ours}. Each time is that of one call on a machine that did other things too."
    if "debug" in Path(program).parts:
        made_by += " Crumple is its development build here, which is slower than a release."
    text = f"{HEAD}\n{textwrap.fill(made_by, 120)}\n"
    with tempfile.TemporaryDirectory() as work:
        ev5 = shared / "data/nhtsa-v10146-camry-frontal/v10146.EV5"
        t, a = np.loadtxt(ev5.with_suffix(".093"), unpack=True)
        run = timed(crumple, program, work, ev5, [])
        record = Record(t, a * G, run[0][0]["test"]["impact_speed_m_per_s"], run[0][0]["test"]["mass_kg"])
        found, times = compared(record, PULSE_TOOLS + FIT_TOOLS, run)
        score = rating(program, *run[0])
        found[CRUMPLE] |= score[0]
        found["objective-rating-metrics"], times["objective-rating-metrics"] = score[1:]
        rows = [*PULSE_ROWS, ("stiffness", "kN/m"), ("rating", "")]
        text += table("A car at the wall: NHTSA 10146, Toyota Camry, channel 93", rows, {}, found, times)
        text += (
            "\nThe fitted spring is that of a mass on a spring and a damper, which this car is not: the widths say it.\n"
            "The rating is ISO/TS 18571 of Crumple's recommended model; both rate the same two curves at 10 kHz.\n"
        )

        mme = shared / "data/iso-mme-98_7707/98_7707.001"
        lines = mme.read_text(errors="replace").splitlines()
        samples = [float(line) for line in lines if line[:1] in "-0123456789" and ":" not in line]
        record = Record(-0.05 + 1e-4 * np.arange(len(samples)), np.array(samples) * G, remove_zero=False)
        run = timed(crumple, program, work, mme, ["--allow-missing"])
        found, times = compared(record, HEAD_TOOLS, run)
        text += table("A head: ISO-MME 98_7707, x alone", [("HIC15", ""), ("3 ms", "g")], {}, found, times)
        text += (
            "\nThe channel is alone, so its magnitude stands for the resultant. Without the `.mme` of its test pyisomme does\n"
            "not read it: its samples were read by hand.\n"
        )

        t = np.arange(-1000, 3001) * 1e-4
        peak, length = 17.2 * G, 0.125
        a = np.where((t >= 0) & (t < length), -peak * np.sin(np.pi * t / length), 0.0)
        speed = 2 / np.pi * peak * length
        sled = Path(work) / "sled.csv"
        sled.write_text("time [s],acceleration [g]\n" + "".join(f"{x:.4f},{y / G:.9f}\n" for x, y in zip(t, a)))
        flags = ["--time-zero", "0s", "--impact-speed", f"{speed}m/s", "--mass", "1000kg"]
        run = timed(crumple, program, work, sled, flags)
        found, times = compared(Record(t, a, speed, 1000.0), PULSE_TOOLS, run)
        truth = {"peak": peak, "delta-v": speed, "crush": speed * length / 2}
        text += table("A sled: half sine of 17.2 g over 125 ms", PULSE_ROWS, truth, found, times)
        text += "\nTruth in closed form: 2/π of peak and duration; the way to the stop is half of speed and duration.\n"

        tdms = shared / "data/iihs-diadem-tdms/Target Pulse.tdms"
        group = TdmsFile.read(tdms).groups()[0]
        t, a, v = (channel[:] for channel in group.channels()[:3])
        is_there = np.isfinite(a)
        run = timed(crumple, program, work, tdms, ["--mass", "1500kg", "--impact-speed", "10m/s"])
        record = Record(t[is_there], -a[is_there] * G, float(v[is_there][-1]), 1500.0)
        found, times = compared(record, PULSE_TOOLS, run)
        truth = {"delta-v": float(v[is_there][-1])}
        text += table("A target pulse: TDMS of IIHS, 1 kHz", PULSE_ROWS, truth, found, times)
        text += "\nTruth: the velocity that the file itself holds. The others read it by npTDMS.\n"

        record, truth = made_car(cars, 0)
        run = timed(crumple, program, work, cars / "0.csv", FLAGS)
        found, times = compared(record, PULSE_TOOLS + FIT_TOOLS, run)
        v0 = truth["impact_speed_m_per_s"]
        truth = {
            "crush": truth["dynamic_crush_m"],
            "delta-v": v0 - truth["rebound_velocity_m_per_s"],
            "stiffness": truth["parameters"]["stiffness_n_per_m"],
        }
        rows = [*PULSE_ROWS, ("stiffness", "kN/m")]
        text += table("A made car: a spring and a damper of known size", rows, truth, found, times)
        text += cover(program, work, cars)
    Path(page).write_text(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
