//! The error for a stage that ended as no stage may.

use std::path::Path;

use crumple_stage::say;

use crate::command::stages::Stage;
use crate::steps::ending::{Unforeseen, signal_name};

/// Says which stage it is, by which command, what happened and what to do.
pub(crate) fn say_what_failed(stage: &Stage, failure: Unforeseen, inputs: &Path) {
    let name = stage.name();
    let happened = match failure {
        Unforeseen::Code(127) => "ended with exit code 127: a program was not found".to_owned(),
        Unforeseen::Code(126) => "ended with exit code 126: a program could not be started".to_owned(),
        Unforeseen::Code(code) => format!("ended with exit code {code}, which is none of a stage"),
        Unforeseen::Signal(9) => "was ended by signal 9 (SIGKILL), as the system does when memory runs out".to_owned(),
        Unforeseen::Signal(signal) => match signal_name(signal) {
            Some(name) => format!("was ended by signal {signal} ({name})"),
            None => format!("was ended by signal {signal}"),
        },
        Unforeseen::NothingWritten => "says it is done, and has written nothing".to_owned(),
        Unforeseen::NoArtifact => "says it is done, and has written no artifact (no MCAP file)".to_owned(),
    };
    say(format_args!("error: the stage {name} {happened}"));
    say(format_args!("  command: {}", stage.command));
    match failure {
        Unforeseen::Code(_) | Unforeseen::Signal(_) => {
            say(
                "  expected: exit code 0 (done), 1 (failure), 2 (usage), 3 (input refused) or 4 (no acceptable result)",
            );
        }
        Unforeseen::NothingWritten | Unforeseen::NoArtifact => say("  expected: an artifact at the path behind -o"),
    }
    say(format_args!(
        "  hint: run the command by itself, its inputs are in {}; what a stage must do: docs/write-a-stage.md",
        inputs.display()
    ));
}
