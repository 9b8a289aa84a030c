# pip install rerun-sdk; python rerun.py view.mcap
import sys

import rerun as rr
import rerun.blueprint as rrb

views = [
    rrb.TimeSeriesView(name=name, origin="/", contents=["+ /test/**", "+ /model/**"])
    for name in ("Acceleration", "Velocity", "Displacement")
]
rr.init("crumple view", spawn=True)
rr.log_file_from_path(sys.argv[1])
rr.send_blueprint(rrb.Blueprint(rrb.Vertical(*views)))
