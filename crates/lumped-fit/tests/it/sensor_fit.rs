//! Every model from its own displacement, velocity or acceleration, of one and of several sensors.

use std::collections::BTreeMap;

use crumple_lumped::{CrushedStructure, Kelvin, Model, ModelKind};
use crumple_lumped_fit::{
    AssessmentOptions, Candidate, FitQuantity, JointTest, MassFit, MassSplit, Method, ONE_MASS_RATE_S_PER_M, Sensor,
    SensorPlace, SolveSettings, TestData, fit_together, solve,
};
use crumple_numerics::estimation::minimise::l_shade::LShadeOptions;
use crumple_signal::{Displacement, Notes, Sampled, Signal};
use crumple_testkit::table_5;

const V0: f64 = 9.7222;
const DT: f64 = 1e-4;

fn model(kind: ModelKind) -> Model {
    let values: &[f64] = match kind {
        ModelKind::Kelvin => &[873.0, 3.2e5, 6e3],
        ModelKind::Elastoplastic => &[873.0, 3.2e5, 9e6],
        ModelKind::Maxwell => &[873.0, 2.3e6, 3.4e4],
        ModelKind::Nonlinear1 => &[873.0, 23_700.0, 253_440.0, 56_816.0, 19_956.0, 1_795.0, 2.7948, 0.5063, V0],
        ModelKind::Nonlinear2 => return Model::Nonlinear2(table_5()),
        ModelKind::DoubleSpringMassDamper => &[375.0, 1125.0, 9e5, 1e6, 6e3, 9e3],
        ModelKind::TripleSpringMassDamper => &[200.0, 300.0, 1000.0, 8e5, 9e5, 1e6, 6e3, 5e3, 9e3],
        ModelKind::ForceDeflection | ModelKind::LoadPaths | ModelKind::Chain | ModelKind::Own => &[],
    };
    let named: BTreeMap<String, f64> =
        kind.parameter_names().iter().map(|n| (*n).to_owned()).zip(values.iter().copied()).collect();
    Model::from_parameters(kind, &named).unwrap()
}

/// The first nonlinear model with the last knot of its spring at its own dynamic crush, as the side conditions of its
/// fit to the plain displacement have it; other models as they are.
fn with_knot_at_crush(model: Model) -> Model {
    let mut named = model.parameters();
    if model.kind() == ModelKind::Nonlinear1 {
        // The fixed point of knot = crush.
        for _ in 0..100 {
            let events = Model::from_parameters(model.kind(), &named).unwrap().events(V0).unwrap();
            named.insert("crush_m".to_owned(), events.dynamic_crush_m.unwrap());
        }
    }
    Model::from_parameters(model.kind(), &named).unwrap()
}

/// What sensors on the masses record, from the barrier on.
fn records(model: &Model, quantity: FitQuantity, samples: usize) -> Vec<Sampled> {
    let response = model.respond(V0, DT, samples).unwrap();
    let of = |motion: &crumple_lumped::Motion| match quantity {
        FitQuantity::Displacement => motion.displacement_m.clone(),
        FitQuantity::Velocity => motion.velocity_m_per_s.clone(),
        FitQuantity::Acceleration | FitQuantity::Force => motion.acceleration_m_per_s2.clone(),
    };
    response.motions.iter().map(|motion| Sampled::new(0.0, DT, of(motion)).unwrap()).collect()
}

struct Run {
    quantity: FitQuantity,
    places: Vec<SensorPlace>,
    settings: SolveSettings,
}

