//! Which crate may use which, and what libraries of numerics never name.

use crate::Package;
use crate::paths::uses;

/// Crates by layer, foundations first. A crate uses crates of lower layers; dev-dependencies are free.
const LAYERS: [&str; 9] = [
    "signal numerics memory source-digest",
    "artifact",
    "metrics lumped",
    "sysid lumped-fit",
    "stage",
    "diff",
    "ingest filter integrate identify parameter-solve simulate predict report artifact-cli",
    "run",
    "testkit",
];

/// Crates that know no files, no command line and no environment.
const NUMERICS: &str = "sysid lumped-fit numerics lumped metrics";
/// Crates and paths that they do without.
const OUTER: [&str; 6] = ["crumple_stage", "crumple_artifact", "anyhow", "clap", "std::fs", "std::env"];

fn layer(name: &str) -> Option<usize> {
    LAYERS.iter().position(|layer| layer.split(' ').any(|crate_name| crate_name == name))
}

/// Crates of the workspace that a package uses outside of its tests.
fn dependencies(package: &Package) -> impl Iterator<Item = &str> {
    let tables = ["dependencies", "build-dependencies"].into_iter().filter_map(|kind| package.manifest.get(kind));
    tables.filter_map(toml::Value::as_table).flatten().filter_map(|(name, _)| name.strip_prefix("crumple-"))
}

pub fn broken(packages: &[Package]) -> Vec<String> {
    let mut broken = Vec::new();
    for package in packages {
        let name = package.name.as_str();
        let Some(own) = layer(name) else {
            broken.push(format!("crate {name} has no layer: add it to LAYERS of {} and to ARCHITECTURE.md", file!()));
            continue;
        };
        for used in dependencies(package).filter(|used| layer(used).is_none_or(|layer| layer >= own)) {
            broken.push(format!("crates/{name}/Cargo.toml: {name} uses {used}, which is in no lower layer"));
        }
        let is_outer = |path: &str| OUTER.iter().any(|outer| format!("{path}::").starts_with(&format!("{outer}::")));
        for named in uses(package).iter().filter(|_| NUMERICS.split(' ').any(|numerics| numerics == name)) {
            let path = named.path.join("::");
            if is_outer(&path) {
                broken.push(format!("{}: {path} in a library of numerics: do it in the stage", named.place));
            }
        }
    }
    broken
}
