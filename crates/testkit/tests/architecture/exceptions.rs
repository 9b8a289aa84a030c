//! What may break a rule, and why: `exceptions.toml`.

use std::path::Path;

use crate::rule::Violation;

/// One line of the list.
#[derive(Debug, Clone, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exception {
    pub rule: u8,
    pub subject: String,
    pub reason: String,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    #[serde(default)]
    exception: Vec<Exception>,
}

/// The list of a workspace.
pub fn read(root: &Path) -> Vec<Exception> {
    let path = root.join("crates/testkit/tests/architecture/exceptions.toml");
    let Ok(text) = std::fs::read_to_string(&path) else { return Vec::new() };
    let list: List = toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    list.exception
}

/// Violations that no exception covers, and exceptions that nothing needs.
pub fn apply(violations: Vec<Violation>, exceptions: &[Exception]) -> (Vec<Violation>, Vec<&Exception>) {
    let covers = |exception: &Exception, violation: &Violation| {
        exception.rule == violation.rule && exception.subject == violation.subject
    };
    let needless: Vec<&Exception> = exceptions
        .iter()
        .filter(|exception| !violations.iter().any(|violation| covers(exception, violation)))
        .collect();
    let left = violations
        .into_iter()
        .filter(|violation| !exceptions.iter().any(|exception| covers(exception, violation)))
        .collect();
    (left, needless)
}