fn run(of: Run, truth: &Model) -> (Vec<Candidate>, String) {
    let records = records(truth, of.quantity, 1201);
    let displacement: Signal<Displacement> = records_of_displacement(truth);
    let sensors: Vec<Sensor<'_>> = of
        .places
        .iter()
        .map(|place| Sensor {
            channel: "channel",
            place: *place,
            quantity: of.quantity,
            record: &records[place.mass(records.len()).unwrap()],
            measurement: None,
            noise: None,
        })
        .collect();
    let events = truth.events(V0).unwrap();
    let parameters = truth.parameters();
    let crush_m = parameters.get("crush_m").copied().or(events.dynamic_crush_m);
    let test = TestData {
        mass_kg: parameters.iter().filter(|(name, _)| name.ends_with("_kg")).map(|(_, m)| m).sum(),
        impact_speed_m_per_s: V0,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        dynamic_crush_m: crush_m,
        coefficient_of_restitution: Some(0.2),
        time_of_rebound_s: events.time_of_rebound_s,
        displacement: Some(&displacement),
        measurement: None,
        sensors: &sensors,
    };
    let settings = SolveSettings { models: vec![truth.kind()], quantity: of.quantity, ..of.settings };
    let mut notes = Notes::new();
    let found = solve(&test, &settings, &mut notes).unwrap();
    (found, notes.to_texts().join("\n"))
}

fn records_of_displacement(truth: &Model) -> Signal<Displacement> {
    let response = truth.respond(V0, DT, 1201).unwrap();
    Signal::new(0.0, DT, response.compartment().displacement_m.clone()).unwrap()
}

/// Largest relative deviation of a parameter.
fn distance(found: &Model, truth: &Model) -> f64 {
    let found = found.parameters();
    truth.parameters().iter().map(|(name, p)| (found[name] / p - 1.0).abs()).fold(0.0, f64::max)
}

fn settings(method: Method, truth: &Model) -> SolveSettings {
    let p = truth.parameters();
    let triple = p.get("m3_kg").map(|m3| [p["m1_kg"], p["m2_kg"], *m3]);
    SolveSettings { methods: vec![method], split: MassSplit::FrontFraction(0.25), triple, ..SolveSettings::default() }
}

#[test]
fn every_model_comes_back_from_every_quantity() {
    // A crushed structure has knots by the record, not those of the truth: see force_deflection.rs.
    for kind in ModelKind::ALL.into_iter().filter(|kind| kind.name() != "force-deflection") {
        let truth = with_knot_at_crush(model(kind));
        for quantity in FitQuantity::ALL {
            let places = match kind {
                ModelKind::TripleSpringMassDamper => {
                    vec![SensorPlace::Compartment, SensorPlace::Front, SensorPlace::Chassis]
                }
                _ => vec![SensorPlace::Compartment],
            };
            // The whole record for the nonlinear models: up to dynamic crush the last knots hardly show.
            let fit_to_s = matches!(kind, ModelKind::Nonlinear1 | ModelKind::Nonlinear2).then_some(0.12);
            let settings = SolveSettings { fit_to_s, ..settings(Method::DirectFit, &truth) };
            let (found, notes) = run(Run { quantity, places, settings }, &truth);
            let best = found.iter().map(|c| distance(&c.model, &truth)).fold(f64::INFINITY, f64::min);
            eprintln!("{kind} {quantity}: {best:e} {:?}", found.first().map(|c| (c.id(), c.fit.clone())));
            // Rounding of the record, 1e-16, times a condition of up to 1e9 for the weakest of ten parameters; 1e-6 is
            // the acceptance limit.
            assert!(best < 1e-6, "{kind} {quantity}: {found:?} {notes}");
            for candidate in &found {
                let fit = candidate.fit.as_ref().unwrap();
                assert_eq!(fit.quantity, quantity);
            }
        }
    }
}

#[test]
fn a_sensor_on_the_chassis_tells_the_dual_apart_and_says_by_how_much() {
    let truth = model(ModelKind::DoubleSpringMassDamper);
    let of = |places| {
        let settings = settings(Method::DirectFit, &truth);
        run(Run { quantity: FitQuantity::Velocity, places, settings }, &truth)
    };
    let (alone, _) = of(vec![SensorPlace::Compartment]);
    assert_eq!(alone[0].equivalent_to, Some(2));
    let (both, notes) = of(vec![SensorPlace::Compartment, SensorPlace::Front]);
    // Exact records: rounding times the condition.
    assert!(distance(&both[0].model, &truth) < 1e-9, "{both:?}");
    assert!(both.iter().all(|c| c.equivalent_to.is_none()));
    assert!(notes.contains("not equivalent"), "{notes}");
    let sensors = &both[0].fit.as_ref().unwrap().sensors;
    assert_eq!((sensors[0].mass, sensors[1].mass), (2, 1));
}

