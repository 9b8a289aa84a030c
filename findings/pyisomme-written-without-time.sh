#!/usr/bin/env bash
# Guess: a channel made from samples and times, written as ISO-MME and read again, has the same times.
# Seen: neither the time of the first sample nor the interval is written; the reader then counts samples, 0, 1,
#   2, ..., as seconds, and says so in a log line alone.
# Version: pyisomme 1.1.0, Python 3.11
# Hurts: converted records lose rate and time zero: a pulse of 0.25 s is 2500 s long, and its change of velocity
#   10,000 times too large.
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


time = np.arange(-500, 2001) * 1e-4
code = "10VEHC000000ACXP"
test = pyisomme.Isomme(test_number="T1", channels=[channel(code, time, -200 * np.sin(time * 30), "m/s^2")])
test.write("T1.mme")
header = open("Channel/T1.001").read().splitlines()[:10]
named = [line for line in header if line.startswith(("Sampling interval", "Time of first sample"))]
back = pyisomme.Isomme().read("T1.mme").channels[0]
print("written from, to, s:", time[0], time[-1], "lines of the header about time:", named)
print("read from, to, s:", back.data.index[0], back.data.index[-1], "samples:", len(back.data))
assert named == [], "changed: times are written"
assert list(back.data.index[:3]) == [0, 1, 2] and back.data.index[-1] == 2500, "changed: times as read"
assert np.allclose(back.data.iloc[:, 0], -200 * np.sin(time * 30), atol=1e-6), "changed: samples"
PY
venv/bin/python run.py
