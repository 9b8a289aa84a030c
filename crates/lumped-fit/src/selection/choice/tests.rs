//! The choice among made candidates.

use super::*;
use crate::selection::compared::{OwnTestErrors, TestEvent};
use crate::selection::rating::ComparedWave;

/// A misfit of noise of this size that is told apart from sample to sample.
fn candidate(id: &str, class: EnergyClass, parameters: usize, misfit: f64) -> ComparedCandidate {
    let signs = [1.0, -1.0, -1.0, 1.0, 1.0, 1.0, -1.0, 1.0, -1.0, -1.0];
    let misfit: Vec<f64> = (0..40).map(|k| misfit * signs[k % 10]).collect();
    ComparedCandidate {
        id: id.to_owned(),
        model: id.to_owned(),
        class,
        masses: 1,
        parameters,
        is_assessed: true,
        unidentified: Vec::new(),
        order_of_magnitude: 0,
        affects_other_speeds: Vec::new(),
        on_bound: Vec::new(),
        physical: true,
        slow_misfit: Some(misfit.clone()),
        fit_percent: Some(99.0 - misfit[0]),
        worst_sensor: None,
        misfit: Some(misfit),
        restitution: Some(0.15),
        force_misfit_percent: None,
        own_test: OwnTestErrors { crush: Some(0.01), time: Some(0.01), restitution: Some(0.01) },
        crush_error_at_lower_speeds: (class == EnergyClass::Plastic).then_some(0.0),
    }
}

/// One wave of 20 independent samples.
fn record() -> ComparedRecord {
    let waves = vec![ComparedWave { samples: usize::MAX, most_independent: 20.0 }];
    ComparedRecord { rms: 100.0, waves, noise: None, restitution: Some(0.15) }
}

fn ids(candidates: &[ComparedCandidate], rules: &SelectionRules) -> [Option<String>; 3] {
    let selection = choose(candidates, &record(), rules);
    [selection.recommended, selection.simplest, selection.closest]
        .map(|choice| choice.candidate.map(|k| candidates[k].id.clone()))
}

fn some(names: [&str; 3]) -> [Option<String>; 3] {
    names.map(|name| Some(name.to_owned()))
}

#[test]
fn noise_that_is_known_gives_many_numbers_a_criterion() {
    let plastic = candidate("plastic", EnergyClass::Plastic, 2, 2.0);
    let many = candidate("many", EnergyClass::Damped, 12, 0.9);
    let choice = |noise| {
        let record = ComparedRecord { noise, ..record() };
        choose(&[plastic.clone(), many.clone()], &record, &SelectionRules::default())
    };
    // By misfits alone 12 numbers and their level are charged 87 for 20 samples, and gain 32.
    assert_eq!(choice(None).recommended.candidate, Some(0));
    // Of noise 1: 20 (4 - 0.81) = 64 are gained for 20 more, beyond the prior of 10; noise 0.4 does not explain it.
    let known = choice(Some(1.0));
    assert_eq!((known.recommended.candidate, known.samples), (Some(1), Some(20.0)));
    assert!((known.rated[1].aicc.unwrap() - (20.0 * 0.82 / 1.01 + 24.0)).abs() < 1e-9, "{:?}", known.rated);
    assert!(known.recommended.because.contains("known noise"), "{}", known.recommended.because);
    let unexplained = choice(Some(0.4)).recommended;
    assert_eq!((unexplained.candidate, unexplained.because.contains("known noise")), (Some(0), false));
}

