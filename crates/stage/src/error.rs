//! Errors that people can act on, and exit codes.

use std::fs;
use std::process::ExitCode;

use crumple_artifact::ReadError;

use crate::names::nearest;
use crate::typed::program;

/// What the process tells its caller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExitStatus {
    /// 0: done (or up to date; for `crumple-diff`: the same).
    Done,
    /// 1: unforeseen failure (for `crumple-diff`: different).
    Failure,
    /// 2: the command line or the pipeline file is wrong (for `crumple-diff`: trouble).
    Usage,
    /// 3: the input was refused.
    Refused,
    /// 4: no acceptable result; the diagnosis is written.
    NoAcceptableResult,
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> Self {
        Self::from(status as u8)
    }
}

/// Input that cannot be used: what was found and where, what was expected, one thing to do. Exit code 3.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{found}")]
pub struct Refused {
    found: String,
    expected: Option<String>,
    hint: Option<String>,
}

impl Refused {
    /// Says what was found, and where.
    pub fn new(found: impl Into<String>) -> Self {
        Self { found: found.into(), expected: None, hint: None }
    }

    /// Says what was expected instead.
    #[must_use]
    pub fn expected(mut self, expected: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self
    }

    /// Says one thing to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

impl From<ReadError> for Refused {
    fn from(error: ReadError) -> Self {
        Self::new(error.to_string()).hint(error.hint())
    }
}

/// A command line or pipeline file that asks for something that does not exist. Exit code 2.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{problem}")]
pub struct Usage {
    problem: String,
    hint: Option<String>,
}

impl Usage {
    /// Says what is wrong with it.
    pub fn new(problem: impl Into<String>) -> Self {
        Self { problem: problem.into(), hint: None }
    }

    /// Says one thing to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}

/// An error about a name that does not exist: with the nearest that does, or all of them.
pub fn unknown_name(problem: &str, name: &str, choices: &[&str]) -> anyhow::Error {
    let hint = match nearest(name, choices.iter().copied()) {
        Some(near) => format!("did you mean {near:?}?"),
        None => format!("there are: {}", choices.join(", ")),
    };
    Usage::new(problem).hint(hint).into()
}

/// A topic that a stage needs is in none of its inputs.
///
/// Where an earlier stage had no acceptable result, this is no fault of the input: the stage has none either.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("topic {topic} is in none of the inputs: {given}")]
pub struct MissingTopic {
    topic: String,
    given: String,
    writers: &'static [&'static str],
}

impl MissingTopic {
    /// A topic, the inputs that lack it, and the stages that write it.
    pub(crate) fn new(topic: &str, given: String, writers: &'static [&'static str]) -> Self {
        Self { topic: topic.to_owned(), given, writers }
    }

    /// The stages that write the topic.
    pub(crate) fn writers(&self) -> &'static [&'static str] {
        self.writers
    }

    /// One thing to do: the program that writes the topic.
    pub(crate) fn hint(&self) -> String {
        let programs: Vec<String> = self.writers.iter().map(|writer| program(writer)).collect();
        let programs = if programs.is_empty() { "another stage".to_owned() } else { programs.join(" or ") };
        format!("give the artifact of {programs} too")
    }
}

/// Turns a library's error into a refusal of the input.
pub trait RefuseExt<T> {
    /// The input is to blame.
    fn refuse(self) -> anyhow::Result<T>;
    /// The input is to blame, and this is what to do.
    fn refuse_with_hint(self, hint: impl Into<String>) -> anyhow::Result<T>;
}

impl<T, E: std::error::Error> RefuseExt<T> for Result<T, E> {
    fn refuse(self) -> anyhow::Result<T> {
        self.map_err(|error| Refused::new(full_text(&error)).into())
    }

    fn refuse_with_hint(self, hint: impl Into<String>) -> anyhow::Result<T> {
        self.map_err(|error| Refused::new(full_text(&error)).hint(hint).into())
    }
}

/// An error with its sources, `outer: inner`, without saying anything twice.
fn full_text(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(inner) = source {
        let inner_text = inner.to_string();
        if !text.contains(&inner_text) {
            text = format!("{text}: {inner_text}");
        }
        source = inner.source();
    }
    text
}

/// The exit status an error stands for.
pub(crate) fn status_of(error: &anyhow::Error) -> ExitStatus {
    if is_in_chain::<Refused>(error) || is_in_chain::<MissingTopic>(error) {
        ExitStatus::Refused
    } else if is_in_chain::<Usage>(error) {
        ExitStatus::Usage
    } else {
        ExitStatus::Failure
    }
}

/// An error of a type somewhere in the chain of causes.
pub(crate) fn find_in_chain<E: std::error::Error + Send + Sync + 'static>(error: &anyhow::Error) -> Option<&E> {
    error.downcast_ref::<E>().or_else(|| error.chain().find_map(<dyn std::error::Error>::downcast_ref::<E>))
}

fn is_in_chain<E: std::error::Error + Send + Sync + 'static>(error: &anyhow::Error) -> bool {
    find_in_chain::<E>(error).is_some()
}

/// Names a file, where the caller of a program wants to know why it has no result: the first reason is written there.
pub const REASON_FILE: &str = "CRUMPLE_REASON_FILE";

