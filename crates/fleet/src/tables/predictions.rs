//! `predictions`: one row an impact that was not made.

use crumple_artifact::records::PredictionV1;
use crumple_report::RunSummary;

use crate::runs::Run;
use crate::tables::table::Kind::{Flag, Number, Text};
use crate::tables::table::{Cell, Kind};
use crate::tables::tests_table::cells_of_run;

/// Columns of the table. Intervals hold 90 %.
pub(crate) const PREDICTIONS: [(&str, Kind); 15] = [
    ("candidate", Text),
    ("recommended", Flag),
    ("impact_speed_m_per_s", Number),
    ("mass_kg", Number),
    ("partner", Text),
    ("extrapolates", Flag),
    ("dynamic_crush_m", Number),
    ("dynamic_crush_m_low", Number),
    ("dynamic_crush_m_high", Number),
    ("time_of_dynamic_crush_s", Number),
    ("delta_v_m_per_s", Number),
    ("coefficient_of_restitution", Number),
    ("peak_acceleration_m_per_s2", Number),
    ("olc_m_per_s2", Number),
    ("absorbed_j", Number),
];

/// The rows of a run.
pub(crate) fn rows(run: &Run, summary: &RunSummary) -> Vec<Vec<Cell>> {
    let own = cells_of_run(run);
    summary.predictions.iter().map(|prediction| [own.clone(), row(prediction)].concat()).collect()
}

fn row(prediction: &PredictionV1) -> Vec<Cell> {
    let crush = prediction.intervals.iter().find(|interval| interval.name == "dynamic_crush_m");
    vec![
        (&prediction.candidate).into(),
        prediction.recommended.into(),
        prediction.impact_speed_m_per_s.into(),
        prediction.mass_kg.into(),
        prediction.partner.as_deref().into(),
        prediction.extrapolates.into(),
        prediction.dynamic_crush_m.into(),
        crush.map(|interval| interval.low).into(),
        crush.map(|interval| interval.high).into(),
        prediction.time_of_dynamic_crush_s.into(),
        prediction.delta_v_m_per_s.into(),
        prediction.coefficient_of_restitution.into(),
        prediction.peak_acceleration_m_per_s2.into(),
        prediction.olc_m_per_s2.into(),
        prediction.energy.as_ref().map(|energy| energy.absorbed_j).into(),
    ]
}
