//! Reads a crash record as users have it and writes it in SI units.

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_stage::main::<crumple_ingest::Ingest>()
}
