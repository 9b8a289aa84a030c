//! What a report says first, as Markdown for a merge request.

use crate::drawing::numbers::{ABSENT, MILLI};
use crate::findings::{HEAD, capitalised, conclusion, distinct_curves, first_warnings, markdown};
use crate::page::conclusion::BEFORE_USE;
use crate::page::header::UNTITLED;
use crate::page::key_numbers::KEY_NUMBERS;
use crate::words;
use crumple_signal::display::unit_shown;
use crumple_stage::by_way;
use serde_json::Value;

use super::compared_run::ComparedRun;
use super::numbers::number_rows;
use super::quantities::engineering;
use super::settings::record_of;
use super::table::to_markdown;

/// Status, conclusion, warnings, key numbers, the recommended model, the candidates, and how to make the run again.
///
/// `pipeline` is the path of the run's own pipeline file, where there is one; `record` that of its record, where it is
/// known: the artifacts hold its name alone.
pub fn first_screen(run: &ComparedRun, pipeline: Option<&str>, record: Option<&str>) -> String {
    let (said, concerns) = conclusion(&run.run, &run.ranking);
    let title = if run.run.test.title.is_empty() { UNTITLED } else { &run.run.test.title };
    let mut text = format!("{HEAD}## {}\n\n", markdown(title));
    text.push_str(&format!("**{}**\n", markdown(&said.status_sentence)));
    for sentence in &said.sentences {
        text.push_str(&format!("{}\n", markdown(sentence)));
    }
    for (label, answer) in said.answers() {
        text.push_str(&format!("{label}: {}\n", markdown(&answer)));
    }
    let (first, others) = first_warnings(&concerns, |_| false, &run.run, &run.ranking);
    if !first.is_empty() || others > 0 {
        text.push_str(&format!("\n### {BEFORE_USE}\n\n"));
        for (number, concern) in first.iter().enumerate() {
            text.push_str(&format!("{}. {}\n", number + 1, markdown(&concern.with_code())));
        }
        if others > 0 {
            text.push_str(&format!("\n{others} more in the report.\n"));
        }
    }
    let one = std::slice::from_ref(run);
    let value = ["value".to_owned()];
    let [numbers, models, _] = number_rows(one, &engineering());
    for (heading, rows) in [(KEY_NUMBERS, numbers), ("Model for predictions", models)] {
        if !rows.is_empty() {
            text.push_str(&format!("\n### {heading}\n\n{}", to_markdown("", &value, &rows)));
        }
    }
    text.push_str(&candidates(run));
    let what_to_name =
        if record.is_some() { "." } else { ": put its path in place of its name, or state it by --record." };
    text.push_str(&format!(
        "{}\nRecord {}{what_to_name}\n",
        command_again(&again(run, pipeline, record)),
        markdown(&record_of(run))
    ));
    text
}

/// The command that makes a run, or a comparison, again.
pub(super) fn command_again(command: &str) -> String {
    format!("\n### Again\n\n```sh\n{command}\n```\n")
}

/// A row a distinct curve.
fn candidates(run: &ComparedRun) -> String {
    let curves = distinct_curves(&run.run, &run.ranking);
    let row = |id: &str, same: usize| {
        let candidate = run.run.candidate(id)?;
        let simulation = candidate.simulation.as_ref();
        let known = candidate.certainties();
        let number = |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or_else(|| ABSENT.to_owned(), text);
        Some(format!(
            "| {}{} | {} | {} | {} | {} |\n",
            markdown(&capitalised(&run.run.name_of(id))),
            if same > 0 { format!(" and {same} with the same curve") } else { String::new() },
            known.words().unwrap_or_else(|| ABSENT.to_owned()),
            number(simulation.and_then(|s| s.dynamic_crush_error_m), &|v| words::signed_cell(MILLI * v, 1, "mm")),
            number(simulation.and_then(|s| s.time_of_dynamic_crush_error_s), &|v| words::signed(MILLI * v, 1)),
            number(candidate.fit_percent(), &|v| words::decimals(v, 2)),
        ))
    };
    let rows: String = curves.iter().filter_map(|curve| row(&curve.id, curve.same_curve.len())).collect();
    if rows.is_empty() {
        return String::new();
    }
    let mm = unit_shown("mm");
    format!("\n### Candidates\n\n| Model | Certainty | ΔC, {mm} | Δtₘ, ms | Fit, % |\n|---|---|---:|---:|---:|\n{rows}")
}

/// The command that makes the run again: its own pipeline file, and what was typed beside it.
fn again(run: &ComparedRun, pipeline: Option<&str>, record: Option<&str>) -> String {
    let pipeline = pipeline.or(run.run.pipeline.as_deref()).map(|name| format!("pipeline={} ", shell_word(name)));
    let ingest = run.run.provenance.iter().find(|record| record.stage == "ingest");
    let settings = ingest.and_then(|record| serde_json::from_str::<Value>(&record.settings).ok());
    let flag = |(key, value): (&String, &Value)| {
        let name = key.replace('_', "-");
        match value {
            Value::String(text) => Some(format!(" --{name} {}", shell_word(text))),
            Value::Number(number) => Some(format!(" --{name} {number}")),
            Value::Bool(true) => Some(format!(" --{name}")),
            Value::Bool(false) => Some(format!(" --{name}=false")),
            _ => None,
        }
    };
    let flags: String = settings
        .as_ref()
        .and_then(Value::as_object)
        .map(|all| all.iter().filter_map(flag).collect())
        .unwrap_or_default();
    let record = shell_word(record.unwrap_or(&run.run.test.source.name));
    match by_way("just", "crumple") {
        "just" => format!("just {}run {record}{flags}", pipeline.unwrap_or_default()),
        program => {
            format!(
                "{program} run {record}{}{flags}",
                pipeline.map_or_else(String::new, |own| format!(" --{}", own.trim_end()))
            )
        }
    }
}

/// A word of a shell's command line.
pub fn shell_word(text: &str) -> String {
    let text = text.replace(['\n', '\r', '`'], " ");
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-,=+@".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}
