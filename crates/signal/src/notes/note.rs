//! Remarks that a stage leaves for the reader of its result.

use std::fmt;

use crate::notes::bearing::{About, Bearing, Weight};

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
    /// What it concerns and how much it changes there; `None`: what the stage concerns, with the least weight.
    pub bearing: Option<Bearing>,
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
        Self { severity: Severity::Info, text: text.into(), bearing: None }
    }

    /// Something that may change a conclusion.
    pub fn warning(text: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, text: text.into(), bearing: None }
    }

    /// The same, with what it concerns and how much it changes there.
    #[must_use]
    pub fn bears_on(mut self, about: About, weight: Weight) -> Self {
        self.bearing = Some(Bearing { about, weight });
        self
    }

    /// Reads the text form back.
    pub fn parse(text: &str) -> Self {
        match text.strip_prefix(WARNING_PREFIX) {
            Some(rest) => Self::warning(rest),
            None => Self::info(text),
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

    /// Adds a warning with what it concerns and how much it changes there.
    pub fn concern(&mut self, about: About, weight: Weight, text: impl Into<String>) {
        self.0.push(Note::warning(text).bears_on(about, weight));
    }

    /// Gives `about` to all warnings that do not say what they concern, with the least weight.
    #[must_use]
    pub fn all_about(mut self, about: &About) -> Self {
        for note in self.0.iter_mut().filter(|note| note.severity == Severity::Warning) {
            note.bearing.get_or_insert_with(|| Bearing { about: about.clone(), weight: Weight::Slight });
        }
        self
    }

    /// Puts a warning before all other notes: what the rest rests on is in doubt.
    pub fn concern_first(&mut self, about: About, text: impl Into<String>) {
        self.0.insert(0, Note::warning(text).bears_on(about, Weight::Decisive));
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
