#!/usr/bin/env bash
# Guess: a time outside the record gives NaN or an error.
# Seen: it gives 0.0, as a measured value would; so does a shorter channel put on the times of a longer one.
# Version: pyisomme 1.1.0, Python 3.11
# Hurts: a belt force read at a time after the end of its channel is 0 N; a crush read before its first sample
#   is 0 mm: plausible, and wrong.
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


force = channel("11SEBE0000B3FO0P", 0.02 + np.arange(801) * 1e-4, np.full(801, 5000.0), "N")
times = [0.0, 0.0199, 0.02, 0.06, 0.1, 0.1001, 0.15]
values = np.asarray(force.get_data(times), dtype=float)
print("measured from 20 to 100 ms, 5000 N throughout")
print(dict(zip(times, values.tolist())))
assert np.allclose(values, [0, 0, 5000, 5000, 5000, 0, 0]), "changed: values outside the record"
PY
venv/bin/python run.py
