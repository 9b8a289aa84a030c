"""Single steps on arrays: each calls the program three times, to pack its input, for its result, to unpack it."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._artifact import Array, Artifact, Record, Wave, read, write
from ._program import Refused, Usage, call, flags, number
from ._shown import in_lines, of_mapping


GRAVITY = 9.80665
# Shares of the impact speed that a whole pulse takes away: it stops the vehicle, which rebounds by 30 % at most, and a
# record that ends early has lost a half or less.
LEAST_TAKEN, MOST_TAKEN = 0.5, 1.5


@dataclass(frozen=True, eq=False)
class Motion:
    """Time, s, and what moves with it, SI units; crush is positive. `record` has its events."""

    time: Array
    acceleration: Array
    velocity: Array
    displacement: Array
    record: Record

    def __repr__(self) -> str:
        step = float(self.time[1] - self.time[0])
        return in_lines(
            f"<crumple.Motion, {len(self.time)} samples, every {step:.6g} s>",
            f"crush up to {float(self.displacement.max()):.4g} m, speed {float(self.velocity[0]):.4g} to "
            f"{float(self.velocity.min()):.4g} m/s",
            of_mapping(self.record),
        )


@dataclass(frozen=True, eq=False)
class LinearModel:
    """An identified model: poles, 1/s; state space (`dt` 0: continuous); transfer function in s, empty without one.

    `fit` says how well `simulated` follows the output, percent; `records` has all that the program found.
    """

    id: str
    poles: NDArray[np.complex128]
    a: Array
    b: Array
    c: Array
    d: Array
    dt: float
    numerator: Array
    denominator: Array
    fit: float
    simulated: Array
    records: dict[str, Record]

    def __repr__(self) -> str:
        kind = "continuous" if self.dt == 0 else f"sampled every {self.dt:.6g} s"
        return in_lines(
            f"<crumple.LinearModel {self.id}, order {len(self.poles)}, {kind}>", f"fit {self.fit:.2f} %",
            "poles, 1/s: " + ", ".join(f"{pole:.4g}" for pole in self.poles),
        )


def filter_cfc(a: ArrayLike, dt: float, cfc: int = 60, *, mode: str = "iso6487", **options: object) -> Array:
    """Filters an array to a channel frequency class, 60, 180, 600 or 1000; its zero level stays.

    `mode` is `iso6487`, `sae_reflect` or `sae_zero_state`. Options: `crumple filter`.
    """
    given = {"cfc": cfc, "mode": mode, "zero_level": "none", "rate": "full", **options}
    return _call("filter", _pulse(a, dt), given).waves["a"].samples


def crush(
    a: ArrayLike, dt: float, v0: float, *, mass: float | None = None, unit: str | None = None, **options: object
) -> Motion:
    """Integrates an acceleration, negative in a frontal impact, from the speed `v0`, m/s, at its first sample.

    `unit` is `"m/s^2"`, taken where none is stated, or `"g"`. `mass` is in kg. Options: `crumple integrate`.
    """
    a = _acceleration(a, dt, v0, unit)
    found = _call("integrate", _pulse(a, dt, v0, mass), options)
    return _motion("a", found, a, found.records["/events"])


def era(y: ArrayLike, dt: float, *, order: int | None = None, **options: object) -> LinearModel:
    """A model of the free motion `y`; without `order` by its singular values. Options: `crumple identify`."""
    return _identify("era", {"y": y}, dt, {"orders": order or "auto", **options})


def okid(u: ArrayLike, y: ArrayLike, dt: float, *, order: int | None = None, **options: object) -> LinearModel:
    """A model of the output `y` of the input `u`, by an observer and ERA. Options: `crumple identify`."""
    return _identify("okid", {"u": u, "y": y}, dt, {"orders": order or "auto", **options})


def n4sid(u: ArrayLike, y: ArrayLike, dt: float, *, order: int | None = None, **options: object) -> LinearModel:
    """A subspace model of the output `y` of the input `u`; without `order` by its BIC. Options: `crumple identify`."""
    return _identify("n4sid", {"u": u, "y": y}, dt, {"orders": order or "auto", **options})


def arx(u: ArrayLike, y: ArrayLike, dt: float, orders: Sequence[int] = (4, 4, 0), **options: object) -> LinearModel:
    """A least-squares model by its numbers of past outputs, of inputs and of samples of delay: `orders`."""
    return _identify("arx", {"u": u, "y": y}, dt, {"arx_orders": orders, **options})


def tfest(u: ArrayLike, y: ArrayLike, dt: float, poles: int = 4, zeros: int = 1, **options: object) -> LinearModel:
    """A continuous transfer function of the output `y` over the input `u`. Options: `crumple identify`."""
    return _identify("tfest", {"u": u, "y": y}, dt, {"poles": poles, "zeros": zeros, **options})


def fit(
    model: str, a: ArrayLike, dt: float, *, mass: float, v0: float, unit: str | None = None, **options: object
) -> Record:
    """Fits a lumped model, `"kelvin"`, to an acceleration as `crush` takes it: its candidate, with `parameters`.

    Options: `crumple parameter-solve`.
    """
    pulse = _pulse(_acceleration(a, dt, v0, unit), dt, v0, mass)
    given = {"models": model, "method": "direct-fit", **options}
    found = _call("parameter-solve", pulse | _call("integrate", pulse, {"uncertainty_replicates": 0}), given)
    return next(iter(found.below("/parameters/").values()))


def simulate(model: str, parameters: Mapping[str, float], *, v0: float, t: ArrayLike, **options: object) -> Motion:
    """The motion of a lumped model with `parameters` as a candidate has them, at times `t` with one step from 0, s."""
    times = samples("t", t)
    dt = float(times[-1]) / (len(times) - 1)
    if dt <= 0 or not np.allclose(times, np.arange(len(times)) * dt, rtol=0, atol=1e-6 * dt):
        raise Refused("t has no equal steps from 0\n  hint: numpy.arange(1001) * 1e-4")
    id, known = f"{model}/given/1", {name: number(name, value) for name, value in parameters.items()}
    candidate = Record("crumple.Candidate.v1", model=model, method="given", parameters=known, physical=True)
    events = Record("crumple.Events.v1", channel="a", time_zero_s=0.0, time_zero_rule="given")
    records = {"/test": _test(v0, None, []), f"/parameters/{id}": candidate, "/events": events}
    rest = {"a/displacement": Wave(np.zeros(len(times)), dt, 0.0, "displacement")}
    found = _call("simulate", Artifact(records, rest), options)
    return _motion(id, found, found.waves[f"{id}/acceleration"].samples, found.records[f"/simulation/{id}"])


def _call(stage: str, artifact: Artifact, options: Mapping[str, object]) -> Artifact:
    with tempfile.TemporaryDirectory() as scratch:
        write(f"{scratch}/array.mcap", artifact)
        call(stage, "array.mcap", "-o", "result.mcap", *flags(options), cwd=scratch)
        return read(f"{scratch}/result.mcap")


def _pulse(a: ArrayLike, dt: float, v0: float | None = None, mass: float | None = None) -> Artifact:
    """A test with one channel."""
    wave = Wave(samples("a", a), number("dt", dt, positive=True), 0.0, "acceleration")
    return Artifact({"/test": _test(v0, mass, [_channel("a", wave)])}, {"a": wave})


def _test(v0: float | None, mass: float | None, channels: list[dict[str, str]]) -> Record:
    return Record(
        "crumple.Test.v1", title="array", source={"format": "array", "name": "array", "digest": ""}, channels=channels,
        mass_kg=None if mass is None else number("mass", mass, positive=True),
        impact_speed_m_per_s=None if v0 is None else number("v0", v0),
    )


def _channel(id: str, wave: Wave) -> dict[str, str]:
    return {"id": id, "location": "", "axis": "x", "quantity": wave.quantity, "unit": wave.unit, "status": "valid"}


def _identify(method: str, arrays: Mapping[str, ArrayLike], dt: float, options: Mapping[str, object]) -> LinearModel:
    waves = {name: Wave(samples(name, one), number("dt", dt, positive=True)) for name, one in arrays.items()}
    if len({len(wave.samples) for wave in waves.values()}) > 1:
        raise Refused("u and y have different lengths")
    ends = {"inputs": "u", "outputs": "y"} if "u" in waves else {"channel": "y"}
    test = _test(None, None, [_channel(*one) for one in waves.items()])
    found = _call("identify", Artifact({"/test": test}, waves), {"methods": method, **ends, **options})
    id, about = next(iter(found.below("/identification/").items()))
    models, modes = found.below(f"/model/{id}/"), found.records[f"/modes/{id}"]
    state = models.get("discrete") or models["continuous"]
    ratio = models.get("transfer-function") or Record("", numerator=[], denominator=[])
    a, b, c, d, numerator, denominator = (
        np.array(one, np.float64) for one in (state.a, state.b, state.c, state.d, ratio.numerator, ratio.denominator)
    )
    poles = np.array([complex(one["re_per_s"], one["im_rad_per_s"]) for one in modes.modes + modes.other_poles])
    simulated = found.waves[f"{id}/simulated"].samples
    return LinearModel(
        id, poles, a, b, c, d, state.sample_time_s, numerator, denominator, about.fit_percent, simulated, found.records
    )


def _motion(id: str, found: Artifact, acceleration: Array, record: Record) -> Motion:
    velocity, displacement = found.waves[f"{id}/velocity"], found.waves[f"{id}/displacement"]
    return Motion(velocity.time, acceleration, velocity.samples, displacement.samples, record)


def _acceleration(a: ArrayLike, dt: float, v0: float, unit: str | None) -> Array:
    """An acceleration in m/s². Refused: one without a unit that takes the speed away in g, and not in m/s²."""
    array, units = samples("a", a), {"m/s^2": 1.0, "m/s²": 1.0, "g": GRAVITY}
    if unit is not None:
        if unit not in units:
            raise Usage(f"unit is {unit!r}, expected 'm/s^2' or 'g'")
        return array * units[unit]
    taken, speed = -float(array.sum()) * number("dt", dt, positive=True), number("v0", v0)
    if speed > 0 and taken < LEAST_TAKEN * speed <= GRAVITY * taken < MOST_TAKEN * speed:
        raise Refused(
            f"a takes away {taken:.2f} of {speed:.2f} m/s; in g it would be {GRAVITY * taken:.2f} m/s\n"
            '  hint: unit="g", or unit="m/s^2" if it is right'
        )
    return array


def samples(name: str, values: ArrayLike) -> Array:
    """One-dimensional finite numbers as `float64`; anything else is refused with its place."""
    array = np.asarray(values)
    if np.ma.is_masked(values):
        problem = f"{name} has masked values\n  hint: .compressed(), or .filled(value)"
    elif array.ndim != 1:
        problem = f"{name} has {array.ndim} dimensions, expected one\n  hint: {name}[:, 0] is the first column"
    elif array.dtype.kind not in "fiu":
        problem = f"{name} holds {array.dtype}, expected real numbers"
    elif len(array) < 2:
        problem = f"{name} has {len(array)} values, expected two or more"
    elif not np.isfinite(array).all():
        place = np.flatnonzero(~np.isfinite(array))[0]
        problem = f"{name}[{place}] is {array[place]}, expected finite numbers"
    else:
        return np.ascontiguousarray(array, np.float64)
    raise Refused(problem)
