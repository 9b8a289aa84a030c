//! The program: the stage `ingest`, the listing of channels, how progress and refusals are shown.

mod ingest;
mod list;
mod process;

use std::process::ExitCode;

/// Lists the channels if `--list` is given, else runs the stage: a listing writes no artifact and has no life of a
/// stage.
pub(crate) fn main() -> ExitCode {
    if std::env::args_os().skip(1).any(|argument| argument == "--list") {
        return crumple_stage::tool_main::<list::Cli>(list::run);
    }
    crumple_stage::main::<ingest::Ingest>()
}
