//! The program on small artifacts: which candidates predict, at which speeds and masses, and what is refused.

#![allow(clippy::unwrap_used, reason = "a failing helper is a failing test")]

mod collisions;
mod plan;

use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{
    AnsweredByV1, CandidateV1, PredictionV1, RatedCandidateV1, RecommendationV1, UncertaintyV1,
};
use crumple_artifact::{Artifact, Compression, Provenance};
use crumple_lumped::{Elastoplastic, Kelvin, Maxwell, Model};
use crumple_signal::{QuantityKind, Sampled};
use crumple_testkit::{IMPACT_SPEED_M_PER_S, integrated};

const KELVIN: Kelvin = Kelvin { mass_kg: 873.0, stiffness_n_per_m: 330_000.0, damping_n_s_per_m: 2_500.0 };
const PLASTIC: Elastoplastic = Elastoplastic {
    mass_kg: 873.0,
    loading_stiffness_n_per_m: 340_000.0,
    unloading_stiffness_n_per_m: 4_000_000.0,
    release: true,
};
const PLASTIC_ID: &str = "elastoplastic/closed-form/1";
const KELVIN_ID: &str = "kelvin/closed-form/1";

fn candidate(model: &Model) -> CandidateV1 {
    CandidateV1 {
        model: model.kind().name().to_owned(),
        method: "closed-form".to_owned(),
        parameters: model.parameters(),
        physical: true,
        equivalent_to: None,
        fit: None,
        uncertainty: Some(UncertaintyV1 {
            method: "stated".to_owned(),
            standard_deviation: model.parameters().into_iter().map(|(name, value)| (name, 0.02 * value)).collect(),
            ..UncertaintyV1::default()
        }),
        notes: Vec::new(),
        ..CandidateV1::default()
    }
}

fn both() -> Vec<(&'static str, CandidateV1)> {
    vec![(PLASTIC_ID, candidate(&Model::Elastoplastic(PLASTIC))), (KELVIN_ID, candidate(&Model::Kelvin(KELVIN)))]
}

fn rated(id: &str, difference: f64) -> RatedCandidateV1 {
    RatedCandidateV1 {
        id: id.to_owned(),
        class: "plastic".to_owned(),
        adequate: true,
        not_adequate_because: None,
        parameters: 2,
        determined: 2,
        misfit: Some(1.0),
        fit_as_measured_percent: Some(99.0),
        coefficient_of_restitution: None,
        force_misfit_percent: None,
        aicc: Some(difference),
        aicc_difference: Some(difference),
        priors: Vec::new(),
        difference_with_priors: Some(difference),
        ..RatedCandidateV1::default()
    }
}

/// The elastoplastic candidate is for prediction and the simplest, the Kelvin one the closest.
fn choice() -> RecommendationV1 {
    RecommendationV1 {
        recommended: Some(PLASTIC_ID.to_owned()),
        simplest: Some(PLASTIC_ID.to_owned()),
        closest: Some(KELVIN_ID.to_owned()),
        candidates: vec![rated(PLASTIC_ID, 0.0), rated(KELVIN_ID, 40.0)],
        ..RecommendationV1::default()
    }
}

fn write(folder: &Path, candidates: &[(&str, CandidateV1)], choice: Option<&RecommendationV1>) {
    write_with(folder, candidates, choice, &[]);
}

/// The same with further velocities, from contact on at 10 kHz.
fn write_with(
    folder: &Path,
    candidates: &[(&str, CandidateV1)],
    choice: Option<&RecommendationV1>,
    velocities: &[(&str, Vec<f64>)],
) {
    let events = KELVIN.events(IMPACT_SPEED_M_PER_S);
    let mut builder = integrated(&Model::Kelvin(KELVIN), Some(873.0), &events, None).unwrap();
    for (id, candidate) in candidates {
        builder.put(&format!("/parameters/{id}"), candidate).unwrap();
    }
    if let Some(choice) = choice {
        builder.put("/recommendation", choice).unwrap();
    }
    let motion = Model::Kelvin(KELVIN).respond(IMPACT_SPEED_M_PER_S, 1e-4, 3000).unwrap();
    let own = [("a/velocity", motion.compartment().velocity_m_per_s.clone())];
    for (id, velocity) in own.iter().chain(velocities) {
        let sampled = Sampled::new(0.0, 1e-4, velocity.clone()).unwrap();
        builder.wave(id, QuantityKind::Velocity, sampled).unwrap();
    }
    let provenance = Provenance::new("parameter-solve", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.join("5.mcap"), &provenance, Compression::None).unwrap();
}

