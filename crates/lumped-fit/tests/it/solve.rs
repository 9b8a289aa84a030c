//! What the solver answers for whole tests, the awkward ones included.

use crumple_lumped::{DoubleSpringMassDamper, Kelvin, Maxwell, Model, ModelKind};
use crumple_lumped_fit::{Candidate, MassSplit, Method, SolveError, SolveSettings, TestData, solve};
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

fn test(displacement: &Signal<Displacement>) -> TestData<'_> {
    let events = car().events(V0).unwrap()[1];
    TestData {
        mass_kg: 1500.0,
        impact_speed_m_per_s: V0,
        time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
        dynamic_crush_m: events.dynamic_crush_m,
        coefficient_of_restitution: Some(0.15),
        time_of_rebound_s: None,
        displacement: Some(displacement),
        measurement: None,
        sensors: &[],
    }
}

fn settings() -> SolveSettings {
    SolveSettings {
        models: SolveSettings::all_models()
            .iter()
            .copied()
            .filter(|m| *m != ModelKind::TripleSpringMassDamper)
            .collect(),
        ..SolveSettings::default()
    }
}

#[test]
fn every_model_gives_its_candidates_and_duals_point_at_each_other() {
    let (record, mut notes) = (record(), Notes::new());
    let found = solve(&test(&record), &settings(), &mut notes).unwrap();
    let ids: Vec<String> = found.iter().map(Candidate::id).collect();
    assert_eq!(
        ids,
        [
            "kelvin/closed-form/1",
            "kelvin/direct-fit/1",
            "elastoplastic/closed-form/1",
            "maxwell/direct-fit/1",
            "nonlinear-1/direct-fit/1",
            "nonlinear-2/direct-fit/1",
            "double-spring-mass-damper/direct-fit/1",
            "double-spring-mass-damper/direct-fit/2",
            "force-deflection/direct-fit/1",
            "force-deflection/direct-fit/2",
            "force-deflection/direct-fit/3"
        ]
    );
    assert_eq!(found[6].equivalent_id().as_ref(), Some(&ids[7]));
    assert_eq!(found[7].equivalent_id().as_ref(), Some(&ids[6]));
    let Model::DoubleSpringMassDamper(double) = found[6].model else { panic!("{found:?}") };
    // The record is exact and the assumed mass split is that of the car.
    assert!((double.k1_n_per_m / 9e5 - 1.0).abs() < 1e-6 && (double.c2_n_s_per_m / 9e3 - 1.0).abs() < 1e-6);
    assert!(found.iter().all(|c| c.model.is_physical()));
    let texts = notes.to_texts().join("\n");
    assert!(texts.contains("m1 = 375.00 kg, m2 = 1125.00 kg: front mass fraction 0.25 is an assumption"), "{texts}");
    assert!(texts.contains("no damping ratio fits"), "{texts}");
}

#[test]
fn a_record_that_never_stops_has_no_kelvin_closed_form_but_all_other_models() {
    let (whole, mut notes) = (record(), Notes::new());
    // The first 40 ms: still fast.
    let cut = Signal::from(whole.slice(0, 401));
    let still_moving = TestData {
        time_of_dynamic_crush_s: None,
        dynamic_crush_m: None,
        coefficient_of_restitution: None,
        ..test(&cut)
    };
    let found = solve(&still_moving, &settings(), &mut notes).unwrap();
    let has = |kind| found.iter().any(|c| c.model.kind() == kind);
    assert!(settings().models.into_iter().all(has));
    assert!(!found.iter().any(|c| c.id() == "kelvin/closed-form/1"));
    for candidate in &found {
        assert!((candidate.fit.as_ref().unwrap().to_s - 0.04).abs() < 2e-4, "{}", candidate.id());
    }
    let texts = notes.to_texts().join("\n");
    assert!(texts.contains("warning: kelvin: not solved: the velocity never reaches zero"), "{texts}");
    assert!(texts.contains("no dynamic crush for closed-form. Use direct-fit"), "{texts}");
    assert!(texts.contains("warning: elastoplastic: the velocity of the record never reaches zero"), "{texts}");
    assert!(texts.contains("double-spring-mass-damper: fitted up to the end of the record"), "{texts}");
}

