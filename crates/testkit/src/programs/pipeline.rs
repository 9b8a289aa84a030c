//! Runs the programs as a user does: through `just`, or one stage at a time.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Once;

use crate::places::workspace;

/// Path of a program, e.g. `crumple-filter`, in the profile that `CRUMPLE_PROFILE` names as the justfile reads it;
/// everything is built first (a no-op once built).
pub fn binary(name: &str) -> PathBuf {
    static BUILT: Once = Once::new();
    BUILT.call_once(|| {
        let output = just().arg("build").output().expect("just is installed (scripts/setup.sh)");
        assert!(output.status.success(), "just build: {}", String::from_utf8_lossy(&output.stderr));
    });
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace().join("target"), PathBuf::from);
    let is_dev = std::env::var("CRUMPLE_PROFILE").is_ok_and(|profile| profile == "dev");
    target.join(if is_dev { "debug" } else { "release" }).join(name)
}

/// `just` in the workspace.
pub fn just() -> Command {
    let mut command = Command::new("just");
    command.current_dir(workspace()).arg("--justfile").arg(workspace().join("justfile"));
    command
}

/// `just <variables> out=<folder> run <input> <args>`.
pub fn run(variables: &[&str], folder: &Path, input: &Path, args: &[&str]) -> Output {
    just()
        .args(variables)
        .arg(format!("out={}", folder.display()))
        .arg("run")
        .arg(input)
        .args(args)
        .output()
        .expect("just is installed (scripts/setup.sh)")
}

/// The same, and it must succeed; returns `summary.json`.
pub fn summary_of(variables: &[&str], folder: &Path, input: &Path, args: &[&str]) -> serde_json::Value {
    let output = run(variables, folder, input, args);
    assert!(output.status.success(), "{}: {}", input.display(), String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(folder.join("summary.json")).expect("summary.json is written");
    serde_json::from_str(&text).expect("summary.json is JSON")
}

/// Exit code and standard error of a command.
pub fn code_and_error(command: &mut Command) -> (i32, String) {
    let output = command.output().expect("the binary starts");
    (output.status.code().unwrap_or(-1), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A number inside a JSON value by a path of keys, e.g. `["events", "dynamic_crush_m"]`.
pub fn number(value: &serde_json::Value, path: &[&str]) -> f64 {
    let number = path.iter().fold(value, |v, key| &v[*key]);
    number.as_f64().unwrap_or_else(|| panic!("{path:?} is {number}, a number is needed"))
}

/// The names of a run folder's artifacts in order.
pub const ARTIFACTS: [&str; 7] = [
    "1-ingest.mcap",
    "2-filter.mcap",
    "3-integrate.mcap",
    "4-identify.mcap",
    "5-parameter-solve.mcap",
    "6-simulate.mcap",
    "7-predict.mcap",
];
