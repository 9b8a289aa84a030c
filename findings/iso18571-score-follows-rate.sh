#!/usr/bin/env bash
# Guess: the rating of two smooth curves hardly depends on their rate, or dt= corrects for it.
# Seen: the running mean of the slope has nine samples at any rate: a model with a ripple of 8 at 100 Hz is
#   0.823 (good) at 10 kHz and 0.955 (excellent) at 1 kHz; dt=0.001 changes nothing and no other rate than 10
#   kHz is refused.
# Version: objective-rating-metrics 1.3, Python 3.11
# Hurts: curves thinned before the comparison rate better, by a grade; ratings of two reports cannot be
#   compared.
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


def rate(every, **options):
    time = (np.arange(2001) * 1e-4)[::every]
    test = np.where(time < 0.1, -200 * np.sin(np.pi * time / 0.1), 0.0)
    model = 1.05 * test + 8 * np.sin(2 * np.pi * 100 * time)
    rating = ISO18571(np.column_stack([time, test]), np.column_stack([time, model]), **options)
    return [float(rating.overall_rating()), float(rating.slope_rating())]


seen = {"10 kHz": rate(1), "2 kHz": rate(5), "1 kHz": rate(10), "1 kHz, dt=0.001": rate(10, dt=1e-3)}
for name, (overall, slope) in seen.items():
    print(name, "overall", overall, "slope", slope)
wanted = [[0.823, 0.212], [0.868, 0.445], [0.955, 0.892], [0.955, 0.892]]
assert np.allclose(list(seen.values()), wanted, atol=2e-3), "changed: ratings"
PY
venv/bin/python run.py
