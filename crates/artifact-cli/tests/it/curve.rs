//! The command `curve`: force-deflection curves of a candidate.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crumple_artifact::records::{CandidateV1, ConcernV1, ConcernsV2, EventsV1, NotesV1, RecommendationV1, SeverityV1};
use crumple_artifact::{ArtifactBuilder, Compression, Provenance};

fn candidate(model: &str, parameters: &[(&str, f64)]) -> CandidateV1 {
    CandidateV1 {
        model: model.to_owned(),
        method: "direct-fit".to_owned(),
        parameters: parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
        physical: true,
        equivalent_to: None,
        fit: None,
        uncertainty: None,
        notes: Vec::new(),
        ..CandidateV1::default()
    }
}

fn artifact(folder: &Path, recommended: Option<&str>) -> PathBuf {
    let mut builder = ArtifactBuilder::new();
    let curve = [
        ("mass_kg", 1500.0),
        ("knot1_m", 0.1),
        ("knot1_n", 2e5),
        ("knot2_m", 0.5),
        ("knot2_n", 3e5),
        ("unloading_stiffness_n_per_m", 2e7),
        ("rate_s_per_m", 0.004),
    ];
    builder.put("/parameters/force-deflection/direct-fit/1", &candidate("force-deflection", &curve)).unwrap();
    let kelvin = [("mass_kg", 1500.0), ("stiffness_n_per_m", 6e5), ("damping_n_s_per_m", 1e3)];
    builder.put("/parameters/kelvin/direct-fit/1", &candidate("kelvin", &kelvin)).unwrap();
    let maxwell = [("mass_kg", 1500.0), ("stiffness_n_per_m", 6e5), ("damping_n_s_per_m", 1e4)];
    builder.put("/parameters/maxwell/direct-fit/1", &candidate("maxwell", &maxwell)).unwrap();
    let choice = RecommendationV1 { recommended: recommended.map(str::to_owned), ..RecommendationV1::default() };
    builder.put("/recommendation", &choice).unwrap();
    let path = folder.join("5-parameter-solve.mcap");
    let provenance = Provenance::new("parameter-solve", "0", "{}".to_owned(), vec![]);
    builder.write(&path, &provenance, Compression::None).unwrap();
    path
}

fn curve(artifact: &Path, flags: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-artifact")).arg("curve").arg(artifact).args(flags).output().unwrap()
}

fn printed(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

#[test]
fn the_recommended_curve_is_written_and_goes_on_with_its_trend() {
    let folder = tempfile::tempdir().unwrap();
    let artifact = artifact(folder.path(), Some("force-deflection/direct-fit/1"));
    let text = printed(&curve(&artifact, &[]));
    assert!(text.starts_with("# force-deflection/direct-fit/1, element 1 between the wall and mass 1\n"), "{text}");
    assert!(text.ends_with("deflection (m),static force (N)\n0,0\n0.1,200000\n0.5,300000\n"), "{text}");
    // From 0.1 to 0.5 m a line, 250 kN in the middle and 50 kN more at the end; usual are 125 kN more.
    let beyond = printed(&curve(&artifact, &["--to", "0.75m"]));
    let force: f64 = beyond.lines().last().unwrap().strip_prefix("0.75,").unwrap().parse().unwrap();
    assert!((force / 430e3 - 1.0).abs() < 1e-12, "{force}");
    assert!(printed(&curve(&artifact, &["--format", "pc-crash"])).ends_with("0.500000\t300.000000\n"));
    let spring = ["--candidate", "kelvin/direct-fit/1", "--to", "0.5m"];
    assert!(printed(&curve(&artifact, &spring)).ends_with("0,0\n0.5,300000\n"));
}

#[test]
fn a_curve_without_knots_ends_at_the_crush_of_the_test() {
    let folder = tempfile::tempdir().unwrap();
    artifact(folder.path(), Some("kelvin/direct-fit/1"));
    let mut builder = ArtifactBuilder::new();
    let events = EventsV1 { dynamic_crush_m: Some(0.75), ..EventsV1::default() };
    builder.put("/events", &events).unwrap();
    let provenance = Provenance::new("integrate", "0", "{}".to_owned(), vec![]);
    builder.write(&folder.path().join("3-integrate.mcap"), &provenance, Compression::None).unwrap();
    assert!(printed(&curve(folder.path(), &[])).ends_with("0,0\n0.75,450000\n"));
    assert!(printed(&curve(folder.path(), &["--to", "0.5m"])).ends_with("0,0\n0.5,300000\n"));
    let knots = ["--candidate", "force-deflection/direct-fit/1"];
    assert!(printed(&curve(folder.path(), &knots)).ends_with("0.5,300000\n"));
}

#[test]
fn what_has_no_curve_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let artifact = artifact(folder.path(), None);
    for (flags, said) in [
        (&[][..], "no candidate is recommended here; candidates: force-deflection/direct-fit/1, kelvin/direct-fit/1"),
        (&["--candidate", "kelvin"], "there is no candidate \"kelvin\""),
        (&["--candidate", "kelvin/direct-fit/1"], "--to 900mm"),
        (&["--candidate", "maxwell/direct-fit/1", "--to", "900mm"], "no element whose force depends on the deflection"),
    ] {
        let output = curve(&artifact, flags);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{stderr}");
        assert!(stderr.contains(said), "{stderr}");
    }
    assert_eq!(curve(&artifact, &["--to", "0m"]).status.code(), Some(2));
    let other = folder.path().join("3-integrate.mcap");
    let provenance = Provenance::new("integrate", "0", "{}".to_owned(), vec![]);
    let mut builder = ArtifactBuilder::new();
    builder.put("/notes", &NotesV1 { stage: "integrate".to_owned(), notes: Vec::new() }).unwrap();
    builder.write(&other, &provenance, Compression::None).unwrap();
    let output = curve(&other, &[]);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("no candidates here") && stderr.contains("5-parameter-solve.mcap of a run"), "{stderr}");
}

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
    assert_eq!(ranked[0], "none    9  report           nothing [CR900]");
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
