"""Artifacts: the program unpacks and packs them (docs/format.md); a Python function as a stage."""

from __future__ import annotations

import functools
import json
import operator
import os
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._program import CrumpleError, call
from ._shown import html_table, in_lines, of_mapping

UNITS = {
    "acceleration": "m/s^2", "velocity": "m/s", "velocity_change": "m/s", "displacement": "m", "force": "N",
    "moment": "N*m", "angle": "rad", "angular_velocity": "rad/s", "angular_acceleration": "rad/s^2",
    "pressure": "Pa", "voltage": "V",
}
Array = NDArray[np.float64]


class Record(dict[str, Any]):
    """A record with its fields as items and attributes, `record.parameters`, and the `schema` that explains them."""

    def __init__(self, schema: str, /, **fields: Any) -> None:
        super().__init__(fields)
        self.schema = schema

    def __getattr__(self, name: str) -> Any:
        if name not in self:
            raise AttributeError(name)
        return self[name]

    def __repr__(self) -> str:
        return in_lines(f"<crumple.Record {self.schema}>", of_mapping(self), f"fields: {', '.join(self)}")

    def _repr_html_(self) -> str:
        return html_table(self.items())


@dataclass(frozen=True, eq=False)
class Wave:
    """A waveform in SI units; `t0` is the time of its first sample, s. `samples` that were read cannot be changed."""

    samples: Array
    dt: float
    t0: float = 0.0
    quantity: str = "other"

    @property
    def time(self) -> Array:
        """Time of every sample, s."""
        return np.asarray(self.t0 + np.arange(len(self.samples)) * self.dt, np.float64)

    @property
    def unit(self) -> str:
        """SI unit of the samples."""
        return UNITS.get(self.quantity, "1")

    def __repr__(self) -> str:
        count, end = len(self.samples), self.t0 + (len(self.samples) - 1) * self.dt
        return in_lines(
            f"<crumple.Wave {self.quantity}, {self.unit}>",
            f"{count} samples from {self.t0:.6g} to {end:.6g} s, every {self.dt:.6g} s",
            f"lowest {self.samples.min():.5g}, highest {self.samples.max():.5g}" if count else "",
        )


@dataclass(frozen=True, eq=False)
class Artifact:
    """Records by topic (`/events`), waveforms by id (`accel_g/velocity`), and where the artifact came from."""

    records: dict[str, Record] = field(default_factory=dict)
    waves: dict[str, Wave] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        return in_lines("<crumple.Artifact>", f"records: {', '.join(self.records)}", f"waves: {', '.join(self.waves)}")

    def __or__(self, other: Artifact) -> Artifact:
        """Both in one; what both have is that of the other."""
        return Artifact(self.records | other.records, self.waves | other.waves, other.provenance)

    def below(self, topic: str) -> dict[str, Record]:
        """Records below a topic by the rest of it: `below("/parameters/")` has the candidates by their ids."""
        return {name[len(topic) :]: record for name, record in self.records.items() if name.startswith(topic)}


def read(path: str | os.PathLike[str]) -> Artifact:
    """Reads an artifact, `*.mcap`. Errors: `Refused`, the file is none or is damaged."""
    with tempfile.TemporaryDirectory() as scratch:
        call("artifact", "unpack", os.path.abspath(path), f"{scratch}/plain")
        folder = Path(scratch, "plain")
        of = folder / "provenance.json"
        artifact = Artifact(provenance=json.loads(of.read_bytes()) if of.exists() else {})
        for one in map(json.loads, (folder / "records.ndjson").read_bytes().splitlines()):
            artifact.records[one["topic"]] = Record(one["schema"], **one["data"])
        for one in map(json.loads, (folder / "waves.ndjson").read_bytes().splitlines()):
            samples = np.fromfile(folder / one["file"], "<f8").astype(np.float64, copy=False)
            samples.flags.writeable = False
            artifact.waves[one["id"]] = Wave(samples, one["dt_s"], one["t0_s"], one["quantity"])
    return artifact


def write(path: str | os.PathLike[str], artifact: Artifact) -> None:
    """Writes records and waveforms. Errors: `Refused`, what is no record of its schema, or no finite number."""
    with tempfile.TemporaryDirectory() as scratch:
        records = [{"topic": topic, "schema": one.schema, "data": one} for topic, one in artifact.records.items()]
        waves = []
        for number, (id, wave) in enumerate(artifact.waves.items()):
            about = {"id": id, "quantity": wave.quantity, "t0_s": wave.t0, "dt_s": wave.dt}
            waves.append({**about, "samples": len(wave.samples), "file": f"{number}.f64"})
            np.asarray(wave.samples, "<f8").tofile(f"{scratch}/{number}.f64")
        for name, lines in (("records", records), ("waves", waves)):
            texts = [json.dumps(line, allow_nan=False, ensure_ascii=False) + "\n" for line in lines]
            Path(scratch, f"{name}.ndjson").write_text("".join(texts), "utf-8")
        call("artifact", "pack", scratch, os.path.abspath(path))


def stage(function: Callable[[Artifact], Artifact]) -> None:
    """Runs a function as a stage, called with `INPUT... -o OUTPUT`; all inputs are one artifact.

    A `CrumpleError` of the function ends the program with its text and exit code.
    """
    import argparse

    parser = argparse.ArgumentParser(allow_abbrev=False)
    parser.add_argument("inputs", nargs="+")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("-p", "--pipeline")
    known, _ = parser.parse_known_args()
    try:
        write(known.output, function(functools.reduce(operator.or_, map(read, known.inputs))))
    except CrumpleError as error:
        print(f"error: {str(error).removeprefix('error: ')}", file=sys.stderr)
        sys.exit(error.exit_code)
