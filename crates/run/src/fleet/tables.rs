//! Tables of a fleet: tests, candidates, metrics, predictions, read from the run folders.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use anyhow::Context;
use crumple_artifact::records::PredictionV1;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_report::{CandidateSummary, MetricSummary, Summary, status};
use rayon::prelude::*;

use crate::fleet::runs::{JournalEntry, Run, path_in};
use crate::table::Kind::{Count, Flag, Number, Text};
use crate::table::{Cell, Column, CsvForm, Kind, Table, columns, write_csv, write_parquet};

// `candidates`: one row a candidate of a run.

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
pub(crate) fn parameter_names<'a>(summaries: impl Iterator<Item = &'a Summary>) -> Vec<String> {
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
pub(crate) fn candidate_rows(run: &Run, summary: &Summary, parameters: &[String]) -> Vec<Vec<Cell>> {
    let own = cells_of_run(run);
    summary
        .candidates
        .iter()
        .map(|candidate| [own.clone(), candidate_row(candidate, summary, parameters)].concat())
        .collect()
}

fn candidate_row(candidate: &CandidateSummary, summary: &Summary, parameters: &[String]) -> Vec<Cell> {
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
        candidate.aicc.into(),
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

// `metrics`: one row a metric of a run.

/// Columns of the table.
pub(crate) const METRICS: [(&str, Kind); 8] = [
    ("metric", Text),
    ("channel", Text),
    ("location", Text),
    ("value", Number),
    ("unit", Text),
    ("low", Number),
    ("high", Number),
    ("definition_id", Text),
];

/// The cells of a metric: its name, channel and location, value with its interval, unit, definition.
pub(crate) fn metric_cells(
    name: &str,
    (channel, location): (Option<&str>, Option<&str>),
    (value, low, high): (Option<f64>, Option<f64>, Option<f64>),
    unit: &str,
    definition: Option<&str>,
) -> Vec<Cell> {
    let numbers = [value, low, high].map(Cell::from);
    let [value, low, high] = numbers;
    vec![name.into(), channel.into(), location.into(), value, unit.into(), low, high, definition.into()]
}

/// The rows of a run: metrics of the pulse, then those of other channels.
pub(crate) fn metric_rows(run: &Run, summary: &Summary) -> Vec<Vec<Cell>> {
    let own = cells_of_run(run);
    let row = |name: &str, channel: Option<&str>, location: Option<&str>, metric: &MetricSummary| {
        let numbers = (metric.value, metric.low, metric.high);
        let row = metric_cells(name, (channel, location), numbers, &metric.unit, metric.definition_id.as_deref());
        [own.clone(), row].concat()
    };
    let pulse = summary.test.channel.as_deref();
    let of_pulse = summary.metrics.iter().map(|(name, metric)| row(name, pulse, None, metric));
    let of_others = summary
        .other_metrics
        .iter()
        .map(|other| row(&other.name, Some(&other.channel), other.location.as_deref(), &other.metric));
    of_pulse.chain(of_others).collect()
}

// `predictions`: one row an impact that was not made.

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
pub(crate) fn prediction_rows(run: &Run, summary: &Summary) -> Vec<Vec<Cell>> {
    let own = cells_of_run(run);
    summary.predictions.iter().map(|prediction| [own.clone(), prediction_row(prediction)].concat()).collect()
}

/// The cells of a prediction.
pub(crate) fn prediction_row(prediction: &PredictionV1) -> Vec<Cell> {
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

// The rows of all runs, read from their folders.

/// A run with how it ended and what it found.
#[derive(Debug)]
pub(crate) struct Row {
    /// The run.
    pub(crate) run: Run,
    /// Its end.
    pub(crate) ended: JournalEntry,
    /// What it found, where it has a result.
    pub(crate) summary: Option<Summary>,
}

/// Reads the summaries of runs that have a result.
pub(crate) fn rows(fleet: &Path, ended: Vec<(Run, JournalEntry)>) -> anyhow::Result<Vec<Row>> {
    let row = |(run, ended): (Run, JournalEntry)| -> anyhow::Result<Row> {
        let summary = ended.has_result().then(|| read_summary(&path_in(fleet, &run))).transpose()?;
        Ok(Row { run, ended, summary })
    };
    ended.into_par_iter().map(row).collect()
}

fn read_summary(folder: &Path) -> anyhow::Result<Summary> {
    let path = folder.join("summary.json");
    let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    Summary::from_json(&bytes).with_context(|| format!("{} is no summary of a run", path.display()))
}

/// The four tables.
pub(crate) fn tables(rows: &[Row]) -> [Table; 4] {
    let found = || rows.iter().filter_map(|row| Some((&row.run, row.summary.as_ref()?)));
    let parameters = parameter_names(found().map(|(_, summary)| summary));
    let with_run = |more: &[_]| -> Vec<Column> { [columns(&OF_RUN), columns(more)].concat() };
    let mut of_candidates = with_run(&CANDIDATES);
    of_candidates.extend(parameter_columns(&parameters));
    [
        Table::new(
            "tests",
            with_run(&TESTS),
            rows.iter().map(|row| test_row(&row.run, &row.ended, row.summary.as_ref())).collect(),
        ),
        Table::new(
            "candidates",
            of_candidates,
            found().flat_map(|(run, summary)| candidate_rows(run, summary, &parameters)).collect(),
        ),
        Table::new("metrics", with_run(&METRICS), found().flat_map(|(run, s)| metric_rows(run, s)).collect()),
        Table::new(
            "predictions",
            with_run(&PREDICTIONS),
            found().flat_map(|(run, summary)| prediction_rows(run, summary)).collect(),
        ),
    ]
}

// `tests`: one row a run.

/// Columns that every table begins with: which run it is.
pub(crate) const OF_RUN: [(&str, Kind); 4] =
    [("record", Text), ("record_digest", Text), ("pipeline", Text), ("settings", Text)];

/// Columns of the table.
pub(crate) const TESTS: [(&str, Kind); 34] = [
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
    ("verdict", Text),
    ("verdict_because", Text),
    ("record_is", Text),
    ("good_for", Text),
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
pub(crate) fn test_row(run: &Run, ended: &JournalEntry, summary: Option<&Summary>) -> Vec<Cell> {
    let test = summary.map(|summary| &summary.test);
    let events = summary.and_then(|summary| summary.events.as_ref());
    let vehicle = test.and_then(|test| test.vehicle.as_deref());
    let metric = |name: &str| Cell::from(summary.and_then(|summary| summary.metric(name)));
    let kelvin = |name: &str| Cell::from(summary.and_then(|summary| summary.parameter("kelvin", name)));
    let text = |text: Option<&String>| Cell::from(text.map(String::as_str));
    let count =
        |count: Option<usize>| count.map_or(Cell::Empty, |count| Cell::Count(i64::try_from(count).unwrap_or(i64::MAX)));
    let row = vec![
        (&run.folder).into(),
        status(ended.exit_code).into(),
        Cell::Count(ended.exit_code.into()),
        (&ended.error).into(),
        text(test.map(|test| &test.title)),
        vehicle.into(),
        summary.and_then(Summary::model_year).map_or(Cell::Empty, Cell::Count),
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
        summary.and_then(|summary| Some(summary.verdict.status?.word())).into(),
        text(summary.map(|summary| &summary.verdict.status_sentence)),
        summary.and_then(|summary| Some(summary.verdict.record?.word())).into(),
        text(summary.map(|summary| summary.verdict.uses()).as_ref()),
        text(summary.and_then(|summary| summary.recommended.as_ref())),
        text(summary.map(|summary| &summary.recommended_because)),
        text(summary.and_then(|summary| summary.simplest.as_ref())),
        text(summary.and_then(|summary| summary.closest.as_ref())),
        count(summary.map(|summary| summary.candidates.len())),
        count(summary.map(Summary::count_of_warnings)),
    ];
    [cells_of_run(run), row].concat()
}

// The tables of a fleet on disk.

/// Writes each table as Parquet and as CSV into a folder, each file in one piece.
pub(crate) fn write_tables(folder: &Path, tables: &[Table]) -> anyhow::Result<()> {
    tables.par_iter().try_for_each(|table| {
        let path = folder.join(format!("{}.parquet", table.name));
        let cannot_write = |path: &Path| format!("cannot write {}", path.display());
        write_atomically(&path, OutputKind::Table, |file| -> anyhow::Result<()> { Ok(write_parquet(table, file)?) })
            .with_context(|| cannot_write(&path))?;
        let path = folder.join(format!("{}.csv", table.name));
        write_atomically(&path, OutputKind::Table, |file| -> anyhow::Result<()> {
            Ok(write_csv(table, CsvForm::Plain, file)?)
        })
        .with_context(|| cannot_write(&path))
    })
}
