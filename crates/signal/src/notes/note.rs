//! Remarks that a stage leaves for the reader of its result.

use std::fmt;

/// What a warning begins with in its text form, as the record of notes has it on disk.
const WARNING_PREFIX: &str = "warning: ";

/// How much a note matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// Good to know.
    Info,
    /// May change a conclusion.
    Warning,
}

/// A remark in plain words. Its text form, which [`Note::parse`] reads back, starts with `warning: ` if it is a
/// warning: nothing else in the code writes or reads that prefix.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// How much it matters.
    pub severity: Severity,
    /// One sentence, units included.
    pub text: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.severity {
            Severity::Info => f.write_str(&self.text),
            Severity::Warning => write!(f, "{WARNING_PREFIX}{}", self.text),
        }
    }
}

impl Note {
    /// Something good to know.
    pub fn info(text: impl Into<String>) -> Self {
        Self { severity: Severity::Info, text: text.into() }
    }

    /// Something that may change a conclusion.
    pub fn warning(text: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, text: text.into() }
    }

    /// Reads the text form back.
    pub fn parse(text: &str) -> Self {
        match text.strip_prefix(WARNING_PREFIX) {
            Some(rest) => Self { severity: Severity::Warning, text: rest.to_owned() },
            None => Self { severity: Severity::Info, text: text.to_owned() },
        }
    }
}

/// The notes of one computation, in the order they were made.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Notes(Vec<Note>);

impl Notes {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds something good to know.
    pub fn info(&mut self, text: impl Into<String>) {
        self.0.push(Note::info(text));
    }

    /// Adds something that may change a conclusion.
    pub fn warning(&mut self, text: impl Into<String>) {
        self.0.push(Note::warning(text));
    }

    /// Puts a warning before all other notes: what the rest rests on is in doubt.
    pub fn warning_first(&mut self, text: impl Into<String>) {
        self.0.insert(0, Note::warning(text));
    }

    /// Adds a note as it is.
    pub fn push(&mut self, note: Note) {
        self.0.push(note);
    }

    /// The notes in order.
    pub fn iter(&self) -> std::slice::Iter<'_, Note> {
        self.0.iter()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Appends the notes of a part of the computation.
    pub fn extend(&mut self, other: Self) {
        self.0.extend(other.0);
    }

    /// The text forms, in order.
    pub fn to_texts(&self) -> Vec<String> {
        self.0.iter().map(Note::to_string).collect()
    }
}
