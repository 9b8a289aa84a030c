//! Starting a stage.

use std::ffi::{OsStr, OsString};
use std::io;
use std::process::{Command, ExitStatus};

use anyhow::Context;

use crate::command::stages::{RECORD, Stage};
use crate::folder::lock::LockedFolder;

/// Runs a shell command with arguments behind it, and more flags as one would type them.
pub(crate) fn run_in_shell(command: &str, arguments: &[OsString], flags: &str) -> anyhow::Result<ExitStatus> {
    // A shell that has nothing else to do becomes the program: no process is between.
    let line = format!("{command} \"$@\" {flags}");
    let start = || -> io::Result<ExitStatus> {
        Command::new("sh").args(["-c", line.trim_end(), "crumple-run"]).args(arguments).status()
    };
    start().with_context(|| format!("cannot start a shell for {command}"))
}

/// The arguments of a stage: its inputs, the pipeline file, its output.
pub(crate) fn arguments(
    stage: &Stage,
    folder: &LockedFolder,
    record: &[OsString],
    pipeline: &OsStr,
    output: OsString,
) -> Vec<OsString> {
    let mut arguments = Vec::new();
    for input in &stage.inputs {
        if input == RECORD {
            arguments.extend_from_slice(record);
        } else {
            arguments.push(folder.path().join(input).into());
        }
    }
    arguments.extend(["--pipeline".into(), pipeline.to_owned(), "-o".into(), output]);
    arguments
}
