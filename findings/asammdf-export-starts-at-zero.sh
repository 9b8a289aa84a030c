#!/usr/bin/env bash
# Guess: a record from -50 ms to 150 ms keeps its times in a table and in an exported CSV, so contact stays at 0
#   s.
# Seen: the table and the CSV begin at 0 s and contact is at 0.05 s; the exported MATLAB file of the same
#   measurement keeps -0.05 s.
# Version: asammdf 8.8.28, Python 3.11
# Hurts: whoever reads the peak time, or takes velocity and crush from t = 0, is 50 ms early; two exports of one
#   test disagree.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  asammdf==8.8.28 numpy==2.4.6 pandas==3.1.1 scipy==1.17.1
cat > run.py <<'PY'
from importlib.metadata import version

import numpy as np
from asammdf import MDF, Signal
from scipy.io import loadmat

print("asammdf", version("asammdf"))
time = np.arange(-500, 1501) * 1e-4
pulse = np.where((time > 0) & (time < 0.1), -200 * np.sin(np.pi * time / 0.1), 0.0)
record = MDF()
record.append(Signal(pulse, time, name="accel", unit="m/s^2"))

table = record.to_dataframe()
record.export("csv", "out.csv", single_time_base=True)
rows = np.genfromtxt("out.csv", delimiter=",", skip_header=1)
record.export("mat", "out.mat")
matlab = loadmat("out.mat")
matlab_time = next(v for k, v in matlab.items() if "time" in k and not k.startswith("__")).ravel()

seen = {
    "record": float(time[0]),
    "table": float(table.index[0]),
    "csv": float(rows[0, 0]),
    "mat": float(matlab_time[0]),
}
peak = {"record": float(time[pulse.argmin()]), "csv": float(rows[rows[:, 1].argmin(), 0])}
print("first time, s:", seen)
print("time of the peak, s:", peak)
assert np.allclose(list(seen.values()), [-0.05, 0.0, 0.0, -0.05]), "changed: first times"
assert np.allclose(list(peak.values()), [0.05, 0.1]), "changed: time of the peak"
PY
venv/bin/python run.py
