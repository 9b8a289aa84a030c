//! The figures of the report, one file each. A figure whose record is absent is left out.

mod at_first;
mod bode;
mod elements;
mod force;
mod mass_divisions;
mod mass_split;
mod models;
mod motion;
mod poles;
mod responses;
mod sensors;
mod singular_values;
mod stabilisation;

use serde_json::json;

use crate::figure::{Figure, set};
use crate::{Ranking, Run};

/// All figures that the run has records for, in the order of the page.
pub fn all(run: &Run, ranking: &Ranking) -> Vec<Figure> {
    let mut figures: Vec<Figure> = [
        motion::figure(run),
        models::figure(run, ranking),
        sensors::figure(run, ranking),
        force::figure(run, ranking),
        elements::figure(run, ranking),
        mass_split::figure(run, ranking),
        poles::figure(run),
        singular_values::figure(run),
        stabilisation::figure(run),
        bode::figure(run),
        responses::figure(run),
    ]
    .into_iter()
    .flatten()
    .collect();
    // Left alone, plotly drops points of a line by its own rule, and smooth curves come out with corners.
    for line in figures.iter_mut().flat_map(|figure| &mut figure.traces).filter_map(|trace| trace.get_mut("line")) {
        set(line, json!({"simplify": false}));
    }
    figures
}

/// First view of a time axis, ms: from a little before time zero to three times the time of crush, within the record.
///
/// Without a time of crush the whole record.
fn time_view_ms(run: &Run) -> Option<[f64; 2]> {
    let acceleration = run.acceleration().or(run.measured.displacement.as_ref())?;
    let (start, end) = (1e3 * acceleration.t0_s(), 1e3 * acceleration.end_s());
    let view = match run.time_of_crush_s() {
        Some(t_m) if t_m > 0.0 => [start.max(-0.3 * 1e3 * t_m), end.min(3.0 * 1e3 * t_m)],
        _ => [start, end],
    };
    (view[1] > view[0]).then_some(view)
}