#[test]
fn a_damped_model_must_win_by_more_than_the_prior() {
    // 20 ln((2/1.5)^2) = 11.5, less 2 for a number more and 2.2 for the correction: the prior of 10 holds.
    let plastic = candidate("plastic", EnergyClass::Plastic, 2, 2.0);
    let near = candidate("damped", EnergyClass::Damped, 3, 1.5);
    let rules = SelectionRules::default();
    assert_eq!(ids(&[plastic.clone(), near.clone()], &rules), some(["plastic", "plastic", "damped"]));
    let without = SelectionRules { plastic_prior: 0.0, ..rules };
    assert_eq!(ids(&[plastic.clone(), near], &without), some(["damped", "plastic", "damped"]));
    // 20 ln 16 = 55.
    let far = candidate("damped", EnergyClass::Damped, 3, 0.5);
    let strength = |all: &[ComparedCandidate]| choose(all, &record(), &rules).strength;
    assert_eq!(strength(&[plastic.clone(), far.clone()]), Some((Strength::Decisive, 0)));
    let same = candidate("same", EnergyClass::Plastic, 2, 2.0);
    assert_eq!(strength(&[plastic.clone(), same]), Some((Strength::Weak, 1)));
    assert_eq!(strength(std::slice::from_ref(&far)), None);
    assert_eq!(ids(&[plastic, far], &rules), some(["damped", "plastic", "damped"]));
}

#[test]
fn weak_evidence_prefers_the_simpler_of_models_that_are_not_plastic() {
    // 20 ln(1/0.75^2) = 11.5, less 4 for two numbers more and the correction for 20 samples.
    let two = candidate("two", EnergyClass::Damped, 2, 1.0);
    let four = candidate("four", EnergyClass::Damped, 4, 0.72);
    let rules = SelectionRules::default();
    let selection = choose(&[two.clone(), four.clone()], &record(), &rules);
    assert_eq!((selection.recommended.candidate, selection.strength), (Some(0), Some((Strength::Weak, 1))));
    assert!(selection.recommended.because.contains("fewer parameters than four, whose criterion is"));
    let decisive = candidate("four", EnergyClass::Damped, 4, 0.5);
    assert_eq!(ids(&[two, decisive], &rules)[0].as_deref(), Some("four"));
    let plastic = [("two", 2, 1.0), ("four", 4, 0.72)].map(|(id, n, e)| candidate(id, EnergyClass::Plastic, n, e));
    assert_eq!(ids(&plastic, &rules)[0].as_deref(), Some("four"));
}

#[test]
fn a_tenth_of_a_point_of_fit_does_not_overrule_a_difference_above_10() {
    let mut small = candidate("small", EnergyClass::Damped, 2, 1.0);
    let true_one = candidate("true", EnergyClass::Damped, 4, 0.5);
    small.fit_percent = Some(99.95);
    assert_eq!(ids(&[small, true_one], &SelectionRules::default()), some(["true", "small", "small"]));
}

#[test]
fn what_the_record_leaves_open_is_not_for_prediction() {
    let rules = SelectionRules::default();
    // 20 ln(1/0.75^2) = 11.5, less 2 for a number more and 1.2 for the correction: lower by 8.3.
    let mut open = candidate("open", EnergyClass::Plastic, 3, 0.75);
    open.unidentified = vec!["k3".to_owned()];
    let determined = candidate("determined", EnergyClass::Plastic, 2, 1.0);
    // Not felt at other speeds, it stands in the way of the simplest alone.
    let unfelt = [open.clone(), determined.clone()];
    assert_eq!(ids(&unfelt, &rules), some(["open", "determined", "open"]));
    open.affects_other_speeds.clone_from(&open.unidentified);
    let both = [open.clone(), determined];
    assert_eq!(ids(&both, &rules), some(["determined", "determined", "open"]));
    let selection = choose(&both, &record(), &rules);
    assert!(selection.recommended.because.contains("but 1 of its 3 numbers are not determined and felt"));
    // Alone, a curve with an open number is recommended and says so; a damped model is not.
    let [recommended, simplest, closest] = ids(&[open.clone()], &rules);
    assert_eq!((recommended.as_deref(), simplest, closest.as_deref()), (Some("open"), None, Some("open")));
    open.class = EnergyClass::Damped;
    assert_eq!(ids(&[open], &rules)[0], None);
}

