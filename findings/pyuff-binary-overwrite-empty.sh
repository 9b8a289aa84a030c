#!/usr/bin/env bash
# Guess: a binary set 58 written with mode "overwrite" is the file: the next read gives it back.
# Seen: the file has 7 bytes, the closing mark alone; header and samples are gone, no error is raised, and a
#   read gives no set. With mode "add" into a new file the set comes back.
# Version: pyuff 2.5.8, Python 3.11
# Hurts: who exports channels in binary to replace an older export has an empty file, and no older one.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  pyuff==2.5.8 numpy==2.4.6
cat > run.py <<'PY'
import os
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
y = 200 * np.sin(x * 30)
seen = {}
for mode in ("add", "overwrite"):
    path = mode + ".uff"
    pyuff.UFF(path).write_sets(data_set(x, y, 1, 1), mode)
    sets = pyuff.UFF(path).read_sets()
    sets = sets if isinstance(sets, list) else [sets]
    seen[mode] = [len(one["data"]) for one in sets]
    print(mode, "bytes:", os.path.getsize(path), "sets read, with samples:", seen[mode])
assert seen["add"] == [1000], "changed: mode add"
assert seen["overwrite"] == [] and os.path.getsize("overwrite.uff") == 7, "changed: mode overwrite"
PY
venv/bin/python run.py
