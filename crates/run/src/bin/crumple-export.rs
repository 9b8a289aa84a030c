//! `crumple-export`: what a fleet says of its vehicles, see the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_run::EXPORT.main()
}
