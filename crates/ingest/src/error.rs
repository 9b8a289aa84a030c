//! Why an input is refused.

use std::fmt;

/// A place in a file: its name, and where known the line and the column.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Place {
    /// File name without folder.
    pub file: String,
    /// Line, counted from 1.
    pub line: Option<usize>,
    /// Column of a table: its number from 1 and its name.
    pub column: Option<String>,
}

impl Place {
    /// Somewhere in a file.
    pub fn file(file: &str) -> Self {
        Self { file: file.to_owned(), line: None, column: None }
    }

    /// A line of a file, counted from 1.
    pub fn line(file: &str, line: usize) -> Self {
        Self { line: Some(line), ..Self::file(file) }
    }

    /// The same place, in a named column.
    pub fn in_column(self, column: impl Into<String>) -> Self {
        Self { column: Some(column.into()), ..self }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        if let Some(column) = &self.column {
            write!(f, ", column {column}")?;
        }
        Ok(())
    }
}

/// The formats that are read, in words.
pub(crate) const WHAT_IS_READ: &str =
    "a table of numbers, NHTSA EV5, ISO-MME, TDMS, TDM with TDX, LVM, MCAP, a ROS 1 bag, or a zip of one of them";

/// Why an input is refused. All of these are the input's, none the program's: exit code 3.
///
/// The message says where and what was found; [`expected`](Self::expected) and [`hint`](Self::hint) the rest.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum IngestError {
    /// The path cannot be opened or has nothing readable in it.
    #[error("{path}: {found}")]
    Path {
        /// As the user typed it.
        path: String,
        /// What is there instead.
        found: String,
        /// What would be read.
        expected: String,
        /// One thing to do.
        hint: String,
    },
    /// The file is in a format that is known and not read.
    #[error("{file} is {what}, which is not read")]
    Foreign {
        /// File name.
        file: String,
        /// The format in words, with its article.
        what: String,
        /// What to export instead.
        instead: String,
    },
    /// The content is not what its format asks for.
    #[error("{place}: {found}")]
    Content {
        /// Where.
        place: Box<Place>,
        /// What was found there.
        found: String,
        /// What was expected.
        expected: String,
        /// One thing to do.
        hint: String,
    },
    /// Something that must be known is stated nowhere.
    #[error("{file} does not state {what}")]
    NotStated {
        /// File name.
        file: String,
        /// What is missing, in words.
        what: String,
        /// What was expected.
        expected: String,
        /// How to state it.
        hint: String,
    },
    /// A key of the sidecar that is not known.
    #[error("{file}: unknown key {key:?}")]
    UnknownKey {
        /// File name.
        file: String,
        /// As written.
        key: String,
        /// What was expected.
        expected: String,
        /// One thing to do.
        hint: String,
    },
    /// The channel asked for cannot be the pulse, or none can be chosen.
    #[error("{file}: {found}")]
    Channel {
        /// File name.
        file: String,
        /// What is wrong with it.
        found: String,
        /// What was expected.
        expected: String,
        /// One thing to do.
        hint: String,
    },
    /// A size limit that guards memory is exceeded.
    #[error("{place}: {found}")]
    TooLarge {
        /// Where.
        place: Place,
        /// What was found.
        found: String,
        /// The limit.
        limit: String,
    },
}

impl IngestError {
    /// What was expected, if there is more to say than the message does.
    pub fn expected(&self) -> Option<&str> {
        match self {
            Self::Path { expected, .. }
            | Self::Content { expected, .. }
            | Self::NotStated { expected, .. }
            | Self::UnknownKey { expected, .. }
            | Self::Channel { expected, .. } => Some(expected).filter(|text| !text.is_empty()).map(String::as_str),
            Self::TooLarge { limit, .. } => Some(limit),
            Self::Foreign { .. } => Some(WHAT_IS_READ),
        }
    }

    /// One thing to do.
    pub fn hint(&self) -> &str {
        match self {
            Self::Path { hint, .. }
            | Self::Content { hint, .. }
            | Self::NotStated { hint, .. }
            | Self::UnknownKey { hint, .. }
            | Self::Channel { hint, .. } => hint,
            Self::Foreign { instead, .. } => instead,
            Self::TooLarge { .. } => {
                "check that this is the file you meant; if so, split it or keep the channels needed"
            }
        }
    }

    pub(crate) fn content(
        place: Place,
        found: impl Into<String>,
        expected: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::Content { place: Box::new(place), found: found.into(), expected: expected.into(), hint: hint.into() }
    }

    pub(crate) fn channel(
        file: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::Channel { file: file.to_owned(), found: found.into(), expected: expected.into(), hint: hint.into() }
    }
}