fn run(folder: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-predict"))
        .arg(folder.join("5.mcap"))
        .arg("-o")
        .arg(folder.join("7.mcap"))
        .args(more)
        .output()
        .unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The predictions in their order.
fn predictions(folder: &Path) -> Vec<PredictionV1> {
    let artifact = Artifact::open(&folder.join("7.mcap")).unwrap();
    (1..).map_while(|n| artifact.record(&format!("/prediction/{n}")).unwrap()).collect()
}

/// A run folder of the same models with other masses, for a partner.
fn run_folder(folder: &Path, candidates: &[(&str, CandidateV1)]) {
    std::fs::create_dir_all(folder).unwrap();
    // Of those that are there.
    let there = |id: Option<String>| {
        let is_there = |id: &String| candidates.iter().any(|(own, _)| own == id);
        id.filter(is_there).or_else(|| candidates.first().map(|(own, _)| (*own).to_owned()))
    };
    let RecommendationV1 { recommended, simplest, closest, .. } = choice();
    let choice = RecommendationV1 {
        recommended: there(recommended),
        simplest: there(simplest),
        closest: there(closest),
        ..choice()
    };
    write(folder, candidates, Some(&choice));
    std::fs::rename(folder.join("5.mcap"), folder.join("5-parameter-solve.mcap")).unwrap();
    let events = KELVIN.events(IMPACT_SPEED_M_PER_S);
    let builder = integrated(&Model::Kelvin(KELVIN), Some(873.0), &events, None).unwrap();
    let provenance = Provenance::new("integrate", "0", "{}".to_owned(), Vec::new());
    builder.write(&folder.join("3-integrate.mcap"), &provenance, Compression::None).unwrap();
}

fn predicted(more: &[&str]) -> Vec<PredictionV1> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let output = run(folder.path(), more);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    predictions(folder.path())
}

#[test]
fn every_speed_is_predicted_by_each_named_candidate_once() {
    let predictions = predicted(&["--speed", "40km/h,20km/h"]);
    let told: Vec<(f64, &str, bool)> = predictions
        .iter()
        .map(|p| ((3.6 * p.impact_speed_m_per_s).round(), p.candidate.as_str(), p.recommended))
        .collect();
    let expected =
        [(20.0, PLASTIC_ID, true), (20.0, KELVIN_ID, false), (40.0, PLASTIC_ID, true), (40.0, KELVIN_ID, false)];
    assert_eq!(told, expected);
    assert_eq!(predictions[0].names, ["recommended", "simplest"]);
    // A linear curve: crush goes as the speed.
    let crush = |k: usize| predictions[k].dynamic_crush_m.unwrap();
    assert!((crush(2) / crush(0) - 2.0).abs() < 1e-9);
    assert!((crush(0) - 20.0 / 3.6 * f64::sqrt(873.0 / 340_000.0)).abs() < 1e-9);
    for prediction in &predictions {
        for interval in &prediction.intervals {
            assert!(interval.level == 0.9 && interval.low <= interval.high && !interval.interval_by.is_empty());
        }
        assert_eq!(prediction.intervals.len(), 6);
        assert_eq!(prediction.extrapolates, prediction.impact_speed_m_per_s > IMPACT_SPEED_M_PER_S);
        assert_eq!(prediction.extrapolates, prediction.notes.iter().any(|note| note.starts_with("extrapolates")));
        let energy = prediction.energy.as_ref().unwrap();
        let impact = 0.5 * 873.0 * prediction.impact_speed_m_per_s.powi(2);
        assert!((energy.kinetic_at_impact_j - impact).abs() < 1e-6 * impact);
        assert!((energy.absorbed_j + energy.kinetic_at_rest_j - impact).abs() < 1e-6 * impact);
    }
    let width = |k: usize| {
        let interval = &predictions[k].intervals[0];
        (interval.high - interval.low) / predictions[k].dynamic_crush_m.unwrap()
    };
    // 35 km/h were tested.
    let in_test = predicted(&["--speed", "35km/h"]);
    let tested = &in_test[0].intervals[0];
    let tested = (tested.high - tested.low) / in_test[0].dynamic_crush_m.unwrap();
    assert!(width(2) > tested && width(0) > tested);
}

