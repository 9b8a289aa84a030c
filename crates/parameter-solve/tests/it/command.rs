//! The program on small artifacts: exit codes and what is written.

use std::path::Path;

use crumple_artifact::records::{
    CandidateV1, DiagnosisV1, EventsV1, ExponentialSumV1, ExponentialTermV1, MatchingV1, StateSpaceV1, TestV1,
    TransferFunctionV1,
};
use crumple_artifact::{Artifact, ArtifactBuilder, Compression, Provenance};
use crumple_lumped::{CrushEvents, DoubleSpringMassDamper, Kelvin, Model};
use crumple_signal::{QuantityKind, Sampled};
use crumple_testkit::{IMPACT_SPEED_M_PER_S, integrated};

use crate::command_models::{run, said, solved, write};

fn kelvin() -> Kelvin {
    Kelvin { mass_kg: 873.0, stiffness_n_per_m: 330_000.0, damping_n_s_per_m: 2_500.0 }
}

/// The artifact integration would write for a car with these events.
fn write_integrated(path: &Path, mass_kg: Option<f64>, stops: bool) {
    let (events, end) = match stops {
        true => (kelvin().events(IMPACT_SPEED_M_PER_S), None),
        false => (CrushEvents::default(), Some(0.06)),
    };
    let builder = integrated(&Model::Kelvin(kelvin()), mass_kg, &events, end).unwrap();
    write(&builder, path);
}

#[test]
fn exact_events_become_exact_parameters_in_the_artifact() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), true);
    let artifact = solved(folder.path(), &["--models", "kelvin"]);
    let candidate: CandidateV1 = artifact.record("/parameters/kelvin/closed-form/1").unwrap().unwrap();
    // Rounding amplified by 1/0.59 twice.
    assert!((candidate.parameters["stiffness_n_per_m"] / 330_000.0 - 1.0).abs() < 1e-13);
    assert!((candidate.parameters["damping_n_s_per_m"] / 2_500.0 - 1.0).abs() < 1e-12);
    assert!(candidate.physical && candidate.fit.is_none());
    assert!(artifact.record::<TestV1>("/test").unwrap().is_some());
}

#[test]
fn a_missing_mass_is_named_in_the_diagnosis_and_a_flag_supplies_it() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), None, true);
    let output = run(folder.path(), &[]);
    let stderr = said(&output);
    assert_eq!(output.status.code(), Some(4), "{stderr}");
    assert!(stderr.contains("the test has no mass") && stderr.contains("--mass 873kg"), "{stderr}");
    let written = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    assert!(written.record::<DiagnosisV1>("/diagnosis").unwrap().is_some());
    assert_eq!(run(folder.path(), &["--mass", "873kg", "--models", "kelvin"]).status.code(), Some(0));
}

#[test]
fn no_candidate_at_all_is_exit_4_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), false);
    let output = run(folder.path(), &["--models", "kelvin", "--method", "closed-form"]);
    let stderr = said(&output);
    assert_eq!(output.status.code(), Some(4), "{stderr}");
    assert!(stderr.contains("never reaches zero"), "{stderr}");
    // The diagnosis is written.
    assert!(Artifact::open(&folder.path().join("5.mcap")).is_ok());
}

#[test]
fn a_mistyped_method_is_a_usage_error_with_the_nearest_name() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), true);
    let output = run(folder.path(), &["--method", "direct-fti"]);
    let stderr = said(&output);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("'direct-fit'"), "{stderr}");
}

#[test]
fn a_window_outside_the_record_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), true);
    let output = run(folder.path(), &["--fit-to", "2s"]);
    let stderr = said(&output);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("0.150000 s after time zero"), "{stderr}");
}

#[test]
fn closed_forms_need_the_events_only_and_are_exact() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("with-wave.mcap"), Some(873.0), true);
    let full = Artifact::open(&folder.path().join("with-wave.mcap")).unwrap();
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &full.record::<TestV1>("/test").unwrap().unwrap()).unwrap();
    builder.put("/events", &full.record::<EventsV1>("/events").unwrap().unwrap()).unwrap();
    let provenance = Provenance::new("by hand", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.path().join("3.mcap"), &provenance, Compression::None).unwrap();

    assert_eq!(run(folder.path(), &["--models", "kelvin", "--method", "closed-form"]).status.code(), Some(0));
    let solved = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let candidate: CandidateV1 = solved.record("/parameters/kelvin/closed-form/1").unwrap().unwrap();
    // The inversion is a closed form with one bracketed root: rounding only.
    for (name, expected) in [("stiffness_n_per_m", 330_000.0), ("damping_n_s_per_m", 2_500.0)] {
        let found = candidate.parameters[name];
        assert!((found / expected - 1.0).abs() < 1e-9, "{name}: {found}");
    }

    // A fit needs the displacement, and says who writes it.
    let output = run(folder.path(), &[]);
    let error = said(&output);
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert!(error.contains("/wave/a/displacement") && error.contains("crumple-integrate"), "{error}");
}

