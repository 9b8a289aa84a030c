//! What the solver answers for whole tests, the awkward ones included.

#![allow(clippy::unwrap_used, reason = "a failing helper is a failing test")]

use crumple_lumped::{DoubleSpringMassDamper, Model, ModelKind};
use crumple_parameter_solve::{Candidate, Evidence, MODELS, MassSplit, Method, SolveError, SolveSettings, solve};
use crumple_signal::{Displacement, Notes, Signal};

const V0: f64 = 13.0;

fn car() -> DoubleSpringMassDamper {
    DoubleSpringMassDamper {
        m1_kg: 375.0,
        m2_kg: 1125.0,
        k1_n_per_m: 900_000.0,
        k2_n_per_m: 1_000_000.0,
        c1_n_s_per_m: 6_000.0,
        c2_n_s_per_m: 9_000.0,
    }
}

fn record() -> Signal<Displacement> {
    let response = Model::DoubleSpringMassDamper(car()).respond(V0, 1e-4, 1501).unwrap();
    Signal::new(0.0, 1e-4, response.compartment().displacement_m.clone()).unwrap()
}

fn evidence(displacement: &Signal<Displacement>) -> Evidence<'_> {
    let events = car().events(V0).unwrap()[1];
    Evidence {
        mass_kg: 1500.0,
        impact_speed_m_per_s: V0,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        dynamic_crush_m: events.dynamic_crush_m,
        coefficient_of_restitution: Some(0.15),
        time_zero_s: 0.0,
        time_of_rebound_s: None,
        displacement: Some(displacement),
        sensors: &[],
    }
}

fn settings() -> SolveSettings {
    SolveSettings {
        models: MODELS.iter().copied().filter(|m| *m != ModelKind::TripleSpringMassDamper).collect(),
        ..SolveSettings::default()
    }
}

#[test]
fn every_model_gives_its_candidates_and_duals_point_at_each_other() {
    let (record, mut notes) = (record(), Notes::new());
    let found = solve(&evidence(&record), &settings(), &mut notes).unwrap();
    let ids: Vec<String> = found.iter().map(Candidate::id).collect();
    assert_eq!(
        ids,
        [
            "kelvin/closed-form/1",
            "elastoplastic/closed-form/1",
            "maxwell/direct-fit/1",
            "nonlinear-1/direct-fit/1",
            "nonlinear-2/direct-fit/1",
            "double-spring-mass-damper/direct-fit/1",
            "double-spring-mass-damper/direct-fit/2"
        ]
    );
    assert_eq!(found[5].equivalent_id().as_ref(), Some(&ids[6]));
    assert_eq!(found[6].equivalent_id().as_ref(), Some(&ids[5]));
    let Model::DoubleSpringMassDamper(double) = found[5].model else { panic!("{found:?}") };
    // The record is exact and the assumed mass split is that of the car.
    assert!((double.k1_n_per_m / 9e5 - 1.0).abs() < 1e-6 && (double.c2_n_s_per_m / 9e3 - 1.0).abs() < 1e-6);
    assert!(found.iter().all(|c| c.model.is_physical()));
    let texts = notes.to_texts().join("\n");
    assert!(texts.contains("m1 = 375.00 kg, m2 = 1125.00 kg: front mass fraction 0.25 assumed"), "{texts}");
    assert!(texts.contains("no Kelvin damping ratio exists"), "{texts}");
}

#[test]
fn a_record_that_never_stops_has_no_single_mass_model_but_still_a_double_one() {
    let (whole, mut notes) = (record(), Notes::new());
    // The first 40 ms: still fast.
    let cut = Signal::from(whole.slice(0, 401));
    let still_moving = Evidence {
        time_of_dynamic_crush_s: None,
        dynamic_crush_m: None,
        coefficient_of_restitution: None,
        ..evidence(&cut)
    };
    let found = solve(&still_moving, &settings(), &mut notes).unwrap();
    assert!(found.len() >= 2 && found.iter().all(|c| c.model.kind() == ModelKind::DoubleSpringMassDamper));
    assert!((found[0].fit.as_ref().unwrap().to_s - 0.04).abs() < 2e-4);
    let texts = notes.to_texts().join("\n");
    assert!(
        texts.contains("warning: kelvin: not solved, since the velocity of the record never reaches zero"),
        "{texts}"
    );
    assert!(texts.contains("warning: elastoplastic: not solved, since"), "{texts}");
    assert!(texts.contains("fitted up to the end of the record"), "{texts}");
}

#[test]
fn without_rebound_the_elastoplastic_model_is_left_out_with_the_reason() {
    let (record, mut notes) = (record(), Notes::new());
    let settings = SolveSettings { models: vec![ModelKind::Elastoplastic], ..settings() };
    for (restitution, reason) in [(None, "is not known"), (Some(0.0), "shows no rebound"), (Some(1.5), "at most 1")] {
        let test = Evidence { coefficient_of_restitution: restitution, ..evidence(&record) };
        assert!(solve(&test, &settings, &mut notes).unwrap().is_empty());
        assert!(notes.to_texts().last().unwrap().contains(reason), "{:?}", notes.to_texts());
    }
}

#[test]
fn a_method_that_does_not_solve_a_model_is_said_so() {
    let (record, mut notes) = (record(), Notes::new());
    let settings = SolveSettings { methods: vec![Method::ClosedForm], ..settings() };
    let found = solve(&evidence(&record), &settings, &mut notes).unwrap();
    assert_eq!(found.len(), 2);
    assert!(notes.to_texts().join("\n").contains("double-spring-mass-damper: none of the methods"), "{notes:?}");
}

#[test]
fn masses_come_from_what_is_given() {
    let record = record();
    let masses = |split| {
        let settings = SolveSettings { models: vec![ModelKind::DoubleSpringMassDamper], split, ..settings() };
        let mut notes = Notes::new();
        solve(&evidence(&record), &settings, &mut notes).map(|found| {
            let p = found[0].model.parameters();
            (p["m1_kg"], p["m2_kg"], notes.to_texts()[0].clone())
        })
    };
    assert_eq!(masses(MassSplit::Front(300.0)).unwrap().1, 1200.0);
    assert_eq!(masses(MassSplit::Rear(1200.0)).unwrap().0, 300.0);
    let (m1, m2, note) = masses(MassSplit::Both(300.0, 1100.0)).unwrap();
    assert_eq!((m1, m2), (300.0, 1100.0));
    assert!(note.contains("their sum 1400.0 kg is not the test mass 1500.0 kg"), "{note}");
    for split in [MassSplit::Front(1500.0), MassSplit::Rear(-1.0), MassSplit::FrontFraction(1.0)] {
        assert!(matches!(masses(split), Err(SolveError::Value { .. })), "{split:?}");
    }
}
