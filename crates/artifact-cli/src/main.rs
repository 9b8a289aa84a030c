//! `crumple-artifact`: looks into artifacts, checks them, takes them apart and puts them together.

/// Keeps the budget of memory, `--memory-limit`.
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> std::process::ExitCode {
    crumple_artifact_cli::PROGRAM.main()
}
