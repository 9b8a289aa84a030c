//! `candidates`: one row a candidate of a run.

use std::collections::BTreeSet;

use crumple_report::{RunSummary, SummaryCandidate};

use crate::runs::Run;
use crate::tables::table::Kind::{Count, Flag, Number, Text};
use crate::tables::table::{Cell, Column, Kind};
use crate::tables::tests_table::cells_of_run;

/// Columns before those of the parameters.
pub(crate) const CANDIDATES: [(&str, Kind); 17] = [
    ("candidate", Text),
    ("model", Text),
    ("method", Text),
    ("rank", Count),
    ("recommended", Flag),
    ("physical", Flag),
    ("equivalent_to", Text),
    ("fit_percent", Number),
    ("fit_velocity_percent", Number),
    ("fit_acceleration_percent", Number),
    ("iso18571_score", Number),
    ("aicc", Number),
    ("rmse_displacement_m", Number),
    ("simulated_dynamic_crush_m", Number),
    ("simulated_time_of_dynamic_crush_s", Number),
    ("dynamic_crush_error_m", Number),
    ("time_of_dynamic_crush_error_s", Number),
];

/// Names of all parameters of these runs: each a column, with the ends of its 95 % interval behind it.
pub(crate) fn parameter_names<'a>(summaries: impl Iterator<Item = &'a RunSummary>) -> Vec<String> {
    let candidates = summaries.flat_map(|summary| &summary.candidates);
    let names: BTreeSet<&String> = candidates.flat_map(|candidate| candidate.parameters.keys()).collect();
    names.into_iter().cloned().collect()
}

/// Columns of parameters.
pub(crate) fn parameter_columns(names: &[String]) -> impl Iterator<Item = Column> {
    names
        .iter()
        .flat_map(|name| [name.clone(), format!("{name}_low"), format!("{name}_high")])
        .map(|name| (name, Number))
}

/// The rows of a run.
pub(crate) fn rows(run: &Run, summary: &RunSummary, parameters: &[String]) -> Vec<Vec<Cell>> {
    let own = cells_of_run(run);
    summary.candidates.iter().map(|candidate| [own.clone(), row(candidate, summary, parameters)].concat()).collect()
}

fn row(candidate: &SummaryCandidate, summary: &RunSummary, parameters: &[String]) -> Vec<Cell> {
    let simulation = candidate.simulation.as_ref();
    let rank = summary.ranking.iter().position(|id| *id == candidate.id).and_then(|rank| i64::try_from(rank + 1).ok());
    let mut row = vec![
        (&candidate.id).into(),
        (&candidate.model).into(),
        (&candidate.method).into(),
        rank.map_or(Cell::Empty, Cell::Count),
        (summary.recommended.as_ref() == Some(&candidate.id)).into(),
        candidate.physical.into(),
        candidate.equivalent_to.as_deref().into(),
        simulation.and_then(|s| s.fit_percent).into(),
        simulation.and_then(|s| s.fit_velocity_percent).into(),
        simulation.and_then(|s| s.fit_acceleration_percent).into(),
        simulation.and_then(|s| s.iso18571_score).into(),
        simulation.and_then(|s| s.aicc).into(),
        simulation.and_then(|s| s.rmse_displacement_m).into(),
        simulation.and_then(|s| s.dynamic_crush_m).into(),
        simulation.and_then(|s| s.time_of_dynamic_crush_s).into(),
        simulation.and_then(|s| s.dynamic_crush_error_m).into(),
        simulation.and_then(|s| s.time_of_dynamic_crush_error_s).into(),
    ];
    let intervals = candidate.uncertainty.as_ref();
    for name in parameters {
        row.push(candidate.parameters.get(name).copied().into());
        row.push(intervals.and_then(|i| *i.interval_low.get(name)?).into());
        row.push(intervals.and_then(|i| *i.interval_high.get(name)?).into());
    }
    row
}
