"""Crumple: a crash pulse in, a physical model out.

`run` takes a record through all stages; `read` opens an artifact; `filter_cfc`, `crush`, `era`, `fit` and others are
single steps on arrays. All of them start the program `crumple`, which this package brings. Numbers are SI.
"""

from importlib.metadata import PackageNotFoundError, version

from ._artifact import Artifact, Record, Wave, read, stage, write
from ._kernels import LinearModel, Motion, arx, crush, era, filter_cfc, fit, n4sid, okid, simulate, tfest
from ._program import CrumpleError, NoResult, Refused, Usage
from ._run import Predictions, Run, compare, damage, diff, open_run, predict, run, together

__all__ = [
    "Artifact", "CrumpleError", "LinearModel", "Motion", "NoResult", "Predictions", "Record", "Refused", "Run", "Usage",
    "Wave", "arx", "compare", "crush", "damage", "diff", "era", "filter_cfc", "fit", "n4sid", "okid", "open_run", "predict", "read", "run",
    "simulate", "stage", "tfest", "together", "write",
]

try:
    __version__ = version("crumple")
except PackageNotFoundError:  # imported from its sources
    __version__ = "0"
