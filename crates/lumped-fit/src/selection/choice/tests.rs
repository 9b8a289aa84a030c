//! The choice among made candidates.

use nalgebra::{DMatrix, DVector};

use super::*;
use crate::selection::compared::{OwnTestErrors, TestEvent};
use crate::selection::evidence::Evidence;
use crate::selection::rating::TERM_S;

/// Misses each of twelve terms by so much; each of its numbers moves a term of its own by ten of what is not known.
fn candidate(id: &str, class: EnergyClass, parameters: usize, misfit: f64) -> ComparedCandidate {
    let signs = [1.0, -1.0, -1.0, 1.0, 1.0, 1.0, -1.0, 1.0, -1.0, -1.0, 1.0, 1.0];
    let terms = DVector::from_fn(12, |k, _| if k < parameters { 0.0 } else { misfit * signs[k] });
    let sensitivity = DMatrix::from_fn(12, parameters, |row, column| if row == column { 10.0 } else { 0.0 });
    ComparedCandidate {
        id: id.to_owned(),
        model: id.to_owned(),
        class,
        parameters,
        is_assessed: true,
        unidentified: Vec::new(),
        order_of_magnitude: 0,
        affects_other_speeds: Vec::new(),
        on_bound: Vec::new(),
        physical: true,
        misfit: Some(misfit),
        evidence: Some(Evidence { terms, sensitivity, names: Vec::new() }),
        fit_percent: Some(99.0 - 0.1 * misfit),
        worst_sensor: None,
        restitution: Some(0.15),
        force_misfit_percent: None,
        own_test: OwnTestErrors { crush: Some(0.01), time: Some(0.01), restitution: Some(0.01), velocity: Some(0.0) },
        crush_error_at_lower_speeds: (class == EnergyClass::Plastic).then_some(0.0),
    }
}

/// Noise of 1 in every term: the discrepancy of 2 % of the record is nothing beside it.
fn record() -> ComparedRecord {
    // So that the noise of a term is 1.
    let size = TERM_S.recip().sqrt();
    ComparedRecord { rms: size, noise: size, restitution: Some(0.15) }
}

fn chosen(candidates: &[ComparedCandidate]) -> CandidateSelection {
    choose(candidates, &record(), &SelectionRules::default())
}

fn ids(candidates: &[ComparedCandidate]) -> [Option<&str>; 3] {
    let selection = chosen(candidates);
    [selection.recommended, selection.simplest, selection.closest]
        .map(|choice| choice.candidate.map(|k| candidates[k].id.as_str()))
}

fn open(candidate: ComparedCandidate, names: &[&str]) -> ComparedCandidate {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    ComparedCandidate { unidentified: names.clone(), affects_other_speeds: names, ..candidate }
}

#[test]
fn weights_are_those_of_the_sums_and_the_heaviest_is_recommended() {
    // Ten terms of 1 and nine of 0.5 beside two and three numbers that cost ln 101 each.
    let two = candidate("two", EnergyClass::Plastic, 2, 1.0);
    let three = candidate("three", EnergyClass::Plastic, 3, 0.5);
    let selection = chosen(&[two.clone(), three.clone()]);
    let sigma2 = 1.0 + 0.02 * 0.02;
    let cost = |p: f64, misfit: f64| (12.0 - p) * misfit * misfit / sigma2 + p * (100.0 / sigma2 + 1.0_f64).ln();
    let difference = cost(3.0, 0.5) - cost(2.0, 1.0);
    let rated = &selection.rated;
    assert!((rated[1].score.unwrap() - rated[0].score.unwrap() - difference).abs() < 1e-9, "{rated:?}");
    // A number more halves the odds.
    let difference = difference + 2.0 * 2.0_f64.ln();
    assert!((rated[1].weight / rated[0].weight - (-0.5 * difference).exp()).abs() < 1e-9);
    assert!((rated[0].weight + rated[1].weight - 1.0).abs() < 1e-12);
    let heavier = usize::from(difference < 0.0);
    assert_eq!((selection.recommended.candidate, selection.terms), (Some(heavier), Some(12)));
    assert_eq!(selection.strength, Some((Strength::Weak, 1 - heavier)));
}

#[test]
fn a_damped_model_must_win_by_more_than_the_prior() {
    // Ten terms of 2 cost 40; of 1.8 they cost 32: less than the prior of 10 away.
    let plastic = candidate("plastic", EnergyClass::Plastic, 2, 2.0);
    let near = candidate("damped", EnergyClass::Damped, 2, 1.8);
    assert_eq!(ids(&[plastic.clone(), near.clone()]), [Some("plastic"), Some("plastic"), Some("damped")]);
    let without = SelectionRules { plastic_prior: 0.0, ..SelectionRules::default() };
    assert_eq!(choose(&[plastic.clone(), near], &record(), &without).recommended.candidate, Some(1));
    let far = candidate("damped", EnergyClass::Damped, 2, 0.5);
    assert_eq!(chosen(&[plastic.clone(), far.clone()]).strength, Some((Strength::Decisive, 0)));
    assert_eq!(chosen(std::slice::from_ref(&far)).strength, None);
    assert_eq!(ids(&[plastic, far])[0], Some("damped"));
}