#[test]
fn a_record_too_coarse_for_a_fit_keeps_its_closed_forms() {
    let (whole, mut notes) = (record(), Notes::new());
    // Every 10 ms, as an event data recorder writes it: 7 or so up to dynamic crush, of 12 that a fit needs.
    let coarse: Vec<f64> = whole.samples().iter().step_by(100).copied().collect();
    let coarse = Signal::new(0.0, 1e-2, coarse).unwrap();
    let found = solve(&test(&coarse), &settings(), &mut notes).unwrap();
    let ids: Vec<String> = found.iter().map(Candidate::id).collect();
    assert_eq!(ids, ["kelvin/closed-form/1", "elastoplastic/closed-form/1"]);
    let texts = notes.to_texts().join("\n");
    assert!(texts.contains("warning: maxwell: not fitted by direct-fit: ") && texts.contains("at least 12"), "{texts}");
}

#[test]
fn without_a_restitution_the_elastoplastic_model_is_left_out_with_the_reason() {
    let (record, mut notes) = (record(), Notes::new());
    let settings = SolveSettings { models: vec![ModelKind::Elastoplastic], ..settings() };
    for (restitution, reason) in [(None, "is not known"), (Some(1.5), "at most 1")] {
        let test = TestData { coefficient_of_restitution: restitution, ..test(&record) };
        assert!(solve(&test, &settings, &mut notes).unwrap().is_empty());
        assert!(notes.to_texts().last().unwrap().contains(reason), "{:?}", notes.to_texts());
    }
}

#[test]
fn a_rebound_of_nothing_is_a_rigid_unloading_and_no_huge_number() {
    let record = record();
    let settings = SolveSettings { models: vec![ModelKind::Elastoplastic], ..settings() };
    for restitution in [0.0, 1e-15, 0.003, 0.029] {
        let mut notes = Notes::new();
        let test = TestData { coefficient_of_restitution: Some(restitution), ..test(&record) };
        let found = solve(&test, &settings, &mut notes).unwrap();
        let p = found[0].model.parameters();
        // Of a rebound of 3 %; some roundings of the quotient.
        let ratio = p["unloading_stiffness_n_per_m"] / p["loading_stiffness_n_per_m"];
        assert!((ratio * 0.03 * 0.03 - 1.0).abs() < 1e-14, "{p:?}");
        let text = "the unloading is rigid, and its stiffness not determined";
        assert!(found[0].notes.iter().any(|note| note.text.contains(text)), "{:?}", found[0].notes);
        assert!(notes.to_texts().iter().any(|note| note.starts_with("warning: ") && note.contains(text)), "{notes:?}");
    }
}

#[test]
fn a_method_that_does_not_solve_a_model_is_said_so() {
    let (record, mut notes) = (record(), Notes::new());
    let settings = SolveSettings { methods: vec![Method::ClosedForm], ..settings() };
    let found = solve(&test(&record), &settings, &mut notes).unwrap();
    assert_eq!(found.len(), 2);
    assert!(notes.to_texts().join("\n").contains("double-spring-mass-damper: none of the methods"), "{notes:?}");
}

