#!/usr/bin/env bash
# Guess: on a common raster a channel is empty before its first and after its last sample.
# Seen: it holds its first value before and its last value after, without a mark, in every row.
# Version: asammdf 8.8.28, Python 3.11
# Hurts: a belt or crush channel that ended at 50 ms reads as a constant measurement to the end; energy and
#   means count it.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  asammdf==8.8.28 numpy==2.4.6 pandas==3.1.1
cat > run.py <<'PY'
from importlib.metadata import version

import numpy as np
from asammdf import MDF, Signal

print("asammdf", version("asammdf"))
record = MDF()
record.append(Signal(np.zeros(201), np.arange(201) * 1e-3, name="accel", unit="m/s^2"))
record.append(Signal(np.linspace(100.0, 600.0, 51), 0.05 + np.arange(51) * 1e-3, name="crush", unit="mm"))
crush = record.to_dataframe(raster=0.001)["crush"].to_numpy(dtype=float)
seen = [float(crush[i]) for i in (0, 49, 50, 100, 101, 200)]
print("crush at 0, 49, 50, 100, 101, 200 ms; measured from 50 to 100 ms:", seen)
print("empty rows:", int(np.isnan(crush).sum()), "of", crush.size)
assert np.allclose(seen, [100, 100, 100, 600, 600, 600]), "changed: values outside the measurement"
assert not np.isnan(crush).any(), "changed: rows are empty"
PY
venv/bin/python run.py