#[test]
fn of_models_that_the_record_does_not_tell_apart_the_simpler_is_recommended() {
    // Numbers that move nothing cost the score nothing.
    let mut six = candidate("six", EnergyClass::Damped, 2, 0.99);
    six.parameters = 6;
    assert_eq!(ids(&[six, candidate("two", EnergyClass::Damped, 2, 1.0)])[0], Some("two"));
}

#[test]
fn what_the_best_misses_no_model_is_known_to_describe() {
    // The best misses ten times the noise: differences count by that, not by the noise.
    let best = candidate("best", EnergyClass::Plastic, 2, 10.0);
    let next = candidate("next", EnergyClass::Plastic, 2, 11.0);
    let gap = chosen(&[best, next]).rated[1].difference.unwrap();
    // 10 (11² - 10²)/10², of what is known to one of ten terms.
    assert!((gap - 2.1).abs() < 1e-9, "{gap}");
}

#[test]
fn numbers_that_nothing_determines_do_not_win_where_the_record_itself_answers() {
    let plastic = candidate("plastic", EnergyClass::Plastic, 2, 3.0);
    let damped = open(candidate("damped", EnergyClass::Damped, 4, 0.5), &["c2", "c3"]);
    let both = [plastic, damped.clone()];
    assert_eq!(ids(&both)[0], Some("plastic"));
    let selection = chosen(&both);
    assert_eq!(selection.rated[1].weight, 0.0);
    let because = &selection.recommended.because;
    assert!(because.contains("lower, but 2 of its 4 numbers are not determined and felt at other speeds"), "{because}");
    let unknown = ComparedCandidate {
        unidentified: ["k1", "c1", "k2", "c2"].map(str::to_owned).to_vec(),
        ..candidate("unknown", EnergyClass::Damped, 4, 0.5)
    };
    assert_eq!(ids(&[both[0].clone(), unknown])[0], Some("plastic"));
    // An open knot of a curve is in its interval.
    let curve = open(candidate("curve", EnergyClass::Plastic, 4, 0.5), &["knot3_n"]);
    assert_eq!(ids(&[both[0].clone(), curve])[0], Some("curve"));
    // Alone it is what there is.
    assert_eq!(ids(&[damped])[0], Some("damped"));
}

#[test]
fn what_is_not_adequate_has_no_say() {
    let good = candidate("good", EnergyClass::Plastic, 2, 1.0);
    let bound =
        ComparedCandidate { on_bound: vec!["k".to_owned()], ..candidate("bound", EnergyClass::Plastic, 2, 0.1) };
    let active = ComparedCandidate { physical: false, ..candidate("active", EnergyClass::Plastic, 2, 0.1) };
    let poor = ComparedCandidate { fit_percent: Some(60.0), ..candidate("poor", EnergyClass::Plastic, 1, 3.0) };
    let all = [good, bound, active, poor];
    assert_eq!(ids(&all), [Some("good"), Some("good"), Some("bound")]);
    let why: Vec<Option<String>> = chosen(&all).rated.iter().map(Rated::why_inadequate).collect();
    let expected = [
        None,
        Some("on a bound of its search: k"),
        Some("a spring or damper is negative"),
        Some("displacement fit of 60.0 % below 90 %"),
    ];
    assert_eq!(why, expected.map(|why| why.map(str::to_owned)));
    let none = chosen(&all[3..]);
    assert_eq!((none.recommended.candidate, none.terms), (None, None));
    assert!(chosen(&[]).closest.candidate.is_none());
}

#[test]
fn an_adequate_model_repeats_its_own_test() {
    let near = candidate("near", EnergyClass::Plastic, 2, 2.0);
    let own = near.own_test;
    let off = |own_test: OwnTestErrors| ComparedCandidate { own_test, ..candidate("off", EnergyClass::Damped, 2, 0.1) };
    let first_reason = |off: &ComparedCandidate| {
        let selection = chosen(&[near.clone(), off.clone()]);
        assert_eq!(selection.recommended.candidate, Some(0));
        selection.rated[1].inadequate[0].clone()
    };
    let missed = |event, error, limit| Inadequacy::Misses { event, error, limit };
    let crush = off(OwnTestErrors { crush: Some(-0.04), ..own });
    assert_eq!(first_reason(&crush), missed(TestEvent::Crush, -0.04, 0.035));
    assert_eq!(first_reason(&crush).to_string(), "misses the dynamic crush of its own test by -4.0 %, limit 3.5 %");
    let late = OwnTestErrors { time: Some(0.2), velocity: Some(0.08), ..own };
    assert_eq!(first_reason(&off(late)), missed(TestEvent::Time, 0.2, 0.05));
    let rebound = off(OwnTestErrors { restitution: Some(0.27), ..own });
    assert_eq!(first_reason(&rebound), missed(TestEvent::Restitution, 0.27, 0.1));
    assert_eq!(first_reason(&off(OwnTestErrors::default())), Inadequacy::NeverStops);
    // A record that ends before the rebound has no restitution to miss.
    let unknown = off(OwnTestErrors { restitution: None, ..own });
    assert_eq!(ids(&[near.clone(), unknown])[0], Some("off"));
    // Where the velocity creeps to zero the time of crush is hardly defined.
    let creeps = off(OwnTestErrors { velocity: Some(0.02), ..late });
    assert_eq!(ids(&[near, creeps])[0], Some("off"));
}

