//! A violation of a rule: where, which, and what to do.

use std::fmt;

use crate::source::Source;

/// One violation.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Violation {
    /// Number of the rule.
    pub rule: u8,
    /// What exceptions name: a file, a folder, a crate, or `file::item`.
    pub subject: String,
    /// Line from 1.
    pub line: usize,
    /// What is wrong and what to do.
    pub message: String,
}

impl Violation {
    /// Of a file.
    pub fn of_file(rule: u8, source: &Source, line: usize, message: String) -> Self {
        Self { rule, subject: source.path.clone(), line, message }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = self.subject.split("::").next().unwrap_or_default();
        write!(f, "{file}:{}: rule {}: {}", self.line, self.rule, self.message)
    }
}
