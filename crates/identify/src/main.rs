//! `crumple-identify`: linear models from a crash pulse.

mod stage;

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_stage::main::<stage::Identify>()
}
