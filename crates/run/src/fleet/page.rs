//! `fleet.html`: the runs of a fleet as an index, with figures of all of them. The page, its table and its quantities
//! are those of `crumple-report`.

use std::io::Write;
use std::path::Path;

use anyhow::Context;
use crumple_artifact::{Artifact, OutputKind, write_atomically};
use crumple_report::drawing::{Axis, Colour, Dash, Figure, Link, Look, Panel, Symbol, span};
use crumple_report::run_numbers::{CRUSH, MASS, OLC, RESTITUTION, SPEED, STIFFNESS, YEAR};
use crumple_report::words;
use crumple_report::{FiguresOfRuns, IndexedRun, RunIndex, RunNumber, Status, pulse_line, write_shared_files};
use rayon::prelude::*;

use crate::fleet::command::{Options, PAGE_FILES};
use crate::fleet::tables::Row;

// How quantities are distributed over the runs.

/// Columns of a panel.
const COLUMNS: usize = 24;

/// Height of a panel, of its own 560 of width.
const HEIGHT_OF_COLUMNS: f64 = 210.0;

/// Names the columns and the axis they rise along.
const RUNS: &str = "runs";

/// Numbers of runs by value, a panel a quantity; those that fewer than two runs have are left out.
pub(crate) fn distributions(rows: &[Row], quantities: &[RunNumber]) -> Figure {
    let mut figure = Figure::new("distributions", "Runs by value");
    let entry = figure.entry(RUNS, Look::line(Colour::Series(0), Dash::Solid), true);
    for quantity in quantities {
        let values: Vec<f64> = rows.iter().filter_map(|row| quantity.value(row.summary.as_ref()?)).collect();
        if values.len() > 1 {
            figure.panels.push(columns_of(entry, quantity, &values));
        }
    }
    figure
}

fn columns_of(entry: usize, quantity: &RunNumber, values: &[f64]) -> Panel {
    let (low, high) = span(values).unwrap_or((0.0, 1.0));
    let room = if high > low { 0.02 * (high - low) } else { (0.1 * high.abs()).max(0.5) };
    let (low, high) = (low - room, high + room);
    let width = (high - low) / COLUMNS as f64;
    let mut counts = [0.0; COLUMNS];
    for value in values {
        counts[(((value - low) / width) as usize).min(COLUMNS - 1)] += 1.0;
    }
    let edges: Vec<f64> = (0..=COLUMNS).map(|k| low + width * k as f64).collect();
    let most = counts.iter().copied().fold(1.0, f64::max);
    let up = Axis { whole: true, ..Axis::new(RUNS) }.from_to([0.0, 1.08 * most]);
    let mut panel =
        Panel { height: HEIGHT_OF_COLUMNS, ..Panel::new(Axis::new(quantity.label()).from_to([low, high]), up) };
    panel.columns(entry, &edges, &counts);
    panel
}

// The page as a whole.

/// Writes `fleet.html` in one piece, and what the pages of runs share where it is gone.
pub(crate) fn write_page(fleet: &Path, rows: &[Row], options: &Options) -> anyhow::Result<()> {
    if !options.whole_pages {
        let folder = fleet.join(PAGE_FILES);
        write_shared_files(&folder).with_context(|| format!("cannot write into {}", folder.display()))?;
    }
    let path = fleet.join("fleet.html");
    let page = options.display.or_of(None)?.during(|| page(fleet, rows));
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
            text: "Mass, speed, year and class differ together in what was tested: a line here describes these runs, \
                   it is no law.",
            figures: scatters.into_iter().map(|(id, y)| scatter(rows, (id, y), &over)).collect(),
        },
        FiguresOfRuns {
            heading: "Distributions",
            text: "How many runs have which value.",
            figures: vec![distributions(rows, &[MASS, SPEED, CRUSH, OLC, STIFFNESS, RESTITUTION])],
        },
    ];
    let tables = [
        ("tests", "tests.csv"),
        ("candidates", "candidates.csv"),
        ("metrics", "metrics.csv"),
        ("predictions", "predictions.csv"),
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
        reason: reason(row),
        summary: row.summary.as_ref(),
        pulse: pulse(fleet, row),
    }
}

