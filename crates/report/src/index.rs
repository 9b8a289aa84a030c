//! Many runs on one page: a sortable table with a small pulse each, runs without a result by reason, figures of all.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crumple_signal::Sampled;
use crumple_signal::display::sentence;

use crate::drawing::escape::{address, html};
use crate::drawing::{Drawing, Entry, Figure, sparkline, swatch};
use crate::findings::{ResultStatus, Status, Summary};
use crate::findings::{capitalised, model_name};
use crate::frame::framed;
use crate::run_numbers::{CRUSH, DELTA_V, MASS, OLC, PEAK, RESTITUTION, RunNumber, SPEED, STIFFNESS, TIME_OF_CRUSH};
use crate::words;

// The page as a whole.

const STYLE: &str = include_str!("index/style.css");

const SORT: &str = include_str!("index/sort.js");

/// Many runs on one page.
#[derive(Debug)]
pub struct RunIndex<'a> {
    /// What the page is called; empty: an index of runs.
    pub title: &'a str,
    /// Files beside the page with all that is in it: what each is called, and its path.
    pub tables: &'a [(&'a str, &'a str)],
    /// The runs, in the order of the table.
    pub runs: &'a [IndexedRun<'a>],
    /// Figures of all runs.
    pub figures: Vec<FiguresOfRuns>,
}

/// Figures of all runs with what to take from them.
#[derive(Debug)]
pub struct FiguresOfRuns {
    /// Heading.
    pub heading: &'static str,
    /// What they show, plain text.
    pub text: &'static str,
    /// The figures; the panels of each stand side by side.
    pub figures: Vec<Figure>,
}

impl RunIndex<'_> {
    /// The page. The same runs give the same bytes.
    pub fn to_html(&self) -> String {
        let title = if self.title.is_empty() { "Index of runs" } else { self.title };
        let mut body = format!(
            "<header>\n<p class=\"brand\">Crumple · index of runs</p>\n<h1>{}</h1>\n<p>{}.{}</p>\n</header>\n\
             <main>\n{}",
            html(title),
            self.counted(),
            self.files(),
            failures(self.runs)
        );
        body.push_str(&format!(
            "<section id=\"runs\">\n<h2>Runs</h2>\n<p class=\"caption\">A name leads to the report of the run. C and \
             tₘ: dynamic crush and its time; e: restitution; k: stiffness of the Kelvin model. Pulses: the filtered \
             acceleration over the first 150 ms, upwards as the vehicle slows down, each to its own peak. Three digits \
             are shown; the reports have all, with intervals.<span class=\"script\"> A head of a column \
             sorts.</span><span class=\"wide\"> The table scrolls to the side.</span></p>\n{}</section>\n",
            table(self.runs)
        ));
        self.figures.iter().for_each(|figures| write_figures(&mut body, figures));
        body.push_str("</main>\n");
        framed(title, STYLE, &body, SORT)
    }

    /// How many runs there are, and how many of them have which status.
    pub fn counted(&self) -> String {
        let of_status = |status: Status| {
            let is_it = |run: &&IndexedRun<'_>| run.status() == Some(status);
            (self.runs.iter().filter(is_it).count(), status.word())
        };
        let failed = self.runs.iter().filter(|run| !run.is_done()).count();
        let [usable, with_care, unusable] = [Status::Usable, Status::UsableWithCare, Status::DoNotUse].map(of_status);
        let counts = [usable, with_care, unusable, (failed, "without a result")];
        let counts = counts.into_iter().filter(|(count, _)| *count > 0).map(|(count, word)| format!("{count} {word}"));
        let (runs, counts) = (if self.runs.len() == 1 { "run" } else { "runs" }, Vec::from_iter(counts).join(", "));
        format!("{} {runs}{}{counts}", self.runs.len(), if counts.is_empty() { "" } else { ": " })
    }

    /// The runs as a terminal shows them: a line each, what it is called, the first numbers, and the status with its
    /// reason.
    pub fn lines(&self) -> Vec<String> {
        let name = |run: &IndexedRun<'_>| run.name.chars().count();
        let width = self.runs.iter().map(name).max().unwrap_or(0).clamp("run".len(), LONGEST_NAME);
        let column = |quantity: &RunNumber| quantity.head().chars().count().max(NARROWEST);
        let in_column = |quantity: &RunNumber, text: &str| format!("  {text:>width$}", width = column(quantity));
        let heads: String = IN_TERMINAL.iter().map(|quantity| in_column(quantity, &quantity.head())).collect();
        let mut lines = vec![format!("{:<width$}{heads}  status", "run")];
        lines.extend(self.runs.iter().map(|run| {
            let number = |quantity: &RunNumber| run.summary.and_then(|summary| quantity.value(summary));
            let shown = |value: Option<f64>| value.map_or_else(String::new, |value| words::significant(value, DIGITS));
            let numbers: String =
                IN_TERMINAL.iter().map(|quantity| in_column(quantity, &shown(number(quantity)))).collect();
            let said = match run.summary.filter(|_| run.is_done()) {
                Some(summary) => sentence(&summary.verdict.status_sentence).into_owned(),
                None => format!("{}: {}", status(run.exit_code), run.first_warning()),
            };
            format!("{:<width$}{numbers}  {said}", shortened(&run.name, LONGEST_NAME - 1))
        }));
        lines
    }

    fn files(&self) -> String {
        let link = |(name, path): &(&str, &str)| format!("<a href=\"{}\">{}</a>", address(path), html(name));
        let links: Vec<String> = self.tables.iter().map(link).collect();
        if links.is_empty() {
            return String::new();
        }
        format!(" All numbers as tables: {}.", links.join(", "))
    }
}

