//! `crumple-diff`: whether two results are the same, and where they part.

/// Keeps the budget of memory, `--memory-limit`.
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> std::process::ExitCode {
    crumple_report::DIFF.main()
}