/// Why a run has no result: by its summary, by what its programs told, or the first line of what clap or a program from
/// elsewhere said.
fn reason(row: &Row) -> String {
    let told = || {
        let first = row.ended.error.lines().next().unwrap_or_default();
        first.strip_prefix("error: ").unwrap_or(first).to_owned()
    };
    let of_summary = row.summary.as_ref().map(|summary| IndexedRun::ending(summary).1);
    of_summary.filter(|reason| !reason.is_empty()).or_else(|| row.ended.reason.clone()).unwrap_or_else(told)
}

// Which points lie far from the line through the others.

/// Residuals beyond this many robust standard deviations are outliers.
pub(crate) const LIMIT: f64 = 4.0;

/// A median absolute deviation of normal residuals is this share of their standard deviation.
const MAD_OF_NORMAL: f64 = 0.674_489_750_196_081_7;

/// Rounds of fitting the line to the points that are not outliers.
const ROUNDS: usize = 3;

/// Fewest points of a line.
const FEWEST: usize = 8;

/// A straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    /// Value at the mean of x.
    pub(crate) level: f64,
    /// Mean of x.
    pub(crate) at: f64,
    /// Slope.
    pub(crate) slope: f64,
}

impl Line {
    /// Value at x.
    pub(crate) fn value(&self, x: f64) -> f64 {
        self.level + self.slope * (x - self.at)
    }
}

/// The least-squares line through the points that are not outliers, and which are: residuals above [`LIMIT`] robust
/// standard deviations. `None`: fewer than eight points.
pub(crate) fn line_and_outliers(points: &[(f64, f64)]) -> Option<(Line, Vec<bool>)> {
    if points.len() < FEWEST {
        return None;
    }
    let mut is_outlier = vec![false; points.len()];
    let mut line = fit(points, &is_outlier);
    for _ in 0..ROUNDS {
        let residuals: Vec<f64> = points.iter().map(|(x, y)| (y - line.value(*x)).abs()).collect();
        let limit = LIMIT * median(&residuals) / MAD_OF_NORMAL;
        // Points on a line have rounding alone for residuals.
        let least = 1e-9 * points.iter().fold(0.0_f64, |most, (_, y)| most.max(y.abs()));
        is_outlier = residuals.iter().map(|residual| *residual > limit.max(least)).collect();
        line = fit(points, &is_outlier);
    }
    Some((line, is_outlier))
}

fn fit(points: &[(f64, f64)], is_outlier: &[bool]) -> Line {
    let kept = || points.iter().zip(is_outlier).filter(|(_, outlier)| !**outlier).map(|(point, _)| point);
    let count = kept().count().max(1) as f64;
    let (x, y) = kept().fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / count, sy + y / count));
    let (xx, xy) = kept().fold((0.0, 0.0), |(xx, xy), (px, py)| (xx + (px - x).powi(2), xy + (px - x) * (py - y)));
    Line { level: y, at: x, slope: if xx > 0.0 { xy / xx } else { 0.0 } }
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or_default()
}

// The pulse of a run.

/// Artifact with the filtered pulse.
const FILTERED: &str = "2-filter.mcap";

/// The filtered acceleration of a run's pulse as a small line; empty where there is none.
pub(crate) fn pulse(fleet: &Path, row: &Row) -> String {
    line(fleet, row).unwrap_or_default()
}

fn line(fleet: &Path, row: &Row) -> Option<String> {
    let summary = row.summary.as_ref()?;
    let artifact = Artifact::open(&fleet.join(&row.run.folder).join(FILTERED)).ok()?;
    let wave = &artifact.waves().get(summary.test.channel.as_deref()?)?.sampled;
    Some(pulse_line(wave))
}

// Quantities over each other, a point a run; outliers lead to their reports.

/// Share of a value within which runs are of one: speeds as people type them, and rounding.
const SAME: f64 = 1e-3;

/// Most outliers of a panel that are links.
const LINKS: usize = 20;

/// Height of a panel, of its own 560 of width.
const HEIGHT: f64 = 300.0;