/// Figures without boxes and cursor: of all runs at once there is nothing to hide.
fn write_figures(out: &mut String, of_runs: &FiguresOfRuns) {
    let figures: Vec<&Figure> = of_runs.figures.iter().filter(|figure| !figure.panels.is_empty()).collect();
    let Some(first) = figures.first() else { return };
    let (heading, text) = (html(of_runs.heading), html(of_runs.text));
    out.push_str(&format!("<section>\n<h2>{heading}</h2>\n<p class=\"caption\">{text}</p>\n{}", legend(first)));
    for figure in figures {
        let id = figure.id;
        out.push_str(&format!(
            "<section class=\"small\" id=\"{id}\" aria-labelledby=\"{id}-title\">\n<h3 id=\"{id}-title\">{}</h3>\n\
             <div class=\"panels\">\n",
            html(&figure.title)
        ));
        for (place, panel) in figure.panels.iter().enumerate() {
            out.push_str(&Drawing::new(figure, panel).svg(&format!("{id}-{place}"), false));
        }
        out.push_str("</div>\n</section>\n");
    }
    out.push_str("</section>\n");
}

/// The legend that the figures of a section share; of one name there is nothing to tell apart.
fn legend(figure: &Figure) -> String {
    if figure.legend.len() < 2 {
        return String::new();
    }
    let item = |entry: &Entry| {
        let name = html(&entry.name);
        format!("<li><svg viewBox=\"0 0 28 12\" aria-hidden=\"true\">{}</svg> {name}</li>\n", swatch(entry))
    };
    let items: String = figure.legend.iter().map(item).collect();
    format!("<ul class=\"legend\">\n{items}</ul>\n")
}

// Runs without a result, by how they ended.

/// Most runs that are named.
const NAMED: usize = 20;

/// Stands for the reason where there is none.
const NO_WORD: &str = "no word of why";

/// Most characters of a reason.
const SHOWN: usize = 200;

/// A section of exit codes, the most frequent first, each with its runs and their reasons; empty where every run is
/// done.
fn failures(runs: &[IndexedRun<'_>]) -> String {
    let mut groups: BTreeMap<i32, Vec<&IndexedRun<'_>>> = BTreeMap::new();
    for run in runs.iter().filter(|run| !run.is_done()) {
        groups.entry(run.exit_code).or_default().push(run);
    }
    if groups.is_empty() {
        return String::new();
    }
    let mut groups: Vec<_> = groups.into_iter().collect();
    groups.sort_by_key(|(_, runs)| std::cmp::Reverse(runs.len()));
    let mut out = "<section id=\"failures\">\n<h2>Without a result</h2>\n".to_owned();
    for (code, runs) in groups {
        out.push_str(&format!("<details><summary>{} × {}</summary><ul>\n", runs.len(), status(code)));
        for run in runs.iter().take(NAMED) {
            let reason = html(&shortened(&sentence(run.reason()), SHOWN));
            out.push_str(&format!("<li>{}: {reason}</li>\n", run.linked()));
        }
        if runs.len() > NAMED {
            out.push_str(&format!("<li>and {} more</li>\n", runs.len() - NAMED));
        }
        out.push_str("</ul></details>\n");
    }
    out.push_str("</section>\n");
    out
}

/// The first line of a text, of at most so many characters, cut between words.
fn shortened(text: &str, most: usize) -> String {
    let text = text.lines().next().unwrap_or_default();
    let Some((end, _)) = text.char_indices().nth(most) else { return text.to_owned() };
    let cut = &text[..end];
    // A word longer than half of the room is cut itself.
    let cut = cut.rsplit_once(' ').map(|(before, _)| before).filter(|before| before.len() > end / 2).unwrap_or(cut);
    format!("{}…", cut.trim_end_matches([',', ';', ':', ' ', '(']))
}

// A run as an index knows it.

/// One run of an index.
#[derive(Debug, Clone)]
pub struct IndexedRun<'a> {
    /// What it is called.
    pub name: String,
    /// Pipeline and settings, where they tell runs apart; else empty.
    pub variant: String,
    /// Path of its report from the folder of the page; `None`: there is none.
    pub report: Option<String>,
    /// Exit code of the run; 4 is a result that is not acceptable.
    pub exit_code: i32,
    /// Why, where the code is not 0; empty: nobody has said it.
    pub reason: String,
    /// What it found, where it has a result.
    pub summary: Option<&'a Summary>,
    /// Its pulse as a small line, HTML; empty: none.
    pub pulse: String,
}

