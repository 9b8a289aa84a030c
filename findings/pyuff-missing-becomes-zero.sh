#!/usr/bin/env bash
# Guess: a missing sample (NaN) is refused or written so that it can be told from a measured one.
# Seen: it is written as 0, and an infinite one as 1.8e308; no warning, no error.
# Version: pyuff 2.5.8, Python 3.11
# Hurts: a dropout in the pulse becomes a measured 0 m/s^2: peak, velocity and crush are wrong and no reader can
#   tell.
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


x = np.arange(1000) * 1e-4
y = np.full(1000, -250.0)
y[100:120] = np.nan
y[130] = np.inf
pyuff.UFF("out.uff").write_sets(data_set(x, y.copy(), 0, 1), "overwrite")
sets = pyuff.UFF("out.uff").read_sets()
data = (sets[0] if isinstance(sets, list) else sets)["data"]
print("written:", y[98:102], y[130])
print("read:", data[98:102], data[130])
print("missing samples written and read:", int(np.isnan(y).sum()), int(np.isnan(data).sum()))
assert np.all(data[100:120] == 0.0), "changed: missing samples"
assert data[130] > 1e308, "changed: infinite sample"
assert np.allclose(np.delete(data, np.r_[100:120, 130]), -250.0), "changed: other samples"
PY
venv/bin/python run.py
