//! Reads a crash record as users have it and writes it in SI units; with `--list`, prints its channels.

mod stage;

use std::process::ExitCode;

fn main() -> ExitCode {
    stage::main()
}
