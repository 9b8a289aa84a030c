//! `crumple-simulate`: the response of every candidate model beside the test.

use std::process::ExitCode;

/// Keeps the budget of memory, `--memory-limit`.
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> ExitCode {
    crumple_simulate::PROGRAM.main()
}
