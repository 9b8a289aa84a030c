//! The command line of `crumple-study`.

use std::path::PathBuf;

use crate::command::Options;

/// Runs a fleet, fits one model to the tests of each vehicle, and asks how the models depend on mass, year and class.
///
/// The recipe `study` of the justfile calls it. Tests are of one vehicle where their records name the same one.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-study",
    version,
    after_help = "Exit codes: 0 done, vehicles without a joint model among them; 1 unforeseen failure, 2 usage, \
                  3 no record to be found, 4 too few vehicles for a regression."
)]
pub struct StudyOptions {
    #[command(flatten)]
    pub(crate) fleet: Options,

    /// Classes of vehicles: a CSV file with the columns `vehicle` and `class`.
    #[arg(long, value_name = "FILE")]
    pub(crate) classes: Option<PathBuf>,
}
