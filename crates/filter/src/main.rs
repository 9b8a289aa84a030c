//! `crumple-filter`: brings the acceleration channels of a test to a channel frequency class.

mod stage;

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_stage::main::<stage::Filter>()
}
