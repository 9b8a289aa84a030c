//! `crumple-integrate`: velocity, displacement, crash events and metrics of the pulse.

mod stage;

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_stage::main::<stage::Integrate>()
}
