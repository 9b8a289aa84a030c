//! Why plain files are no artifact.

use crumple_artifact::{ReadError, WriteError};

/// Why plain files are no artifact.
#[derive(Debug, thiserror::Error)]
pub enum PlainError {
    /// A line does not parse.
    #[error("{file}, line {line}: {problem}")]
    Line {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// A waveform does not make sense.
    #[error("wave {id:?}: {problem}")]
    Wave {
        /// Its id.
        id: String,
        /// What is wrong.
        problem: String,
    },
    /// A record is not what its schema says.
    #[error(transparent)]
    Record(#[from] WriteError),
    /// A waveform typed as a record is not one.
    #[error(transparent)]
    Read(#[from] ReadError),
}
