//! Rules 1 and 10: which crate may use which, what numerics never name, how large a crate is.

use crate::modules::line_of_path;
use crate::rule::Violation;
use crate::source::{Package, Source};

/// Crates by layer, foundations first. A crate may use crates of lower layers; the stages of a run use none of each
/// other, what counts as different stands below them, and the programs of many runs above them.
pub const LAYERS: [&[&str]; 9] = [
    &["signal", "linalg", "memory", "source-digest", "browser"],
    &["lti", "estimation", "artifact", "drawing"],
    &["metrics", "lumped", "phrases"],
    &["sysid", "lumped-fit", "findings"],
    &["stage"],
    &["diff"],
    &[
        "ingest",
        "filter",
        "integrate",
        "identify",
        "parameter-solve",
        "simulate",
        "predict",
        "report",
        "artifact-cli",
        "run",
    ],
    &["fleet"],
    &["testkit"],
];

/// The layer of the programs.
pub const PROGRAMS: usize = 5;

/// Crates that compute, and what they never name.
const NUMERICS: [&str; 7] = ["sysid", "lumped-fit", "estimation", "linalg", "lti", "lumped", "metrics"];
const OUTER: [&[&str]; 6] =
    [&["crumple_stage"], &["crumple_artifact"], &["anyhow"], &["clap"], &["std", "fs"], &["std", "env"]];

/// Most lines of a crate.
const CRATE_LINES: usize = 10_000;

/// The layer of a crate.
pub fn layer(name: &str) -> Option<usize> {
    LAYERS.iter().position(|layer| layer.contains(&name))
}

fn dependencies(package: &Package) -> Vec<String> {
    let Some(toml::Value::Table(table)) = package.manifest.get("dependencies") else { return Vec::new() };
    table.keys().filter_map(|key| key.strip_prefix("crumple-")).map(str::to_owned).collect()
}

/// Rule 1 on the manifest of a package and what its library names; rule 10 on its size.
pub fn check(package: &Package) -> Vec<Violation> {
    let name = package.name.as_str();
    let manifest = format!("crates/{name}/Cargo.toml");
    let broken = |message: String| Violation { rule: 1, subject: manifest.clone(), line: 1, message };
    let Some(own) = layer(name) else {
        return vec![broken(format!(
            "crate {name} has no layer: add it to LAYERS of this test and to ARCHITECTURE.md"
        ))];
    };
    let mut violations = Vec::new();
    for used in dependencies(package) {
        if used == "testkit" {
            violations.push(broken("testkit is used by tests only: put it under [dev-dependencies]".to_owned()));
        } else if layer(&used).is_none_or(|layer| layer >= own) {
            violations
                .push(broken(format!("{name} depends on {used}, arrows go to lower layers: move what both need down")));
        }
    }
    if NUMERICS.contains(&name) {
        for source in &package.sources {
            for outer in OUTER {
                violations.extend(line_of_path(source, outer).map(|line| {
                    let message = format!("{} in a library of numerics: do it in the stage", outer.join("::"));
                    Violation::of_file(1, source, line, message)
                }));
            }
        }
    }
    let lines: usize = package.sources.iter().map(Source::lines).sum();
    if lines > CRATE_LINES {
        let message = format!("crate {name} has {lines} lines without tests, {CRATE_LINES} at most: make two of it");
        violations.push(Violation { rule: 10, subject: format!("crates/{name}"), line: 1, message });
    }
    violations
}
