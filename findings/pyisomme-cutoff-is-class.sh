#!/usr/bin/env bash
# Guess: cfc_hz(100), "cutoff frequency in Hz", has -3 dB at 100 Hz.
# Seen: the number is a channel frequency class: at 100 Hz 0.950 of a tone is left, and 0.708 (-3 dB) at 167 Hz. The old
#   cfc(60) is the same as cfc_hz(60), so it is CFC 60 with -3 dB at 100 Hz, though its warning calls 60 a frequency.
# Version: pyisomme 1.1.0, Python 3.11
# Hurts: who asks for the 100 Hz of CFC 60 gets CFC 100: peaks are higher, and no report says why.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  pyisomme==1.1.0 numpy==1.26.4 scipy==1.12.0 pandas==2.2.3
cat > run.py <<'PY'
import logging
import warnings
from importlib.metadata import version

import numpy as np
import pandas as pd
from pyisomme.channel import Channel

logging.disable(logging.CRITICAL)
warnings.simplefilter("ignore")
print("pyisomme", version("pyisomme"))
CODE = "10VEHCCG0000ACXP"
time = np.arange(20000) * 1e-4


def tone(frequency):
    return Channel(CODE, pd.DataFrame({CODE: np.sin(2 * np.pi * frequency * time)}, index=time), "m/s^2")


def left(channel):
    return float(np.abs(np.asarray(channel.get_data(), dtype=float)[8000:12000]).max())


gains = {f"cfc_hz(100) at {f} Hz": round(left(tone(f).cfc_hz(100)), 3) for f in (100, 167)}
gains |= {"cfc_hz(60) at 100 Hz": round(left(tone(100).cfc_hz(60)), 3), "cfc('D') at 100 Hz": round(left(tone(100).cfc("D")), 3)}
print(gains)
assert np.allclose(list(gains.values()), [0.950, 0.708, 0.710, 0.710], atol=3e-3), "changed: gains"
PY
venv/bin/python run.py
