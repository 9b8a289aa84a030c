//! `crumple-passport`: what a run was made from and what it made, see the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_run::PASSPORT.main()
}
