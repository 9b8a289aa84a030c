//! `crumple-artifact`: looks into artifacts, checks them, takes them apart and puts them together.

mod stage;

fn main() -> std::process::ExitCode {
    stage::main()
}