#[test]
fn a_typed_transfer_function_is_matched_with_every_solution_and_no_test_is_needed() {
    let folder = tempfile::tempdir().unwrap();
    let mut builder = ArtifactBuilder::new();
    let model = TransferFunctionV1 {
        numerator: vec![-76.15, 466.2],
        denominator: vec![1.0, 35.7, 6024.0, 185_000.0, 414_600.0],
        input: "force".to_owned(),
        output: "displacement".to_owned(),
        delay_s: None,
    };
    builder.put("/model/civic", &model).unwrap();
    let provenance = Provenance::new("by hand", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.path().join("3.mcap"), &provenance, Compression::None).unwrap();
    let flags = ["--models", "double-spring-mass-damper", "--method", "coefficient-matching"];
    let solved = solved(folder.path(), &[&flags[..], &["--m1", "284.4kg", "--m2", "1137.6kg"]].concat());
    let matching: MatchingV1 = solved.record("/matching/civic").unwrap().unwrap();
    assert_eq!((matching.solutions.len(), matching.roots.len()), (6, 3));
    assert!((matching.largest_mass_ratio.unwrap() - 0.14703).abs() < 5e-6);
    let id = "double-spring-mass-damper/coefficient-matching";
    let first: CandidateV1 = solved.record(&format!("/parameters/{id}/1")).unwrap().unwrap();
    // The value of the identification reference, six decimals.
    assert!((first.parameters["c1_n_s_per_m"] - 34434.205385).abs() < 1e-6);
    assert!(!first.physical && first.equivalent_to == Some(format!("{id}/2")));
    assert_eq!(matching.solutions[1].candidate, Some(format!("{id}/2")));
    assert!(first.notes.iter().any(|note| note.contains("0.14703")), "{:?}", first.notes);
    assert!(first.notes.iter().any(|note| note.contains("6.1221") && note.contains("not consistent")));
    assert!(solved.record::<CandidateV1>(&format!("/parameters/{id}/3")).unwrap().is_none());
    // Masses have to be said.
    let output = run(folder.path(), &flags);
    assert_eq!(output.status.code(), Some(3));
    assert!(said(&output).contains("--m1 284.4kg"));
}

#[test]
fn a_state_space_of_both_masses_is_transformed_to_physical_coordinates_and_names_the_right_set() {
    let folder = tempfile::tempdir().unwrap();
    let truth = DoubleSpringMassDamper {
        m1_kg: 300.0,
        m2_kg: 900.0,
        k1_n_per_m: 4e5,
        k2_n_per_m: 6e5,
        c1_n_s_per_m: 9e3,
        c2_n_s_per_m: 2e4,
    };
    let a = truth.state_matrix();
    let rows: Vec<Vec<f64>> = a.row_iter().map(|row| row.iter().copied().collect()).collect();
    let mut builder = ArtifactBuilder::new();
    let model = StateSpaceV1 {
        c: vec![rows[2].clone(), rows[3].clone()],
        a: rows,
        b: vec![vec![0.0], vec![0.0], vec![12.0], vec![12.0]],
        d: vec![vec![0.0], vec![0.0]],
        sample_time_s: 0.0,
        input: "unit impulse".to_owned(),
        output: "acceleration of engine and compartment, m/s^2".to_owned(),
        delay_s: None,
    };
    builder.put("/model/both", &model).unwrap();
    let provenance = Provenance::new("identify", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.path().join("3.mcap"), &provenance, Compression::None).unwrap();
    let flags =
        ["--models", "double-spring-mass-damper", "--method", "coefficient-matching", "--m1", "300kg", "--m2", "900kg"];
    let artifact = solved(folder.path(), &flags);
    let matching: MatchingV1 = artifact.record("/matching/both").unwrap().unwrap();
    assert_eq!(matching.source.as_deref(), Some("eigenvalues of the state matrix of"));
    // c1 c2/(m1 m2) = 666.67 from the jerk at contact: a few roundings through the inverse of A.
    assert!((matching.zeta_of_the_start_per_s2.unwrap() - 1.8e8 / 2.7e5).abs() < 1e-8);
    let best = |c: &&crumple_artifact::records::PhysicalCoordinatesV1| c.chassis_mismatch.unwrap();
    let right = matching.coordinates.iter().min_by(|a, b| best(a).total_cmp(&best(b))).unwrap();
    assert!(right.chassis_mismatch.unwrap() < 1e-8 && (right.stiffness_n_per_m[0][0] / 1e6 - 1.0).abs() < 1e-9);
    assert!(
        matching.coordinates.iter().filter(|c| c.chassis_mismatch.unwrap() > 1e-3).count() >= 1,
        "its dual at least"
    );
    // One candidate more, from both rows and the total mass alone.
    let last = format!("/parameters/double-spring-mass-damper/coefficient-matching/{}", matching.coordinates.len() + 1);
    let direct: CandidateV1 = artifact.record(&last).unwrap().unwrap();
    assert!(
        (direct.parameters["m1_kg"] / 300.0 - 1.0).abs() < 1e-9
            && (direct.parameters["k1_n_per_m"] / 4e5 - 1.0).abs() < 1e-9
    );
}