#[test]
fn a_decisive_record_is_for_a_model_with_open_numbers_unless_most_of_them_are() {
    let rules = SelectionRules::default();
    // 20 ln 16 = 55 above one without open numbers.
    let determined = candidate("determined", EnergyClass::Plastic, 2, 2.0);
    let open = |names: &[&str]| {
        let open: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let close = candidate("open", EnergyClass::Damped, 4, 0.5);
        ComparedCandidate { affects_other_speeds: open.clone(), unidentified: open, ..close }
    };
    let half = [open(&["c2", "c3"]), determined.clone()];
    assert_eq!(ids(&half, &rules), some(["open", "determined", "open"]));
    let because = choose(&half, &record(), &rules).recommended.because;
    assert!(because.starts_with("damped, 2 of 4 parameters determined, 2 open (2 felt at other speeds)"), "{because}");
    let most = [open(&["c1", "c2", "c3"]), determined.clone()];
    assert_eq!(ids(&most, &rules), some(["determined", "determined", "open"]));
    // 20 ln(1.25^2) = 8.9: not decisive.
    let near = ComparedCandidate { misfit: candidate("", EnergyClass::Damped, 4, 1.6).misfit, ..open(&["c2"]) };
    assert_eq!(ids(&[near, determined.clone()], &rules)[0].as_deref(), Some("determined"));
    let misses_the_wall = ComparedCandidate { force_misfit_percent: Some(60.0), ..open(&["c2"]) };
    assert_eq!(ids(&[misses_the_wall, determined], &rules), some(["determined", "determined", "open"]));
}

#[test]
fn a_misfit_that_is_all_zero_level_leaves_a_choice_among_the_fewest_numbers() {
    let level = |mut candidate: ComparedCandidate, level: f64| {
        candidate.misfit = Some(vec![level; 40]);
        candidate
    };
    let two = level(candidate("two", EnergyClass::Plastic, 2, 1.0), 1.0);
    let worse = level(candidate("worse", EnergyClass::Plastic, 2, 1.0), 2.0);
    let three = level(candidate("three", EnergyClass::Plastic, 3, 0.9), 0.9);
    let all = [worse, three, two];
    assert_eq!(ids(&all, &SelectionRules::default())[0].as_deref(), Some("two"));
    assert_eq!(choose(&all, &record(), &SelectionRules::default()).samples, Some(5.0));
}

#[test]
fn what_is_not_adequate_has_no_say() {
    let good = candidate("good", EnergyClass::Plastic, 2, 1.0);
    let mut bound = candidate("bound", EnergyClass::Plastic, 2, 0.1);
    bound.on_bound = vec!["k".to_owned()];
    let mut active = candidate("active", EnergyClass::Plastic, 2, 0.1);
    active.physical = false;
    let mut poor = candidate("poor", EnergyClass::Plastic, 1, 3.0);
    poor.fit_percent = Some(60.0);
    let all = [good, bound, active, poor];
    assert_eq!(ids(&all, &SelectionRules::default()), some(["good", "good", "bound"]));
    let selection = choose(&all, &record(), &SelectionRules::default());
    let why: Vec<Option<String>> = selection.rated.iter().map(Rated::why_inadequate).collect();
    let expected = [
        None,
        Some("on a bound of its search: k"),
        Some("a spring or damper is negative"),
        Some("displacement fit of 60.0 % below 90 %"),
    ];
    assert_eq!(why, expected.map(|why| why.map(str::to_owned)));
    let none = choose(&all[3..], &record(), &SelectionRules::default());
    assert_eq!((none.recommended.candidate, none.samples), (None, None));
    assert!(choose(&[], &record(), &SelectionRules::default()).closest.candidate.is_none());
}

#[test]
fn too_many_numbers_and_a_missed_wall_are_refused() {
    let many = candidate("many", EnergyClass::Plastic, 18, 0.01);
    let mut wall = candidate("wall", EnergyClass::Plastic, 2, 0.5);
    wall.force_misfit_percent = Some(42.0);
    let good = candidate("good", EnergyClass::Plastic, 2, 0.9);
    let names = ids(&[many, wall, good], &SelectionRules::default());
    assert_eq!(names[0].as_deref(), Some("good"));
}

