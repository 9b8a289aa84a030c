//! One row a run. The script makes buttons of the heads of its columns, which sort.

use crate::phrases::PHRASES;
use crate::phrases::words;
use std::fmt::Write as _;

use crate::drawing::escape::html;
use crate::findings::names::model_name;

use super::failures::{line_of, shortened};
use super::indexed_run::{IndexedRun, status};
use super::quantities::{CRUSH, DELTA_V, MASS, OLC, PEAK, Quantity, RESTITUTION, SPEED, STIFFNESS, TIME_OF_CRUSH};
use super::run_summary::RunSummary;

/// Columns of numbers.
const NUMBERS: [Quantity; 9] = [SPEED, MASS, CRUSH, TIME_OF_CRUSH, DELTA_V, PEAK, OLC, RESTITUTION, STIFFNESS];
/// Digits of a number: hundreds of rows are compared, none is taken from here.
const DIGITS: usize = 3;
/// Most characters of a warning and of the name of a vehicle: the report has all.
const OF_WARNING: usize = 100;
const OF_VEHICLE: usize = 60;

/// The table. End tags that HTML does not ask for are left out: there are hundreds of rows.
pub(super) fn table(runs: &[IndexedRun<'_>]) -> String {
    let texts = &PHRASES.runs;
    let several = runs.iter().any(|run| !run.variant.is_empty());
    let mut out = format!(
        "<div class=\"scroll\" role=\"region\" aria-label=\"{}\" tabindex=\"0\">\n\
         <table class=\"index\">\n<thead><tr><th scope=col>{}<th scope=col>{}",
        texts.runs, texts.run, texts.vehicle_or_test
    );
    for quantity in NUMBERS {
        let unit = if quantity.unit.is_empty() { String::new() } else { format!(", {}", quantity.unit) };
        let _ = write!(out, "<th scope=col abbr=\"{}\">{}{unit}", quantity.name(), quantity.symbol());
    }
    let _ = write!(
        out,
        "<th scope=col>{}<th scope=col>{}<th scope=col data-fixed>{}<th scope=col>{}",
        texts.recommended, texts.numbers_of_it, texts.pulse, texts.first_warning
    );
    if several {
        let _ = write!(out, "<th scope=col>{}", texts.pipeline_head);
    }
    out.push_str("</thead>\n<tbody>\n");
    runs.iter().for_each(|run| row(&mut out, run, several));
    out.push_str("</tbody></table>\n</div>\n");
    out
}

fn row(out: &mut String, run: &IndexedRun<'_>, several: bool) {
    let texts = &PHRASES.runs;
    let summary = run.summary;
    let test = summary.map(|summary| &summary.test);
    let vehicle = test.map(|test| test.vehicle.as_ref().filter(|name| !name.trim().is_empty()).unwrap_or(&test.title));
    // Writing to a string does not fail.
    let _ = write!(out, "<tr><th>{}<td>{}", run.linked(), html(&shortened(vehicle.map_or("", |v| v), OF_VEHICLE)));
    for quantity in NUMBERS {
        let value = summary.and_then(quantity.of);
        let _ = write!(out, "<td>{}", value.map_or_else(String::new, |value| words::significant(value, DIGITS)));
    }
    let certainty = summary.and_then(RunSummary::certainty).unwrap_or_default();
    let _ = match summary.filter(|_| run.is_done()) {
        Some(summary) => {
            let model = summary.usable_model().map(|id| model_name(id.split('/').next().unwrap_or(id)));
            let word = summary.conclusion.status.map(|status| status.word().to_owned());
            let said: Vec<String> = word.into_iter().chain(model).collect();
            let said = if said.is_empty() { texts.none.to_owned() } else { said.join(": ") };
            write!(out, "<td title=\"{}\">{}", html(&summary.conclusion.status_sentence), html(&said))
        }
        None if run.is_done() => write!(out, "<td>{}", texts.none),
        None => write!(out, "<td><b>{}</b>", status(run.exit_code)),
    };
    let warning = match summary.and_then(|summary| summary.concerns.first()) {
        Some(concern) if run.is_done() => &concern.text,
        _ if run.is_done() => "",
        _ => line_of(&run.error, texts.no_word),
    };
    let _ = write!(out, "<td>{certainty}<td>{}<td>{}", run.pulse, html(&shortened(warning, OF_WARNING)));
    if several {
        let _ = write!(out, "<td>{}", html(&run.variant));
    }
    out.push('\n');
}
