//! The notes of artifacts and runs alone.

use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{ConcernV1, ConcernsV2, NotesV1, SeverityV1};
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};

fn write(folder: &Path, name: &str, stage: &str, notes: &[&str], concerns: Vec<ConcernV1>) {
    let mut builder = ArtifactBuilder::new();
    let notes = notes.iter().map(|text| (*text).to_owned()).collect();
    builder.put("/notes", &NotesV1 { stage: stage.to_owned(), notes }).unwrap();
    if !concerns.is_empty() {
        builder.put("/concerns", &ConcernsV2 { concerns }).unwrap();
    }
    let provenance = Provenance::new(stage, "0.1.0", "{}".to_owned(), vec![]);
    builder.write(&folder.join(name), &provenance, Compression::None).unwrap();
}

fn notes(path: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-artifact")).arg("notes").arg(path).output().unwrap()
}

fn lines(path: &Path) -> Vec<String> {
    let output = notes(path);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
}

fn concern(stage: &str, weight: u8, text: &str) -> ConcernV1 {
    ConcernV1 {
        stage: stage.to_owned(),
        severity: SeverityV1::Warning,
        about: "pulse".to_owned(),
        weight,
        text: text.to_owned(),
        remedy: None,
    }
}

#[test]
fn warnings_stand_by_weight_and_one_that_nobody_weighed_last() {
    let folder = tempfile::tempdir().unwrap();
    let warnings = ["good to know", "warning: drift", "warning: wrong sign"];
    write(folder.path(), "1-ingest.mcap", "ingest", &warnings, vec![concern("ingest", 3, "wrong sign")]);
    write(folder.path(), "2-filter.mcap", "filter", &["warning: causal"], vec![concern("filter", 2, "causal")]);
    let expected = [
        "warning 3  ingest           wrong sign",
        "warning 2  filter           causal",
        "warning 1  ingest           drift",
        "note       ingest           good to know",
    ];
    assert_eq!(lines(folder.path()), expected);
    assert_eq!(lines(&folder.path().join("2-filter.mcap")), expected[1..2]);

    // The summary of a run weighs them by what it shows.
    let summary = r#"{"concerns": [{"stage": "report", "severity": "no-result", "about": "motion", "weight": 9,
        "text": "nothing", "remedy": "try again"}]}"#;
    std::fs::write(folder.path().join("summary.json"), summary).unwrap();
    let ranked = lines(folder.path());
    assert_eq!(ranked[0], "none    9  report           nothing");
    assert_eq!(ranked[1].trim_start(), "what to do: try again");
    assert_eq!(ranked[2], "note       ingest           good to know");
}

#[test]
fn a_folder_without_artifacts_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = notes(folder.path());
    assert_eq!(output.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&output.stderr).contains("holds no artifact"));
}
