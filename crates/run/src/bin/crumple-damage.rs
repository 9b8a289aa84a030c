//! `crumple-damage`: speed from damage, see the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_run::DAMAGE.main()
}