#[test]
fn masses_come_from_what_is_given() {
    let record = record();
    let masses = |split| {
        let settings = SolveSettings { models: vec![ModelKind::DoubleSpringMassDamper], split, ..settings() };
        let mut notes = Notes::new();
        solve(&test(&record), &settings, &mut notes).map(|found| {
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

/// The first 40 ms of a swing that stops at 70 ms: no event is known.
fn cut_short(model: &Model) -> Signal<Displacement> {
    let response = model.respond(V0, 1e-4, 401).unwrap();
    Signal::new(0.0, 1e-4, response.compartment().displacement_m.clone()).unwrap()
}

fn without_events(displacement: &Signal<Displacement>) -> TestData<'_> {
    TestData {
        time_of_dynamic_crush_s: None,
        dynamic_crush_m: None,
        coefficient_of_restitution: None,
        ..test(displacement)
    }
}

#[test]
fn a_record_that_never_stops_is_fitted_up_to_its_end() {
    let stiffness_n_per_m = 1500.0 * (std::f64::consts::FRAC_PI_2 / 0.07).powi(2);
    let record = cut_short(&Model::Kelvin(Kelvin { mass_kg: 1500.0, stiffness_n_per_m, damping_n_s_per_m: 0.0 }));
    let models = vec![ModelKind::Elastoplastic, ModelKind::Maxwell, ModelKind::Nonlinear1, ModelKind::Nonlinear2];
    let mut notes = Notes::new();
    let found =
        solve(&without_events(&record), &SolveSettings { models, ..SolveSettings::default() }, &mut notes).unwrap();
    let ids: Vec<String> = found.iter().map(Candidate::id).collect();
    assert_eq!(
        ids,
        ["elastoplastic/closed-form/1", "maxwell/direct-fit/1", "nonlinear-1/direct-fit/1", "nonlinear-2/direct-fit/1"]
    );
    for candidate in &found {
        let fit = candidate.fit.as_ref().unwrap();
        assert!((fit.to_s - 0.04).abs() < 2e-4, "{}: {}", candidate.id(), fit.to_s);
        // Every one of them holds an undamped spring: Maxwell with a rigid damper, the nonlinear ones with equal knots.
        assert!(fit.rmse < 1e-4, "{}: {}", candidate.id(), fit.rmse);
    }
    // The loading part is that spring; the unloading is not determined and says so. Sensitivity near one, least squares
    // to 1e-12.
    let p = found[0].model.parameters();
    assert!((p["loading_stiffness_n_per_m"] / stiffness_n_per_m - 1.0).abs() < 1e-6, "{p:?}");
    assert_eq!(found[0].fit.as_ref().unwrap().active_bounds, ["unloading_stiffness_n_per_m"]);
    assert!(found[0].notes.iter().any(|n| n.text.contains("The unloading stiffness is set to the loading")));
    assert!(
        found[2].notes.iter().any(|n| n.text.contains("conditions at dynamic crush are left out")),
        "{:?}",
        found[2].notes
    );
    assert_eq!(notes.iter().filter(|n| n.text.contains("never reaches zero: fitted up to 40.00 ms")).count(), 4);
}

#[test]
fn a_maxwell_model_that_creeps_comes_back() {
    // Two real roots: critical at sqrt(k m)/2 = 3.1e4 N·s/m; the mass creeps to m v0/c.
    let truth = Maxwell { mass_kg: 1300.0, stiffness_n_per_m: 3e6, damping_n_s_per_m: 25_000.0 };
    let response = Model::Maxwell(truth).respond(14.0, 1e-4, 2501).unwrap();
    let record = Signal::new(0.0, 1e-4, response.compartment().displacement_m.clone()).unwrap();
    let test = TestData { mass_kg: 1300.0, impact_speed_m_per_s: 14.0, ..without_events(&record) };
    for fit_to_s in [None, Some(0.2)] {
        let settings = SolveSettings { models: vec![ModelKind::Maxwell], fit_to_s, ..SolveSettings::default() };
        let found = solve(&test, &settings, &mut Notes::new()).unwrap();
        let p = found[0].model.parameters();
        // The acceptance limit of records with known parameters.
        assert!((p["stiffness_n_per_m"] / 3e6 - 1.0).abs() < 1e-6, "{p:?}");
        assert!((p["damping_n_s_per_m"] / 25_000.0 - 1.0).abs() < 1e-6, "{p:?}");
    }
    let beyond = SolveSettings { models: vec![ModelKind::Maxwell], fit_to_s: Some(2.0), ..SolveSettings::default() };
    assert!(matches!(solve(&test, &beyond, &mut Notes::new()), Err(SolveError::Window { .. })));
}
