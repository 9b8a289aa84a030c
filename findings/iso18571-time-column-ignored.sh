#!/usr/bin/env bash
# Guess: two curves on different time axes, 50 ms apart or of different rates, are refused or rated by their
#   times.
# Seen: the time column is never looked at: the same samples give 1.0 in all parts whether one of the curves is
#   50 ms late or lasts twice as long.
# Version: objective-rating-metrics 1.3, Python 3.11
# Hurts: a model with its time zero elsewhere, or sampled at another rate with as many rows, is rated excellent.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  objective-rating-metrics==1.3 numpy==1.26.4 scipy==1.12.0
cat > run.py <<'PY'
from importlib.metadata import version

import numpy as np
from objective_rating_metrics.rating import ISO18571

print("objective-rating-metrics", version("objective-rating-metrics"))
time = np.arange(2001) * 1e-4
pulse = np.where(time < 0.1, -200 * np.sin(np.pi * time / 0.1), 0.0)
test = np.column_stack([time, pulse])
seen = {}
for name, other in (("same", time), ("50 ms late", time + 0.05), ("twice as long", 2 * time)):
    rating = ISO18571(test, np.column_stack([other, pulse]))
    seen[name] = [
        rating.overall_rating(),
        rating.corridor_rating(),
        rating.phase_rating(),
        rating.magnitude_rating(),
        rating.slope_rating(),
    ]
    print(name, [float(x) for x in seen[name]])
assert all(np.allclose(parts, 1.0) for parts in seen.values()), "changed: the time column counts"
PY
venv/bin/python run.py
