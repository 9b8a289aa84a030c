//! `crumple-integrate`: velocity, displacement, crash events and metrics of the pulse.

use std::process::ExitCode;

/// Keeps the budget of memory, `--memory-limit`.
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> ExitCode {
    crumple_integrate::PROGRAM.main()
}
