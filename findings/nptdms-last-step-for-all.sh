#!/usr/bin/env bash
# Guess: a channel that goes on in a second segment with another start and step gets a time axis of both, or an
#   error.
# Seen: time_track() applies the start and step of the last segment to all samples: ten samples from -10 ms in
#   steps of 0.1 ms are placed from 500 ms in steps of 1 ms.
# Version: npTDMS 1.13.0, Python 3.11
# Hurts: two records appended to one file, or a logger that changes its rate at the trigger: the pulse is ten
#   times too long, and its change of velocity ten times too large.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  npTDMS==1.13.0 numpy==2.4.6
cat > run.py <<'PY'
from importlib.metadata import version

import numpy as np
from nptdms import ChannelObject, TdmsFile, TdmsWriter

print("npTDMS", version("npTDMS"))
fast = {"wf_increment": 1e-4, "wf_start_offset": -0.01}
slow = {"wf_increment": 1e-3, "wf_start_offset": 0.5}
with TdmsWriter("crash.tdms") as writer:
    writer.write_segment([ChannelObject("test", "accel", np.arange(10.0), properties=fast)])
    writer.write_segment([ChannelObject("test", "accel", np.arange(10.0, 15.0), properties=slow)])
channel = TdmsFile.read("crash.tdms")["test"]["accel"]
time = channel.time_track()
print("samples:", channel[:])
print("times, s:", np.round(time, 6))
print("step of the first ten, s: written 0.0001, read", round(float(time[1] - time[0]), 6))
assert np.allclose(time, 0.5 + 1e-3 * np.arange(15)), "changed: time axis"
PY
venv/bin/python run.py
