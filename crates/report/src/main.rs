//! `crumple-report`: writes the report and the summary of a run.

mod stage;

fn main() -> std::process::ExitCode {
    crumple_stage::tool_main(stage::run)
}
