//! The rows of all runs, read from their folders.

use std::fs;
use std::path::Path;

use anyhow::Context;
use crumple_report::RunSummary;
use rayon::prelude::*;

use crate::runs::Ended;
use crate::runs::{Run, path_in};
use crate::tables::table::{Column, Table, columns};
use crate::tables::tests_table::OF_RUN;
use crate::tables::{candidates, metrics, predictions, tests_table};

/// A run with how it ended and what it found.
#[derive(Debug)]
pub(crate) struct Row {
    /// The run.
    pub(crate) run: Run,
    /// Its end.
    pub(crate) ended: Ended,
    /// What it found, where it has a result.
    pub(crate) summary: Option<RunSummary>,
}

/// Reads the summaries of runs that have a result.
pub(crate) fn rows(fleet: &Path, ended: Vec<(Run, Ended)>) -> anyhow::Result<Vec<Row>> {
    let row = |(run, ended): (Run, Ended)| -> anyhow::Result<Row> {
        let summary = ended.has_result().then(|| read_summary(&path_in(fleet, &run))).transpose()?;
        Ok(Row { run, ended, summary })
    };
    ended.into_par_iter().map(row).collect()
}

fn read_summary(folder: &Path) -> anyhow::Result<RunSummary> {
    let path = folder.join("summary.json");
    let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    RunSummary::from_json(&bytes).with_context(|| format!("{} is no summary of a run", path.display()))
}

/// The four tables.
pub(crate) fn tables(rows: &[Row]) -> [Table; 4] {
    let found = || rows.iter().filter_map(|row| Some((&row.run, row.summary.as_ref()?)));
    let parameters = candidates::parameter_names(found().map(|(_, summary)| summary));
    let with_run = |more: &[_]| -> Vec<Column> { [columns(&OF_RUN), columns(more)].concat() };
    let mut of_candidates = with_run(&candidates::CANDIDATES);
    of_candidates.extend(candidates::parameter_columns(&parameters));
    let table = |name, columns, rows| Table { name, columns, rows };
    [
        table(
            "tests",
            with_run(&tests_table::TESTS),
            rows.iter().map(|row| tests_table::row(&row.run, &row.ended, row.summary.as_ref())).collect(),
        ),
        table(
            "candidates",
            of_candidates,
            found().flat_map(|(run, summary)| candidates::rows(run, summary, &parameters)).collect(),
        ),
        table("metrics", with_run(&metrics::METRICS), found().flat_map(|(run, s)| metrics::rows(run, s)).collect()),
        table(
            "predictions",
            with_run(&predictions::PREDICTIONS),
            found().flat_map(|(run, summary)| predictions::rows(run, summary)).collect(),
        ),
    ]
}
