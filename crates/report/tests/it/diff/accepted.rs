//! Several records beside what was accepted: each is told, whatever becomes of the others.

use std::ffi::OsString;
use std::fs;
use std::path::Path;

use crumple_stage::{Call, ExitStatus, Way};

use super::cli::run_of;
use super::{Outcome, diff};

/// A run of this crush below `runs/`.
fn run(root: &Path, folder: &str, crush: f64) {
    let folder = root.join("runs").join(folder);
    fs::create_dir_all(folder.parent().unwrap()).unwrap();
    _ = fs::remove_dir_all(&folder);
    run_of(&folder, 2.0);
    let number = serde_json::json!({"name": "dynamic_crush", "value": crush, "unit": "m"});
    let summary = serde_json::json!({"schema": "crumple.summary.v1", "key_numbers": [number],
        "verdict": {"status": "usable"}});
    fs::write(folder.join("summary.json"), summary.to_string()).unwrap();
    fs::write(folder.join("0-pipeline.toml"), "[run]\nname = \"default\"\n").unwrap();
}

/// The last run into the folder was refused.
fn refuse(root: &Path, folder: &str) {
    let noted = "[run]\nname = \"default\"\nstate = \"failed\"\nexit_code = 3\n";
    fs::write(root.join("runs").join(folder).join("0-pipeline.toml"), noted).unwrap();
}

fn accept(root: &Path, folders: &[&str]) -> ExitStatus {
    let folders = folders.iter().map(|folder| root.join(folder).into_os_string());
    let into = [OsString::from("--into"), root.join("expected").into_os_string()];
    let words = folders.chain(into).collect();
    (crumple_report::ACCEPT.run)(&Call { program: "crumple accept".to_owned(), words, way: Way::Within })
}

fn compare(root: &Path) -> (Outcome, String, String) {
    let files = ["--engineering", "--markdown", "r.md", "--junit", "r.xml"];
    let outcome = diff(root, &[&["expected", "runs"], &files[..]].concat());
    let text = |name: &str| fs::read_to_string(root.join(name)).unwrap_or_default();
    (outcome, text("r.md"), text("r.xml"))
}

#[test]
fn every_record_is_told_whatever_becomes_of_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    for name in ["changed", "damaged", "gone", "refused", "same"] {
        run(root, &format!("{name}/default"), 0.75);
    }
    assert_eq!(accept(root, &["runs"]), ExitStatus::Done);
    let (outcome, text, _) = compare(root);
    assert_eq!(outcome.code, 0, "{}", outcome.stdout);
    assert!(text.contains("The same within the limits: changed, damaged, gone, refused, same."), "{text}");
    run(root, "changed/default", 0.80);
    fs::write(root.join("runs/damaged/default/5-parameter-solve.mcap"), "cut").unwrap();
    fs::remove_dir_all(root.join("runs/gone")).unwrap();
    refuse(root, "refused/default");
    run(root, "new/default", 0.75);
    let (outcome, text, junit) = compare(root);
    assert_eq!(outcome.code, 2, "{}", outcome.stdout);
    for words in ["damaged: unreadable: ", "gone: missing: ", "refused: refused: ", "new: never accepted: "] {
        assert!(outcome.stdout.contains(words), "{}", outcome.stdout);
    }
    assert!(outcome.stderr.contains("exit code 3: its results are of an earlier run"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("\n  hint: "), "{}", outcome.stderr);
    assert!(text.contains("### 4 of 6 records not compared") && text.contains("### Record changed"), "{text}");
    assert!(text.contains("The same within the limits: same."), "{text}");
    assert_eq!((junit.matches("<error ").count(), junit.matches("type=\"refused\"").count()), (3, 1), "{junit}");
    // A refused record, and nothing is accepted.
    let before = fs::read_to_string(root.join("expected/changed.json")).unwrap();
    assert_eq!(accept(root, &["runs"]), ExitStatus::Usage);
    assert_eq!(fs::read_to_string(root.join("expected/changed.json")).unwrap(), before);
    assert!(!root.join("expected/new.json").exists());
}

#[test]
fn a_record_in_a_fleet_and_by_itself_is_refused_with_both_folders() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    run(root, "car/default", 0.75);
    assert_eq!(accept(root, &["runs"]), ExitStatus::Done);
    run(root, "fleet/tests/runs/car/default", 0.80);
    let (outcome, _, _) = compare(root);
    let said = outcome.stderr.replace('\\', "/");
    assert_eq!(outcome.code, 2, "{said}");
    assert!(said.contains("runs/car/default and runs/fleet/tests/runs/car/default are both"), "{said}");
    assert_eq!(accept(root, &["runs"]), ExitStatus::Usage);
    assert_eq!(accept(root, &["runs/car", "runs/fleet"]), ExitStatus::Usage);
    // One of both by its folder.
    let outcome = diff(root, &["expected", "runs/fleet/tests", "--engineering"]);
    assert_eq!(outcome.code, 1, "{}{}", outcome.stdout, outcome.stderr);
    // The same folder twice is one.
    assert_eq!(accept(root, &["runs/fleet", "runs/fleet/tests/runs/car/default"]), ExitStatus::Done);
}

#[test]
fn a_file_of_an_earlier_version_is_read_and_what_it_lacks_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    run(root, "car/default", 0.75);
    assert_eq!(accept(root, &["runs"]), ExitStatus::Done);
    let path = root.join("expected/car.json");
    let mut kept: serde_json::Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    kept["schema"] = "crumple.expected.v1".into();
    kept.as_object_mut().unwrap().remove("options");
    kept["summary"]["verdict"] = serde_json::json!({"kind": "measured-only", "status": null});
    fs::write(&path, kept.to_string()).unwrap();
    let (outcome, text, _) = compare(root);
    assert_eq!(outcome.code, 0, "{}", outcome.stdout);
    assert!(outcome.stdout.contains("accepted by an earlier version, so not compared: status"), "{}", outcome.stdout);
    assert!(text.contains("so not compared"), "{text}");
    run(root, "car/default", 0.80);
    assert_eq!(compare(root).0.code, 1);
}
