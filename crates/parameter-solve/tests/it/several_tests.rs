//! The program on artifacts of several tests, each under a name of its own.

use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{CandidateV1, EventsV1, NotesV1, RecommendationV1, TestV1, TestsV1};
use crumple_artifact::{Artifact, ArtifactBuilder};
use crumple_lumped::{CrushedStructure, Model};
use crumple_signal::{Channel, QuantityKind, Sampled, Source, TestDescription};

use crate::program::{result, said, write};

const DT: f64 = 1e-4;

/// A car of this mass at r = 0.02 s/m.
fn car(mass_kg: f64) -> Model {
    let knots = [(0.05, 1.3e5), (0.12, 1.5e5), (0.25, 2.1e5), (0.4, 2.6e5), (0.6, 3.4e5)];
    Model::ForceDeflection(CrushedStructure::new(mass_kg, &knots, 2.5e7, 0.02).unwrap())
}

/// What integration writes for a test of it.
fn write_test(path: &Path, mass_kg: f64, speed: f64) {
    let truth = car(mass_kg);
    let events = truth.events(speed).unwrap();
    let mut builder = ArtifactBuilder::new();
    let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
    let test = TestDescription {
        title: name.clone(),
        mass_kg: Some(mass_kg),
        impact_speed_m_per_s: Some(speed),
        channels: vec![Channel::new("a", QuantityKind::Acceleration)],
        source: Source { format: "made".to_owned(), name: name.clone(), digest: format!("blake3:{name}") },
        ..TestDescription::default()
    };
    builder.put("/test", &TestV1::from(&test)).unwrap();
    let crash = EventsV1 {
        channel: "a".to_owned(),
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: events.dynamic_crush_m,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        time_of_rebound_s: events.time_of_rebound_s,
        coefficient_of_restitution: events.rebound_velocity_m_per_s.map(|v| v.abs() / speed),
        impact_speed_m_per_s: Some(speed),
        ..EventsV1::default()
    };
    builder.put("/events", &crash).unwrap();
    let motion = truth.respond(speed, DT, 1501).unwrap();
    let compartment = motion.compartment();
    let wave = |samples: &[f64]| Sampled::new(0.0, DT, samples.to_vec()).unwrap();
    builder.wave("a", QuantityKind::Acceleration, wave(&compartment.acceleration_m_per_s2)).unwrap();
    builder.wave("a/displacement", QuantityKind::Displacement, wave(&compartment.displacement_m)).unwrap();
    write(&builder, path);
}