#[test]
fn two_sensors_tell_the_mass_ratio() {
    let truth = model(ModelKind::DoubleSpringMassDamper);
    let settings = SolveSettings {
        mass_fit: MassFit::Shares { lower: 0.05, upper: 0.8 },
        split: MassSplit::FrontFraction(0.5),
        ..settings(Method::DirectFit, &truth)
    };
    let places = vec![SensorPlace::Compartment, SensorPlace::Front];
    let (found, _) = run(Run { quantity: FitQuantity::Displacement, places, settings }, &truth);
    // Exact records, condition below 1e4.
    assert!(distance(&found[0].model, &truth) < 1e-8, "{found:?}");
    let minimum = found[0].minimum.as_ref().unwrap();
    let assessed = minimum.assess(None, AssessmentOptions::default()).unwrap();
    assert!(assessed.standard_deviation.contains_key("m1_kg"));
}

#[test]
fn the_general_search_comes_to_the_same_models() {
    for kind in [ModelKind::Kelvin, ModelKind::Maxwell, ModelKind::DoubleSpringMassDamper, ModelKind::Nonlinear1] {
        let truth = model(kind);
        let settings = SolveSettings {
            l_shade: LShadeOptions { evaluations: 20_000, seed: 1 },
            fit_to_s: (kind == ModelKind::Nonlinear1).then_some(0.12),
            ..settings(Method::LShade, &truth)
        };
        let (found, notes) = run(Run { quantity: FitQuantity::Displacement, places: vec![], settings }, &truth);
        let best = found.iter().map(|c| distance(&c.model, &truth)).fold(f64::INFINITY, f64::min);
        eprintln!("{kind}: {best:e} {:?}", found.first().map(|c| &c.notes));
        // As the direct fits: it ends with the same descent.
        assert!(best < 1e-6, "{kind}: {found:?} {notes}");
    }
}

#[test]
fn noise_decides_how_much_a_sensor_counts() {
    let truth = model(ModelKind::DoubleSpringMassDamper);
    let mut records = records(&truth, FitQuantity::Displacement, 1201);
    // Alternating errors: 0.1 mm in the compartment, 5 mm on the front.
    let disturbed = |record: &Sampled, by: f64| {
        let samples =
            record.samples().iter().enumerate().map(|(k, x)| x + if k / 4 % 2 == 0 { by } else { -by }).collect();
        Sampled::new(0.0, DT, samples).unwrap()
    };
    records = vec![disturbed(&records[0], 5e-3), disturbed(&records[1], 1e-4)];
    let sensor = |place, record| Sensor {
        channel: "channel",
        place,
        quantity: FitQuantity::Displacement,
        record,
        measurement: None,
        noise: None,
    };
    let sensors = [sensor(SensorPlace::Compartment, &records[1]), sensor(SensorPlace::Front, &records[0])];
    let events = truth.events(V0).unwrap();
    let test = TestData {
        mass_kg: 1500.0,
        impact_speed_m_per_s: V0,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        dynamic_crush_m: events.dynamic_crush_m,
        coefficient_of_restitution: None,
        time_of_rebound_s: None,
        displacement: None,
        measurement: None,
        sensors: &sensors,
    };
    let settings = SolveSettings { models: vec![truth.kind()], ..settings(Method::DirectFit, &truth) };
    let found = solve(&test, &settings, &mut Notes::new()).unwrap();
    let fit = found[0].fit.as_ref().unwrap();
    // The levels are those put in, to what four parameters can follow of an alternating error.
    assert!(
        (fit.sensors[0].noise / 1e-4 - 1.0).abs() < 0.1 && (fit.sensors[1].noise / 5e-3 - 1.0).abs() < 0.1,
        "{fit:?}"
    );
    assert!(distance(&found[0].model, &truth) < 0.02, "{:?}", found[0]);
}

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
    let assessed = minimum.assess(None, AssessmentOptions::default()).unwrap();
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
