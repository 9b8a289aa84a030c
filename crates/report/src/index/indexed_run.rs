//! A run as an index knows it.

use crate::drawing::escape::{address, html};
use crate::phrases::PHRASES;

use super::run_summary::RunSummary;

/// One run of an index.
#[derive(Debug, Clone)]
pub struct IndexedRun<'a> {
    /// What it is called.
    pub name: String,
    /// Pipeline and settings, where they tell runs apart; else empty.
    pub variant: String,
    /// Path of its report from the folder of the page; `None`: there is none.
    pub report: Option<String>,
    /// Exit code of the run; 4 is a result that is not acceptable.
    pub exit_code: i32,
    /// What was said of it where the code is not 0.
    pub error: String,
    /// What it found, where it has a result.
    pub summary: Option<&'a RunSummary>,
    /// Its pulse as a small line, HTML; empty: none.
    pub pulse: String,
}

impl IndexedRun<'_> {
    /// Exit code and reason of a run folder, by its summary alone.
    pub fn ending(summary: &RunSummary) -> (i32, String) {
        let no_word = || PHRASES.runs.no_word.to_owned();
        match summary.conclusion.standing.as_str() {
            "no-result" => (4, summary.conclusion.reason.clone().unwrap_or_else(no_word)),
            _ => (0, String::new()),
        }
    }

    /// Its name, HTML: a link to its report where there is one.
    pub(crate) fn linked(&self) -> String {
        match &self.report {
            Some(report) => format!("<a href=\"{}\">{}</a>", address(report), html(&self.name)),
            None => html(&self.name),
        }
    }

    /// Whether there is what was asked for.
    pub(crate) fn is_done(&self) -> bool {
        self.exit_code == 0
    }
}

/// An exit code in words.
pub fn status(exit_code: i32) -> &'static str {
    let texts = &PHRASES.runs;
    match exit_code {
        0 => texts.done,
        2 => texts.usage,
        3 => texts.refused,
        4 => texts.not_acceptable,
        _ => texts.failed,
    }
}