/// `y` over each of several quantities, a panel each; those that fewer than two runs have, or that are one for all
/// runs, are left out.
pub(crate) fn scatter(rows: &[Row], (id, y): (&'static str, RunNumber), over: &[RunNumber]) -> Figure {
    let mut figure = Figure::new(id, capitalised(y.name));
    let unusable = "a run with the status do not use";
    let outlier = "outlier: more than four robust standard deviations off the line; leads to its report";
    let entries = [
        figure.entry("a run", Look::marks(Colour::Series(0), Symbol::Point), true),
        figure.entry(
            "least-squares line of the runs that are no outliers",
            Look::line(Colour::Muted, Dash::Dashed),
            true,
        ),
        figure.entry(outlier, Look::marks(Colour::Series(1), Symbol::Ring), true),
    ];
    // Hollow; without one the legend does not speak of it.
    let hollow = Look::marks(Colour::Series(0), Symbol::Ring);
    let is_shown = (1..=HOLLOW).contains(&rows.iter().filter(|row| is_unusable(row)).count());
    let unusable = is_shown.then(|| figure.entry(unusable, hollow, true));
    figure.panels = over.iter().filter_map(|x| panel(rows, (entries, unusable), (*x, y))).collect();
    figure
}

/// Hollow dots of a figure at most: each is as long as three dots, and a page of 500 runs stays below half a megabyte.
/// Of more the table and the count above it tell.
const HOLLOW: usize = 50;

/// Whether the results of a run are not to be used.
fn is_unusable(row: &Row) -> bool {
    row.summary.as_ref().is_some_and(|summary| summary.verdict.status == Some(Status::DoNotUse))
}

fn panel(
    rows: &[Row],
    ([runs, line, _], unusable): ([usize; 3], Option<usize>),
    (x, y): (RunNumber, RunNumber),
) -> Option<Panel> {
    let both = |row: &Row| row.summary.as_ref().and_then(|run| Some((x.value(run)?, y.value(run)?)));
    let of_rows: Vec<(&Row, (f64, f64))> = rows.iter().filter_map(|row| Some((row, both(row)?))).collect();
    if of_rows.len() < 2 {
        return None;
    }
    let points: Vec<(f64, f64)> = of_rows.iter().map(|(_, point)| *point).collect();
    // Over one speed, or of one crush, there is nothing to see.
    let varies = |of: fn(&(f64, f64)) -> f64| {
        span(&points.iter().map(of).collect::<Vec<_>>()).is_some_and(|(low, high)| high - low > SAME * high.abs())
    };
    if !varies(|point| point.0) || !varies(|point| point.1) {
        return None;
    }
    let fitted = line_and_outliers(&points);
    let is_outlier = |number: usize| fitted.as_ref().is_some_and(|(_, outliers)| outliers[number]);
    let whole = x.unit.is_empty();
    let mut panel =
        Panel { height: HEIGHT, ..Panel::new(Axis { whole, ..Axis::new(x.label()) }, Axis::new(y.label())) };
    for (entry, hollow) in std::iter::once((runs, false)).chain(unusable.map(|entry| (entry, true))) {
        let dots = of_rows.iter().enumerate().filter(|(number, _)| !is_outlier(*number));
        let dots = dots
            .filter(|(_, (row, _))| (unusable.is_some() && is_unusable(row)) == hollow)
            .map(|(_, (_, (x, y)))| [*x, *y])
            .collect();
        panel.points(entry, dots);
    }
    if let Some((fit, _)) = &fitted {
        let all: Vec<f64> = points.iter().map(|point| point.0).collect();
        let (low, high) = span(&all)?;
        panel.line(line, [low, high].map(|at| [at, fit.value(at)]).to_vec());
    }
    let outliers = of_rows.iter().enumerate().filter(|(number, _)| is_outlier(*number)).take(LINKS);
    panel.links = outliers
        .map(|(_, (row, point))| Link {
            at: [point.0, point.1],
            address: format!("{}/report.html", row.run.folder),
            text: format!("{}: {} {}", row.run.record.identity, words::significant(point.1, 3), y.shown().2)
                .trim_end()
                .to_owned(),
        })
        .collect();
    Some(panel)
}

fn capitalised(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::records::Record;
    use crate::fleet::runs::JournalEntry;
    use crate::fleet::runs::Run;
    use clap::Parser;
    use crumple_report::Summary;
    use crumple_report::run_numbers::MASS;
    use std::fs;
    use std::os::unix::fs::symlink;
    use std::path::PathBuf;

    #[test]
    fn every_run_is_in_a_column_and_equal_values_have_an_axis() {
        for values in [vec![1.0, 2.0, 2.0, 5.0], vec![3.0, 3.0]] {
            let panel = columns_of(0, &MASS, &values);
            let counted: f64 = panel.curves[0].points.windows(2).filter(|p| p[0][1] == p[1][1]).map(|p| p[0][1]).sum();
            assert_eq!(counted, values.len() as f64, "{panel:?}");
            assert_eq!(panel.x.title, "test mass, kg");
        }
    }

    fn fixture(file: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/kelvin/golden").join(file)
    }

    /// Numbers between 0 and 1 that look random.
    fn share(number: usize, stream: usize) -> f64 {
        (number as f64 * [0.618_034, 0.754_878, 0.569_840, 0.324_718][stream]).fract()
    }

    /// A run whose stiffness goes with its mass, but for one in a hundred; every fiftieth is refused.
    fn row(number: usize, found: &Summary) -> Row {
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
        let reason = format!("{name}.csv, line {number}: \"x\" is no number");
        let ended = JournalEntry {
            key: String::new(),
            folder: run.folder.clone(),
            exit_code: if refused { 3 } else { 0 },
            error: if refused { format!("error: cannot read {name}.csv") } else { String::new() },
            reason: refused.then_some(reason),
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
        let found = Summary::from_json(&fs::read(fixture("summary.json")).unwrap()).unwrap();
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
        assert!(
            html.contains("<summary>10 × refused</summary>")
                && html.contains(", line 49: &quot;x&quot; is no number</li>")
        );
        assert_eq!(html, page(&fleet, &rows));
        assert_eq!(fs::read_dir(fleet.join(PAGE_FILES)).unwrap().count(), 3, "style and two scripts");
    }

    #[test]
    fn a_run_that_is_not_to_be_used_is_counted_and_a_hollow_dot() {
        let folder = tempfile::tempdir().unwrap();
        let found = Summary::from_json(&fs::read(fixture("summary.json")).unwrap()).unwrap();
        let mut rows: Vec<Row> = (0..20).map(|number| row(number, &found)).collect();
        rows.iter_mut().filter_map(|row| row.summary.as_mut()).for_each(|of| of.verdict.status = Some(Status::Usable));
        assert!(!page(folder.path(), &rows).contains("status do not use"));
        rows[3].summary.as_mut().unwrap().verdict.status = Some(Status::DoNotUse);
        let html = page(folder.path(), &rows);
        assert!(html.contains("20 runs: 19 usable, 1 do not use") && html.contains("status do not use"));
        // What is looked for is in front.
        assert!(html.find("<section id=\"runs\">") < html.find("<h2>Over mass"));
    }

    #[test]
    fn a_fleet_without_a_single_result_has_a_page() {
        let folder = tempfile::tempdir().unwrap();
        let found = Summary::from_json(&fs::read(fixture("summary.json")).unwrap()).unwrap();
        let html = page(folder.path(), &[row(49, &found)]);
        assert!(html.contains("1 run: 1 without a result") && !html.contains("Distrib"));
        assert!(page(folder.path(), &[]).contains("0 runs"));
    }

    #[test]
    fn over_what_is_one_for_all_runs_nothing_is_drawn() {
        let found = Summary::from_json(&fs::read(fixture("summary.json")).unwrap()).unwrap();
        let mut rows: Vec<Row> = (0..20).map(|number| row(number, &found)).collect();
        let panels = |rows: &[Row]| scatter(rows, ("crush", CRUSH), &[MASS, SPEED]).panels.len();
        assert_eq!(panels(&rows), 2);
        rows.iter_mut().filter_map(|row| row.summary.as_mut()).for_each(|run| run.test.mass_kg = Some(1500.0));
        assert_eq!(panels(&rows), 1);
    }

    #[test]
    fn the_point_that_was_moved_is_found_and_does_not_turn_the_line() {
        let mut points: Vec<(f64, f64)> =
            (0..40).map(|k| (f64::from(k), 2.0 * f64::from(k) + 0.1 * f64::from(k % 3))).collect();
        points[35].1 += 30.0;
        let (line, outliers) = line_and_outliers(&points).unwrap();
        assert_eq!(outliers.iter().filter(|outlier| **outlier).count(), 1);
        assert!(outliers[35] && (line.slope - 2.0).abs() < 1e-3, "{line:?}");
        assert!(line_and_outliers(&points[..7]).is_none());
        let on_a_line: Vec<(f64, f64)> = (0..9).map(|k| (f64::from(k), 0.1 * f64::from(k))).collect();
        assert!(!line_and_outliers(&on_a_line).unwrap().1.contains(&true));
    }
}
