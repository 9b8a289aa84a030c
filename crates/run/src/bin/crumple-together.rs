//! `crumple-together`: one model for several tests, see the library.

use std::process::ExitCode;

/// Keeps the budget of memory, `--memory-limit`.
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> ExitCode {
    crumple_run::TOGETHER.main()
}