impl IndexedRun<'_> {
    /// Exit code and reason of a run folder, by its summary alone.
    pub fn ending(summary: &Summary) -> (i32, String) {
        let verdict = &summary.verdict;
        match (verdict.standing, &verdict.reason) {
            (ResultStatus::NoResult, reason) => (4, reason.clone().unwrap_or_default()),
            _ => (0, String::new()),
        }
    }

    fn reason(&self) -> &str {
        if self.reason.is_empty() { NO_WORD } else { &self.reason }
    }

    /// Its first warning, or why it has no result.
    fn first_warning(&self) -> String {
        match self.summary.and_then(|summary| summary.concerns.first()) {
            _ if !self.is_done() => sentence(self.reason().lines().next().unwrap_or_default()).into_owned(),
            concern => concern.map_or_else(String::new, |concern| sentence(&concern.with_code()).into_owned()),
        }
    }

    /// Its name, HTML: a link to its report where there is one.
    pub(crate) fn linked(&self) -> String {
        match &self.report {
            Some(report) => format!("<a href=\"{}\">{}</a>", address(report), html(&self.name)),
            None => html(&self.name),
        }
    }

    /// Whether its results may be used; `None`: it has none, or an early version did not say it.
    fn status(&self) -> Option<Status> {
        self.summary.filter(|_| self.is_done()).and_then(|summary| summary.verdict.status)
    }

    /// Whether there is what was asked for.
    pub(crate) fn is_done(&self) -> bool {
        self.exit_code == 0
    }
}

/// An exit code in words.
pub fn status(exit_code: i32) -> &'static str {
    match exit_code {
        0 => "done",
        2 => "usage",
        3 => "refused",
        4 => "no acceptable result",
        _ => "failed",
    }
}

// The pulse of a run as a small line.

/// Time that is shown after time zero: the same for all runs, so that lines compare.
pub const SHOWN_S: f64 = 0.15;

/// An acceleration over the first 150 ms after contact, upwards as the vehicle slows down, each run to its own peak;
/// empty where there is nothing to draw.
pub fn pulse_line(acceleration: &Sampled) -> String {
    let samples = acceleration.samples().iter().enumerate();
    let points: Vec<[f64; 2]> = samples.map(|(k, a)| [acceleration.time_s(k), -a]).collect();
    sparkline(&points, [0.0, SHOWN_S]).unwrap_or_default()
}

// One row a run. The script makes buttons of the heads of its columns, which sort.

/// Columns of numbers.
const NUMBERS: [RunNumber; 9] = [SPEED, MASS, CRUSH, TIME_OF_CRUSH, DELTA_V, PEAK, OLC, RESTITUTION, STIFFNESS];

/// Numbers that a line of a terminal has room for.
const IN_TERMINAL: [RunNumber; 4] = [SPEED, CRUSH, DELTA_V, PEAK];

/// Fewest characters of a column of numbers in a terminal.
const NARROWEST: usize = 6;

/// Most characters of a name in a terminal.
const LONGEST_NAME: usize = 28;

/// Digits of a number: hundreds of rows are compared, none is taken from here.
const DIGITS: usize = 3;

/// Most characters of the name of a vehicle: the report has all.
const OF_VEHICLE: usize = 60;

/// The class of a status, which has its colour.
fn class_of(status: Status) -> &'static str {
    match status {
        Status::Usable => "good",
        Status::UsableWithCare => "care",
        Status::DoNotUse => "bad",
    }
}

