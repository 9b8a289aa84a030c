//! Reads a crash record as users have it and writes it in SI units; with `--list`, prints its channels.

use std::process::ExitCode;

/// Keeps the budget of memory, `--memory-limit`.
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> ExitCode {
    crumple_ingest::PROGRAM.main()
}
