//! The arrows between the crates point down only, and no stage depends on another stage.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

use std::collections::BTreeMap;

/// Crates by layer, foundations first. A crate may use crates of lower layers; those of the last layer are programs and
/// use no one of their own.
const LAYERS: [&[&str]; 7] = [
    &["signal", "linalg"],
    &["lti", "estimation", "artifact"],
    &["metrics", "lumped"],
    &["sysid", "lumped-fit"],
    &["stage"],
    &[
        "ingest",
        "filter",
        "integrate",
        "identify",
        "parameter-solve",
        "simulate",
        "report",
        "diff",
        "artifact-cli",
        "run",
    ],
    &["testkit"],
];

fn layer(name: &str) -> usize {
    LAYERS.iter().position(|layer| layer.contains(&name)).unwrap_or_else(|| {
        panic!("crate {name} has no layer: add it here and to ARCHITECTURE.md");
    })
}

fn dependencies(manifest: &toml::Table, section: &str) -> Vec<String> {
    let Some(toml::Value::Table(table)) = manifest.get(section) else { return Vec::new() };
    table.keys().filter_map(|key| key.strip_prefix("crumple-")).map(str::to_owned).collect()
}

#[test]
fn arrows_point_down_and_no_stage_knows_another() {
    let crates = crumple_testkit::workspace().join("crates");
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(crates).unwrap() {
        let path = entry.unwrap().path();
        let Ok(text) = std::fs::read_to_string(path.join("Cargo.toml")) else { continue };
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        found.insert(name, text.parse::<toml::Table>().unwrap());
    }
    assert_eq!(found.len(), LAYERS.iter().map(|layer| layer.len()).sum::<usize>(), "crates: {:?}", found.keys());
    for (name, manifest) in &found {
        for used in dependencies(manifest, "dependencies") {
            assert!(layer(&used) < layer(name), "{name} depends on {used}: arrows point down only");
            assert!(name == "testkit" || used != "testkit", "{name}: testkit is a dev-dependency only");
            let numerics = ["linalg", "lti", "estimation", "lumped", "lumped-fit", "metrics", "sysid"];
            assert!(
                !(numerics.contains(&name.as_str()) && ["artifact", "stage"].contains(&used.as_str())),
                "{name} depends on {used}: numerics know no files"
            );
        }
    }
}
