//! The program on two sensors through CFC 60: values, intervals and what else is said of fits to them.

use std::path::Path;
use std::process::{Command, Output};

use crumple_artifact::records::{CandidateV1, ChannelFilterV1, EventsV1, NotesV1, RecommendationV1, TestV1, TestsV2};
use crumple_artifact::{Artifact, ArtifactBuilder};
use crumple_lumped::{CrushedStructure, DoubleSpringMassDamper, Model};
use crumple_lumped_fit::{FitQuantity, MeasureModel};
use crumple_signal::{
    Channel, IntegrationRule, Measurement, QuantityKind, Sampled, Source, TestDescription, TwoPassFilter,
};

use crate::command_models::{result, run, said, write};

const V0: f64 = 15.0;
const DT: f64 = 1e-4;
const BEFORE: usize = 500;

const TRUTH: [(&str, f64); 6] = [
    ("m1_kg", 400.0),
    ("m2_kg", 1000.0),
    ("k1_n_per_m", 6e5),
    ("k2_n_per_m", 9e5),
    ("c1_n_s_per_m", 9e3),
    ("c2_n_s_per_m", 6e3),
];

fn truth() -> Model {
    Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
        m1_kg: 400.0,
        m2_kg: 1000.0,
        k1_n_per_m: 6e5,
        k2_n_per_m: 9e5,
        c1_n_s_per_m: 9e3,
        c2_n_s_per_m: 6e3,
    })
}

/// CFC 60 as the filter stage designs it: ISO 6487 Annex A, 1.25/0.6 times the class, bilinear.
fn cfc_60() -> TwoPassFilter {
    let wa = (std::f64::consts::PI * 60.0 * 1.25 / 0.6 * DT).tan();
    let d = 1.0 + std::f64::consts::SQRT_2 * wa + wa * wa;
    let a0 = wa * wa / d;
    let coefficients =
        [a0, 2.0 * a0, a0, -2.0 * (wa * wa - 1.0) / d, (-1.0 + std::f64::consts::SQRT_2 * wa - wa * wa) / d];
    TwoPassFilter { coefficients, samples_added: (0.01 / DT).round() as usize }
}

/// What filter and integration write for a car of two masses with a sensor on each.
fn write_record(path: &Path) {
    write_record_with(path, 1.0, 0.6);
}

/// The same where the sensor in front has this gain, and the test this restitution.
fn write_record_with(path: &Path, gain_in_front: f64, restitution: f64) {
    let filter = cfc_60();
    let measurement = Measurement {
        dt_s: DT,
        first_s: -(BEFORE as f64) * DT,
        samples: BEFORE + 1501,
        filter: Some(filter),
        from_contact: false,
        rule: Some(IntegrationRule::Trapezoid),
        before_event: None,
    };
    let mut builder = ArtifactBuilder::new();
    let test = TestDescription {
        title: "two masses".to_owned(),
        mass_kg: Some(1400.0),
        impact_speed_m_per_s: Some(V0),
        channels: ["comp", "front"].map(|id| Channel::new(id, QuantityKind::Acceleration)).to_vec(),
        ..TestDescription::default()
    };
    builder.put("/test", &TestV1::from(&test)).unwrap();
    for (id, mass) in [("comp", 1), ("front", 0)] {
        let record = ChannelFilterV1 {
            cfc: Some(60),
            mode: "iso6487".to_owned(),
            samples_added: filter.samples_added as u64,
            coefficients: filter.coefficients.to_vec(),
            frequency_factor: None,
            gain_at_class_db: None,
            zero_level_removed: 0.0,
            notes: Vec::new(),
            corridor: Vec::new(),
            corridor_ok: None,
            cutoff_hz: Vec::new(),
            phase: None,
            width_s: None,
            resampled_to_hz: None,
            shift_s: None,
        };
        builder.put(&format!("/filter/{id}"), &record).unwrap();
        let seen = |quantity| {
            let mut samples = measurement.motion(&truth(), Some(mass), quantity, V0, usize::MAX).unwrap();
            samples.iter_mut().filter(|_| id == "front").for_each(|x| *x *= gain_in_front);
            Sampled::new(measurement.first_s, DT, samples).unwrap()
        };
        builder.wave(id, QuantityKind::Acceleration, seen(FitQuantity::Acceleration)).unwrap();
        builder.wave(&format!("{id}/velocity"), QuantityKind::Velocity, seen(FitQuantity::Velocity)).unwrap();
        let x = seen(FitQuantity::Displacement);
        builder.wave(&format!("{id}/displacement"), QuantityKind::Displacement, x).unwrap();
    }
    let stops = truth().events(V0).unwrap();
    let events = EventsV1 {
        channel: "comp".to_owned(),
        time_zero_rule: "file".to_owned(),
        dynamic_crush_m: stops.dynamic_crush_m,
        time_of_dynamic_crush_s: stops.time_of_dynamic_crush_s,
        coefficient_of_restitution: Some(restitution),
        impact_speed_m_per_s: Some(V0),
        rule: Some("trapezoid".to_owned()),
        start: Some("record-start".to_owned()),
        ..EventsV1::default()
    };
    builder.put("/events", &events).unwrap();
    write(&builder, path);
}

