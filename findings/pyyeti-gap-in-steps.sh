#!/usr/bin/env bash
# Guess: fixtime() fills a gap of 20 ms in a ramp by a straight line, or leaves it marked.
# Seen: it repeats the nearest sample: half of the gap is the last value before, half the first one after, with
#   a jump of the whole change between; NaN inside are filled alike.
# Version: pyyeti 1.4.7, Python 3.11
# Hurts: a dropout on the flank of a pulse becomes a step: jerk, filters and fits see an impact that was not
#   there.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  pyyeti==1.4.7 numpy==2.4.6 scipy==1.17.1
cat > run.py <<'PY'
from importlib.metadata import version

import numpy as np
from pyyeti import dsp

print("pyyeti", version("pyyeti"))
time = np.arange(2001) * 1e-4
ramp = 1e4 * time
kept = (time < 0.05) | (time > 0.07)
missing = np.where(kept, ramp, np.nan)
for name, (t, y) in {"left out": (time[kept], ramp[kept]), "NaN": (time, missing)}.items():
    even, filled = dsp.fixtime((t, y), sr=10000, verbose=False)
    inside = filled[(even > 0.0501) & (even < 0.0699)]
    jump = float(np.abs(np.diff(filled)).max())
    print(name, "different values in the gap:", np.unique(inside.round(6)), "largest step:", round(jump, 3))
    assert np.unique(inside.round(3)).size == 2, "changed: values in the gap"
    assert 198 < jump < 205, "changed: the jump"
PY
venv/bin/python run.py
