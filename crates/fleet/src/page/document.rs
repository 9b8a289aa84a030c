//! The page as a whole.

use crumple_report::phrases::PHRASES;
use std::io::Write;
use std::path::Path;

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_report::quantities::{CRUSH, MASS, OLC, RESTITUTION, SPEED, STIFFNESS, YEAR};
use crumple_report::{FiguresOfRuns, IndexedRun, RunIndex, write_shared_files};
use rayon::prelude::*;

use crate::command::{Options, PAGE_FILES};
use crate::page::distributions::distributions;
use crate::page::pulse::pulse;
use crate::page::scatter::scatter;
use crate::tables::rows::Row;

/// Writes `fleet.html` in one piece, and what the pages of runs share where it is gone.
pub(crate) fn write_page(fleet: &Path, rows: &[Row], options: &Options) -> anyhow::Result<()> {
    if !options.whole_pages {
        let folder = fleet.join(PAGE_FILES);
        write_shared_files(&folder).with_context(|| format!("cannot write into {}", folder.display()))?;
    }
    let path = fleet.join("fleet.html");
    let page = page(fleet, rows);
    write_atomically(&path, OutputKind::Report, |file| file.write_all(page.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))
}

fn page(fleet: &Path, rows: &[Row]) -> String {
    let texts = &PHRASES.fleet;
    let name = fleet.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let differ = |row: &Row| row.run.pipeline_name != rows[0].run.pipeline_name || !row.run.settings.is_empty();
    let several = rows.iter().any(differ);
    let runs: Vec<IndexedRun<'_>> = rows.par_iter().map(|row| indexed(fleet, row, several)).collect();
    let over = [MASS, SPEED, YEAR];
    let scatters = [("stiffness", STIFFNESS), ("crush", CRUSH), ("olc", OLC)];
    let figures = vec![
        FiguresOfRuns {
            heading: texts.over,
            text: texts.no_law,
            figures: scatters.into_iter().map(|(id, y)| scatter(rows, (id, y), &over)).collect(),
        },
        FiguresOfRuns {
            heading: texts.distributions,
            text: texts.how_many,
            figures: vec![distributions(rows, &[MASS, SPEED, CRUSH, OLC, STIFFNESS, RESTITUTION])],
        },
    ];
    let tables = [
        (texts.tests, "tests.csv"),
        (texts.candidates, "candidates.csv"),
        (texts.metrics, "metrics.csv"),
        (texts.predictions, "predictions.csv"),
    ];
    RunIndex { title: &name, tables: &tables, runs: &runs, figures }.to_html()
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

#[cfg(test)]
mod tests {
    use std::fs;
    use std::os::unix::fs::symlink;
    use std::path::PathBuf;

    use clap::Parser;

    use crumple_report::RunSummary;

    use super::*;
    use crate::records::record::Record;
    use crate::runs::Ended;
    use crate::runs::Run;

    fn fixture(file: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/kelvin/golden").join(file)
    }

    /// Numbers between 0 and 1 that look random.
    fn share(number: usize, stream: usize) -> f64 {
        (number as f64 * [0.618_034, 0.754_878, 0.569_840, 0.324_718][stream]).fract()
    }

    /// A run whose stiffness goes with its mass, but for one in a hundred; every fiftieth is refused.
    fn row(number: usize, found: &RunSummary) -> Row {
        let name = format!("{number:05}-56");
        let record =
            Record { path: PathBuf::new(), identity: format!("{name}.csv"), name: name.clone(), digests: None };
        let run = Run {
            record,
            pipeline: "default".into(),
            pipeline_name: "default".into(),
            settings: Vec::new(),
            folder: format!("runs/{name}/default"),
            key: None,
        };
        let refused = number % 50 == 49;
        let error =
            format!("error: cannot read {name}.csv\n  caused by: {name}.csv, line {number}: \"x\" is no number");
        let ended = Ended {
            key: String::new(),
            folder: run.folder.clone(),
            exit_code: if refused { 3 } else { 0 },
            error: if refused { error } else { String::new() },
            summary: None,
            seconds: 0.0,
        };
        let mut summary = found.clone();
        let mass = 1000.0 + 1500.0 * share(number, 0);
        let off = if number % 100 == 5 { 2.0 } else { 1.0 };
        let stiffness = 420.0 * mass * (0.95 + 0.1 * share(number, 1)) * off;
        let speed = if number.is_multiple_of(2) { 15.56 } else { 11.11 };
        summary.test.mass_kg = Some(mass.round());
        summary.test.impact_speed_m_per_s = Some(speed);
        summary.test.vehicle = Some(format!("{} MADE SEDAN {number:05}", 1998 + (25.0 * share(number, 2)) as usize));
        let crush = speed * (mass / stiffness).sqrt();
        if let Some(events) = &mut summary.events {
            events.dynamic_crush_m = Some(crush);
        }
        if let Some(olc) = summary.metrics.get_mut("olc") {
            olc.value = Some(speed * speed / crush * (0.7 + 0.05 * share(number, 3)));
        }
        for candidate in summary.candidates.iter_mut().filter(|candidate| candidate.model == "kelvin") {
            candidate.parameters.insert("stiffness_n_per_m".into(), stiffness);
        }
        Row { run, ended, summary: (!refused).then_some(summary) }
    }

    fn made(folder: &Path) -> Vec<Row> {
        let found = RunSummary::from_json(&fs::read(fixture("summary.json")).unwrap()).unwrap();
        let rows: Vec<Row> = (0..500).map(|number| row(number, &found)).collect();
        for row in &rows {
            let folder = folder.join(&row.run.folder);
            fs::create_dir_all(&folder).unwrap();
            symlink(fixture("2-filter.mcap").canonicalize().unwrap(), folder.join("2-filter.mcap")).unwrap();
        }
        rows
    }

    #[test]
    fn a_fleet_of_five_hundred_is_below_half_a_megabyte_and_names_outliers_and_failures() {
        let folder = tempfile::tempdir().unwrap();
        let fleet = folder.path().join("made <fleet>");
        let rows = made(&fleet);
        let options = Options::parse_from(["fleet", "records"]);
        write_page(&fleet, &rows, &options).unwrap();
        let html = fs::read_to_string(fleet.join("fleet.html")).unwrap();
        eprintln!("fleet.html of 500 runs: {} bytes", html.len());
        assert!(html.len() < 500_000, "{}", html.len());
        assert!(html.contains("<h1>made &lt;fleet&gt;</h1>") && html.matches("<svg class=s ").count() == 490);
        // Stiffness, crush and OLC over mass, speed and year; six distributions.
        assert_eq!(html.matches("<svg class=\"plot\"").count(), 9 + 6);
        assert!(html.contains("href=\"runs/00005-56/default/report.html\"><circle class=\"link\""));
        assert!(html.contains("<summary>10 × refused: …, line #: &quot;…&quot; is no number</summary>"));
        assert_eq!(html, page(&fleet, &rows));
        assert_eq!(fs::read_dir(fleet.join(PAGE_FILES)).unwrap().count(), 3, "style and two scripts");
    }

    #[test]
    fn a_fleet_without_a_single_result_has_a_page() {
        let folder = tempfile::tempdir().unwrap();
        let found = RunSummary::from_json(&fs::read(fixture("summary.json")).unwrap()).unwrap();
        let html = page(folder.path(), &[row(49, &found)]);
        assert!(html.contains("1 run, 0 with a recommended model, 1 without a result") && !html.contains("Distrib"));
        assert!(page(folder.path(), &[]).contains("0 runs"));
    }
}