fn recorded(folder: &Path, flags: &[&str]) -> Output {
    write_record(&folder.join("3.mcap"));
    run(folder, flags)
}

const DOUBLE: [&str; 6] =
    ["--models", "double-spring-mass-damper", "--method", "direct-fit", "--sensors", "compartment=comp,front=front"];

fn solved(flags: &[&str]) -> Artifact {
    let folder = tempfile::tempdir().unwrap();
    result(folder.path(), &recorded(folder.path(), flags))
}

fn candidate(flags: &[&str], id: &str) -> CandidateV1 {
    solved(flags).record(&format!("/parameters/{id}")).unwrap().unwrap()
}

/// Values within 0.1 % of the truth, and the truth inside every interval of the names.
fn holds_the_truth(found: &CandidateV1, names: impl Fn(&str) -> bool) {
    let uncertainty = found.uncertainty.as_ref().unwrap();
    for (name, wanted) in TRUTH {
        // The acceptance limit: the model goes the way of the record, so rounding is left.
        assert!((found.parameters[name] / wanted - 1.0).abs() < 1e-3, "{name}: {}", found.parameters[name]);
        if names(name) {
            let (low, high) = (uncertainty.interval_low[name].unwrap(), uncertainty.interval_high[name].unwrap());
            assert!(low <= wanted && wanted <= high, "{name}: {wanted} outside [{low}, {high}]");
        }
    }
}

#[test]
fn intervals_of_two_sensors_hold_the_truth_of_a_filtered_record_for_every_quantity() {
    for quantity in FitQuantity::ALL {
        let flags = ["--m1", "400kg", "--m2", "1000kg", "--fit-quantity", quantity.name()];
        let found = candidate(&[&DOUBLE[..], &flags].concat(), "double-spring-mass-damper/direct-fit/1");
        holds_the_truth(&found, |name| !name.ends_with("_kg"));
        let uncertainty = found.uncertainty.unwrap();
        assert_eq!((uncertainty.rank, uncertainty.order.len(), uncertainty.correlation.len()), (Some(4), 4, 4));
        let direction = uncertainty.weakest_direction.unwrap();
        assert!(direction.contains(&format!("the {quantity} by only")), "{direction}");
        assert!(uncertainty.effective_samples.is_some());
    }
}

#[test]
fn free_masses_have_intervals_profile_bootstrap_and_propagation_and_the_rest_of_the_total_too() {
    let flags = ["--fit-masses", "free", "--profile", "--bootstrap", "40", "--mass-uncertainty", "14kg"];
    let found = candidate(&[&DOUBLE[..], &flags].concat(), "double-spring-mass-damper/direct-fit/1");
    holds_the_truth(&found, |_| true);
    let uncertainty = found.uncertainty.unwrap();
    assert_eq!(uncertainty.rank, Some(5));
    let (low, high) = (&uncertainty.interval_low, &uncertainty.interval_high);
    // The rest mirrors the free mass: one error, seen from the other end.
    let width = |name: &str| high[name].unwrap() - low[name].unwrap();
    assert!((width("m1_kg") / width("m2_kg") - 1.0).abs() < 1e-9);
    let propagation = uncertainty.propagation.unwrap();
    let bootstrap = uncertainty.bootstrap.unwrap();
    for (name, value) in TRUTH {
        let profile = uncertainty.profile.iter().find(|p| p.parameter == name).unwrap();
        assert!(profile.identifiable && profile.low.unwrap() <= value && value <= profile.high.unwrap(), "{name}");
        assert!(bootstrap.low.contains_key(name), "{name}");
        // One percent of mass, 1.645 deviations; 200 draws know their percentiles to a sixth.
        let half = 0.5 * (propagation.high[name] - propagation.low[name]) / value;
        assert!((half / 0.01645 - 1.0).abs() < 0.17, "{name}: {half}");
    }
}

