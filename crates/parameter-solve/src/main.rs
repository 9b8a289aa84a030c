//! `crumple-parameter-solve`: finds springs and dampers of lumped models from the events and motion of a test.

use std::process::ExitCode;

/// Every evaluation of a model takes and returns some hundred kilobytes, which the system's allocator gives back to the
/// system each time: a quarter of a run went into page faults.
#[cfg(not(target_family = "wasm"))]
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<mimalloc::MiMalloc> = crumple_memory::Budgeted(mimalloc::MiMalloc);

fn main() -> ExitCode {
    crumple_parameter_solve::PROGRAM.main()
}
