//! What a person types to accept results and to compare with them: each case is a script in a folder of its own, with
//! `FIXTURES` and `PYTHON`; its last exit code and its words are compared.

use std::path::PathBuf;
use std::process::Command;

use crumple_testkit::programs::binary;
use crumple_testkit::workspace;
use serde_json::Value;

use crate::Check;
use crate::records::said;

/// What of a case is not met.
pub fn check(_: Value) -> Check {
    let programs = binary("crumple").parent().map(PathBuf::from).unwrap();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = std::env::join_paths(std::iter::once(programs).chain(std::env::split_paths(&path))).unwrap();
    Box::new(move |case| {
        let folder = tempfile::tempdir().unwrap();
        let mut script = Command::new("sh");
        script.args(["-c", case["script"].as_str().unwrap()]).current_dir(folder.path()).env("PATH", &path);
        let output = script.env("FIXTURES", workspace().join("fixtures")).env("PYTHON", "python3").output().unwrap();
        let text = String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned();
        let expected = &case["expect"];
        let code = output.status.code().map_or(-1, i64::from);
        let is_right = expected["exit"].as_array().unwrap().iter().any(|right| right == code);
        let wrong = (!is_right).then(|| format!("exit {code}: {text}"));
        wrong.into_iter().chain(said(expected, &text)).collect()
    })
}
