#!/usr/bin/env bash
# Guess: butterworth(high_cutoff=100) is a low-pass whose gain at 100 Hz is -3 dB.
# Seen: it is a band-pass from 1 to 100 Hz, as low_cutoff is 1 Hz unless None: the change of velocity of a pulse
#   of 0.1 s falls from 12.73 to 3.95 m/s, its peak from 200 to 170. It runs forward and back, so the gain at
#   100 Hz is one half (-6 dB).
# Version: endaq 1.5.3, Python 3.11
# Hurts: velocity and crush after such a filter are a third of the true ones; a CFC filter is not had by its
#   cut-off either.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  endaq==1.5.3 numpy==2.4.6 scipy==1.17.1 pandas==3.1.1
cat > run.py <<'PY'
import warnings
from importlib.metadata import version

import numpy as np
import pandas as pd

warnings.simplefilter("ignore")
from endaq.calc import filters

print("endaq", version("endaq"))
step = 1e-4
time = pd.Index(np.arange(4000) * step, name="time")
pulse = np.where((time > 0.05) & (time < 0.15), 200 * np.sin(np.pi * (time - 0.05) / 0.1), 0.0)
record = pd.DataFrame({"x": pulse}, index=time)
asked = filters.butterworth(record, high_cutoff=100.0)["x"].to_numpy()
none = filters.butterworth(record, low_cutoff=None, high_cutoff=100.0)["x"].to_numpy()
change = [float(np.trapezoid(v, dx=step)) for v in (pulse, asked, none)]
print("change of velocity: record, high_cutoff=100, low_cutoff=None as well:", np.round(change, 3))
print("peak:", np.round([pulse.max(), asked.max(), none.max()], 1))
tone_time = pd.Index(np.arange(20000) * step, name="time")
tone = pd.DataFrame({"x": np.sin(2 * np.pi * 100 * tone_time)}, index=tone_time)
gain = float(filters.butterworth(tone, low_cutoff=None, high_cutoff=100.0)["x"].iloc[8000:12000].max())
print("gain at 100 Hz:", round(gain, 4))
assert np.allclose(change, [12.732, 3.952, 12.732], atol=5e-3), "changed: change of velocity"
assert abs(asked.max() - 169.9) < 0.5 and abs(none.max() - 200) < 0.5, "changed: peak"
assert abs(gain - 0.5) < 1e-3, "changed: gain at the cut-off"
PY
venv/bin/python run.py
