//! The house keeps its ten rules: layers, rooms, circles, sizes, names. Text only; what may break a rule stands in
//! `exceptions.toml`.
//!
//! `CRUMPLE_ROOT` checks another checkout, `CRUMPLE_CRATE` prints one crate's violations only.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod circles;
mod exceptions;
mod layers;
mod modules;
mod page;
mod planted;
mod rooms;
mod rule;
mod source;
mod words;

use std::path::{Path, PathBuf};

use exceptions::Exception;
use modules::Modules;
use rule::Violation;

/// Every violation in a workspace, exceptions or not.
fn violations(root: &Path) -> Vec<Violation> {
    let packages = source::packages(root);
    let mut violations = Vec::new();
    for package in &packages {
        let arrows = Modules::new(package).arrows();
        violations.extend(layers::check(package));
        violations.extend(circles::check(package, &arrows));
        violations.extend(rooms::check_layout(package));
        violations.extend(rooms::check_order(package, &arrows));
        violations.extend(rooms::check_stage(package));
        violations.extend(package.sources.iter().flat_map(words::check_file));
        violations.extend(package.others.iter().flat_map(words::check_form));
    }
    violations.extend(words::check_type_names(&packages));
    violations.sort();
    violations
}

fn root() -> PathBuf {
    std::env::var_os("CRUMPLE_ROOT").map_or_else(crumple_testkit::workspace, PathBuf::from)
}

#[test]
fn the_house_keeps_its_rules() {
    let root = root();
    let exceptions = exceptions::read(&root);
    let (left, needless) = exceptions::apply(violations(&root), &exceptions);
    let only = std::env::var("CRUMPLE_CRATE").unwrap_or_default();
    let is_meant = |subject: &str| only.is_empty() || subject.split('/').nth(1) == Some(&only);
    let mut lines: Vec<String> =
        left.iter().filter(|violation| is_meant(&violation.subject)).map(ToString::to_string).collect();
    lines.extend(needless.iter().filter(|exception| is_meant(&exception.subject)).map(
        |Exception { rule, subject, .. }| {
            format!(
                "exceptions.toml: rule {rule}: {subject} keeps it now: take the exception out, the list only shrinks"
            )
        },
    ));
    assert!(lines.is_empty(), "{} violations\n{}", lines.len(), lines.join("\n"));
}

#[test]
fn every_exception_has_a_reason() {
    for exception in exceptions::read(&root()) {
        assert!(exception.reason.split_whitespace().count() > 3, "{exception:?}");
    }
}
