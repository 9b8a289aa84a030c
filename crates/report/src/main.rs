//! `crumple-report`: writes the report and the summary of a run.

mod stage;

/// Keeps the budget of memory, `--memory-limit`.
#[global_allocator]
static ALLOCATOR: crumple_memory::Budgeted<std::alloc::System> = crumple_memory::Budgeted(std::alloc::System);

fn main() -> std::process::ExitCode {
    crumple_stage::tool_main(stage::run)
}
