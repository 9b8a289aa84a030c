# pip install rerun-sdk mcap; python in_rerun.py view.mcap [view.rrd] (a file named rerun.py would hide the package)
import sys

import rerun as rr
import rerun.blueprint as rrb
from mcap.reader import make_reader
from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping

VIEWS = [
    ("Acceleration, m/s²", "acceleration_m_per_s2", "RightBottom"),
    ("Velocity, m/s", "velocity_m_per_s", "RightTop"),
    ("Displacement, m", "displacement_m", "RightBottom"),
]
COLOURS = [(31, 119, 180), (127, 127, 127), (214, 39, 40), (44, 160, 44)]
FROM_TIME_ZERO = rrb.VisibleTimeRange(
    "message_log_time",
    start=rrb.TimeRangeBoundary.absolute(seconds=1.0),
    end=rrb.TimeRangeBoundary.infinite(),
)


def line(topic, schema, field, colour):
    """A field over time: Rerun keeps a message in one component, the field is selected in it."""
    source = f"{schema.name}:message"
    kind = ComponentSourceKind.SourceComponent
    data = VisualizerComponentMapping("Scalars:scalars", kind, source_component=source, selector=f".{field}")
    width = 4 if "recommended" in topic.metadata else 1.5  # the test is drawn over the model
    return rr.SeriesLines(names=topic.metadata["id"], colors=colour, widths=width).visualizer(mappings=[data])


with open(sys.argv[1], "rb") as file:
    summary = make_reader(file).get_summary()
# The test and the recommended model, as in the other layouts.
topics = [c for c in summary.channels.values() if c.topic.startswith("/test/") or "recommended" in c.metadata]
views = []
for name, field, corner in VIEWS:
    of = {
        topic.topic: line(topic, summary.schemas[topic.schema_id], field, COLOURS[k % len(COLOURS)])
        for k, topic in enumerate(topics)
        if f"unit.{field}" in topic.metadata
    }
    legend = rrb.PlotLegend(corner)
    of_view = {"contents": list(of), "overrides": of, "plot_legend": legend, "time_ranges": FROM_TIME_ZERO}
    views.append(rrb.TimeSeriesView(name=name, **of_view))
rr.init("crumple view", spawn=len(sys.argv) < 3)
if len(sys.argv) > 2:
    rr.save(sys.argv[2])
rr.log_file_from_path(sys.argv[1])
rr.send_blueprint(rrb.Blueprint(rrb.Vertical(*views), collapse_panels=True))