/// Tells the caller why there is no result, where it asks for that: the cause next to the error, or the error alone.
pub(crate) fn tell_caller(error: &anyhow::Error) {
    let Some(path) = std::env::var_os(REASON_FILE) else { return };
    if fs::metadata(&path).is_ok_and(|file| file.len() == 0) {
        let causes = causes(error);
        // Where it cannot be written, what stands on stderr must do.
        _ = fs::write(&path, causes.get(1).unwrap_or(&causes[0]));
    }
}

/// The error and its causes. Some messages quote their cause already, which is then left out.
fn causes(error: &anyhow::Error) -> Vec<String> {
    let mut causes: Vec<String> = Vec::new();
    for text in error.chain().map(ToString::to_string) {
        if !causes.iter().any(|effect| effect.contains(&text)) {
            causes.push(text);
        }
    }
    causes
}

/// The text for stderr: `error:`, the causes, what was expected, one hint.
pub(crate) fn render(error: &anyhow::Error) -> String {
    let label = |place: usize| if place == 0 { "error" } else { "  caused by" };
    let told = causes(error).into_iter().enumerate();
    let mut lines: Vec<String> = told.map(|(place, text)| format!("{}: {text}", label(place))).collect();
    let (mut expected, mut hint) = (None, None);
    for cause in error.chain() {
        if let Some(refused) = cause.downcast_ref::<Refused>() {
            expected = expected.or(refused.expected.clone());
            hint = hint.or(refused.hint.clone());
        }
        if let Some(missing) = cause.downcast_ref::<MissingTopic>() {
            hint = hint.or(Some(missing.hint()));
        }
        if let Some(usage) = cause.downcast_ref::<Usage>() {
            hint = hint.or(usage.hint.clone());
        }
    }
    lines.extend(expected.map(|text| format!("  expected: {text}")));
    lines.extend(hint.map(|text| format!("  hint: {text}")));
    lines.iter().map(|line| shortened(line)).collect::<Vec<_>>().join("\n")
}

/// A text as people read it: what is longer than a screen was quoted from a file, and its ends tell enough.
fn shortened(text: &str) -> String {
    const LONGEST: usize = 2000;
    const END: usize = 400;
    let characters = text.chars().count();
    if characters <= LONGEST {
        return text.to_owned();
    }
    let place_of = |n: usize| text.char_indices().nth(n).map_or(text.len(), |(place, _)| place);
    let (start, end) = (&text[..place_of(LONGEST - END)], &text[place_of(characters - END)..]);
    format!("{start} ... ({} characters left out) ... {end}", characters - LONGEST)
}

#[cfg(test)]
mod tests {
    use anyhow::Context;

    use super::*;

    #[test]
    fn a_refusal_reads_from_the_outside_in_and_ends_with_a_hint() {
        let error =
            Err::<(), _>(Refused::new("a.csv, line 7: \"x\" is no number").expected("a number").hint("mend it"))
                .context("cannot read a.csv")
                .unwrap_err();
        insta::assert_snapshot!(render(&error), @r#"
        error: cannot read a.csv
          caused by: a.csv, line 7: "x" is no number
          expected: a number
          hint: mend it
        "#);
        let long = anyhow::anyhow!("{} is no name", "ä".repeat(100_000));
        let text = render(&long);
        assert!(text.chars().count() < 2100 && text.starts_with("error: ää") && text.ends_with("ää is no name"));
        assert!(text.contains("... (98018 characters left out) ..."), "{text}");
        assert_eq!(causes(&error), ["cannot read a.csv", "a.csv, line 7: \"x\" is no number"]);
        assert_eq!(status_of(&error), ExitStatus::Refused);
        assert_eq!(status_of(&Usage::new("no such key").into()), ExitStatus::Usage);
        assert_eq!(status_of(&anyhow::anyhow!("disk on fire")), ExitStatus::Failure);
    }

    #[test]
    fn a_missing_topic_names_who_writes_it() {
        let error = MissingTopic::new("/events", "2-filter.mcap (filter)".to_owned(), &["integrate"]);
        assert_eq!(error.writers(), ["integrate"]);
        insta::assert_snapshot!(render(&error.into()), @r#"
        error: topic /events is in none of the inputs: 2-filter.mcap (filter)
          hint: give the artifact of crumple-integrate too
        "#);
    }

    #[test]
    fn an_error_of_a_library_is_told_with_its_sources_once() {
        #[derive(Debug, thiserror::Error)]
        #[error("cannot read the table")]
        struct Outer(#[source] Inner);
        #[derive(Debug, thiserror::Error)]
        #[error("line 7")]
        struct Inner;
        #[derive(Debug, thiserror::Error)]
        #[error("cannot read: line 7")]
        struct Quoting(#[source] Inner);
        let text = |error: &dyn std::error::Error| full_text(error);
        assert_eq!(text(&Outer(Inner)), "cannot read the table: line 7");
        assert_eq!(text(&Quoting(Inner)), "cannot read: line 7");
        let refused = Err::<(), _>(Outer(Inner)).refuse_with_hint("mend it").unwrap_err();
        assert!(render(&refused).ends_with("line 7\n  hint: mend it") && status_of(&refused) == ExitStatus::Refused);
        // A cause that its effect quotes is not said twice.
        let quoted = anyhow::Error::new(Quoting(Inner));
        assert_eq!(render(&quoted), "error: cannot read: line 7");
    }
}