#[test]
fn a_wall_is_missed_in_proportion_to_the_best_of_as_many_masses() {
    let missing = |id: &str, masses: usize, misfit: f64, force: f64| ComparedCandidate {
        masses,
        force_misfit_percent: Some(force),
        ..candidate(id, EnergyClass::Plastic, 2, misfit)
    };
    let recommended = |candidates: &[ComparedCandidate]| ids(candidates, &SelectionRules::default())[0].clone();
    // 1.4 times 32 % is 44.8 %: one mass that misses 44 % is as good as one can be, 46 % is not.
    let one = missing("coarse", 1, 0.9, 32.0);
    assert_eq!(recommended(&[one.clone(), missing("near", 1, 0.5, 44.0)]).as_deref(), Some("near"));
    assert_eq!(recommended(&[one.clone(), missing("off", 1, 0.5, 46.0)]).as_deref(), Some("coarse"));
    // Two masses have masses in front: they are measured by their own.
    assert_eq!(recommended(&[one, missing("two", 2, 0.5, 44.0)]).as_deref(), Some("coarse"));
    // Where none is within the limit none is recommended.
    assert_eq!(recommended(&[missing("a", 1, 0.9, 60.0), missing("b", 1, 0.5, 61.0)]), None);
}

#[test]
fn an_adequate_model_repeats_its_own_test() {
    let near = candidate("near", EnergyClass::Plastic, 2, 0.9);
    let own = near.own_test;
    let off = |own_test: OwnTestErrors| ComparedCandidate { own_test, ..candidate("off", EnergyClass::Damped, 2, 0.1) };
    let first_reason = |off: &ComparedCandidate| {
        let selection = choose(&[near.clone(), off.clone()], &record(), &SelectionRules::default());
        assert_eq!(selection.recommended.candidate, Some(0));
        selection.rated[1].inadequate[0].clone()
    };
    let missed = |event, error, limit| Inadequacy::Misses { event, error, limit };
    let crush = off(OwnTestErrors { crush: Some(-0.04), ..own });
    assert_eq!(first_reason(&crush), missed(TestEvent::Crush, -0.04, 0.035));
    assert_eq!(first_reason(&crush).to_string(), "misses the dynamic crush of its own test by -4.0 %, limit 3.5 %");
    let time = off(OwnTestErrors { time: Some(0.06), ..own });
    assert_eq!(first_reason(&time), missed(TestEvent::Time, 0.06, 0.05));
    let rebound = off(OwnTestErrors { restitution: Some(0.27), ..own });
    assert_eq!(first_reason(&rebound), missed(TestEvent::Restitution, 0.27, 0.1));
    assert_eq!(first_reason(&off(OwnTestErrors::default())), Inadequacy::NeverStops);
    // A record that ends before the rebound has no restitution to miss.
    let unknown = off(OwnTestErrors { restitution: None, ..own });
    assert_eq!(ids(&[near.clone(), unknown], &SelectionRules::default())[0].as_deref(), Some("off"));
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
    assert_eq!(ids(&all, &SelectionRules::default())[0].as_deref(), Some("rebound"));
    let selection = choose(&all, &record(), &SelectionRules::default());
    assert_eq!(selection.rated[1].missed_events(), ["coefficient_of_restitution"]);
    assert!(!selection.rated[1].is_adequate());
    // No adequate one is named where there is none.
    assert!(selection.simplest.candidate.is_none() && selection.simplest.because.contains("no candidate is adequate"));
    assert!(selection.recommended.because.contains("the only candidate with the crush of the test that qualifies"));
    assert!(selection.recommended.because.contains("misses the restitution of its own test by +0.30"));
    assert_eq!(ids(&all[..1], &SelectionRules::default())[0], None);
    // So it is where an adequate one has open numbers that are felt.
    let names = vec!["a".to_owned(), "b".to_owned()];
    let open = ComparedCandidate {
        unidentified: names.clone(),
        affects_other_speeds: names,
        ..candidate("open", EnergyClass::Damped, 2, 0.9)
    };
    assert_eq!(ids(&[open, all[1].clone()], &SelectionRules::default())[0].as_deref(), Some("rebound"));
}

