#!/usr/bin/env bash
# Guess: times written in double precision (ordinate type 4) come back as doubles, or to the nanosecond.
# Seen: the start and every uneven time have six digits: a record from 1234.5678 s begins 2.2 ms late, and in
#   one with uneven steps near 1234.5 s 1000 times become 12; the samples themselves have twelve digits. The
#   fields of the format are that wide; nothing warns.
# Version: pyuff 2.5.8, Python 3.11
# Hurts: channels cut from a long acquisition are shifted against others, or their time axis stands still.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  pyuff==2.5.8 numpy==2.4.6
cat > run.py <<'PY'
from importlib.metadata import version

import numpy as np
import pyuff

print("pyuff", version("pyuff"))

def data_set(x, y, binary, even):
    return pyuff.prepare_58(
        binary=binary,
        func_type=1,
        rsp_node=1,
        rsp_dir=1,
        ref_node=0,
        ref_dir=0,
        ord_data_type=4,
        num_pts=len(x),
        abscissa_spacing=even,
        abscissa_min=float(x[0]),
        abscissa_inc=float(x[1] - x[0]) if even else 0.0,
        z_axis_value=0.0,
        abscissa_spec_data_type=17,
        ordinate_spec_data_type=12,
        ordinate_axis_units_lab="m/s^2",
        orddenom_spec_data_type=0,
        z_axis_spec_data_type=0,
        data=y,
        x=x,
    )


def through(x, even):
    path = f"even{even}.uff"
    pyuff.UFF(path).write_sets(data_set(x, np.sin(x), 0, even), "overwrite")
    sets = pyuff.UFF(path).read_sets()
    return sets[0] if isinstance(sets, list) else sets


even = 1234.5678 + np.arange(1000) * 1e-4
back = through(even, 1)["x"]
print("even, start written and read, s:", even[0], float(back[0]), "late by", round(float(back[0] - even[0]), 6))
uneven = 1234.5 + np.cumsum(np.where(np.arange(1000) % 2, 1.0e-4, 1.1e-4))
again = through(uneven, 0)
steps = np.unique(again["x"]).size
print("uneven, different times written and read:", np.unique(uneven).size, steps)
error = float(np.abs(again["data"] - np.sin(uneven)).max())
print("largest error of a sample:", error)
assert np.isclose(back[0], 1234.57) and np.isclose(back[-1], 1234.6699), "changed: start"
assert steps == 12, "changed: uneven times"
assert error < 1e-11, "changed: samples"
PY
venv/bin/python run.py
