//! What a stage writes, and what it does not overwrite.

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::records::RemarkV1;
use crumple_artifact::{ArtifactBuilder, OutputKind, Record, WriteError};
use crumple_signal::{Note, Notes, QuantityKind, Sampled};

use crate::artifacts::inputs::path_of;
use crate::artifacts::remarks::LeftOut;
use crate::command_line::pipeline_file::Pipeline;
use crate::error::{Refused, Usage};
use crate::terminal::Progress;
use crate::typed::by_way;

/// A line of the short summary.
#[derive(Debug, Clone, PartialEq)]
pub enum SummaryLine {
    /// A text.
    Text(String),
    /// A remark, which is not printed a second time.
    Remark(Note),
}

impl From<String> for SummaryLine {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Note> for SummaryLine {
    fn from(remark: Note) -> Self {
        Self::Remark(remark)
    }
}

impl fmt::Display for SummaryLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(text),
            Self::Remark(remark) => remark.fmt(f),
        }
    }
}

/// Collects records, waveforms, notes and the summary of a stage.
pub struct Output {
    pub(crate) builder: ArtifactBuilder,
    pub(crate) notes: Notes,
    pub(crate) summary: Vec<SummaryLine>,
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

    /// Adds the record of a candidate under a topic and returns whether it could. One with a number that no record
    /// holds is left out, for a reason that the notes say: a wild root takes no other candidate with it. Error: the
    /// topic is taken.
    pub fn put_candidate<R: Record>(&mut self, topic: &str, id: &str, record: &R) -> anyhow::Result<bool> {
        let Err(error) = self.put(topic, record) else { return Ok(true) };
        let Some(WriteError::Impossible { field, value, .. }) = error.downcast_ref() else { return Err(error) };
        let (field, value) = (field.to_owned(), format!("{value:e}"));
        self.notes.push(LeftOut { id: id.to_owned(), field, value });
        Ok(false)
    }

    /// Adds a waveform in SI units; its topic is `/wave/<id>`.
    pub fn wave(&mut self, id: &str, quantity: QuantityKind, samples: Sampled) -> anyhow::Result<()> {
        self.builder.wave(id, quantity, samples).context("a result cannot be written")
    }

    /// Remarks for the reader of the result; written under `/remarks`, warnings also to stderr.
    pub fn notes(&mut self) -> &mut Notes {
        &mut self.notes
    }

    /// Adds a line to the short summary on stderr.
    pub fn summary(&mut self, line: impl Into<SummaryLine>) {
        self.summary.push(line.into());
    }

    /// Puts a remark in the place of one that a line of the summary has, now that more is known.
    pub fn replace_in_summary(&mut self, remark: &Note, by: &Note) {
        let lines = self.summary.iter_mut().filter(|line| matches!(line, SummaryLine::Remark(own) if own == remark));
        lines.for_each(|line| *line = SummaryLine::Remark(by.clone()));
    }

    /// Whether a line of the summary has this remark of the stage.
    pub(crate) fn is_in_summary(&self, remark: &RemarkV1) -> bool {
        let is_said = |note: &Note| RemarkV1::new(&remark.stage, note).says_the_same(remark);
        self.summary.iter().any(|line| matches!(line, SummaryLine::Remark(note) if is_said(note)))
    }

