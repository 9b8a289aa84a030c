"""Finds the program `crumple`, calls it, and raises what it says."""

from __future__ import annotations

import functools
import logging
import math
import os
import shutil
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Mapping
from pathlib import Path
from typing import Any

LOG = logging.getLogger("crumple")


class CrumpleError(Exception):
    """There is no result. `str(error)` is what the program said, whole, with its hint."""

    exit_code = 1


class Usage(CrumpleError, TypeError):
    """An argument has no meaning."""

    exit_code = 2


class Refused(CrumpleError, ValueError):
    """A record, an artifact or an array cannot be used."""

    exit_code = 3


class NoResult(CrumpleError):
    """There is no acceptable result. `run` is the run with the diagnosis, where it was one."""

    exit_code = 4
    run: Any = None


@functools.cache
def program() -> str:
    """The program of this package: in the environment, of the user, beside `--target`, at last on the `PATH`."""
    user = sysconfig.get_path("scripts", sysconfig.get_preferred_scheme("user"))
    beside = [sysconfig.get_path("scripts"), os.path.dirname(sys.executable), user, Path(__file__).parents[1] / "bin"]
    for path in [*map(str, beside), None]:
        if found := shutil.which("crumple", path=path):
            return found
    raise CrumpleError("the program crumple is missing\n  hint: pip install --force-reinstall crumple")


def call(*words: str, allowed: tuple[int, ...] = (0,), cwd: str | Path | None = None) -> tuple[int, str]:
    """Calls the program: exit code and standard output; its standard error goes to the log `crumple`.

    Errors: an exit code that is not allowed. An interruption ends the program and all it has started.
    """
    with subprocess.Popen(
        [program(), *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=cwd,
        text=True, encoding="utf-8", errors="replace", start_new_session=True,
    ) as process:
        try:
            out, said = process.communicate()
        except BaseException:
            if process.poll() is None:
                process.terminate() if sys.platform == "win32" else os.killpg(process.pid, signal.SIGTERM)
            raise
    code = process.returncode
    LOG.info("%s", said.rstrip())
    if code in allowed:
        return code, out
    if code < 0:
        said += f"killed by signal {-code}{' (out of memory?)' if code == -9 else ''}"
    error = {2: Usage, 3: Refused, 4: NoResult}.get(code, CrumpleError)(said.strip())
    error.exit_code = code
    raise error


def number(name: str, value: object, *, positive: bool = False) -> float:
    """The value as a finite number. Errors: `Usage`."""
    try:
        real = math.nan if isinstance(value, bool) else float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        real = math.nan
    if not math.isfinite(real) or (positive and real <= 0):
        raise Usage(f"{name} is {value!r}, expected a {'positive ' if positive else ''}number")
    return real


def quantity(name: str, value: float | str | None, unit: str) -> str | None:
    """A quantity as the program reads it: a text as typed, a number in its SI unit."""
    return value if value is None or isinstance(value, str) else f"{number(name, value, positive=unit == 'kg')!r}{unit}"


def flags(options: Mapping[str, object]) -> list[str]:
    """Options as flags: `fit_to="60ms"` is `--fit-to=60ms`. Lists are joined by commas; `None` is left out."""
    return [f"--{name.replace('_', '-')}={text(value)}" for name, value in options.items() if value is not None]


def text(value: object) -> str:
    """A value as it is typed."""
    if isinstance(value, (list, tuple)):
        return ",".join(map(text, value))
    return str(value).lower() if isinstance(value, bool) else str(value)