#[test]
fn a_closed_form_is_propagated_by_itself_and_has_no_profile_of_another_estimate() {
    let folder = tempfile::tempdir().unwrap();
    let flags = ["--models", "kelvin,elastoplastic", "--method", "closed-form", "--mass-uncertainty", "14kg"];
    let output = recorded(folder.path(), &[&flags[..], &["--profile", "--bootstrap", "40"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let crush = truth().events(V0).unwrap().dynamic_crush_m.unwrap();
    for model in ["kelvin", "elastoplastic"] {
        let found: CandidateV1 = artifact.record(&format!("/parameters/{model}/closed-form/1")).unwrap().unwrap();
        let uncertainty = found.uncertainty.unwrap();
        assert!(uncertainty.profile.is_empty() && uncertainty.bootstrap.is_none());
        let propagation = uncertainty.propagation.unwrap();
        for (name, low) in propagation.low.iter().filter(|(name, low)| name.ends_with("_per_m") && **low > 0.0) {
            let value = found.parameters[name];
            // Proportional to the mass: k (1 +- 1.645 %), with percentiles of 200 draws known to a sixth of that.
            for (end, wanted) in [(low, 1.0 - 0.01645), (&propagation.high[name], 1.01645)] {
                assert!((end / value - wanted).abs() < 0.17 * 0.01645, "{model} {name}: {} ", end / value);
            }
        }
        // A mass changes no crush; the events read again from the displacement move not at all.
        let ends = [propagation.low["dynamic_crush_m"], propagation.high["dynamic_crush_m"]];
        for end in ends {
            assert!((end / crush - 1.0).abs() < 1e-9, "{model}: {end} {crush}");
        }
    }
    let notes = serde_json::to_string(&artifact.record::<NotesV1>("/notes").unwrap()).unwrap();
    assert!(notes.contains("--profile and --bootstrap not computed for kelvin/closed-form/1"), "{notes}");
}

#[test]
fn the_conditioned_fit_lies_inside_its_own_propagation() {
    let flags = ["--models", "nonlinear-1", "--method", "direct-fit", "--mass-uncertainty", "14kg"];
    let found = candidate(&flags, "nonlinear-1/direct-fit/1");
    let propagation = found.uncertainty.unwrap().propagation.unwrap();
    for (name, low) in &propagation.low {
        let Some(value) = found.parameters.get(name) else { continue };
        // 1e-6: a knot, which no mass moves, is repeated to the tolerance of the descent.
        let slack = 1e-6 * value;
        assert!(low - slack <= *value && *value <= propagation.high[name] + slack, "{name}: {value} {low}");
    }
}

#[test]
fn an_uncertainty_that_reaches_zero_mass_or_speed_is_a_usage_error() {
    for (flag, value) in [("--mass-uncertainty", "2000kg"), ("--speed-uncertainty", "40km/h")] {
        let folder = tempfile::tempdir().unwrap();
        let output = recorded(folder.path(), &["--models", "kelvin", flag, value]);
        let stderr = said(&output);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(flag.trim_start_matches('-')) && stderr.contains("reach zero"), "{stderr}");
    }
}

#[test]
fn a_flag_without_effect_is_named() {
    let folder = tempfile::tempdir().unwrap();
    // Without a displacement of the pulse there is nothing to judge a closed form by.
    let whole = folder.path().join("3.mcap");
    write_record(&whole);
    let artifact = Artifact::open(&whole).unwrap();
    let mut builder = ArtifactBuilder::new();
    builder.put("/test", &artifact.record::<TestV1>("/test").unwrap().unwrap()).unwrap();
    builder.put("/events", &artifact.record::<EventsV1>("/events").unwrap().unwrap()).unwrap();
    write(&builder, &whole);
    let flags = ["--models", "kelvin", "--method", "closed-form", "--profile", "--mass-uncertainty", "14kg"];
    let stderr = said(&run(folder.path(), &flags));
    assert!(stderr.contains("--profile, --mass-uncertainty without effect on kelvin/closed-form/1"), "{stderr}");
}

#[test]
fn a_dual_that_leads_back_to_the_truth_through_the_filters_is_no_second_candidate() {
    let artifact = solved(&[&DOUBLE[..], &["--m1", "400kg", "--m2", "1000kg"]].concat());
    let id = |k: usize| format!("/parameters/double-spring-mass-damper/direct-fit/{k}");
    assert!(artifact.record::<CandidateV1>(&id(1)).unwrap().is_some());
    assert!(artifact.record::<CandidateV1>(&id(2)).unwrap().is_none());
}

#[test]
fn a_uniform_uncertainty_is_a_half_width() {
    let flags = ["--models", "kelvin", "--method", "closed-form", "--mass-uncertainty", "14 kg uniform"];
    let found = candidate(&flags, "kelvin/closed-form/1");
    let propagation = found.uncertainty.unwrap().propagation.unwrap();
    let half = 0.5 * (propagation.high["stiffness_n_per_m"] - propagation.low["stiffness_n_per_m"]);
    // 5 to 95 % of +-1 % are +-0.9 %; percentiles of 200 uniform draws are known to 3 % of the width, two of that
    // allowed.
    assert!((half / found.parameters["stiffness_n_per_m"] / 0.009 - 1.0).abs() < 0.06, "{half}");
}

#[test]
fn a_dead_sensor_takes_no_part_in_the_choice_and_a_test_without_a_rebound_has_one_to_miss() {
    let folder = tempfile::tempdir().unwrap();
    write_record_with(&folder.path().join("3.mcap"), 0.0, 0.0);
    let flags = ["--models", "kelvin", "--method", "closed-form", "--sensors", "compartment=comp,front=front"];
    let output = run(folder.path(), &flags);
    let said = said(&output);
    assert!(said.contains("channel front is zero throughout"), "{said}");
    let artifact = Artifact::open(&folder.path().join("5.mcap")).unwrap();
    let choice: RecommendationV1 = artifact.record("/recommendation").unwrap().unwrap();
    assert_eq!(choice.decided_by, ["comp"]);
    let kelvin = &choice.candidates[0];
    assert!(kelvin.misfit.is_some() && kelvin.restitution_error.unwrap() > 0.1, "{kelvin:?}");
    assert!(kelvin.missed_events.iter().any(|name| name == "coefficient_of_restitution"), "{kelvin:?}");
}

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

fn run_together(folder: &Path, inputs: &[&str], threads: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_crumple-parameter-solve"))
        .args(inputs)
        .args(["-o", "5.mcap", "--force", "--models", "force-deflection,elastoplastic,kelvin"])
        .env("RAYON_NUM_THREADS", threads)
        .current_dir(folder)
        .output()
        .unwrap()
}

fn solved_together(folder: &Path, inputs: &[&str]) -> Artifact {
    result(folder, &run_together(folder, inputs, "2"))
}

/// The records are exact and the knots at other places than those of the truth, which leaves at most 0.3 % per m/s.
#[test]
fn two_speeds_and_masses_tell_the_rate_factor_and_all_tests_are_named() {
    let folder = tempfile::tempdir().unwrap();
    write_test(&folder.path().join("fast.mcap"), 1400.0, 56.0 / 3.6);
    write_test(&folder.path().join("slow.mcap"), 1250.0, 40.0 / 3.6);
    let inputs = ["slow:slow.mcap", "fast:fast.mcap"];
    let artifact = solved_together(folder.path(), &inputs);
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

    let tests: TestsV2 = artifact.record("/tests").unwrap().unwrap();
    let of = |test: &crumple_artifact::records::JointTestV1| (test.name.clone(), test.mass_kg, test.digest.clone());
    assert_eq!(of(&tests.tests[0]), ("slow".to_owned(), 1250.0, "blake3:slow".to_owned()));
    assert_eq!((tests.tests.len(), tests.rate_factor.as_str()), (2, "fitted"));
    // Mass and speed of the deepest crush.
    let test: TestV1 = artifact.record("/test").unwrap().unwrap();
    assert_eq!((test.mass_kg, test.title.as_str()), (Some(1400.0), "slow + fast"));
    let kinds: Vec<&str> = artifact.provenance().unwrap().inputs.iter().map(|input| input.kind.as_str()).collect();
    assert_eq!(kinds, ["fast:integrate", "slow:integrate"]);

    let bytes = std::fs::read(folder.path().join("5.mcap")).unwrap();
    assert_eq!(run_together(folder.path(), &inputs, "1").status.code(), Some(0));
    assert!(bytes == std::fs::read(folder.path().join("5.mcap")).unwrap(), "the same bytes for any number of threads");
}

#[test]
fn tests_at_one_speed_keep_the_prior_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    write_test(&folder.path().join("a.mcap"), 1400.0, 15.0);
    write_test(&folder.path().join("b.mcap"), 1250.0, 15.2);
    let artifact = solved_together(folder.path(), &["a:a.mcap", "b:b.mcap"]);
    let candidate: CandidateV1 = artifact.record("/parameters/force-deflection/direct-fit/1").unwrap().unwrap();
    assert!((candidate.parameters["rate_s_per_m"] - 0.004).abs() < 1e-15);
    let notes: NotesV1 = artifact.record("/notes").unwrap().unwrap();
    assert!(notes.notes.iter().any(|note| note.contains("does not tell the rate effect")), "{notes:?}");
    assert_eq!(artifact.record::<TestsV2>("/tests").unwrap().unwrap().rate_factor, "prior");
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
        let output = run_together(folder.path(), &inputs, "2");
        let said = said(&output);
        assert!(said.contains(words), "{inputs:?}: {said}");
        assert_eq!(output.status.code(), Some(code), "{inputs:?}: {said}");
    }
    assert!(!folder.path().join("5.mcap").exists());
    // An output that is an input would be lost, named or not.
    write_test(&folder.path().join("5.mcap"), 1400.0, 9.0);
    let output = run_together(folder.path(), &["a:a.mcap", "b:5.mcap"], "2");
    assert!(said(&output).contains("is an input too"), "{}", said(&output));
}
