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
        f.write_str(&self.file.replace('\n', "\\n"))?;
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
    "a table of numbers, Excel, MATLAB, NHTSA EV5, ISO-MME, TDMS, TDM, LVM, UFF 58, MCAP, a ROS 1 bag, or a zip of one";

/// Which kind of refusal, where a caller answers it in its own way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// The content is not what its format asks for.
    Content,
    /// The channel asked for cannot be the pulse, or none can be chosen.
    Channel,
    /// A size limit that guards memory is exceeded.
    TooLarge,
    /// A key of the sidecar that is not known, as written.
    UnknownKey(String),
    /// Any other: a path, a format that is known and not read, something that is stated nowhere.
    Other,
}

/// Why an input is refused. All of these are the input's, none the program's: exit code 3.
///
/// The message says where and what was found; [`expected`](Self::expected) and [`hint`](Self::hint) the rest.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct IngestError {
    /// Which kind of refusal.
    pub refusal: Refusal,
    message: String,
    expected: String,
    hint: String,
}

impl IngestError {
    /// What was expected, if there is more to say than the message does.
    pub fn expected(&self) -> Option<&str> {
        Some(self.expected.as_str()).filter(|text| !text.is_empty())
    }

    /// One thing to do.
    pub fn hint(&self) -> &str {
        &self.hint
    }

    /// The same with other advice.
    pub(crate) fn with_hint(self, hint: &str) -> Self {
        Self { hint: hint.to_owned(), ..self }
    }

    fn new(refusal: Refusal, message: String, expected: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { refusal, message, expected: expected.into(), hint: hint.into() }
    }

    pub(crate) fn content(
        place: Place,
        found: impl fmt::Display,
        expected: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::new(Refusal::Content, format!("{place}: {found}"), expected, hint)
    }

    pub(crate) fn channel(
        file: &str,
        found: impl fmt::Display,
        expected: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::new(Refusal::Channel, format!("{file}: {found}"), expected, hint)
    }

    pub(crate) fn too_large(place: Place, found: impl fmt::Display, limit: impl Into<String>) -> Self {
        let hint = "check that this is the file you meant; if so, split it or keep the channels needed";
        Self::new(Refusal::TooLarge, format!("{place}: {found}"), limit, hint)
    }

    /// A path, as the user typed it, that cannot be opened or has nothing readable in it.
    pub(crate) fn path(
        path: impl fmt::Display,
        found: impl fmt::Display,
        expected: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::new(Refusal::Other, format!("{path}: {found}"), expected, hint)
    }

    /// A file in a format, in words with its article, that is known and not read; what to export instead.
    pub(crate) fn foreign(file: &str, what: &str, instead: &str) -> Self {
        Self::new(Refusal::Other, format!("{file} is {what}, which is not read"), WHAT_IS_READ, instead)
    }

    /// Something that must be known is stated nowhere.
    pub(crate) fn not_stated(file: &str, what: impl fmt::Display, expected: &str, hint: &str) -> Self {
        Self::new(Refusal::Other, format!("{file} does not state {what}"), expected, hint)
    }

    pub(crate) fn unknown_key(file: &str, key: &str, expected: &str, hint: impl Into<String>) -> Self {
        Self::new(Refusal::UnknownKey(key.to_owned()), format!("{file}: unknown key {key:?}"), expected, hint)
    }
}
