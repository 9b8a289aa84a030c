//! Starting a stage.

use std::env;
use std::ffi::{OsStr, OsString};
use std::process::ExitStatus;

use anyhow::Context;
use crumple_stage::shell_command;

use crate::command::stages::{RECORD, Stage};
use crate::folder::lock::LockedFolder;

/// Settings of the allocator of glibc: the heap grows by 8 MiB at a time, in pages of 2 MiB where the system has them.
/// A page of 4 KiB is taken from the system at its first use, and a stage that writes a megabyte used some thousand.
const ALLOCATOR: (&str, &str) = ("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1:glibc.malloc.top_pad=8388608");

/// Runs a shell command with arguments behind it, and more flags as one would type them.
pub(crate) fn run_in_shell(command: &str, arguments: &[OsString], flags: &str) -> anyhow::Result<ExitStatus> {
    let mut process = shell_command(command, arguments, flags);
    if env::var_os(ALLOCATOR.0).is_none() {
        process.env(ALLOCATOR.0, ALLOCATOR.1);
    }
    process.status().with_context(|| format!("cannot start {command}"))
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
