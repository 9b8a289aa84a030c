//! The page as a whole.

use std::io::Write;
use std::path::Path;

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_report::quantities::{CRUSH, MASS, OLC, RESTITUTION, SPEED, STIFFNESS, YEAR};
use crumple_report::{FiguresOfRuns, IndexedRun, RunIndex};
use rayon::prelude::*;

use crate::page::distributions::distributions;
use crate::page::pulse::pulse;
use crate::page::scatter::scatter;
use crate::tables::rows::Row;

/// Tables beside the page.
const TABLES: [(&str, &str); 4] = [
    ("tests", "tests.csv"),
    ("candidates", "candidates.csv"),
    ("metrics", "metrics.csv"),
    ("predictions", "predictions.csv"),
];

/// Writes `fleet.html` in one piece.
pub(crate) fn write_page(fleet: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let path = fleet.join("fleet.html");
    let page = page(fleet, rows);
    write_atomically(&path, OutputKind::Report, |file| file.write_all(page.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}

fn page(fleet: &Path, rows: &[Row]) -> String {
    let name = fleet.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let differ = |row: &Row| row.run.pipeline_name != rows[0].run.pipeline_name || !row.run.settings.is_empty();
    let several = rows.iter().any(differ);
    let runs: Vec<IndexedRun<'_>> = rows.par_iter().map(|row| indexed(fleet, row, several)).collect();
    let over = [MASS, SPEED, YEAR];
    let scatters = [("stiffness", STIFFNESS), ("crush", CRUSH), ("olc", OLC)];
    let figures = vec![
        FiguresOfRuns {
            heading: "Over mass, speed and model year",
            text: "What differs between records of a fleet differs together: a line here says what was tested, it is no \
                   law.",
            figures: scatters.into_iter().map(|(id, y)| scatter(rows, id, y, &over)).collect(),
        },
        FiguresOfRuns {
            heading: "Distributions",
            text: "How many runs have which value.",
            figures: vec![distributions(rows, &[MASS, SPEED, CRUSH, OLC, STIFFNESS, RESTITUTION])],
        },
    ];
    RunIndex { title: &name, tables: &TABLES, runs: &runs, figures }.to_html()
}

fn indexed<'a>(fleet: &Path, row: &'a Row, several: bool) -> IndexedRun<'a> {
    let variant = || format!("{} {}", row.run.pipeline_name, row.run.settings()).trim_end().to_owned();
    IndexedRun {
        name: row.run.record.identity.clone(),
        variant: if several { variant() } else { String::new() },
        report: row.summary.as_ref().map(|_| format!("{}/report.html", row.run.folder)),
        exit_code: row.ended.exit_code,
        error: row.ended.error.clone(),
        summary: row.summary.as_ref(),
        pulse: pulse(fleet, row),
    }
}
