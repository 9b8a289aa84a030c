//! `crumple-integrate`: velocity, displacement, crash events and metrics of the pulse.

mod body;
mod contact;
mod further;
mod injury;
mod load_cells;
mod motionless;
mod options;
mod recorded;
mod redundant;
mod stage;
mod to_records;
mod uncertain;

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_stage::main::<stage::Integrate>()
}
