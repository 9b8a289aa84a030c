//! Why two results cannot be compared.

use std::path::PathBuf;

use crumple_artifact::{ReadError, TOLERANCE_HINT};

/// Why two results cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum DiffError {
    /// An artifact is unreadable, damaged or foreign.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The operating system refused.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What it said.
        source: std::io::Error,
    },
    /// A JSON file does not parse.
    #[error("{}: not JSON: {source}", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// What is wrong, with line and column.
        source: serde_json::Error,
    },
    /// A folder is compared with a file, or a JSON file with an artifact.
    #[error("{} is {a_is}, {} is {b_is}: they cannot be compared", a.display(), b.display())]
    Kinds {
        /// First side.
        a: PathBuf,
        /// What it is.
        a_is: &'static str,
        /// Second side.
        b: PathBuf,
        /// What it is.
        b_is: &'static str,
    },
    /// A folder without results.
    #[error("{}: no run folder: no *.mcap and no summary.json in it", path.display())]
    NotARun {
        /// The folder.
        path: PathBuf,
    },
    /// A tolerance file asks for something that does not exist.
    #[error("tolerances: {0}")]
    Tolerance(String),
}

impl DiffError {
    /// One thing to do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Read(error) => error.hint(),
            Self::Io { .. } => "check the path and its permissions",
            Self::Json { .. } => "write the report again with --force",
            Self::Kinds { .. } => "give two artifacts, two summary.json or two run folders",
            Self::NotARun { .. } => "give the folder that holds 1-ingest.mcap ..., e.g. runs/crash/default",
            Self::Tolerance(_) => TOLERANCE_HINT,
        }
    }
}
