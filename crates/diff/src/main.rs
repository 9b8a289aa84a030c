//! `crumple-diff`: whether two results are the same, and where they part.

mod stage;

fn main() -> std::process::ExitCode {
    stage::main()
}
