#!/usr/bin/env bash
# Guess: a discrete model from data is taken back to continuous time by the logarithm of its poles, as for a
#   held input.
# Seen: undiscretize() takes the bilinear rule unless the model was made by its own discretize(): a mode of 100
#   Hz sampled at 1 kHz reads 103.4 Hz with damping 0.053 for 0.050, one of 200 Hz 231 Hz and 0.066.
#   method="zoh" is right.
# Version: harold 1.0.3, Python 3.11
# Hurts: frequencies are too high, by 16 % at a fifth of the rate, stiffness by a third, and it looks like a
#   property of the car.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  harold==1.0.3 numpy==1.26.4 scipy==1.17.1
cat > run.py <<'PY'
from importlib.metadata import version

import harold
import numpy as np
from scipy.signal import cont2discrete

print("harold", version("harold"))
step, damping = 1e-3, 0.05
seen = {}
for frequency in (20, 100, 200):
    w = 2 * np.pi * frequency
    numerator, denominator, _ = cont2discrete(([1.0], [1.0, 2 * damping * w, w * w]), step, "zoh")
    model = harold.Transfer(numerator.ravel()[1:], denominator, dt=step)
    row = []
    for options in ({}, {"method": "zoh"}):
        pole = harold.undiscretize(model, **options).poles[0]
        row += [abs(pole) / (2 * np.pi), -pole.real / abs(pole)]
    seen[frequency] = np.round(row, 4)
    print(frequency, "Hz, damping 0.05; as called:", seen[frequency][:2], "zoh:", seen[frequency][2:])
for frequency, wanted in {20: (20.026, 0.0501), 100: (103.41, 0.0534), 200: (231.04, 0.0660)}.items():
    assert np.allclose(seen[frequency][:2], wanted, rtol=2e-3), "changed: as called"
    assert np.allclose(seen[frequency][2:], (frequency, 0.05), rtol=1e-3), "changed: zoh"
PY
venv/bin/python run.py
