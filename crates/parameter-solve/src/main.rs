//! `crumple-parameter-solve`: finds springs and dampers of lumped models from the events and motion of a test.

mod stage;

use std::process::ExitCode;

use crumple_memory::Budgeted;

/// Every evaluation of a model takes and returns some hundred kilobytes, which the system's allocator gives back to the
/// system each time: a quarter of a run went into page faults.
#[global_allocator]
static ALLOCATOR: Budgeted<mimalloc::MiMalloc> = Budgeted(mimalloc::MiMalloc);

fn main() -> ExitCode {
    crumple_stage::main::<stage::ParameterSolve>()
}
