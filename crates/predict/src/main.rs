//! `crumple-predict`: the candidates of a test at other speeds and masses.

mod stage;

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_stage::main::<stage::Predict>()
}
