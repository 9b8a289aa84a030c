//! `tests`: one row a run.

use crumple_report::{RunSummary, status};
use crumple_signal::{Note, Severity};

use crate::runs::Ended;
use crate::runs::Run;
use crate::tables::table::Kind::{Count, Number, Text};
use crate::tables::table::{Cell, Kind};

/// Columns that every table begins with: which run it is.
pub(crate) const OF_RUN: [(&str, Kind); 4] =
    [("record", Text), ("record_digest", Text), ("pipeline", Text), ("settings", Text)];

/// Columns of the table.
pub(crate) const TESTS: [(&str, Kind); 30] = [
    ("run_folder", Text),
    ("status", Text),
    ("exit_code", Count),
    ("error", Text),
    ("title", Text),
    ("vehicle", Text),
    ("model_year", Count),
    ("barrier", Text),
    ("mass_kg", Number),
    ("impact_speed_m_per_s", Number),
    ("channel", Text),
    ("sample_rate_hz", Number),
    ("dynamic_crush_m", Number),
    ("time_of_dynamic_crush_s", Number),
    ("centroid_time_s", Number),
    ("rebound_velocity_m_per_s", Number),
    ("coefficient_of_restitution", Number),
    ("delta_v_m_per_s", Number),
    ("peak_acceleration_m_per_s2", Number),
    ("olc_m_per_s2", Number),
    ("average_stiffness_n_per_m", Number),
    ("energy_absorbed_j", Number),
    ("kelvin_stiffness_n_per_m", Number),
    ("kelvin_damping_n_s_per_m", Number),
    ("recommended", Text),
    ("recommended_because", Text),
    ("simplest", Text),
    ("closest", Text),
    ("candidates", Count),
    ("warnings", Count),
];

/// The cells of a run that every table begins with.
pub(crate) fn cells_of_run(run: &Run) -> Vec<Cell> {
    vec![
        (&run.record.identity).into(),
        run.record_digest().into(),
        (&run.pipeline_name).into(),
        // Not null where there are none: tables are joined by it, and null equals nothing.
        Cell::Text(run.settings().into()),
    ]
}

/// The row of a run.
pub(crate) fn row(run: &Run, ended: &Ended, summary: Option<&RunSummary>) -> Vec<Cell> {
    let test = summary.map(|summary| &summary.test);
    let events = summary.and_then(|summary| summary.events.as_ref());
    let vehicle = test.and_then(|test| test.vehicle.as_deref());
    let metric = |name: &str| Cell::from(summary.and_then(|summary| summary.metric(name)));
    let kelvin = |name: &str| Cell::from(summary.and_then(|summary| summary.parameter("kelvin", name)));
    let text = |text: Option<&String>| Cell::from(text.map(String::as_str));
    let count =
        |count: Option<usize>| count.map_or(Cell::Empty, |count| Cell::Count(i64::try_from(count).unwrap_or(i64::MAX)));
    let warnings =
        |summary: &RunSummary| summary.notes.iter().filter(|text| severity(text) == Severity::Warning).count();
    let row = vec![
        (&run.folder).into(),
        status(ended.exit_code).into(),
        Cell::Count(ended.exit_code.into()),
        (&ended.error).into(),
        text(test.map(|test| &test.title)),
        vehicle.into(),
        summary.and_then(RunSummary::model_year).map_or(Cell::Empty, Cell::Count),
        text(test.and_then(|test| test.barrier.as_ref())),
        test.and_then(|test| test.mass_kg).into(),
        test.and_then(|test| test.impact_speed_m_per_s).into(),
        text(test.and_then(|test| test.channel.as_ref())),
        test.and_then(|test| test.sample_rate_hz).into(),
        events.and_then(|events| events.dynamic_crush_m).into(),
        events.and_then(|events| events.time_of_dynamic_crush_s).into(),
        events.and_then(|events| events.centroid_time_s).into(),
        events.and_then(|events| events.rebound_velocity_m_per_s).into(),
        events.and_then(|events| events.coefficient_of_restitution).into(),
        events.and_then(|events| events.delta_v_m_per_s).into(),
        metric("peak_acceleration"),
        metric("olc"),
        metric("average_stiffness"),
        metric("energy_absorbed"),
        kelvin("stiffness_n_per_m"),
        kelvin("damping_n_s_per_m"),
        text(summary.and_then(|summary| summary.recommended.as_ref())),
        text(summary.and_then(|summary| summary.recommended_because.as_ref())),
        text(summary.and_then(|summary| summary.simplest.as_ref())),
        text(summary.and_then(|summary| summary.closest.as_ref())),
        count(summary.map(|summary| summary.candidates.len())),
        count(summary.map(warnings)),
    ];
    [cells_of_run(run), row].concat()
}

/// How severe a note of a summary is: `STAGE: NOTE`.
fn severity(text: &str) -> Severity {
    Note::parse(text.split_once(": ").map_or(text, |(_, rest)| rest)).severity
}
