#!/usr/bin/env bash
# Guess: of two channels named accel the second gets a name by its group or a count, the same in every file of a
#   series.
# Seen: its name is accel with a number that is the place of a block in the file, e.g. accel_17432_17432: one
#   more channel elsewhere, and the name is another one.
# Version: mdfreader 4.3, files by asammdf 8.8.28, Python 3.11
# Hurts: a script that picks the second sensor by name finds it in one test and not in the next.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  mdfreader==4.3 asammdf==8.8.28 numpy==2.4.6 pandas==3.1.1
cat > run.py <<'PY'
import re
from importlib.metadata import version

import mdfreader
import numpy as np
from asammdf import MDF, Signal

print("mdfreader", version("mdfreader"), "asammdf", version("asammdf"))
fast, slow = np.arange(1001) * 1e-4, np.arange(51) * 1e-3
names = []
for others in ([], ["belt"]):
    record = MDF(version="4.10")
    signals = [Signal(np.sin(fast), fast, name=name, unit="m/s^2") for name in ["accel", *others]]
    record.append(signals)
    record.append(Signal(np.cos(slow), slow, name="accel", unit="m/s^2"))
    record.save("series.mf4", overwrite=True)
    found = [name for name in mdfreader.Mdf("series.mf4") if name.startswith("accel")]
    print("channels", ["accel", *others, "accel"], "names:", sorted(found))
    names.append([name for name in found if name != "accel"])
shape = re.compile(r"accel(_[0-9]+)+")
assert all(len(n) == 1 and shape.fullmatch(n[0]) for n in names), "changed: form of the name"
assert names[0] != names[1], "changed: the name is the same in both files"
PY
venv/bin/python run.py