#[test]
fn where_none_is_adequate_one_that_misses_the_rebound_alone_is_good_for_its_crush() {
    let own = candidate("", EnergyClass::Damped, 2, 1.0).own_test;
    let off = |id: &str, own_test: OwnTestErrors| ComparedCandidate {
        own_test,
        ..candidate(id, EnergyClass::Damped, 2, 0.5)
    };
    let crush = off("crush", OwnTestErrors { crush: Some(0.05), ..own });
    let rebound = off("rebound", OwnTestErrors { restitution: Some(0.3), ..own });
    let all = [crush, rebound];
    assert_eq!(ids(&all)[0], Some("rebound"));
    let selection = chosen(&all);
    assert_eq!(selection.rated[1].missed_events(), ["coefficient_of_restitution"]);
    assert!(!selection.rated[1].is_adequate());
    // No adequate one is named where there is none.
    assert!(selection.simplest.candidate.is_none() && selection.simplest.because.contains("no candidate is adequate"));
    assert!(selection.recommended.because.contains("the only candidate with the crush of the test"));
    assert!(selection.recommended.because.contains("misses the restitution of its own test by +0.30"));
    assert_eq!(ids(&all[..1])[0], None);
}

#[test]
fn the_crush_at_lower_speeds_and_the_force_on_the_wall_are_terms_of_the_sum() {
    let error = |id: &str, misfit: f64, error: f64| ComparedCandidate {
        crush_error_at_lower_speeds: Some(error),
        ..candidate(id, EnergyClass::Plastic, 2, misfit)
    };
    // 1 % is one standard deviation: 36 for the line, which ten terms of 1 for 2 do not outweigh.
    let (line, curve) = (error("line", 1.0, 0.06), error("curve", 2.0, 0.002));
    assert_eq!(ids(&[line.clone(), curve])[0], Some("curve"));
    assert!(chosen(std::slice::from_ref(&line)).rated[0].terms.contains(&("lower speeds", 36.0)));
    let unknown = ComparedCandidate { crush_error_at_lower_speeds: None, ..line };
    assert_eq!(ids(&[unknown, error("other", 1.0, 0.012)])[0], Some("line"));
    let wall =
        ComparedCandidate { force_misfit_percent: Some(70.0), ..candidate("wall", EnergyClass::Plastic, 2, 0.5) };
    // 35 % is two standard deviations.
    assert!(chosen(std::slice::from_ref(&wall)).rated[0].terms.contains(&("wall force", 16.0)));
    assert_eq!(ids(&[wall, candidate("good", EnergyClass::Plastic, 2, 0.9)])[0], Some("good"));
}

#[test]
fn a_restitution_unlike_that_of_the_test_costs() {
    let bouncy = ComparedCandidate { restitution: Some(0.6), ..candidate("bouncy", EnergyClass::Plastic, 2, 1.0) };
    let selection = chosen(&[bouncy, candidate("plain", EnergyClass::Plastic, 2, 1.0)]);
    let term = selection.rated[0].terms.iter().find(|(name, _)| *name == "restitution").unwrap().1;
    assert!((term - (4.0_f64.ln() / 0.35).powi(2)).abs() < 1e-12);
    assert_eq!(selection.recommended.candidate, Some(1));
    let wide = SelectionRules {
        restitution_deviation: 0.0,
        plastic_prior: 0.0,
        number_prior: 0.0,
        ..SelectionRules::default()
    };
    assert!(wide.terms(&candidate("a", EnergyClass::Elastic, 1, 1.0), None).is_empty());
    assert!(wide.priors(None).is_empty());
}

#[test]
fn a_sensor_that_one_model_follows_speaks_against_those_that_do_not() {
    let follows = |candidate: ComparedCandidate, percent| ComparedCandidate {
        worst_sensor: Some(("engine".to_owned(), percent)),
        ..candidate
    };
    let one_mass = follows(candidate("one mass", EnergyClass::Plastic, 2, 0.5), 40.0);
    let two = candidate("two masses", EnergyClass::Damped, 4, 2.0);
    let both = [one_mass.clone(), follows(two.clone(), 95.0)];
    assert_eq!(ids(&both), [Some("two masses"), Some("two masses"), Some("one mass")]);
    let why = chosen(&both).rated[0].why_inadequate();
    assert_eq!(why.as_deref(), Some("follows the displacement of engine to 40.0 %, limit 90 %"));
    // A sensor that nobody follows decides nothing.
    assert_eq!(ids(&[one_mass, follows(two, 80.0)])[0], Some("one mass"));
}
