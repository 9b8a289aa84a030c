//! `crumple-report`: writes the report and the summary of a run.

/// Keeps the budget of memory, `--memory-limit`.
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> std::process::ExitCode {
    crumple_report::PROGRAM.main()
}
