//! The command line that all stages have in common.

use std::path::PathBuf;

use crumple_artifact::Compression;

/// Flags of every stage.
#[derive(Debug, Clone, clap::Args)]
pub struct SharedFlags {
    /// Input files: artifacts of earlier stages in any order (for ingest: the record as you have it).
    #[arg(required = true, value_name = "INPUT")]
    pub inputs: Vec<PathBuf>,

    /// Artifact to write (an MCAP file).
    #[arg(short, long, value_name = "OUTPUT")]
    pub output: PathBuf,

    /// Pipeline file; the stage takes its options from its own table, flags override them.
    #[arg(short, long, value_name = "FILE")]
    pub pipeline: Option<PathBuf>,

    /// File made from the output: removed right before a new output appears, so that it never stands beside one it was
    /// not made from; kept where the output is up to date or the stage fails. Several: in the order of removal.
    #[arg(long = "dependent", value_name = "FILE")]
    pub dependents: Vec<PathBuf>,

    /// Compute even if the output is up to date.
    #[arg(long)]
    pub force: bool,

    /// Print the records of the result to stdout, one JSON object a line.
    #[arg(long)]
    pub json: bool,

    /// Check the options and end: nothing is read, nothing is written.
    #[arg(long, hide = true)]
    pub check_options: bool,

    /// No summary and no progress.
    #[arg(short, long)]
    pub quiet: bool,

    /// No summary, but progress: crumple-run asks for it, whose last stage sums the run up.
    #[arg(long, hide = true)]
    pub no_summary: bool,

    /// Compression of the artifact; the content and its digest stay the same.
    #[arg(long, value_enum, default_value_t = Compress::None)]
    pub compress: Compress,
}

/// Compression of an artifact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Compress {
    /// Fastest; filtered signals hardly compress.
    None,
    /// Zstandard; halves raw recorder data and more.
    Zstd,
}

impl From<Compress> for Compression {
    fn from(compress: Compress) -> Self {
        match compress {
            Compress::None => Self::None,
            Compress::Zstd => Self::Zstd,
        }
    }
}

/// The whole command line of a stage.
#[derive(Debug, clap::Parser)]
pub(crate) struct Cli<O: clap::Args> {
    #[command(flatten)]
    pub(crate) common: SharedFlags,

    #[command(flatten, next_help_heading = "Stage options (also keys of the stage's pipeline table)")]
    pub(crate) options: O,
}