#[test]
fn an_open_knot_does_not_hand_the_choice_to_a_damped_model() {
    let damped = candidate("damped", EnergyClass::Damped, 2, 1.0);
    let open = |id: &str, parameters: usize, misfit: f64, open: &[&str]| {
        let names: Vec<String> = open.iter().map(|name| (*name).to_owned()).collect();
        let curve = candidate(id, EnergyClass::Plastic, parameters, misfit);
        ComparedCandidate { unidentified: names.clone(), affects_other_speeds: names, ..curve }
    };
    let rules = SelectionRules::default();
    // Most of its numbers are open, so the curve does not decide over the damped model; with fewer knots it is not.
    let (three, two) = (open("three", 3, 0.9, &["a", "b"]), open("two", 2, 1.1, &[]));
    assert_eq!(ids(&[damped.clone(), three.clone(), two], &rules)[0].as_deref(), Some("two"));
    let fewer = open("fewer", 3, 1.0, &["a"]);
    assert_eq!(ids(&[damped.clone(), three.clone(), fewer], &rules)[0].as_deref(), Some("fewer"));
    // Where the evidence is for the damped model it stays.
    let close = ComparedCandidate { misfit: candidate("", EnergyClass::Damped, 2, 0.2).misfit, ..damped };
    assert_eq!(ids(&[close.clone(), three.clone()], &rules)[0].as_deref(), Some("damped"));
    // So it does where it has open numbers itself: a curve that is decisively worse is no way out.
    let undecided = ComparedCandidate { affects_other_speeds: vec!["c".to_owned(), "k".to_owned()], ..close };
    assert_eq!(ids(&[undecided.clone(), three.clone()], &rules)[0], None);
    // 20 ln(1/0.9^2) = 4.2 less the prior of 10 and the charge of a number more.
    let near = ComparedCandidate { misfit: candidate("", EnergyClass::Damped, 2, 0.9).misfit, ..undecided };
    let weak = choose(&[near, three], &record(), &rules);
    assert_eq!((weak.recommended.candidate, weak.strength), (Some(1), Some((Strength::Weak, 0))));
}

#[test]
fn of_plastic_models_the_record_has_the_last_word_on_lower_speeds() {
    let error = |id: &str, parameters: usize, misfit: f64, error: f64| {
        let plastic = candidate(id, EnergyClass::Plastic, parameters, misfit);
        ComparedCandidate { crush_error_at_lower_speeds: Some(error), ..plastic }
    };
    // The criterion is for the line; 18 numbers have none, and the curve of 18 is the nearest to the record.
    let (line, curve) = (error("line", 2, 1.0, 0.06), error("curve", 5, 1.0, 0.008));
    let (coarse, fine) = (error("coarse", 4, 1.0, 0.03), error("fine", 18, 0.9, 0.002));
    let rules = SelectionRules::default();
    let all = [line.clone(), coarse.clone(), curve, fine.clone()];
    assert_eq!(ids(&all, &rules)[0].as_deref(), Some("curve"));
    let because = choose(&all, &record(), &rules).recommended.because;
    assert!(because.contains("within 0.8 %") && because.contains("line has a lower criterion but misses it by 6.0 %"));
    // 20 ln 9 = 44: the line follows the pulse closer.
    let rough = ComparedCandidate { misfit: candidate("", EnergyClass::Plastic, 5, 3.0).misfit, ..all[2].clone() };
    assert_eq!(choose(&[line.clone(), rough], &record(), &rules).strength, Some((Strength::Contrary, 0)));
    assert_eq!(ids(&[line.clone(), fine.clone()], &rules)[0].as_deref(), Some("fine"));
    // What has no criterion has no difference to another: neither words nor a strength come of it.
    let choice = choose(&[line.clone(), fine], &record(), &rules);
    assert_eq!((choice.rated[1].difference_with_priors, choice.strength), (None, None));
    assert!(!choice.recommended.because.contains("inf"), "{}", choice.recommended.because);
    // Nor is a crush that cannot be compared an error.
    let unknown = ComparedCandidate { crush_error_at_lower_speeds: None, ..line.clone() };
    assert_eq!(ids(&[unknown, error("other", 5, 1.0, 0.002)], &rules)[0].as_deref(), Some("line"));
    assert_eq!(ids(&[line.clone(), coarse], &rules)[0].as_deref(), Some("coarse"));
    assert_eq!(ids(&[line.clone(), error("hardly", 4, 1.0, 0.04)], &rules)[0].as_deref(), Some("line"));
    let wide = SelectionRules { lower_speed_limit_percent: 10.0, ..rules };
    assert_eq!(ids(&all, &wide)[0].as_deref(), Some("line"));
    // A damped model that wins is not asked.
    let damped = candidate("damped", EnergyClass::Damped, 2, 0.1);
    assert_eq!(ids(&[line, damped], &rules)[0].as_deref(), Some("damped"));
}

