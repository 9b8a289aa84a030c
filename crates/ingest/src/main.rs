//! Reads a crash record as users have it and writes it in SI units; with `--list`, prints its channels.

use std::process::ExitCode;

fn main() -> ExitCode {
    // A listing writes no artifact, so it does not go through the life of a stage.
    if std::env::args_os().skip(1).any(|argument| argument == "--list") {
        return crumple_stage::tool_main::<crumple_ingest::ListCli>(crumple_ingest::list_channels);
    }
    crumple_stage::main::<crumple_ingest::Ingest>()
}
