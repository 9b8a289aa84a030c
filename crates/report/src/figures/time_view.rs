//! Axes of the crash: their titles, and the part of a record that a time axis shows first.

use crate::drawing::{Axis, Panel};
use crate::findings::Run;

/// What an axis is of, and the unit of its points on metric pages.
pub(crate) type Titled = (&'static str, &'static str);

/// Title of an axis of accelerations.
pub(crate) const ACCELERATION: Titled = ("acceleration", "g");
/// Title of an axis of velocities.
pub(crate) const VELOCITY: Titled = ("velocity", "km/h");
/// Title of an axis of displacements.
pub(crate) const DISPLACEMENT: Titled = ("displacement", "mm");
/// Title of an axis of forces.
pub(crate) const FORCE: Titled = ("force", "kN");

/// First view of a time axis, ms: from a little before time zero to three times the time of crush, within the record.
///
/// Without a time of crush the whole record.
pub fn time_view_ms(run: &Run) -> Option<[f64; 2]> {
    let acceleration = run.acceleration().or(run.measured.displacement.as_ref())?;
    let (start, end) = (1e3 * acceleration.t0_s(), 1e3 * acceleration.end_s());
    let view = match run.time_of_crush_s() {
        Some(t_m) if t_m > 0.0 => [start.max(-0.3 * 1e3 * t_m), end.min(3.0 * 1e3 * t_m)],
        _ => [start, end],
    };
    (view[1] > view[0]).then_some(view)
}

/// A panel over the time of the record.
pub(crate) fn over_time_axis(view: Option<[f64; 2]>, y: Axis) -> Panel {
    Panel::over_time(Axis { view, ..Axis::new("time after time zero, ms") }, y)
}