fn write_exponentials(folder: &Path, exponents: &[(f64, f64)]) {
    let term = |(re_per_s, im_rad_per_s): &(f64, f64)| ExponentialTermV1 {
        re_amplitude: 1.0,
        im_amplitude: 0.0,
        re_per_s: *re_per_s,
        im_rad_per_s: *im_rad_per_s,
    };
    let sum = ExponentialSumV1 { terms: exponents.iter().map(term).collect(), output: "displacement a, m".to_owned() };
    let mut builder = ArtifactBuilder::new();
    builder.put("/model/exponentials-3", &sum).unwrap();
    let provenance = Provenance::new("identify", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.join("3.mcap"), &provenance, Compression::None).unwrap();
}

#[test]
fn the_maxwell_closed_form_comes_from_a_sum_of_three_exponentials() {
    let folder = tempfile::tempdir().unwrap();
    write_exponentials(folder.path(), &[(1e-4, 0.0), (-20.0, 30.0), (-20.0, -30.0)]);
    let flags = ["--models", "maxwell", "--method", "closed-form", "--mass", "900kg"];
    let artifact = solved(folder.path(), &flags);
    let found: CandidateV1 = artifact.record("/parameters/maxwell/closed-form/1").unwrap().unwrap();
    // k = m (a² + b²) = 900 · 1300, c = -k/(2a); a few roundings.
    assert!((found.parameters["stiffness_n_per_m"] / 1.17e6 - 1.0).abs() < 1e-14 && found.physical);
    assert!((found.parameters["damping_n_s_per_m"] / 29_250.0 - 1.0).abs() < 1e-14);

    write_exponentials(folder.path(), &[(0.0, 0.0), (4.0, 30.0), (4.0, -30.0)]);
    let output = run(folder.path(), &flags);
    let stderr = said(&output);
    assert_eq!(output.status.code(), Some(4), "{stderr}");
    assert!(stderr.contains("slowest exponent of the fit is 4, expected negative"), "{stderr}");
}

#[test]
fn poles_without_their_conjugates_are_pointed_at() {
    let folder = tempfile::tempdir().unwrap();
    write_exponentials(folder.path(), &[(-3.0, 0.0), (-5.0, 0.0), (-20.0, 30.0), (-20.0, -31.0)]);
    let models = ["--models", "double-spring-mass-damper", "--method", "coefficient-matching"];
    let output = run(folder.path(), &[&models[..], &["--m1", "291kg", "--m2", "582kg"]].concat());
    let stderr = said(&output);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("its complex poles must come in conjugate pairs") && !stderr.contains("--m1"), "{stderr}");
}

#[test]
fn without_a_model_of_four_poles_every_form_that_would_do_is_named() {
    let folder = tempfile::tempdir().unwrap();
    write_exponentials(folder.path(), &[(-3.0, 0.0)]);
    let models = ["--models", "double-spring-mass-damper", "--method", "coefficient-matching"];
    let output = run(folder.path(), &[&models[..], &["--m1", "291kg", "--m2", "582kg"]].concat());
    let stderr = said(&output);
    assert_eq!(output.status.code(), Some(3), "{stderr}");
    assert!(stderr.contains("a state space of order 4 or a sum of four exponentials"), "{stderr}");
}

