//! Why an input is refused.

use std::fmt::{self, Display};

/// A place in a file in words: its name without folder, and where known the line, from 1, and the column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Place(String);

impl Place {
    /// Somewhere in a file.
    pub(crate) fn file(file: &str) -> Self {
        Self(file.to_owned())
    }

    /// A line of a file, counted from 1.
    pub(crate) fn line(file: &str, line: usize) -> Self {
        Self(format!("{file}, line {line}"))
    }

    /// The same place, in a named column.
    pub(crate) fn in_column(self, column: impl Display) -> Self {
        Self(format!("{self}, column {column}"))
    }

    /// The same place, in a column of a table by its number and its name.
    pub(crate) fn in_nth_column(self, k: usize, title: &str) -> Self {
        self.in_column(format!("{} ({title})", k + 1))
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.replace('\n', "\\n"))
    }
}

/// The formats that are read, in words.
pub(crate) const WHAT_IS_READ: &str = concat!(
    "a table of numbers, JSON lines, Parquet, Excel, MATLAB, HDF5, NHTSA EV5, ISO-MME, TDMS, TDM, LVM, UFF 58, MCAP, ",
    "a ROS 1 bag, binout, nodout, T01, or a zip of one"
);
/// What to do about samples that are missing inside a record.
pub(crate) const GAPS_ARE_NOT_FILLED: &str =
    "cut the record before the gap, or fill it in the program that made it: gaps are not filled here";

/// Which kind of refusal, where a caller answers it in its own way.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refusal {
    /// The content is not what its format asks for.
    Content,
    /// The channel asked for cannot be the pulse, or none can be chosen.
    Channel,
    /// A size limit that guards memory is exceeded.
    TooLarge,
    /// The unit of the times is stated nowhere, and their steps do not tell it.
    UnitOfTime,
    /// A key of the sidecar that is not known, as written.
    UnknownKey(String),
    /// Any other: a path, a format that is known and not read, something that is stated nowhere.
    Other,
}

/// What a person can state that answers a refusal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Question {
    /// The unit of the times.
    UnitOfTime,
    /// The sampling interval.
    Interval,
    /// The unit of the accelerations.
    Unit,
    /// The channel with the pulse; one that may be it.
    Channel(String),
    /// The node of a simulation; one that may be it.
    Node(Box<str>),
    /// The units of a simulation; the system that fits.
    Units(Option<&'static str>),
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
    /// What would answer it.
    pub(crate) question: Option<Question>,
}

/// What may be refused.
pub type Result<T, E = IngestError> = std::result::Result<T, E>;

/// [`IngestError::content`] as the answer.
pub fn refuse<T>(at: impl Display, found: impl Display, expected: impl Display, hint: impl Display) -> Result<T> {
    Err(IngestError::content(at, found, expected, hint))
}

/// [`IngestError::channel`] as the answer.
pub fn refuse_channel<T>(file: &str, found: impl Display, expected: impl Display, hint: impl Display) -> Result<T> {
    Err(IngestError::channel(file, found, expected, hint))
}

/// [`IngestError::path`] as the answer.
pub fn refuse_path<T>(at: impl Display, found: impl Display, expected: impl Display, hint: impl Display) -> Result<T> {
    Err(IngestError::path(at, found, expected, hint))
}

/// [`IngestError::too_large`] as the answer.
pub fn refuse_size<T>(at: impl Display, found: impl Display, limit: impl Display) -> Result<T> {
    Err(IngestError::too_large(at, found, limit))
}

/// Refuses more than so many bytes. In the words for what was found and for the limit `#` stands for MiB.
pub fn check_size(at: impl Display, bytes: u64, most: u64, found: &str, limit: &str) -> Result<()> {
    let words = |text: &str, bytes: u64| text.replace('#', &(bytes >> 20).to_string());
    if bytes <= most { Ok(()) } else { refuse_size(at, words(found, bytes), words(limit, most)) }
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
        Self { hint: hint.to_owned(), question: None, ..self }
    }

    /// The same as a question that a flag answers.
    pub(crate) fn asking(self, question: Question) -> Self {
        Self { question: Some(question), ..self }
    }

    /// The same with what would be asked next: `answers` are flags with their values in words.
    pub(crate) fn with_next(self, next: &[Self], answers: &[String]) -> Self {
        let messages = std::iter::once(&self).chain(next).map(|error| error.message.as_str());
        let message = messages.collect::<Vec<_>>().join("; ");
        let hint = format!("{}; in the same line {}", self.hint, answers.join(" and "));
        Self { message, hint, ..self }
    }

    fn new(refusal: Refusal, message: String, expected: impl Display, hint: impl Display) -> Self {
        Self { refusal, message, expected: expected.to_string(), hint: hint.to_string(), question: None }
    }

    /// Content that is not what its format asks for, at a [`Place`] or in a file.
    pub(crate) fn content(at: impl Display, found: impl Display, expected: impl Display, hint: impl Display) -> Self {
        Self::new(Refusal::Content, format!("{at}: {found}"), expected, hint)
    }

    pub(crate) fn channel(file: &str, found: impl Display, expected: impl Display, hint: impl Display) -> Self {
        Self::new(Refusal::Channel, format!("{file}: {found}"), expected, hint)
    }

    pub(crate) fn too_large(at: impl Display, found: impl Display, limit: impl Display) -> Self {
        let hint = "check that this is the file you meant; if so, split it or keep the channels needed";
        Self::new(Refusal::TooLarge, format!("{at}: {found}"), limit, hint)
    }

    /// A path, as the user typed it, that cannot be opened or has nothing readable in it.
    pub(crate) fn path(path: impl Display, found: impl Display, expected: impl Display, hint: impl Display) -> Self {
        Self::new(Refusal::Other, format!("{path}: {found}"), expected, hint)
    }

    /// A file in a format, in words with its article, that is known and not read; what to export instead.
    pub(crate) fn foreign(file: &str, what: &str, instead: &str) -> Self {
        Self::new(Refusal::Other, format!("{file} is {what}, which is not read"), WHAT_IS_READ, instead)
    }

    /// Something that must be known is stated nowhere.
    pub(crate) fn not_stated(file: &str, what: impl Display, expected: &str, hint: &str) -> Self {
        Self::new(Refusal::Other, format!("{file} does not state {what}"), expected, hint)
    }

    /// Units that make no sense.
    pub(crate) fn units(file: &str, found: impl Display, expected: &str, hint: &str) -> Self {
        Self::new(Refusal::Other, format!("{file}: {found}"), expected, hint)
    }

    /// A unit of time that is stated nowhere.
    pub(crate) fn unit_of_time(file: &str, times: impl Display, expected: &str, hint: &str) -> Self {
        let error = Self::not_stated(file, format!("the unit of time: {times}"), expected, hint);
        Self { refusal: Refusal::UnitOfTime, ..error }.asking(Question::UnitOfTime)
    }

    pub(crate) fn unknown_key(file: &str, key: &str, expected: &str, hint: impl Display) -> Self {
        Self::new(Refusal::UnknownKey(key.to_owned()), format!("{file}: unknown key {key:?}"), expected, hint)
    }
}
