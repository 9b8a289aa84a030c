//! `crumple-fleet`: many records, see the library.

use std::process::ExitCode;

fn main() -> ExitCode {
    crumple_stage::tool_main(crumple_run::fleet::fleet)
}
