//! Why plain files are no artifact, and why a candidate has no curve.

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

/// Why a candidate has no force-deflection curve.
#[derive(Debug, thiserror::Error)]
pub enum CurveError {
    /// The artifact is of another stage.
    #[error("there are no candidates here")]
    NoCandidates,
    /// The artifact recommends none.
    #[error("no candidate is recommended here; candidates: {candidates}")]
    NoneRecommended {
        /// Those that are there.
        candidates: String,
    },
    /// There is no such candidate.
    #[error("there is no candidate {id:?}; candidates: {candidates}")]
    NoCandidate {
        /// The one asked for.
        id: String,
        /// Those that are there.
        candidates: String,
    },
    /// Its curve has no last point of its own.
    #[error("{id} has stiffnesses without an end")]
    NoEnd {
        /// The candidate.
        id: String,
    },
    /// No force of it is of the deflection alone.
    #[error("{id} ({model}) has no element whose force depends on the deflection alone")]
    NoStaticForce {
        /// The candidate.
        id: String,
        /// Its model.
        model: String,
    },
    /// Its parameters make no model.
    #[error(transparent)]
    Model(#[from] crumple_lumped::LumpedError),
    /// A record cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
}
