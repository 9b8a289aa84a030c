"""Artifacts after docs/format.md: the program reads them, this module writes them; a Python function as a stage."""

from __future__ import annotations

import functools
import json
import operator
import os
import struct
import sys
import tempfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._program import CrumpleError, call

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, METADATA, DATA_END = 1, 2, 3, 4, 5, 12, 15
BLOCK, ORIGIN_NS = 65_536, 1_000_000_000_000
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


@dataclass(frozen=True, eq=False)
class Artifact:
    """Records by topic (`/events`), waveforms by id (`accel_g/velocity`), and where the artifact came from."""

    records: dict[str, Record] = field(default_factory=dict)
    waves: dict[str, Wave] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)

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
    """Writes records and waveforms; the latter start 1000 s before time zero at the earliest."""
    file = bytearray(MAGIC + _section(HEADER, _text("") + _text("crumple python/1")))

    def add(number: int, topic: str, encoding: str, schema: str, about: bytes, messages: dict[float, bytes]) -> None:
        ids = struct.pack("<H", number)
        file.extend(_section(SCHEMA, ids + _text(schema) + _text("jsonschema") + _text("{}")))
        file.extend(_section(CHANNEL, ids + ids + _text(topic) + _text(encoding) + _counted(about)))
        for time_s, data in messages.items():
            at = ORIGIN_NS + round(1e9 * time_s)
            file.extend(_section(MESSAGE, struct.pack("<HIQQ", number, 0, at, at) + data))

    start = min((wave.t0 for wave in artifact.waves.values()), default=0.0)
    for number, (topic, record) in enumerate(artifact.records.items(), 1):
        data = json.dumps(record, allow_nan=False, ensure_ascii=False).encode()
        add(number, topic, "json", record.schema, b"", {start: data})
    for number, (id, wave) in enumerate(artifact.waves.items(), 1 + len(artifact.records)):
        blocks = {}
        for first in range(0, len(wave.samples), BLOCK):
            block = np.asarray(wave.samples[first : first + BLOCK], "<f8")
            head = struct.pack("<qdQQ", round(1e9 * wave.t0), wave.dt, first, len(block))
            blocks[wave.t0 + first * wave.dt] = head + block.tobytes()
        about = _text("quantity") + _text(wave.quantity) + _text("unit") + _text(wave.unit)
        add(number, f"/wave/{id}", "bincode", "crumple.WaveBlock.v1", about, blocks)
    origin = _counted(_text("time.t0_offset_ns") + _text(str(ORIGIN_NS)))
    file.extend(_section(METADATA, _text("content") + origin))
    file.extend(_section(DATA_END, struct.pack("<I", zlib.crc32(file))) + _section(FOOTER, bytes(20)) + MAGIC)
    Path(path).write_bytes(file)


def _section(code: int, body: bytes) -> bytes:
    return struct.pack("<BQ", code, len(body)) + body


def _counted(body: bytes) -> bytes:
    return struct.pack("<I", len(body)) + body


def _text(text: str) -> bytes:
    return _counted(text.encode())


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
