//! What is said to people beside what the stages say themselves.

use std::ffi::OsString;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use crumple_artifact::Artifact;
use crumple_artifact::records::TestV1;
use crumple_stage::{ExitStatus, Pipeline, by_way, chain, say};

use crate::folder::content::is_artifact;
use crate::program::Program;
use crate::steps::{Unforeseen, signal_name};

// Which options differ from those of the run before.

/// Says of each option that differs what it is and what it was.
pub(crate) fn say_what_changed(now: &Pipeline, before: &Pipeline) {
    for (name, old, new) in now.changes_since(before) {
        let is = |value: Option<String>| value.unwrap_or_else(|| "not given".to_owned());
        say(format_args!("{:<16} {name} is {}, was {} in the run before", "run", is(new), is(old)));
    }
}

// Which record a run folder held before.

/// Says which record's run is replaced, if it is another one than that of the artifact now at `path`.
pub(crate) fn say_what_is_replaced(before: File, path: &Path, folder: &Path) {
    let old = Artifact::read(path, BufReader::new(before)).ok().as_ref().and_then(record_of);
    let new = Artifact::open(path).ok().as_ref().and_then(record_of);
    if let Some(old) = old.filter(|old| new.as_ref() != Some(old)) {
        say(format_args!(
            "note: replaces the run of {old} in {}: another record, or this one before a change \
             ({} keeps both)",
            folder.display(),
            by_way("just out=DIR run", "crumple run --out DIR")
        ));
    }
}

/// `crash.csv (csv, content 0123456789ab)`; `None` where an artifact does not say what it was made from.
fn record_of(artifact: &Artifact) -> Option<String> {
    let source = artifact.record::<TestV1>("/test").ok()??.source;
    let digest = source.digest.rsplit(':').next().unwrap_or_default();
    let start = digest.get(..12)?;
    Some(format!("{} ({}, content {start})", source.name, source.format))
}

// What is said of a stage that failed.

/// Names a program from elsewhere that ended with 1, 2 or 3: it may have said why, or nothing at all.
pub(crate) fn say_which_stage_failed(stage: &str, program: &Program, failure: ExitStatus) {
    let (code, meaning) = match failure {
        ExitStatus::Usage => (2, "usage"),
        ExitStatus::Refused => (3, "input refused"),
        _ => (1, "failure"),
    };
    say(format_args!("note: the stage {stage} ended with exit code {code} ({meaning}): {}", program.typed));
}

/// Says which stage, of this name and these outputs, broke the contract, by which command, what happened, what to do.
/// `inputs` is where its inputs are, if it reads any from the run folder.
pub(crate) fn say_what_failed(
    (name, outputs): (&str, &[&str]),
    program: &Program,
    failure: Unforeseen,
    inputs: Option<&Path>,
) {
    let output = |number: usize| outputs.get(number).copied().unwrap_or_default();
    let happened = match failure {
        Unforeseen::Code(127) => "ended with exit code 127: a program was not found".to_owned(),
        Unforeseen::Code(126) => "ended with exit code 126: a program could not be started".to_owned(),
        Unforeseen::Code(code) => format!("ended with exit code {code}, which has no meaning for a stage"),
        Unforeseen::Signal(9) => "was ended by signal 9 (SIGKILL), as the system does when memory runs out".to_owned(),
        Unforeseen::Signal(signal) => match signal_name(signal) {
            Some(name) => format!("was ended by signal {signal} ({name})"),
            None => format!("was ended by signal {signal}"),
        },
        Unforeseen::NothingWritten(0) => "says it is done, and has written nothing".to_owned(),
        Unforeseen::NothingWritten(number) => format!("says it is done, and has not written {}", output(number)),
        Unforeseen::NoArtifact(_) => "says it is done, and has written no artifact (no MCAP file)".to_owned(),
    };
    say(format_args!("error: the stage {name} {happened}"));
    say(format_args!("  command: {}", program.typed));
    match failure {
        Unforeseen::Code(_) | Unforeseen::Signal(_) => {
            say(
                "  expected: exit code 0 (done), 1 (failure), 2 (usage), 3 (input refused) or 4 (no acceptable result)",
            );
        }
        Unforeseen::NothingWritten(number) | Unforeseen::NoArtifact(number) => say(match (number, output(number)) {
            (0, name) if is_artifact(name) => format!("  expected: an artifact, {name}, at the path behind -o"),
            (0, name) => format!("  expected: {name} at the path behind -o"),
            (_, name) => format!("  expected: {name} beside {}, the path behind -o", output(0)),
        }),
    }
    let inputs = inputs.map_or_else(String::new, |inputs| format!(", its inputs are in {}", inputs.display()));
    say(format_args!("  hint: run the command by itself{inputs}; what a stage must do: docs/write-a-stage.md"));
}

// Whose a flag is that the first stage does not know.

/// Flags behind the record go to the first stage: says of each that is an option of another stage in this pipeline, and
/// of options of other stages in general, how they are set.
pub(crate) fn suggest_stage_of_flag(flags: &[OsString], pipeline: &Pipeline) {
    let mut is_told = flags.is_empty();
    for flag in flags {
        let flag = flag.to_string_lossy();
        let Some(option) = flag.strip_prefix("--").and_then(|flag| flag.split('=').next()) else { continue };
        let has = |stage: &str| pipeline.table(stage).is_some_and(|t| t.contains_key(&option.replace('-', "_")));
        for stage in chain().skip(1).filter(|stage| has(stage.name)) {
            is_told = true;
            say(format_args!("tip: --{option} is an option of {0}: --set {0}.{option}=VALUE", stage.name));
        }
    }
    if !is_told {
        say("tip: flags behind the record go to ingest; for options of other stages: --set STAGE.OPTION=VALUE");
    }
}