#[test]
fn without_a_speed_the_test_itself_is_predicted() {
    let predictions = predicted(&[]);
    let own = predictions.iter().find(|p| p.candidate == KELVIN_ID).unwrap();
    let tested = KELVIN.events(IMPACT_SPEED_M_PER_S);
    assert!((own.dynamic_crush_m.unwrap() - tested.dynamic_crush_m.unwrap()).abs() < 1e-12);
    assert!((own.time_of_dynamic_crush_s.unwrap() - tested.time_of_dynamic_crush_s.unwrap()).abs() < 1e-12);
    assert!(!own.extrapolates);
    // The record of the test is that of the damped model: both have its peak, and say whose it is.
    let plastic = predictions.iter().find(|p| p.candidate == PLASTIC_ID).unwrap();
    let peaks = [own, plastic].map(|p| p.peak_acceleration_m_per_s2.unwrap());
    assert!((peaks[1] / peaks[0] - 1.0).abs() < 1e-9, "{peaks:?}");
    assert_eq!((plastic.peak_by, plastic.delta_v_by), (Some(AnsweredByV1::Record), None));
    let faster = predicted(&["--speed", "50km/h"]);
    assert_eq!(faster[0].peak_by, Some(AnsweredByV1::Model));
}

#[test]
fn a_range_and_masses_are_a_grid_and_added_mass_is_the_compartments() {
    let predictions = predicted(&["--speed", "20..40/10 km/h", "--mass", "873kg,1200kg", "--candidate", PLASTIC_ID]);
    let grid: Vec<(f64, f64)> =
        predictions.iter().map(|p| (p.mass_kg, (3.6 * p.impact_speed_m_per_s).round())).collect();
    assert_eq!(grid, [(873.0, 20.0), (873.0, 30.0), (873.0, 40.0), (1200.0, 20.0), (1200.0, 30.0), (1200.0, 40.0)]);
    let ratio = predictions[3].dynamic_crush_m.unwrap() / predictions[0].dynamic_crush_m.unwrap();
    assert!((ratio - f64::sqrt(1200.0 / 873.0)).abs() < 1e-9, "{ratio}");
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let output = run(folder.path(), &["--speed", "20..40/10 km/h", "--mass", "873kg,1200kg"]);
    assert!(stderr(&output).contains("crush in mm, elastoplastic/closed-form/1:"), "{}", stderr(&output));
}

#[test]
fn the_pipeline_has_standing_speeds_and_the_flag_adds_to_them() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let pipeline = folder.path().join("p.toml");
    std::fs::write(&pipeline, "[predict]\nspeeds = ['40 km/h', '48 km/h']\n").unwrap();
    let output = run(folder.path(), &["--pipeline", pipeline.to_str().unwrap(), "--speed", "30 km/h"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let mut speeds: Vec<f64> =
        predictions(folder.path()).iter().map(|p| (3.6 * p.impact_speed_m_per_s).round()).collect();
    speeds.dedup();
    assert_eq!(speeds, [30.0, 40.0, 48.0]);
}

#[test]
fn a_candidate_that_does_not_exist_is_answered_with_the_nearest() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let output = run(folder.path(), &["--candidate", "kelvin/closed-from/1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("did you mean \"kelvin/closed-form/1\"?"), "{}", stderr(&output));
}

#[test]
fn speeds_and_masses_that_are_none_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let output = run(folder.path(), &["--speed", "40"]);
    assert!(stderr(&output).contains("e.g. 40 km/h"), "{}", stderr(&output));
    for flags in [["--speed", "0km/h"], ["--speed", "40"], ["--speed", "80..20/5 km/h"], ["--mass", "0 kg"]] {
        let output = run(folder.path(), &flags);
        assert_eq!(output.status.code(), Some(2), "{flags:?}: {}", stderr(&output));
    }
}

