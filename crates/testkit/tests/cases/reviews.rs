//! What a person types to accept results and to compare with them: each case is a script in a folder of its own, with
//! `FIXTURES` and `PYTHON`; its last exit code and its words are compared.

use std::path::{Path, PathBuf};
use std::process::Command;

use crumple_testkit::programs::binary;
use crumple_testkit::workspace;
use serde_json::Value;

use crate::Check;
use crate::expected::said;
use crate::records::Answer;

/// What of a case is not met; the files of the cases lie beside theirs.
pub fn check(file: Value) -> Check {
    let folder = PathBuf::from(file["folder"].as_str().unwrap_or("."));
    Box::new(move |case| {
        let here = folder.join(case["file"].as_str().unwrap());
        let answer = typed(case["script"].as_str().unwrap(), here.parent().unwrap());
        let expected = &case["expect"];
        let is_right = expected["exit"].as_array().unwrap().iter().any(|right| *right == answer.code);
        let wrong = (!is_right).then(|| format!("exit {}: {}", answer.code, answer.said));
        wrong.into_iter().chain(said(expected, &answer.said)).collect()
    })
}

/// Runs a script in an empty folder, with the programs in its path; what it leaves in `o/summary.json` counts.
pub fn typed(script: &str, here: &Path) -> Answer {
    let programs = binary("crumple").parent().map(PathBuf::from).unwrap();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(programs).chain(std::env::split_paths(&path))).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut shell = Command::new("sh");
    shell.args(["-c", script]).current_dir(folder.path()).env("PATH", path).env("HERE", here);
    let output = shell.env("FIXTURES", workspace().join("fixtures")).env("PYTHON", "python3").output().unwrap();
    let summary = std::fs::read(folder.path().join("o/summary.json")).ok();
    Answer {
        code: output.status.code().map_or(-1, i64::from),
        said: String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned(),
        summary: summary.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default(),
        ..Answer::default()
    }
}
