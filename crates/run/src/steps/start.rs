//! Starting a stage.

use std::env;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::process::{Command, ExitStatus};

use anyhow::Context;

use crate::command::program::Program;
use crate::command::stages::{RECORD, Stage};
use crate::folder::lock::LockedFolder;

/// Settings of the allocator of glibc: the heap grows by 8 MiB at a time, in pages of 2 MiB where the system has them.
/// A page of 4 KiB is taken from the system at its first use, and a stage that writes a megabyte used some thousand.
const ALLOCATOR: (&str, &str) = ("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1:glibc.malloc.top_pad=8388608");

/// Runs the program of a stage: flags of its own, these arguments, flags of every stage.
pub(crate) fn start(program: &Program, arguments: &[OsString], flags: &[String]) -> anyhow::Result<ExitStatus> {
    let own = program.flags.iter().map(OsString::from);
    let words: Vec<OsString> = own.chain(arguments.iter().cloned()).chain(flags.iter().map(OsString::from)).collect();
    run_program(&program.file, &words)
}

/// Runs a program.
pub(crate) fn run_program(file: &Path, arguments: &[OsString]) -> anyhow::Result<ExitStatus> {
    let mut process = Command::new(file);
    if env::var_os(ALLOCATOR.0).is_none() {
        process.env(ALLOCATOR.0, ALLOCATOR.1);
    }
    process.args(arguments).status().with_context(|| format!("cannot start {}", file.display()))
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
        if *input == RECORD {
            arguments.extend_from_slice(record);
        } else {
            arguments.push(folder.path().join(input).into());
        }
    }
    arguments.extend(["--pipeline".into(), pipeline.to_owned(), "-o".into(), output]);
    arguments
}