#[test]
fn where_nothing_qualifies_the_diagnosis_says_why_and_a_candidate_can_still_be_named() {
    let folder = tempfile::tempdir().unwrap();
    let none = RecommendationV1 { recommended_because: "no crush".to_owned(), ..RecommendationV1::default() };
    write(folder.path(), &both(), Some(&none));
    let output = run(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(4));
    assert!(stderr(&output).contains("no crush"), "{}", stderr(&output));
    assert_eq!(run(folder.path(), &["--candidate", KELVIN_ID]).status.code(), Some(0));
    assert_eq!(predictions(folder.path()).len(), 1);
    write(folder.path(), &[], None);
    let output = run(folder.path(), &[]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("crumple-parameter-solve"), "{}", stderr(&output));
}

#[test]
fn where_nobody_chose_every_physical_candidate_predicts() {
    let folder = tempfile::tempdir().unwrap();
    let mut candidates = both();
    candidates[1].1.physical = false;
    write(folder.path(), &candidates, None);
    assert_eq!(run(folder.path(), &["--speed", "30km/h"]).status.code(), Some(0));
    let predictions = predictions(folder.path());
    assert_eq!((predictions.len(), predictions[0].recommended), (1, false));
}

#[test]
fn a_model_that_creeps_has_no_crush_and_says_so() {
    let folder = tempfile::tempdir().unwrap();
    // k m < 4 ... of the damper in series: it never comes to rest.
    let creeping = Maxwell { mass_kg: 873.0, stiffness_n_per_m: 3e6, damping_n_s_per_m: 2e3 };
    let id = "maxwell/direct-fit/1";
    write(folder.path(), &[(id, candidate(&Model::Maxwell(creeping)))], None);
    let output = run(folder.path(), &["--speed", "30km/h"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let prediction = predictions(folder.path()).remove(0);
    assert_eq!((prediction.dynamic_crush_m, prediction.energy), (None, None));
    assert!(prediction.notes.iter().any(|note| note.contains("the model never stops")), "{:?}", prediction.notes);
}

#[test]
fn the_bytes_are_the_same_for_any_number_of_threads() {
    let bytes = |threads: &str| {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &both(), Some(&choice()));
        let status = Command::new(env!("CARGO_BIN_EXE_crumple-predict"))
            .arg(folder.path().join("5.mcap"))
            .args(["-q", "--speed", "20..60/10 km/h", "-o"])
            .arg(folder.path().join("7.mcap"))
            .env("RAYON_NUM_THREADS", threads)
            .status()
            .unwrap();
        assert!(status.success());
        std::fs::read(folder.path().join("7.mcap")).unwrap()
    };
    assert_eq!(bytes("1"), bytes("3"));
}

#[test]
fn a_prediction_is_compared_with_another_test_at_its_speed_and_mass() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), &both(), Some(&choice()));
    let other = folder.path().join("other");
    std::fs::create_dir(&other).unwrap();
    // Twice the mass: the plastic model itself made this test.
    let heavy = Model::Elastoplastic(Elastoplastic { mass_kg: 1746.0, ..PLASTIC });
    let events = heavy.events(IMPACT_SPEED_M_PER_S).unwrap();
    let builder = integrated(&heavy, Some(1746.0), &events, None);
    let provenance = Provenance::new("integrate", "0", "{}".to_owned(), Vec::new());
    builder.unwrap().write(&other.join("3-integrate.mcap"), &provenance, Compression::None).unwrap();
    let output = run(folder.path(), &["--speed", "20km/h", "--against", other.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let predictions = predictions(folder.path());
    assert!(predictions[..2].iter().all(|p| p.against.is_none()));
    let [plastic, kelvin] = &predictions[2..] else { panic!("{predictions:?}") };
    assert_eq!((plastic.candidate.as_str(), plastic.mass_kg), (PLASTIC_ID, 1746.0));
    let against = plastic.against.as_ref().unwrap();
    assert!(against.dynamic_crush_error_percent.unwrap().abs() < 1e-9, "{against:?}");
    assert!(against.held.iter().any(|name| name == "dynamic_crush_m"), "{against:?}");
    // The damper takes some of the crush.
    assert!(kelvin.against.as_ref().unwrap().dynamic_crush_error_percent.unwrap() < -1.0);
    assert!(stderr(&output).contains("the interval holds the crush"), "{}", stderr(&output));
    let nowhere = run(folder.path(), &["--against", "nowhere"]);
    assert_eq!(nowhere.status.code(), Some(2), "{}", stderr(&nowhere));
}
