//! `crumple-parameter-solve`: finds springs and dampers of lumped models from the events and motion of a test.

use std::process::ExitCode;

/// Every evaluation of a model takes and returns some hundred kilobytes, which the system's allocator gives back to the
/// system each time: a quarter of a run went into page faults. It is written in C, which other systems do without.
#[cfg(unix)]
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<mimalloc::MiMalloc> = crumple_memory::Budgeted(mimalloc::MiMalloc);

#[cfg(not(unix))]
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> ExitCode {
    crumple_parameter_solve::PROGRAM.main()
}
