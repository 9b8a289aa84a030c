//! The program on identified models, on a paper's printed numbers, and on a vehicle that never stops.

use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{CandidateV1, EvidenceV1, MatchingV1, NotesV1, TestV1, TransferFunctionV1};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_lumped::{CrushEvents, DoubleSpringMassDamper, Maxwell, Model};
use crumple_numerics::estimation::statistics::NORMAL_95;
use crumple_signal::TestDescription;
use crumple_testkit::integrated;

const MATCHING: [&str; 4] = ["--models", "double-spring-mass-damper", "--method", "coefficient-matching"];
const ID: &str = "/parameters/double-spring-mass-damper/coefficient-matching";

fn candidate(artifact: &Artifact, number: usize) -> Option<CandidateV1> {
    artifact.record(&format!("{ID}/{number}")).unwrap()
}

fn notes(artifact: &Artifact) -> String {
    let notes: Option<NotesV1> = artifact.record("/notes").unwrap();
    notes.map_or_else(String::new, |notes| format!("{notes:?}"))
}

#[test]
fn the_solutions_that_the_transfer_function_paper_lists_need_no_model_and_are_labelled() {
    let folder = tempfile::tempdir().unwrap();
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &TestV1::from(&TestDescription { title: "any".to_owned(), ..Default::default() })).unwrap();
    write(&builder, &folder.path().join("3.mcap"));
    let solved = solved(folder.path(), &[&MATCHING[..], &["--paper", "tfest"]].concat());
    let all: Vec<CandidateV1> = (1..=4).map(|k| candidate(&solved, k).unwrap()).collect();
    assert!(candidate(&solved, 5).is_none());
    // The printed c1 of all four, cut after the last digit printed.
    for printed in [34_435.783, -24_275.563, -3_091.65, 43_732.53] {
        assert!(all.iter().any(|c| (c.parameters["c1_n_s_per_m"] - printed).abs() < 0.0101), "{printed}");
    }
    assert!(all.iter().all(|c| !c.physical && c.notes.iter().any(|note| note.starts_with("for reproduction only"))));
    let split: MatchingV1 = solved.record("/matching/tfest-paper/one-fifth-in-front").unwrap().unwrap();
    assert_eq!((split.solutions.len(), split.m1_kg, split.m2_kg), (6, 284.4, 1137.6));
    assert!(solved.record::<MatchingV1>("/matching/tfest-paper/four-fifths-in-front").unwrap().is_some());
    assert!(notes(&solved).contains("not of this test"));
    // Another paper has no such numbers.
    let output = run(folder.path(), &["--paper", "tfset"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("'tfest'"));
}

/// Evidence of an identification with this covariance, or these deviations.
fn evidence(covariance: Vec<Vec<f64>>, deviations: Vec<f64>) -> EvidenceV1 {
    let empty = serde_json::json!([]);
    let mut value = serde_json::json!({
        "output": "displacement", "initial_conditions": "zero", "parameters": 4, "effective_samples": 100.0,
        "denominator_covariance": covariance, "denominator_deviations": deviations,
    });
    for name in [
        "losses",
        "numerator_deviations",
        "frequency_deviations",
        "damping_deviations",
        "zeros_re_per_s",
        "zeros_im_rad_per_s",
        "singular_value_errors",
        "parameter_names",
        "parameter_values",
        "parameter_deviations",
        "parameter_correlations",
        "zero_re_deviations",
        "zero_im_deviations",
        "frequency_spreads",
        "damping_spreads",
        "zero_re_spreads",
        "zero_im_spreads",
        "parameter_names",
        "parameter_values",
        "parameter_deviations",
        "parameter_correlations",
    ] {
        value[name] = empty.clone();
    }
    serde_json::from_value(value).unwrap()
}

