//! `crumple-parameter-solve`: finds springs and dampers of lumped models from the events and motion of a test.

mod adoption;
mod chain_table;
mod chains;
mod exponents;
mod judging;
mod judging_settings;
mod measured;
mod models;
mod options;
mod pairs;
mod sensor_waves;
mod stage;
mod stage_settings;
mod verdict;

use std::process::ExitCode;

/// Every evaluation of a model takes and returns some hundred kilobytes, which the system's allocator gives back to the system each
/// time: a quarter of a run went into page faults.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    crumple_stage::main::<stage::ParameterSolve>()
}
