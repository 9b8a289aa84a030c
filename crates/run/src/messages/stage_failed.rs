//! What is said of a stage that failed.

use std::path::Path;

use crumple_stage::{ExitStatus, say};

use crate::command::program::Program;
use crate::folder::content::is_artifact;
use crate::steps::ending::{Unforeseen, signal_name};

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
