//! Chains of masses from their own motion: what comes back, what cannot, and what is said of it.

use crumple_lumped::{Chain, Drive, PiecewiseLinear};
use crumple_lumped_fit::{
    Assessment, AssessmentOptions, Candidate, FitQuantity, MeasureModel, Observation, ObservedWave, SolveError, Stated,
    StatedChain, StatedElement, StatedMass,
};
use crumple_signal::{IntegrationRule, Measurement, Sampled, TwoPassFilter};

const V0: f64 = 13.4;
const DT: f64 = 1e-4;
const END_S: f64 = 0.08;
const FREE: Stated = Stated::Free { start: None, lower: None, upper: None };

const EXACT: Measurement = Measurement {
    dt_s: DT,
    first_s: 0.0,
    samples: 1001,
    filter: None,
    from_contact: true,
    rule: None,
    before_event: None,
};

fn linear(masses: &[f64], springs: &[f64], dampers: &[f64]) -> Chain {
    let laws = |of: &[f64]| of.iter().map(|value| PiecewiseLinear::constant(*value)).collect::<Vec<_>>();
    Chain::new(masses, &laws(springs), &laws(dampers)).unwrap()
}

fn three() -> Chain {
    linear(&[220.0, 310.0, 870.0], &[9e5, 6e5, 1.1e6], &[8e3, 5e3, 1.2e4])
}

fn four() -> Chain {
    linear(&[150.0, 200.0, 300.0, 850.0], &[1.2e6, 7e5, 9e5, 1.4e6], &[6e3, 9e3, 4e3, 1.1e4])
}

/// Sensors on these masses, which record the motion as it is.
fn exact(truth: &Chain, masses: &[usize], quantity: FitQuantity) -> Observation {
    let response = truth.respond(&Drive::Impact(V0), DT, 1001).unwrap();
    let wave = |mass: &usize| {
        let motion = &response.motions[*mass];
        let samples = match quantity {
            FitQuantity::Displacement => &motion.displacement_m,
            FitQuantity::Velocity => &motion.velocity_m_per_s,
            FitQuantity::Acceleration | FitQuantity::Force => &motion.acceleration_m_per_s2,
        };
        let record = Sampled::new(0.0, DT, samples.clone()).unwrap();
        ObservedWave::new(&record, (Some(*mass), quantity), EXACT, (0.0, END_S), 250).unwrap()
    };
    Observation { impact_speed_m_per_s: V0, waves: masses.iter().map(wave).collect() }
}

/// A chain of known masses of which every spring and damper is free.
fn known_masses(masses: &[f64]) -> StatedChain {
    let element = |kg: &f64| StatedElement {
        mass_kg: StatedMass::Own(Stated::Fixed(*kg)),
        stiffness: vec![(0.0, FREE)],
        damping: vec![(0.0, FREE)],
    };
    StatedChain { elements: masses.iter().map(element).collect(), total_mass_kg: Some(masses.iter().sum()) }
}

fn linearised(found: &Candidate) -> Assessment {
    found.minimum.as_ref().unwrap().assess(None, AssessmentOptions::default()).unwrap()
}

fn free_names(found: &Candidate) -> Vec<String> {
    found.minimum.as_ref().unwrap().free_names()
}

