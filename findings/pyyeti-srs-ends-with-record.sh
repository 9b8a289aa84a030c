#!/usr/bin/env bash
# Guess: the shock spectrum of a pulse counts the greatest response during the pulse and after it.
# Seen: it counts to the last sample, and the oscillator is still on its way at low frequencies: a record of 120
#   ms gives 39.8 at 1 Hz where 73.8 is right, and the same pulse with a longer tail of zeros 73.8. time="total"
#   adds what follows.
# Version: pyyeti 1.4.7, Python 3.11
# Hurts: crash records end soon after rebound; the spectrum below 3 Hz then depends on when recording stopped.
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
from pyyeti import srs

print("pyyeti", version("pyyeti"))
rate, frequencies = 10000, np.array([1.0, 2.0, 5.0, 10.0])


def spectrum(duration, **options):
    time = np.arange(int(duration * rate) + 1) / rate
    pulse = np.where(time < 0.1, 200 * np.sin(np.pi * time / 0.1), 0.0)
    return np.round(srs.srs(pulse, rate, frequencies, Q=10, parallel="no", **options), 1)


short, total, long = spectrum(0.12), spectrum(0.12, time="total"), spectrum(2.0)
print("at", frequencies, "Hz")
print("record of 0.12 s:", short)
print('record of 0.12 s, time="total":', total)
print("record of 2 s:", long)
assert np.allclose(short, [39.8, 122.2, 292.5, 324.8], atol=0.3), "changed: record of 0.12 s"
assert np.allclose(total, long, atol=0.3) and abs(long[0] - 73.8) < 0.3, "changed: with what follows"
PY
venv/bin/python run.py
