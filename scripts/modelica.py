"""What `just modelica RUN...` runs: each candidate as Modelica, simulated by Rumoca, beside the numbers of Crumple.

Crush, its time and the restitution of the mass farthest from the barrier are compared with `simulation` of
`summary.json`. A difference above 0.1 % is a failure: the steps of 0.02 ms that Rumoca writes find an extreme of a curve
that turns within 50 ms to 1e-7, its tolerance is 1e-6, and the numbers of the summary are those of the exact motion.
Run as `modelica.py EXPORT RUN...`, EXPORT being the program `crumple-export`.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import rumoca

LIMIT = 1e-3
UNTIL_S, STEP_S = 0.3, 2e-5


def simulated(text):
    """Crush, its time and the restitution of the last mass."""
    result = rumoca.Session().loads(text, model="Candidate").simulate(t=(0, UNTIL_S), dt=STEP_S)
    time = np.asarray(result.time)
    last = max(int(name[1:]) for name in result.names if name[0] == "x" and name[1:].isdigit())
    x, v = (np.asarray(result[f"{letter}{last}"]) for letter in "xv")
    at = int(x.argmax())
    return {"dynamic_crush_m": x[at], "time_of_dynamic_crush_s": time[at], "coefficient_of_restitution": -v.min() / v[0]}


def main(program, *runs):
    """Prints a line a number; fails where one is off."""
    worst = 0.0
    for run in map(Path, runs):
        for candidate in json.loads((run / "summary.json").read_text())["candidates"]:
            told = candidate.get("simulation")
            if not told:
                continue
            with tempfile.TemporaryDirectory() as folder:
                words = [program, run, "--to", "modelica", "--candidate", candidate["id"], "-q", "-o", f"{folder}/model.mo"]
                done = subprocess.run(words, capture_output=True, text=True)
                if done.returncode:
                    print(f"{run.parent.name} {candidate['id']}: {done.stderr.splitlines()[0]}")
                    continue
                own = simulated(Path(folder, "model.mo").read_text())
            for name, value in own.items():
                if told.get(name) is None:
                    continue
                off = abs(value - told[name]) / max(abs(told[name]), 0.05)
                worst = max(worst, off)
                print(f"{run.parent.name} {candidate['id']} {name}: {told[name]:.6g}, by Modelica {value:.6g}, off {off:.1e}")
    print(f"largest difference {worst:.1e}, limit {LIMIT:.0e}")
    return worst > LIMIT


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
