//! What a recorder kept: the changes of velocity over time, and the way that follows from the impact speed.

use crate::drawing::numbers::{KM_PER_H_PER_M_PER_S, MILLI};
use crate::drawing::{Axis, Colour, Dash, Figure, Look, Width, over_time};
use crate::figures::crash::curves::view_ms;
use crate::figures::time_view::{DISPLACEMENT, over_time_axis};
use crate::findings::Run;

/// A curve a channel; `None` without any.
pub fn figure(run: &Run) -> Option<Figure> {
    let mut figure = Figure::new("recorded", "What the recorder kept");
    let mut changes = over_time_axis(view_ms(run), Axis::of(("change of velocity", "km/h")));
    let mut first = None;
    for (place, (id, change)) in run.recorded_changes.iter().enumerate() {
        let colour = place.checked_sub(1).map_or(Colour::Test, Colour::Series);
        let entry = figure.entry(id.clone(), Look::line(colour, Dash::Solid).width(Width::Thick), true);
        changes.line(entry, over_time(change, KM_PER_H_PER_M_PER_S));
        first.get_or_insert(entry);
    }
    let first = first?;
    figure.panels.push(changes);
    if let Some(way) = &run.measured.displacement {
        let mut panel = over_time_axis(view_ms(run), Axis::of(DISPLACEMENT));
        panel.line(first, over_time(way, MILLI));
        figure.panels.push(panel);
    }
    Some(figure.tidy())
}
