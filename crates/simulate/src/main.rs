//! `crumple-simulate`: the response of every candidate model beside the test.

mod stage;

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_stage::main::<stage::Simulate>()
}
