#!/usr/bin/env bash
# Guess: the 3 ms value of a chest or vehicle channel is of its magnitude, or a negative channel is refused.
# Seen: it counts positive samples alone: a pulse of -60 g gives 0.0, and its time beyond 30 g is 0; olc() of
#   the same package wants the very same channel negative.
# Version: crashmetrics 0.6.0, Python 3.11
# Hurts: x-accelerations of a frontal test are negative by the convention of the field: the chest criterion is 0
#   g, and passes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  crashmetrics==0.6.0 numpy==1.26.4
cat > run.py <<'PY'
from importlib.metadata import version

import numpy as np
from crashmetrics import acceleration, pulse

print("crashmetrics", version("crashmetrics"))
time = np.arange(2001) * 1e-4
chest = np.where(time < 0.1, -60 * np.sin(np.pi * time / 0.1), 0.0)
clip = [float(acceleration.clip_3ms(time, sign * chest)) for sign in (1, -1)]
beyond = [float(acceleration.exceedance_duration(time, sign * chest, 30)) for sign in (1, -1)]
olc = float(pulse.olc(time, chest * 9.80665, 14.0).value)
print("3 ms value as measured, and with the sign turned, g:", np.round(clip, 2))
print("duration beyond 30 g:", np.round(beyond, 4))
print("OLC of the channel as measured, g:", round(olc, 2))
assert clip[0] == 0 and beyond[0] == 0, "changed: negative channel"
assert abs(clip[1] - 59.93) < 0.05 and olc > 20, "changed: positive channel or OLC"
PY
venv/bin/python run.py
