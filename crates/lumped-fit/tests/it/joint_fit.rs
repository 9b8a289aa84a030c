//! One model fitted to several tests of one car: what two speeds and two masses say.

use crumple_lumped::{CrushedStructure, Kelvin, Model, ModelKind};
use crumple_lumped_fit::{
    AssessmentOptions, Candidate, JointTest, ONE_MASS_RATE_S_PER_M, SolveSettings, TestData, assess, fit_together,
};
use crumple_signal::{Displacement, Notes, Signal};

const DT: f64 = 1e-4;

/// A car of this mass at r = 0.02 s/m.
fn sensitive(mass_kg: f64) -> Model {
    let knots = [(0.05, 1.3e5), (0.12, 1.5e5), (0.25, 2.1e5), (0.4, 2.6e5), (0.6, 3.4e5)];
    Model::ForceDeflection(CrushedStructure::new(mass_kg, &knots, 2.5e7, 0.02).unwrap())
}

fn kelvin(mass_kg: f64) -> Model {
    Model::Kelvin(Kelvin { mass_kg, stiffness_n_per_m: 3e5, damping_n_s_per_m: 9e3 })
}

/// The exact displacement of a test.
fn displacement(truth: &Model, speed: f64) -> Signal<Displacement> {
    let response = truth.respond(speed, DT, 1501).unwrap();
    Signal::new(0.0, DT, response.compartment().displacement_m.clone()).unwrap()
}

/// Fits to tests at these masses and speeds, together.
fn fitted(car: fn(f64) -> Model, impacts: &[(f64, f64)], kind: ModelKind, notes: &mut Notes) -> Vec<Candidate> {
    let cars: Vec<(Model, f64)> = impacts.iter().map(|(mass_kg, speed)| (car(*mass_kg), *speed)).collect();
    let records: Vec<Signal<Displacement>> = cars.iter().map(|(car, speed)| displacement(car, *speed)).collect();
    let names: Vec<String> = (1..=cars.len()).map(|k| format!("test {k}")).collect();
    let tests: Vec<JointTest<'_>> = cars
        .iter()
        .zip(&records)
        .zip(impacts.iter().zip(&names))
        .map(|(((car, speed), record), ((mass_kg, _), name))| {
            let events = car.events(*speed).unwrap();
            let data = TestData {
                mass_kg: *mass_kg,
                impact_speed_m_per_s: *speed,
                time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
                dynamic_crush_m: events.dynamic_crush_m,
                coefficient_of_restitution: events.rebound_velocity_m_per_s.map(|v| v.abs() / speed),
                time_of_rebound_s: events.time_of_rebound_s,
                time_zero_s: 0.0,
                displacement: Some(record),
                measurement: None,
                sensors: &[],
            };
            JointTest { name, data, acceleration: None }
        })
        .collect();
    fit_together(&tests, &SolveSettings { models: vec![kind], ..SolveSettings::default() }, notes).unwrap()
}

fn crush(model: &Model, speed: f64) -> f64 {
    model.events(speed).unwrap().dynamic_crush_m.unwrap()
}

/// Knots stand at other places than those of the truth: the rate factor is off by what a curve of other pieces leaves,
/// at most 0.3 % per m/s (prediction from two speeds with 6 to 20 knots), crush by 2/3 of that for each m/s.
#[test]
fn two_speeds_tell_the_rate_factor_and_with_it_the_crush_at_others() {
    let impacts = [(1400.0, 56.0 / 3.6), (1400.0, 40.0 / 3.6)];
    let candidates = fitted(sensitive, &impacts, ModelKind::ForceDeflection, &mut Notes::new());
    let model = &candidates[0].model;
    let rate = model.parameters()["rate_s_per_m"];
    assert!((rate - 0.02).abs() < 3e-3, "{rate}");
    for speed in [30.0, 48.0, 64.0].map(|km_per_h| km_per_h / 3.6) {
        let error = crush(model, speed) / crush(&sensitive(1400.0), speed) - 1.0;
        assert!(error.abs() < 0.01, "{:.0} km/h: {error}", 3.6 * speed);
    }
    // The deviation of the rate factor is known, and every test is named with its error.
    let minimum = candidates[0].minimum.as_ref().unwrap();
    let assessed = assess(minimum, None, AssessmentOptions::default()).unwrap();
    assert!(assessed.standard_deviation["rate_s_per_m"] > 0.0);
    let names: Vec<&str> = candidates[0].fit.as_ref().unwrap().sensors.iter().map(|s| s.channel.as_str()).collect();
    assert_eq!(names, ["test 1", "test 2"]);
}

#[test]
fn tests_at_one_speed_leave_the_rate_factor_a_prior_and_it_is_said() {
    let impacts = [(1400.0, 15.0), (1300.0, 15.5)];
    let candidates = fitted(sensitive, &impacts, ModelKind::ForceDeflection, &mut Notes::new());
    assert!((candidates[0].model.parameters()["rate_s_per_m"] - ONE_MASS_RATE_S_PER_M).abs() < 1e-15);
    assert!(candidates[0].notes.iter().any(|note| note.text.contains("is a prior")), "{:?}", candidates[0].notes);
}

/// The records are exact and the model is the truth: what is left is the end of the descent.
#[test]
fn other_masses_and_speeds_are_one_spring_and_one_damper() {
    let impacts = [(1200.0, 10.0), (1500.0, 15.0), (900.0, 15.0)];
    let candidates = fitted(kelvin, &impacts, ModelKind::Kelvin, &mut Notes::new());
    let [candidate] = &candidates[..] else { panic!("{}", candidates.len()) };
    let values = candidate.model.parameters();
    assert!((values["stiffness_n_per_m"] / 3e5 - 1.0).abs() < 1e-6, "{values:?}");
    assert!((values["damping_n_s_per_m"] / 9e3 - 1.0).abs() < 1e-6, "{values:?}");
    // That of the deepest crush.
    assert!((values["mass_kg"] - 1500.0).abs() < 1e-12);
}

#[test]
fn a_chain_is_left_out_with_a_note() {
    let mut notes = Notes::new();
    let impacts = [(1200.0, 10.0), (1500.0, 15.0)];
    assert!(fitted(kelvin, &impacts, ModelKind::DoubleSpringMassDamper, &mut notes).is_empty());
    let said: Vec<&str> = notes.iter().map(|note| note.text.as_str()).collect();
    assert!(said[0].starts_with("double-spring-mass-damper: not fitted to several tests"), "{said:?}");
}