fn run(folder: &Path, inputs: &[&str], threads: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-parameter-solve"))
        .args(inputs)
        .args(["-o", "5.mcap", "--force", "--models", "force-deflection,elastoplastic,kelvin"])
        .env("RAYON_NUM_THREADS", threads)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn solved(folder: &Path, inputs: &[&str]) -> Artifact {
    result(folder, &run(folder, inputs, "2"))
}

/// The records are exact and the knots at other places than those of the truth, which leaves at most 0.3 % per m/s.
#[test]
fn two_speeds_and_masses_tell_the_rate_factor_and_all_tests_are_named() {
    let folder = tempfile::tempdir().unwrap();
    write_test(&folder.path().join("fast.mcap"), 1400.0, 56.0 / 3.6);
    write_test(&folder.path().join("slow.mcap"), 1250.0, 40.0 / 3.6);
    let inputs = ["slow:slow.mcap", "fast:fast.mcap"];
    let artifact = solved(folder.path(), &inputs);
    let choice: RecommendationV1 = artifact.record("/recommendation").unwrap().unwrap();
    let recommended = choice.recommended.unwrap();
    assert!(recommended.starts_with("force-deflection/direct-fit/"), "{recommended}");
    let candidate: CandidateV1 = artifact.record(&format!("/parameters/{recommended}")).unwrap().unwrap();
    let rate = candidate.parameters["rate_s_per_m"];
    assert!((rate - 0.02).abs() < 3e-3, "{rate}");
    let known = candidate.uncertainty.unwrap();
    assert!(known.order.contains(&"rate_s_per_m".to_owned()), "{:?}", known.order);
    let fit = candidate.fit.unwrap();
    let fitted: Vec<(&str, &str)> = fit.sensors.iter().map(|s| (s.channel.as_str(), s.quantity.as_str())).collect();
    let (x, a) = ("displacement", "acceleration");
    assert_eq!(fitted, [("slow:a", x), ("slow:a", a), ("fast:a", x), ("fast:a", a)]);

    let tests: TestsV1 = artifact.record("/tests").unwrap().unwrap();
    let of = |test: &crumple_artifact::records::JointTestV1| (test.name.clone(), test.mass_kg, test.digest.clone());
    assert_eq!(of(&tests.tests[0]), ("slow".to_owned(), 1250.0, "blake3:slow".to_owned()));
    assert_eq!((tests.tests.len(), tests.rate_factor.as_str()), (2, "fitted"));
    // Mass and speed of the deepest crush.
    let test: TestV1 = artifact.record("/test").unwrap().unwrap();
    assert_eq!((test.mass_kg, test.title.as_str()), (Some(1400.0), "slow + fast"));
    let kinds: Vec<&str> = artifact.provenance().unwrap().inputs.iter().map(|input| input.kind.as_str()).collect();
    assert_eq!(kinds, ["fast:integrate", "slow:integrate"]);

    let bytes = std::fs::read(folder.path().join("5.mcap")).unwrap();
    assert_eq!(run(folder.path(), &inputs, "1").status.code(), Some(0));
    assert!(bytes == std::fs::read(folder.path().join("5.mcap")).unwrap(), "the same bytes for any number of threads");
}

#[test]
fn tests_at_one_speed_keep_the_prior_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    write_test(&folder.path().join("a.mcap"), 1400.0, 15.0);
    write_test(&folder.path().join("b.mcap"), 1250.0, 15.2);
    let artifact = solved(folder.path(), &["a:a.mcap", "b:b.mcap"]);
    let candidate: CandidateV1 = artifact.record("/parameters/force-deflection/direct-fit/1").unwrap().unwrap();
    assert!((candidate.parameters["rate_s_per_m"] - 0.004).abs() < 1e-15);
    let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
    assert!(notes.notes.iter().any(|note| note.contains("does not tell the rate effect")), "{notes:?}");
    assert_eq!(artifact.record::<TestsV1>("/tests").unwrap().unwrap().rate_factor, "prior");
}

#[test]
fn a_mixture_one_test_and_one_record_twice_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    write_test(&folder.path().join("a.mcap"), 1400.0, 15.0);
    write_test(&folder.path().join("b.mcap"), 1400.0, 11.0);
    for (inputs, code, words) in [
        (["a.mcap", "b.mcap"], 3, "are both of the stage integrate"),
        (["a:a.mcap", "b.mcap"], 2, "b.mcap has no name of a test in front"),
        (["a:a.mcap", "a:b.mcap"], 2, "a is the only test"),
        (["a:a.mcap", "b:a.mcap"], 3, "a and b are one record"),
        (["a:a.mcap", "b:none.mcap"], 3, "none.mcap"),
        (["a:a.mcap", "b:5.mcap"], 3, "5.mcap"),
    ] {
        let output = run(folder.path(), &inputs, "2");
        let said = said(&output);
        assert!(said.contains(words), "{inputs:?}: {said}");
        assert_eq!(output.status.code(), Some(code), "{inputs:?}: {said}");
    }
    assert!(!folder.path().join("5.mcap").exists());
    // An output that is an input would be lost, named or not.
    write_test(&folder.path().join("5.mcap"), 1400.0, 9.0);
    let output = run(folder.path(), &["a:a.mcap", "b:5.mcap"], "2");
    assert!(said(&output).contains("is an input too"), "{}", said(&output));
}