#[test]
fn the_curve_fit_of_the_paper_comes_from_a_sum_of_exponentials_and_is_labelled() {
    let folder = tempfile::tempdir().unwrap();
    let term =
        |(s, c): (f64, f64)| ExponentialTermV1 { re_amplitude: c, im_amplitude: 0.0, re_per_s: s, im_rad_per_s: 0.0 };
    let printed = [(-7.754, -253.6), (-6.238, 83.75), (-9.603, 333.0), (-10.87, -163.2)];
    let sum = ExponentialSumV1 { terms: printed.map(term).to_vec(), output: "displacement a, m".to_owned() };
    let mut builder = ArtifactBuilder::new();
    builder.put("/model/exponentials-4", &sum).unwrap();
    let provenance = Provenance::new("identify", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.path().join("3.mcap"), &provenance, Compression::None).unwrap();
    let models = ["--models", "double-spring-mass-damper", "--method", "curve-fit,coefficient-matching"];
    let output = run(folder.path(), &[&models[..], &["--m1", "291kg", "--m2", "582kg"]].concat());
    let stderr = said(&output);
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("as the ERA paper prints it, for reproduction only"), "{stderr}");
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let record = |id: &str| artifact.record::<CandidateV1>(&format!("/parameters/{id}")).unwrap();
    let paper = record("double-spring-mass-damper/curve-fit/1").unwrap();
    // Printed without decimals.
    assert!((paper.parameters["k2_n_per_m"] - 40731.0).abs() < 0.5 && !paper.physical);
    // The right way beside it: the two physical sets with these exponents.
    assert!(record("double-spring-mass-damper/coefficient-matching/1").unwrap().physical);
}

#[test]
fn a_method_named_twice_is_meant_once() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), true);
    let done = run(folder.path(), &["--models", "maxwell,maxwell", "--method", "direct-fit,direct-fit"]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn numbers_of_replicates_without_an_interval_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), true);
    for flags in [["--bootstrap", "19"], ["--bootstrap", "100001"], ["--repetitions", "10"]] {
        let done = run(folder.path(), &flags);
        assert_eq!(done.status.code(), Some(2), "{flags:?}");
        assert!(String::from_utf8_lossy(&done.stderr).contains("from 20 to 100000"), "{flags:?}");
    }
    assert!(!folder.path().join("5.mcap").exists());
}

#[test]
fn a_record_that_does_not_stop_is_fitted_up_to_the_end_of_its_event() {
    let folder = tempfile::tempdir().unwrap();
    write_integrated(&folder.path().join("3.mcap"), Some(873.0), false);
    let end_of_fit = |flags: &[&str]| {
        let output = run(folder.path(), &[&["--models", "maxwell", "--force"], flags].concat());
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
        let candidate: CandidateV1 = artifact.record("/parameters/maxwell/direct-fit/1").unwrap().unwrap();
        candidate.fit.unwrap().to_s
    };
    // The record goes on to 150 ms; a fit picks every so many samples, here of 0.1 ms.
    let by_event = end_of_fit(&["--method", "direct-fit"]);
    assert!((0.0585..=0.06 + 1e-9).contains(&by_event), "{by_event}");
    let stated = end_of_fit(&["--method", "direct-fit", "--fit-to", "80ms"]);
    assert!((0.0785..=0.08 + 1e-9).contains(&stated), "{stated}");
}

#[test]
fn a_vehicle_that_speeds_up_has_no_model() {
    let folder = tempfile::tempdir().unwrap();
    let mut builder = ArtifactBuilder::new();
    let still = integrated(&Model::Kelvin(kelvin()), Some(873.0), &CrushEvents::default(), None).unwrap();
    let provenance = Provenance::new("integrate", "0", "{}".to_owned(), Vec::new());
    still.write(&folder.path().join("still.mcap"), &provenance, Compression::None).unwrap();
    let still = Artifact::open(&folder.path().join("still.mcap")).unwrap();
    builder.put("/test", &still.record::<TestV1>("/test").unwrap().unwrap()).unwrap();
    builder.put("/events", &still.record::<EventsV1>("/events").unwrap().unwrap()).unwrap();
    // 20 g forwards.
    let x = (0..1001).map(|k| 1e-4 * f64::from(k)).map(|t| IMPACT_SPEED_M_PER_S * t + 98.0 * t * t).collect();
    builder.wave("a/displacement", QuantityKind::Displacement, Sampled::new(0.0, 1e-4, x).unwrap()).unwrap();
    builder.write(&folder.path().join("3.mcap"), &provenance, Compression::None).unwrap();
    let output = run(folder.path(), &[]);
    let error = said(&output);
    assert_eq!(output.status.code(), Some(4), "{error}");
    assert!(error.contains("--sign flip"), "{error}");
}