#[test]
fn a_restitution_unlike_that_of_the_test_costs() {
    let mut bouncy = candidate("bouncy", EnergyClass::Plastic, 2, 1.0);
    bouncy.restitution = Some(0.6);
    let plain = candidate("plain", EnergyClass::Plastic, 2, 1.0);
    let selection = choose(&[bouncy, plain], &record(), &SelectionRules::default());
    // (ln 4/0.35)^2.
    assert!((selection.rated[0].terms[1].1 - (4.0_f64.ln() / 0.35).powi(2)).abs() < 1e-12);
    assert_eq!(selection.recommended.candidate, Some(1));
    let wide = SelectionRules { restitution_deviation: 0.0, plastic_prior: 0.0, ..SelectionRules::default() };
    assert!(wide.terms(&candidate("a", EnergyClass::Elastic, 1, 1.0), None).is_empty());
    assert!(wide.priors(None).is_empty());
}

#[test]
fn what_two_sensors_miss_is_worth_the_samples_of_both() {
    // Signs that change at once are worth as many samples as the filter lets through, in each wave.
    let waves = |count: usize| vec![ComparedWave { samples: 40 / count, most_independent: 9.0 }; count];
    let samples = |waves: Vec<ComparedWave>| {
        let level = candidate("level", EnergyClass::Plastic, 1, 1.0);
        let record = ComparedRecord { waves, ..record() };
        choose(std::slice::from_ref(&level), &record, &SelectionRules::default()).samples
    };
    assert_eq!((samples(waves(1)), samples(waves(2))), (Some(9.0), Some(18.0)));
}

#[test]
fn a_sensor_that_one_model_follows_speaks_against_those_that_do_not() {
    let follows = |candidate: ComparedCandidate, percent| ComparedCandidate {
        worst_sensor: Some(("engine".to_owned(), percent)),
        ..candidate
    };
    let one_mass = follows(candidate("one mass", EnergyClass::Plastic, 2, 0.5), 40.0);
    let two = candidate("two masses", EnergyClass::Damped, 4, 2.0);
    let rules = SelectionRules::default();
    let both = [one_mass.clone(), follows(two.clone(), 95.0)];
    assert_eq!(ids(&both, &rules), some(["two masses", "two masses", "one mass"]));
    let why = choose(&both, &record(), &rules).rated[0].why_inadequate();
    assert_eq!(why.as_deref(), Some("follows the displacement of engine to 40.0 %, limit 90 %"));
    // A sensor that nobody follows decides nothing.
    assert_eq!(ids(&[one_mass, follows(two, 80.0)], &rules)[0].as_deref(), Some("one mass"));
}
