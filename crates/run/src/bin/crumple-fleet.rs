//! `crumple-fleet`: many records, see the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_run::FLEET.main()
}
