#!/usr/bin/env bash
# Guess: an OLC whose occupant does not use up the restraint within the record is refused, as it is where the free
#   flight does not end.
# Seen: the end of the record is taken for the end of the restraint: a half sine of 17.2 g over 125 ms has 17.7 g; cut
#   at 80 ms 28.9 g, at 60 ms 46.5 g, without a warning or an error.
# Version: pyisomme 1.1.0, Python 3.11
# Hurts: a record that ends early, or a pulse of a slow test, has a hard OLC; a limit of 40 g is missed by a mild pulse.
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
from pyisomme.calculate.olc import calculate_olc
from pyisomme.channel import Channel

logging.disable(logging.CRITICAL)
print("pyisomme", version("pyisomme"))
CODE, G = "10VEHCCG0000ACXP", 9.80665
peak, length = 17.2 * G, 0.125


def olc(end):
    time = np.arange(int(end * 1e4) + 1) * 1e-4
    pulse = np.where(time < length, -peak * np.sin(np.pi * time / length), 0.0)
    velocity = Channel(CODE, pd.DataFrame({CODE: pulse}, index=time), "m/s^2").integrate(2 / np.pi * peak * length)
    criterion = calculate_olc(velocity)[0].convert_unit("m/s^2")
    return round(float(np.asarray(criterion.get_data(), dtype=float).ravel()[0]) / G, 2)


seen = {end: olc(end) for end in (0.25, 0.15, 0.08, 0.06)}
print("end of the record, s, and OLC, g:", seen)
assert np.allclose(list(seen.values()), [17.69, 17.69, 28.86, 46.46], atol=0.05), "changed: OLC of a cut record"
PY
venv/bin/python run.py