#[test]
fn matched_springs_carry_the_deviations_of_the_identified_coefficients_and_a_delay_is_named() {
    let truth = DoubleSpringMassDamper {
        m1_kg: 300.0,
        m2_kg: 900.0,
        k1_n_per_m: 4e5,
        k2_n_per_m: 6e5,
        c1_n_s_per_m: 4e3,
        c2_n_s_per_m: 6e3,
    };
    let polynomial = truth.characteristic_polynomial();
    let deviations: Vec<f64> = polynomial[1..].iter().map(|c| 1e-4 * c).collect();
    let covariance: Vec<Vec<f64>> =
        (0..4).map(|i| (0..4).map(|j| if i == j { deviations[i].powi(2) } else { 0.0 }).collect()).collect();
    let solved = |covariance: Vec<Vec<f64>>, deviations: Vec<f64>| {
        let folder = tempfile::tempdir().unwrap();
        let mut builder = ArtifactBuilder::new();
        let model = TransferFunctionV1 {
            numerator: vec![1.0],
            denominator: polynomial.to_vec(),
            input: "force".to_owned(),
            output: "displacement".to_owned(),
            delay_s: Some(2e-3),
        };
        builder.put("/model/tfest-4-0/transfer-function", &model).unwrap();
        builder.put("/evidence/tfest-4-0", &evidence(covariance, deviations)).unwrap();
        write(&builder, &folder.path().join("3.mcap"));
        let artifact = solved(folder.path(), &[&MATCHING[..], &["--m1", "300kg", "--m2", "900kg"]].concat());
        assert!(notes(&artifact).contains("a delay of 2.000 ms"));
        candidate(&artifact, 1).unwrap()
    };
    let known = solved(covariance, deviations.clone());
    let uncertainty = known.uncertainty.unwrap();
    assert!(uncertainty.method.contains("covariance of the identified coefficients"), "{}", uncertainty.method);
    for name in ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"] {
        let (value, deviation) = (known.parameters[name], uncertainty.standard_deviation[name]);
        assert!(deviation > 0.0);
        // Log-normal, 1.96 relative deviations.
        let low = uncertainty.interval_low[name].unwrap();
        assert!((low / value - (-NORMAL_95 * deviation / value).exp()).abs() < 1e-12, "{name}");
    }
    // The covariance is that of the deviations: the same numbers, another label.
    let assumed = solved(Vec::new(), deviations).uncertainty.unwrap();
    assert!(assumed.method.contains("taken as independent"), "{}", assumed.method);
    for (name, deviation) in &assumed.standard_deviation {
        assert!((deviation / uncertainty.standard_deviation[name] - 1.0).abs() < 1e-12);
    }
    assert!(solved(Vec::new(), Vec::new()).uncertainty.is_none());
}

#[test]
fn a_vehicle_that_never_stops_is_judged_over_the_window_of_its_fits() {
    // Two real roots: it creeps to rest.
    let creeping = Maxwell { mass_kg: 873.0, stiffness_n_per_m: 3e6, damping_n_s_per_m: 2e4 };
    let folder = tempfile::tempdir().unwrap();
    let builder = integrated(&Model::Maxwell(creeping), Some(873.0), &CrushEvents::default(), None).unwrap();
    write(&builder, &folder.path().join("3.mcap"));
    let flags = ["--models", "elastoplastic,maxwell,nonlinear-1", "--mass-uncertainty", "10kg"];
    let solved = solved(folder.path(), &flags);
    let maxwell: CandidateV1 = solved.record("/parameters/maxwell/direct-fit/1").unwrap().unwrap();
    let uncertainty = maxwell.uncertainty.unwrap();
    assert!(uncertainty.rank == Some(2) && uncertainty.weakest_direction.is_some());
    for (name, truth) in [("stiffness_n_per_m", 3e6), ("damping_n_s_per_m", 2e4)] {
        let (low, high) = (uncertainty.interval_low[name].unwrap(), uncertainty.interval_high[name].unwrap());
        assert!(low <= truth && truth <= high, "{name}: {low} {high}");
    }
    let propagation = uncertainty.propagation.unwrap();
    assert_eq!(propagation.method, "fit repeated with mass, impact speed, zero level and time zero drawn again");
    let notes = notes(&solved);
    assert!(notes.contains("does not stop within the record"));
    let bound = "warning: elastoplastic/closed-form/1: parameters at a search limit, not identifiable from this \
        record: unloading stiffness";
    assert!(notes.contains(bound), "{notes}");
}

/// Writes an artifact as integration does.
pub fn write(builder: &ArtifactBuilder, path: &Path) {
    let provenance = Provenance::new("integrate", "0", "{}".to_owned(), Vec::new());
    builder.write(path, &provenance, Compression::None).unwrap();
}

pub fn run(folder: &Path, flags: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-parameter-solve"))
        .args([folder.join("3.mcap").as_os_str(), "-o".as_ref(), folder.join("5.mcap").as_os_str()])
        .args(flags)
        .output()
        .unwrap()
}

pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What a run that is done wrote.
pub fn result(folder: &Path, output: &Output) -> Artifact {
    assert_eq!(output.status.code(), Some(0), "{}", said(output));
    Artifact::open(&folder.join("5.mcap")).unwrap()
}

/// The result of [`run`].
pub fn solved(folder: &Path, flags: &[&str]) -> Artifact {
    result(folder, &run(folder, flags))
}
