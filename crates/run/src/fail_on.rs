//! When a run fails for CI: by the codes of its remarks, by the word on its record, by its status.

use std::path::Path;
use std::str::FromStr;

use anyhow::Context;
use crumple_report::{Soundness, Status, Summary};
use crumple_stage::records::RemarkV1;
use crumple_stage::{ExitStatus, nearest, refuse_unknown_code, say};

/// One thing that a run may not have.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum FailOn {
    /// A remark of this code.
    Code(String),
    /// A record that is no better than this.
    Record(Soundness),
    /// A status that is no better than this.
    Status(Status),
}

/// Words beside codes.
const WORDS: [(&str, FailOn); 4] = [
    ("check", FailOn::Record(Soundness::Check)),
    ("wrong", FailOn::Record(Soundness::Wrong)),
    ("usable-with-care", FailOn::Status(Status::UsableWithCare)),
    ("do-not-use", FailOn::Status(Status::DoNotUse)),
];

impl FromStr for FailOn {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let word = WORDS.iter().find(|(word, _)| word.eq_ignore_ascii_case(text));
        if let Some((_, known)) = word {
            return Ok(known.clone());
        }
        let code = text.to_ascii_uppercase();
        if code.starts_with("CR") {
            return refuse_unknown_code(&code).map(|()| Self::Code(code)).map_err(|error| format!("{error:#}"));
        }
        let words = WORDS.map(|(word, _)| word);
        let near = nearest(text, words).map_or_else(String::new, |near| format!("; the nearest word is {near}"));
        Err(format!("expected a code such as CR203, or {}{near}", words.join(", ")))
    }
}

impl FailOn {
    /// What of a run fails by it, in words.
    fn found(&self, summary: &Summary) -> Option<String> {
        match self {
            Self::Code(code) => {
                let is_of = |remark: &&RemarkV1| remark.code == *code;
                let allowed = summary.allowed.contains_key(code);
                summary.remarks.iter().find(is_of).filter(|_| !allowed).map(RemarkV1::with_code)
            }
            Self::Record(limit) => {
                let record = summary.verdict.record.filter(|record| record >= limit)?;
                Some(format!("the record is {}", record.word()))
            }
            Self::Status(limit) => {
                let status = summary.verdict.status.filter(|status| status >= limit)?;
                Some(format!("its status is {}", status.word()))
            }
        }
    }
}

/// The status of a run whose stages came to `status`, after what it may not have. What it fails by is said.
pub(crate) fn after_limits(folder: &Path, limits: &[FailOn], status: ExitStatus) -> anyhow::Result<ExitStatus> {
    let path = folder.join("summary.json");
    if limits.is_empty() {
        return Ok(status);
    }
    let bytes = std::fs::read(&path).with_context(|| format!("--fail-on reads {}", path.display()))?;
    let summary = Summary::from_json(&bytes).with_context(|| format!("--fail-on reads {}", path.display()))?;
    let found: Vec<String> = limits.iter().filter_map(|limit| limit.found(&summary)).collect();
    for text in &found {
        say(format_args!("{:<16} fails: {text}", "run"));
    }
    Ok(if found.is_empty() { status } else { ExitStatus::NoAcceptableResult })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_words_are_read_and_others_refused() {
        assert_eq!("cr203".parse(), Ok(FailOn::Code("CR203".to_owned())));
        assert_eq!("check".parse(), Ok(FailOn::Record(Soundness::Check)));
        assert!("chek".parse::<FailOn>().unwrap_err().ends_with("the nearest word is check"));
        assert!("CR2".parse::<FailOn>().is_err() && "usable".parse::<FailOn>().is_err());
    }

    #[test]
    fn a_graver_word_fails_with_the_lighter_one() {
        let mut summary = Summary::default();
        summary.verdict.record = Some(Soundness::Wrong);
        summary.verdict.status = Some(Status::UsableWithCare);
        let found = |limit: &str| limit.parse::<FailOn>().unwrap().found(&summary);
        assert_eq!(found("check").as_deref(), Some("the record is wrong"));
        assert_eq!((found("usable-with-care").is_some(), found("do-not-use")), (true, None));
        assert_eq!(found("CR203"), None);
    }
}
