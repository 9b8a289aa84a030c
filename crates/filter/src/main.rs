//! `crumple-filter`: brings the acceleration channels of a test to a channel frequency class.

use std::process::ExitCode;

/// Keeps the budget of memory, `--memory-limit`.
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> ExitCode {
    crumple_filter::PROGRAM.main()
}