fn largest_error(found: &Candidate, truth: &Chain) -> f64 {
    let (found, truth) = (found.model.parameters(), truth.parameters());
    assert!(found.keys().eq(truth.keys()));
    truth.iter().map(|(name, value)| (found[name] / value - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn three_and_four_masses_come_back_from_any_quantity_of_all_their_sensors() {
    for (truth, masses) in [(three(), 3), (four(), 4)] {
        for quantity in FitQuantity::ALL {
            let all: Vec<usize> = (0..masses).collect();
            let found = known_masses(truth.masses_kg()).fit(&exact(&truth, &all, quantity), 24).unwrap();
            assert_eq!(found.len(), 1, "{masses} {quantity}");
            let error = largest_error(&found[0], &truth);
            // The signal is the response itself: rounding of it times the condition.
            assert!(error < 1e-6, "{masses} masses, {quantity}: {error:e}");
            let linearised = linearised(&found[0]);
            assert_eq!((linearised.rank, free_names(&found[0]).len()), (2 * masses, 2 * masses));
            assert!(found[0].fit.as_ref().unwrap().active_bounds.is_empty());
            for (name, (low, high)) in &linearised.interval {
                let value = truth.parameters()[name];
                assert!(low.unwrap() <= value && value <= high.unwrap(), "{masses} {quantity} {name}");
            }
        }
    }
}

#[test]
fn masses_are_found_where_their_total_is_known() {
    let truth = three();
    let mut stated = known_masses(truth.masses_kg());
    stated.elements[0].mass_kg = StatedMass::Own(FREE);
    stated.elements[1].mass_kg = StatedMass::Own(Stated::Free { start: None, lower: Some(150.0), upper: Some(600.0) });
    stated.elements[2].mass_kg = StatedMass::Rest;
    let found = stated.fit(&exact(&truth, &[0, 1, 2], FitQuantity::Velocity), 24).unwrap();
    // As above.
    assert!(largest_error(&found[0], &truth) < 1e-6, "{:?}", found[0]);
    assert_eq!(free_names(&found[0]).last().unwrap(), "m3_kg");
    assert_eq!(free_names(&found[0]).len(), 9);
}

#[test]
fn without_the_total_only_ratios_of_masses_springs_and_dampers_are_determined_and_that_is_said() {
    let truth = three();
    let mut stated = known_masses(truth.masses_kg());
    for element in &mut stated.elements {
        element.mass_kg = StatedMass::Own(FREE);
    }
    let blind = StatedChain { total_mass_kg: None, ..stated.clone() };
    let refused = blind.fit(&exact(&truth, &[0, 1, 2], FitQuantity::Displacement), 24).unwrap_err();
    assert!(refused.to_string().contains("needs both bounds"), "{refused}");
    let found = stated.fit(&exact(&truth, &[0, 1, 2], FitQuantity::Displacement), 24).unwrap();
    let (values, wanted) = (found[0].model.parameters(), truth.parameters());
    let scale = values["m3_kg"] / wanted["m3_kg"];
    for (name, value) in &wanted {
        // The whole model times any factor moves alike.
        assert!((values[name] / value / scale - 1.0).abs() < 1e-6, "{name}");
    }
    let linearised = linearised(&found[0]);
    assert_eq!((linearised.rank, linearised.parameters.len()), (8, 9));
    assert_eq!(linearised.condition, None);
    assert!(linearised.interval.values().all(|ends| *ends == (None, None)), "{:?}", linearised.interval);
    let words = linearised.weakest_direction.as_ref().unwrap();
    assert!(words.contains("are not determined one by one") && words.ends_with("nothing bounds it"), "{words}");
}

#[test]
fn what_is_given_stays_and_what_is_free_stays_in_its_bounds() {
    let truth = three();
    let mut stated = known_masses(truth.masses_kg());
    stated.elements[0].stiffness = vec![(0.0, Stated::Fixed(9e5))];
    stated.elements[1].damping = vec![(0.0, Stated::Fixed(5e3))];
    // Too stiff: the truth lies below.
    let tight = Stated::Free { start: Some(1.3e6), lower: Some(1.2e6), upper: Some(2e6) };
    stated.elements[2].stiffness = vec![(0.0, tight)];
    let found = stated.fit(&exact(&truth, &[0, 2], FitQuantity::Displacement), 24).unwrap();
    let values = found[0].model.parameters();
    assert_eq!((values["k1_n_per_m"], values["c2_n_s_per_m"]), (9e5, 5e3));
    assert_eq!(found[0].fit.as_ref().unwrap().active_bounds, ["k3_n_per_m"]);
    // The logarithm of the bound and back.
    assert!((values["k3_n_per_m"] / 1.2e6 - 1.0).abs() < 1e-14);
    assert_eq!(linearised(&found[0]).interval["k3_n_per_m"], (None, None));
}

#[test]
fn coefficients_with_knots_are_fitted_by_differences() {
    let curve = |points: &[(f64, f64)]| PiecewiseLinear::new(points).unwrap();
    let truth = Chain::new(
        &[250.0, 900.0],
        &[curve(&[(0.0, 9e5), (0.25, 3.5e5)]), PiecewiseLinear::constant(1.1e6)],
        &[PiecewiseLinear::constant(8e3), curve(&[(0.0, 1.5e4), (6.0, 5e3)])],
    )
    .unwrap();
    let mut stated = known_masses(&[250.0, 900.0]);
    stated.elements[0].stiffness = vec![(0.0, FREE), (0.25, FREE)];
    stated.elements[1].damping = vec![(0.0, FREE), (6.0, FREE)];
    let found = stated.fit(&exact(&truth, &[0, 1], FitQuantity::Displacement), 24).unwrap();
    // Steps of 1e-7 err the sensitivities by as much: the descent ends where the cost no longer falls.
    assert!(largest_error(&found[0], &truth) < 1e-6, "{:?}", found[0].model.parameters());
    assert_eq!(linearised(&found[0]).rank, 6);
}

#[test]
fn a_filtered_record_gives_the_truth_when_the_chain_goes_through_the_filter() {
    let truth = three();
    // CFC 60 at 10 kHz, two passes.
    let filter = TwoPassFilter {
        coefficients: [0.001_460_3, 0.002_920_6, 0.001_460_3, 1.889_033_6, -0.894_874_8],
        samples_added: 100,
    };
    let measurement = Measurement {
        first_s: -0.01,
        samples: 1100,
        filter: Some(filter),
        rule: Some(IntegrationRule::Trapezoid),
        ..EXACT
    };
    let model = crumple_lumped::TripleSpringMassDamper {
        masses_kg: [220.0, 310.0, 870.0],
        springs_n_per_m: [9e5, 6e5, 1.1e6],
        dampers_n_s_per_m: [8e3, 5e3, 1.2e4],
    };
    let model = crumple_lumped::Model::TripleSpringMassDamper(model);
    let wave = |mass: usize| {
        let what = (Some(mass), FitQuantity::Velocity);
        let seen = measurement.motion(&model, Some(mass), FitQuantity::Velocity, V0, 1099).unwrap();
        let record = Sampled::new(-0.01, DT, seen).unwrap();
        ObservedWave::new(&record, what, measurement, (0.0, END_S), 250).unwrap()
    };
    let observed = Observation { impact_speed_m_per_s: V0, waves: (0..3).map(wave).collect() };
    let stated = known_masses(truth.masses_kg());
    let plain = stated.fit(&observed.clone().exact(), 24).unwrap();
    let through = stated.fit(&observed, 24).unwrap();
    // The record is what the measurement makes of the truth, digit by digit.
    assert!(largest_error(&through[0], &truth) < 1e-6, "{:e}", largest_error(&through[0], &truth));
    // What the filter does to the jump at contact is not seen otherwise.
    assert!(largest_error(&plain[0], &truth) > 1e-4, "{:e}", largest_error(&plain[0], &truth));
}

fn two() -> Chain {
    linear(&[300.0, 900.0], &[9e5, 6e5], &[8e3, 1.2e4])
}

#[test]
fn two_masses_seen_in_the_last_one_come_with_their_dual() {
    let truth = two();
    let observed = exact(&truth, &[1], FitQuantity::Displacement);
    let found = known_masses(truth.masses_kg()).fit(&observed, 24).unwrap();
    assert_eq!(found.len(), 2, "{found:?}");
    assert_eq!((found[0].equivalent_to, found[1].equivalent_to), (Some(2), Some(1)));
    let k1 = |of: &Candidate| of.model.parameters()["k1_n_per_m"];
    assert!(k1(&found[0]) < k1(&found[1]));
    // mu = 4/3: the dual has k1 = 4/3 6e5 = 8e5 and comes first.
    let (dual, own) = (&found[0], &found[1]);
    // The signal is the response itself: rounding of it times the condition.
    assert!(largest_error(own, &truth) < 1e-6, "{:?}", own.model.parameters());
    let wanted = linear(&[300.0, 900.0], &[8e5, 6.75e5], &[1.6e4, 6e3]);
    assert!(largest_error(dual, &wanted) < 1e-6, "{:?}", dual.model.parameters());
    assert!(!own.division_undecided && !dual.division_undecided);
}

#[test]
fn a_number_that_is_given_or_another_sensor_decides_between_a_chain_and_its_dual() {
    let truth = two();
    let mut stated = known_masses(truth.masses_kg());
    let both = stated.fit(&exact(&truth, &[0, 1], FitQuantity::Displacement), 24).unwrap();
    assert_eq!((both.len(), both[0].equivalent_to, &both[0].excluded_dual), (1, None, &None));
    stated.elements[0].stiffness = vec![(0.0, Stated::Fixed(9e5))];
    let found = stated.fit(&exact(&truth, &[1], FitQuantity::Displacement), 24).unwrap();
    assert_eq!(found.len(), 1);
    let dual = found[0].excluded_dual.as_ref().unwrap();
    // As above.
    assert!((dual.parameters()["k1_n_per_m"] / 8e5 - 1.0).abs() < 1e-6);
    assert!(largest_error(&found[0], &truth) < 1e-6);
}

#[test]
fn masses_looked_for_by_one_sensor_on_the_last_are_called_undecided() {
    let truth = two();
    let mut stated = known_masses(truth.masses_kg());
    stated.elements[0].mass_kg = StatedMass::Own(FREE);
    stated.elements[1].mass_kg = StatedMass::Rest;
    let one = stated.fit(&exact(&truth, &[1], FitQuantity::Displacement), 24).unwrap();
    assert!(one.iter().all(|found| found.division_undecided), "{one:?}");
    assert_eq!(one[0].equivalent_to, Some(2));
    let two = stated.fit(&exact(&truth, &[0, 1], FitQuantity::Displacement), 24).unwrap();
    assert!(!two[0].division_undecided && two[0].equivalent_to.is_none());
    // The rest has an interval like the mass it follows from.
    let known = linearised(&two[0]);
    let (low, high) = known.interval["m2_kg"];
    assert!(low.unwrap() <= 900.0 && 900.0 <= high.unwrap(), "{:?}", known.interval);
    assert!(known.standard_deviation.contains_key("m2_kg") && !known.parameters.contains(&"m2_kg".to_owned()));
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let observed = exact(&three(), &[1, 2], FitQuantity::Acceleration);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| known_masses(&[220.0, 310.0, 870.0]).fit(&observed, 24)).unwrap()
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn a_chain_without_meaning_is_refused() {
    let observed = exact(&three(), &[0, 1, 2], FitQuantity::Displacement);
    let error = |change: fn(&mut StatedChain)| {
        let mut stated = known_masses(&[220.0, 310.0, 870.0]);
        change(&mut stated);
        stated.fit(&observed, 24).unwrap_err()
    };
    assert_eq!(error(|s| s.elements.clear()), SolveError::NothingFree);
    assert_eq!(error(|s| s.elements.iter_mut().for_each(|e| e.mass_kg = StatedMass::Rest)), SolveError::TwoRests);
    assert_eq!(
        error(|s| {
            s.elements[0].mass_kg = StatedMass::Rest;
            s.total_mass_kg = None;
        }),
        SolveError::RestWithoutTotal
    );
    let few = error(|s| {
        s.elements[0].mass_kg = StatedMass::Rest;
        s.total_mass_kg = Some(1000.0);
    });
    assert_eq!(
        few.to_string(),
        "the masses given for the chain are 1180 kg of a total of 1000 kg: they leave nothing for the rest"
    );
    let falling = error(|s| {
        s.elements[0].damping[0].1 = Stated::Free { start: Some(1.0), lower: Some(2.0), upper: None };
    });
    assert_eq!(
        falling.to_string(),
        "c1_n_s_per_m: lower, start and upper do not rise, expected positive numbers with lower below start below upper"
    );
    let short = error(|s| {
        s.elements.pop();
    });
    assert_eq!(short.to_string(), "number of a mass with a sensor is 3, expected a mass of the chain");
    let given = error(|s| {
        for element in &mut s.elements {
            element.stiffness = vec![(0.0, Stated::Fixed(1e6))];
            element.damping = vec![(0.0, Stated::Fixed(1e3))];
        }
    });
    assert_eq!(given, SolveError::NothingFree);
}

#[test]
fn a_law_given_by_knots_of_one_value_has_the_dual_of_a_constant() {
    // Fixed knots of one value and a constant are one chain under two sets of names.
    let damper = |speeds: &[f64]| speeds.iter().map(|v| (*v, Stated::Fixed(4e3))).collect();
    let chain = |speeds: &[f64]| {
        let mut stated = known_masses(&[400.0, 1000.0]);
        stated.elements[0].damping = damper(speeds);
        stated
    };
    let truth = Chain::new(
        &[400.0, 1000.0],
        &[9e5, 4e5].map(PiecewiseLinear::constant),
        &[4e3, 6e3].map(PiecewiseLinear::constant),
    )
    .unwrap();
    let waves = exact(&truth, &[1], FitQuantity::Displacement);
    let [flat, constant] = [&[0.0, 2.0][..], &[0.0]].map(|speeds| chain(speeds).fit(&waves, 24).unwrap());
    let duals = [&flat[0], &constant[0]].map(|found| found.excluded_dual.as_ref().unwrap().parameters());
    for (name, value) in &duals[0] {
        // Two descents to one minimum.
        assert!((value / duals[1][name] - 1.0).abs() < 1e-6, "{name}");
    }
}
