//! Notes of a candidate: a sentence with its severity and what it is about.

use std::fmt;

use crumple_signal::{Note, Severity};

/// What a note is about, so that a step that changes the values can bring it up to date.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoteTopic {
    /// Reductions, assumptions, where a value comes from.
    General,
    /// The root mean square error of every sensor.
    SensorErrors,
    /// Parameters that stopped on a bound.
    ActiveBounds,
}

/// A note of a candidate. Its text form, which the artifact holds, is that of [`Note`]: a warning begins with
/// `warning: `.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CandidateNote {
    /// The sentence and how much it matters.
    pub note: Note,
    /// What it is about.
    pub topic: NoteTopic,
}

impl CandidateNote {
    fn new(severity: Severity, topic: NoteTopic, text: impl Into<String>) -> Self {
        Self { note: Note { severity, text: text.into() }, topic }
    }

    /// Something good to know.
    pub fn info(text: impl Into<String>) -> Self {
        Self::new(Severity::Info, NoteTopic::General, text)
    }

    /// Something that may change a conclusion.
    pub fn warning(text: impl Into<String>) -> Self {
        Self::new(Severity::Warning, NoteTopic::General, text)
    }

    /// How far each sensor was missed, see [`note_of_errors`](crate::note_of_errors).
    pub fn sensor_errors(text: impl Into<String>) -> Self {
        Self::new(Severity::Info, NoteTopic::SensorErrors, text)
    }

    /// Which parameters stopped on a bound, see [`bounds_remark`](crate::bounds_remark).
    pub fn active_bounds(text: impl Into<String>) -> Self {
        Self::new(Severity::Info, NoteTopic::ActiveBounds, text)
    }

    /// The sentence alone.
    pub fn text(&self) -> &str {
        &self.note.text
    }
}

/// A sentence of no severity is good to know.
impl From<String> for CandidateNote {
    fn from(text: String) -> Self {
        Self::info(text)
    }
}

impl fmt::Display for CandidateNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.note.fmt(f)
    }
}

/// Sentences that are good to know, in their order.
pub(crate) fn infos(texts: Vec<String>) -> Vec<CandidateNote> {
    texts.into_iter().map(CandidateNote::info).collect()
}
