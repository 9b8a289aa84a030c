//! What a stage found, on its way into the artifact.

use anyhow::Context;
use crumple_artifact::{ArtifactBuilder, Record};
use crumple_signal::{Notes, QuantityKind, Sampled};

use crate::terminal::Progress;

/// Collects records, waveforms, notes and the summary of a stage.
pub struct Output {
    pub(crate) builder: ArtifactBuilder,
    pub(crate) notes: Notes,
    pub(crate) summary: Vec<String>,
    pub(crate) without: Option<String>,
    pub(crate) remedy: Option<String>,
}

impl Output {
    pub(crate) fn new() -> Self {
        Self { builder: ArtifactBuilder::new(), notes: Notes::new(), summary: Vec::new(), without: None, remedy: None }
    }

    /// Adds a record under a topic. Error: the topic is taken, or a number in it is not finite.
    pub fn put<R: Record>(&mut self, topic: &str, record: &R) -> anyhow::Result<()> {
        self.builder.put(topic, record).context("a result cannot be written")
    }

    /// Adds a waveform in SI units; its topic is `/wave/<id>`.
    pub fn wave(&mut self, id: &str, quantity: QuantityKind, samples: Sampled) -> anyhow::Result<()> {
        self.builder.wave(id, quantity, samples).context("a result cannot be written")
    }

    /// Remarks for the reader of the result; written under `/notes`, warnings also to stderr.
    pub fn notes(&mut self) -> &mut Notes {
        &mut self.notes
    }

    /// Adds a line to the short summary on stderr. A warning of the notes that is put here, in its text form, is not
    /// printed again.
    pub fn summary(&mut self, line: impl Into<String>) {
        self.summary.push(line.into());
    }

    /// States why a result that is done holds nothing that later stages work on: they then have no acceptable result,
    /// for this reason. A line of the summary too.
    pub fn nothing_for_later_stages(&mut self, reason: impl Into<String>) {
        let reason = reason.into();
        self.summary.push(reason.clone());
        self.without = Some(reason);
    }

    /// One thing to do for a result, or for one that later stages work on, where there is none: a sentence without a
    /// capital and a full stop, which works when followed.
    pub fn remedy(&mut self, remedy: impl Into<String>) {
        self.remedy = Some(remedy.into());
    }

    /// Starts to show the progress of work with `total` parts.
    pub fn progress(&self, what: impl Into<String>, total: u64) -> Progress {
        Progress::new(what, total)
    }
}
