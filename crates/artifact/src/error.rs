//! Why an artifact cannot be read or written.

use std::path::PathBuf;

/// A record that is well-formed but does not make sense.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ConversionError(pub String);

/// Why an artifact cannot be read. Every message names the file.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system refused.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What it said.
        source: std::io::Error,
    },
    /// Not an MCAP file at all.
    #[error("{}: not an artifact: it does not start with the MCAP magic bytes", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// The file ends inside a record.
    #[error("{}: truncated: the file ends at byte {at}, before the end of {record}", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Length of the file.
        at: u64,
        /// The last record that was begun.
        record: String,
    },
    /// A checksum does not match, or a record cannot be parsed.
    #[error("{}: corrupted: {record}: {problem}", path.display())]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// Which record, and where.
        record: String,
        /// What is wrong with it.
        problem: String,
    },
    /// An MCAP file of somebody else.
    #[error("{}: an MCAP file, but not of this kind: none of its {channels} channels has a schema named \
        crumple.*{example}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// How many channels it has.
        channels: usize,
        /// `, e.g. topic ...`
        example: String,
    },
    /// Written by a later version.
    #[error("{}: {what} is {found}, this version reads up to {known}", path.display())]
    Newer {
        /// The file.
        path: PathBuf,
        /// Topic or metadata record.
        what: String,
        /// Version found.
        found: String,
        /// Version known.
        known: String,
    },
    /// A topic holds something else than what is asked for.
    #[error("{}: topic {topic} holds {found}, {needed} is needed", path.display())]
    WrongType {
        /// The file.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// Schema found.
        found: String,
        /// Schema needed.
        needed: String,
    },
    /// A message does not decode, or decodes to nonsense.
    #[error("{}: topic {topic}: {problem}", path.display())]
    Message {
        /// The file.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// What is wrong.
        problem: String,
    },
}

impl ReadError {
    /// One thing to do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Io { .. } => "check the path and its permissions",
            Self::NotMcap { .. } => {
                "give an artifact written by a crumple stage; a raw record goes through ingest first"
            }
            Self::Truncated { .. } | Self::Corrupt { .. } => "run the stage that wrote it again with --force",
            Self::Foreign { .. } => "give an artifact of a crumple stage; docs/format.md says what one must hold",
            Self::Newer { .. } => "update crumple, or write the file again with this version",
            Self::WrongType { .. } | Self::Message { .. } => {
                "compare the program that wrote it with docs/format.md; `crumple check FILE` lists its faults"
            }
        }
    }
}

/// Why an artifact cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system refused.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The target.
        path: PathBuf,
        /// What it said.
        source: std::io::Error,
    },
    /// The container refused.
    #[error("cannot write {}: {source}", path.display())]
    Container {
        /// The target.
        path: PathBuf,
        /// What it said.
        source: mcap::McapError,
    },
    /// A number is NaN, infinite, or beyond what a crash can have.
    #[error("record {topic}: {field} is {value}, {}", crate::finite::needed(*value))]
    Impossible {
        /// The topic.
        topic: String,
        /// Path of the field inside the record.
        field: String,
        /// The number.
        value: f64,
    },
    /// Two records under one topic.
    #[error("topic {0} is written twice")]
    Duplicate(String),
    /// The record does not serialise.
    #[error("record {topic}: {problem}")]
    Encode {
        /// The topic.
        topic: String,
        /// What is wrong.
        problem: String,
    },
}
