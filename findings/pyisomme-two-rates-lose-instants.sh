#!/usr/bin/env bash
# Guess: the sum, difference or resultant of a channel at 10 kHz and one at 1 kHz is on the 101 common instants,
#   or interpolated.
# Seen: 15 of the 101 are lost, since times are compared as exact doubles and 3 x 0.001 is not 30 x 0.0001; the
#   result is unevenly spaced, by 1 to 4 ms.
# Version: pyisomme 1.1.0, Python 3.11
# Hurts: differences of left and right sensors and resultants of channels of different rates have holes, and the
#   peak may be in one; the filters that follow suppose even steps.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  pyisomme==1.1.0 numpy==1.26.4 scipy==1.12.0 pandas==2.2.3
cat > run.py <<'PY'
import logging
from importlib.metadata import version

import numpy as np
import pandas as pd
import pyisomme
from pyisomme.channel import Channel

logging.disable(logging.CRITICAL)
print("pyisomme", version("pyisomme"))


def channel(code, time, values, unit):
    return Channel(code, pd.DataFrame({code: values}, index=time), unit)


fast = channel("10VEHC000000ACXP", np.arange(2001) * 1e-4, np.ones(2001), "m/s^2")
slow = channel("10VEHC000000ACXP", np.arange(101) * 1e-3, np.ones(101), "m/s^2")
both = fast - slow
steps = np.unique(np.round(np.diff(both.data.index), 6))
resultant = pyisomme.calculate_resultant(fast, slow, fast)
print("common instants: 101, in the difference:", len(both.data), "in the resultant:", len(resultant.data))
print("steps of the difference, s:", steps)
assert len(both.data) == 86 and len(resultant.data) == 86, "changed: number of instants"
assert np.allclose(steps, [0.001, 0.002, 0.003, 0.004]), "changed: steps"
PY
venv/bin/python run.py