/// The table. End tags that HTML does not ask for are left out: there are hundreds of rows.
fn table(runs: &[IndexedRun<'_>]) -> String {
    let several = runs.iter().any(|run| !run.variant.is_empty());
    let mut out = "<div class=\"scroll\" role=\"region\" aria-label=\"Runs\" tabindex=\"0\">\n\
                   <table class=\"index\">\n<thead><tr><th scope=col>Run<th scope=col>Status<th scope=col>Vehicle or \
                   test"
        .to_owned();
    for quantity in NUMBERS {
        let _ = write!(out, "<th scope=col abbr=\"{}\">{}", quantity.name, quantity.head());
    }
    out.push_str(
        "<th scope=col>Recommended<th scope=col>Numbers of it<th scope=col data-fixed>Pulse\
         <th scope=col>First warning",
    );
    if several {
        out.push_str("<th scope=col>Pipeline");
    }
    out.push_str("</thead>\n<tbody>\n");
    runs.iter().for_each(|run| row(&mut out, run, several));
    out.push_str("</tbody></table>\n</div>\n");
    out
}

fn row(out: &mut String, run: &IndexedRun<'_>, several: bool) {
    let summary = run.summary;
    let test = summary.map(|summary| &summary.test);
    let vehicle = test.map(|test| test.vehicle.as_ref().filter(|name| !name.trim().is_empty()).unwrap_or(&test.title));
    // Writing to a string does not fail.
    let reason = summary.filter(|_| run.is_done()).map_or("", |summary| &summary.verdict.status_sentence);
    let _ = write!(out, "<tr><th>{}", run.linked());
    let _ = match summary.filter(|_| run.is_done()) {
        Some(summary) => {
            let answers = summary.verdict.answers().map(|(label, text)| format!("{label}: {text}"));
            let title = Vec::from_iter(std::iter::once(sentence(reason).into_owned()).chain(answers)).join("; ");
            let (class, word) = run.status().map_or(("none", ""), |status| (class_of(status), status.word()));
            write!(out, "<td class={class} title=\"{}\">{word}", html(&title))
        }
        None if run.is_done() => write!(out, "<td>"),
        None => write!(out, "<td><b>{}</b>", status(run.exit_code)),
    };
    let _ = write!(out, "<td>{}", html(&shortened(vehicle.map_or("", |v| v), OF_VEHICLE)));
    for quantity in NUMBERS {
        let value = summary.and_then(|summary| quantity.value(summary));
        let _ = write!(out, "<td>{}", value.map_or_else(String::new, |value| words::significant(value, DIGITS)));
    }
    let certainty = summary.and_then(|summary| summary.verdict.certainty()).unwrap_or_default();
    let _ = match summary.filter(|_| run.is_done()) {
        Some(summary) => {
            let model = summary.usable().map(|candidate| model_name(&candidate.model, &candidate.parameters));
            let model = model.map_or_else(|| "none".to_owned(), |model| capitalised(&model));
            write!(out, "<td>{}", html(&model))
        }
        None if run.is_done() => write!(out, "<td>none"),
        None => write!(out, "<td>"),
    };
    let warning = &run.first_warning();
    let _ = write!(out, "<td>{certainty}<td>{}<td>{}", run.pulse, html(warning));
    if several {
        let _ = write!(out, "<td>{}", html(&run.variant));
    }
    out.push('\n');
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn the_script_cannot_end_its_element() {
        assert!(!SORT.contains("</script") && !SORT.contains("<!--") && SORT.len() < 2_000);
    }

    #[test]
    fn a_long_text_is_cut_between_words() {
        assert_eq!(shortened("the pulse is short", 18), "the pulse is short");
        assert_eq!(shortened("the pulse is, short", 14), "the pulse is…");
        assert_eq!(shortened(&"ä".repeat(30), 10), format!("{}…", "ä".repeat(10)));
    }

    #[test]
    fn a_pulse_is_drawn_upwards_from_contact() {
        let samples: Vec<f64> = (0..400).map(|k| if (100..200).contains(&k) { -50.0 } else { 0.0 }).collect();
        // Contact, 100 ms after the first sample, is at the left edge.
        let acceleration = Sampled::new(-0.1, 1e-3, samples).unwrap();
        let line = pulse_line(&acceleration);
        assert!(line.contains("d=\"M0 1l") && line.contains(" 18"), "{line}");
        assert_eq!(pulse_line(&acceleration.starting_at(-1.0).unwrap()), "");
    }
}
