//! What the codes of remarks mean, in general and in a run.

use std::path::{Path, PathBuf};

use crumple_artifact::records::{RemarkV1, ValueV1};
use crumple_signal::display::sentence;
use crumple_signal::{Display, Kind, Weight};
use crumple_stage::joints::invariants;
use crumple_stage::{ExitStatus, columns, kinds, printable, refuse_unknown_code, to_stdout, wrapped};

/// What finds the remarks of the folder of a run.
type OfARun<'a> = &'a dyn Fn(&Path) -> anyhow::Result<Vec<RemarkV1>>;

/// Prints what a code means: found, decided how, what it means, what to do; with a run what it found there. A run alone
/// prints all that it holds.
pub(crate) fn explain(
    words: &[PathBuf],
    markdown: bool,
    display: Display,
    remarks_of_a_run: OfARun<'_>,
) -> anyhow::Result<ExitStatus> {
    let (code, run) = match words {
        [only] if only.is_dir() => (None, Some(only)),
        [only] => (Some(only), None),
        [run, code, ..] => (Some(code), Some(run)),
        [] => (None, None),
    };
    let code = code.map(|code| code.to_string_lossy());
    let known = kinds();
    if let Some(code) = &code {
        refuse_unknown_code(code)?;
    }
    let asked =
        code.as_deref().and_then(|code| known.iter().find(|kind| kind.code.eq_ignore_ascii_case(code)).copied());
    if markdown {
        let all: String =
            known.iter().filter(|kind| asked.is_none_or(|asked| asked == **kind)).map(as_markdown).collect();
        to_stdout(printable(&all).as_bytes())?;
        return Ok(ExitStatus::Done);
    }
    let here = run.map_or(Ok(Vec::new()), |run| remarks_of_a_run(run))?;
    let is_asked = |kind: &&&Kind| match asked {
        Some(asked) => asked == **kind,
        None => here.iter().any(|found| found.code == kind.code),
    };
    // The strongest first, as the run has them.
    let strength = |kind: &&&Kind| here.iter().position(|found| found.code == kind.code);
    let mut asked_for: Vec<&&Kind> = known.iter().filter(is_asked).collect();
    asked_for.sort_by_key(strength);
    let mut paragraphs = Vec::new();
    for kind in asked_for {
        let [_, decided, means, remedy] = kind.explanation;
        paragraphs.push(format!("{}, {}: {}", kind.code, weight_of(kind), kind.found()));
        let of_kind: Vec<&RemarkV1> = here.iter().filter(|found| found.code == kind.code).collect();
        paragraphs.extend(of_kind.iter().map(|found| in_this_run(found, display)));
        if let Some(run) = run.filter(|_| of_kind.is_empty()) {
            paragraphs.push(format!("Here: nothing of that in {}.", run.display()));
        }
        paragraphs.push(format!("How it is decided. {decided}"));
        paragraphs.push(format!("What it means. {means}"));
        paragraphs.push(format!("What to do: {remedy}."));
    }
    if let Some(run) = run.filter(|_| paragraphs.is_empty()) {
        paragraphs.push(format!("No stage remarks anything on {}.", run.display()));
    }
    let lines: Vec<String> = paragraphs.iter().map(|text| wrapped(text, columns()).join("\n") + "\n").collect();
    to_stdout(printable(&lines.join("\n")).as_bytes())?;
    Ok(ExitStatus::Done)
}

/// The sentence that a run has of a kind, with what it was made from.
///
/// The sentence is in the units of the reader; values are SI, with the unit in their name.
fn in_this_run(found: &RemarkV1, display: Display) -> String {
    let of_value = |(name, value): (&String, &ValueV1)| match value {
        ValueV1::Number(number) => format!("{name} {number}"),
        ValueV1::Text(text) => format!("{name} {text}"),
    };
    let values: Vec<String> = found.values.iter().map(of_value).collect();
    let values = if values.is_empty() { String::new() } else { format!(" Values: {}.", values.join(", ")) };
    let text = display.during(|| sentence(found.text.trim_end_matches('.')).into_owned());
    format!("Here, {}: {text}.{values}", found.stage)
}

/// How much a kind changes, in words.
fn weight_of(kind: &Kind) -> &'static str {
    match kind.weight {
        _ if invariants().any(|row| row.ends_the_run && row.kind.code == kind.code) => "refused, exit code 3",
        Weight::None => "good to know",
        Weight::Slight => "a warning, weight 1",
        Weight::Marked => "a warning, weight 2",
        Weight::Decisive => "a warning, weight 3",
    }
}

/// A section of docs/remarks.md.
fn as_markdown(kind: &&Kind) -> String {
    let [_, decided, means, remedy] = kind.explanation;
    let paragraphs = [
        format!("{} *{}*", kind.found(), weight_of(kind)),
        format!("Decided: {decided}"),
        format!("Means: {means}"),
        format!("Do: {remedy}."),
    ];
    format!("## {}\n{}\n\n", kind.code, paragraphs.map(|text| wrapped(&text, 120).join("\n")).join("\n\n"))
}