    /// States why a result that is done holds nothing that later stages work on: they then have no acceptable result,
    /// for this reason. A line of the summary too.
    pub fn nothing_for_later_stages(&mut self, reason: impl Into<String>) {
        let reason = reason.into();
        self.summary(reason.clone());
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

/// Refuses an output that is an input too, or a file that exists and is of another kind: it would be lost.
///
/// Asked before anything is computed; the writing itself refuses other kinds once more.
pub fn refuse_to_overwrite(output: &Path, kind: OutputKind, inputs: &[PathBuf]) -> anyhow::Result<()> {
    let Ok(existing) = output.canonicalize() else { return Ok(()) };
    let problem = if inputs.iter().any(|input| path_of(input).canonicalize().is_ok_and(|path| path == existing)) {
        "is an input too"
    } else {
        let problem = kind.problem_at(&existing).with_context(|| format!("cannot read {}", output.display()))?;
        match problem {
            Some(problem) => problem,
            None => return Ok(()),
        }
    };
    Err(Usage::new(format!("the output {} {problem}", output.display())).hint("give it another name").into())
}

/// What to name in place of a folder that is no run: those right below it that are, as the pipelines of a record are;
/// else what makes one.
pub fn hint_for_a_run(folder: &Path) -> String {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_run = |path: &PathBuf| {
        let mut inside = std::fs::read_dir(path).into_iter().flatten().flatten();
        inside.any(|entry| entry.file_name().to_string_lossy().ends_with("-ingest.mcap"))
    };
    let mut runs: Vec<String> = entries.filter(is_run).map(|path| path.display().to_string()).collect();
    runs.sort();
    match runs.as_slice() {
        [] => format!("{} RECORD makes one, and says where it is", by_way("just run", "crumple run")),
        [only] => format!("did you mean {only}?"),
        [first, ..] => format!("name one of its {} runs, such as {first}", runs.len()),
    }
}

/// The artifacts of a run folder, in the order of their stages. Refuses a folder without any.
pub fn artifacts_of_a_run(folder: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let refused = |problem: String| {
        Refused::new(problem)
            .expected("the folder of a run, with 1-ingest.mcap and what was made from it")
            .hint(hint_for_a_run(folder))
    };
    let cannot = |error: std::io::Error| refused(format!("cannot read the folder {}: {error}", folder.display()));
    let mut artifacts = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(cannot)? {
        let path = entry.map_err(cannot)?.path();
        // A stage that was killed may leave a hidden temporary file.
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if !is_hidden && path.extension().is_some_and(|ending| ending == "mcap") {
            artifacts.push(path);
        }
    }
    artifacts.sort();
    if artifacts.is_empty() {
        return Err(refused(format!("{} holds no artifact", folder.display())).into());
    }
    Ok(artifacts)
}

/// Why the results in a run folder are not those of its record: the last run into it failed. `None`: they are.
pub fn results_of_an_earlier_run(folder: &Path) -> Option<String> {
    let code = Pipeline::failure_in(folder)?;
    let left = match artifacts_of_a_run(folder) {
        Ok(_) => "its results are of an earlier run",
        Err(_) => "it left no results",
    };
    Some(format!("the last run into {} ended with exit code {code}: {left}", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    use crumple_signal::Value;

    #[test]
    fn a_remark_in_the_summary_is_known_by_its_values() {
        let of_value = |value: f64| Note { values: vec![("k", Value::Number(value))], ..Note::warning("k is odd") };
        let is_said = |out: &Output, value: f64| out.is_in_summary(&RemarkV1::new("filter", &of_value(value)));
        let mut out = Output::new();
        out.summary("warning: k is odd".to_owned());
        assert!(!is_said(&out, 1.0));
        out.summary(of_value(1.0));
        assert!(is_said(&out, 1.0) && !is_said(&out, 2.0));
        out.replace_in_summary(&of_value(1.0), &of_value(2.0));
        assert!(!is_said(&out, 1.0) && is_said(&out, 2.0));
    }

    #[test]
    fn inputs_and_files_of_other_kinds_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, content: &[u8]| {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            path
        };
        let old = write("2-filter.mcap", b"\x89MCAP0\r\n crumple.Test.v1");
        let input = write("1-ingest.mcap", b"\x89MCAP0\r\n crumple.Test.v1");
        let record = write("crash.csv", b"time_s,accel_g\n");
        let refused = |output: &Path| {
            let asked = refuse_to_overwrite(output, OutputKind::Artifact, std::slice::from_ref(&input));
            asked.err().map(|error| error.to_string().replace(&folder.path().display().to_string(), "F"))
        };
        assert_eq!(refused(&old), None);
        assert_eq!(refused(&folder.path().join("new.mcap")), None);
        assert_eq!(refused(&input).unwrap(), "the output F/1-ingest.mcap is an input too");
        // by another way to it
        assert_eq!(
            refused(&folder.path().join(".").join("1-ingest.mcap")).unwrap(),
            "the output F/./1-ingest.mcap is an input too"
        );
        assert_eq!(refused(&record).unwrap(), "the output F/crash.csv exists and is no artifact of this project");
        assert_eq!(refused(folder.path()).unwrap(), "the output F exists and is no regular file");
    }
}
