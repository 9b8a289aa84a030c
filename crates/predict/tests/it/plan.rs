//! Which second test would help: what is expected of it.

use crumple_lumped::{Elastoplastic, Model};
use crumple_predict::{Candidate, Inputs, ParameterSpread, Scenario, SecondTest, TestedImpact, expected_widths};

const TESTED_M_PER_S: f64 = 14.0;

/// A plastic car of which the record leaves the stiffness unsure by so much.
fn car(stiffness: f64) -> Candidate {
    let model = Elastoplastic {
        mass_kg: 1200.0,
        loading_stiffness_n_per_m: 4e5,
        unloading_stiffness_n_per_m: 9e6,
        release: true,
    };
    let order = ["loading_stiffness_n_per_m", "unloading_stiffness_n_per_m"].map(str::to_owned).to_vec();
    let deviations = [stiffness * 4e5, 0.1 * 9e6];
    Candidate {
        id: "elastoplastic/direct-fit/1".to_owned(),
        model: Ok(Model::Elastoplastic(model)),
        spread: Some(ParameterSpread {
            standard_deviation: order.iter().cloned().zip(deviations).collect(),
            correlation: vec![vec![1.0, 0.0], vec![0.0, 1.0]],
            order,
            open: Vec::new(),
        }),
        weight: 1.0,
    }
}

/// Widths now and after second tests at these speeds, m, of the crush at 18 m/s.
fn widths(stiffness: f64, speeds: &[f64]) -> (f64, Vec<f64>) {
    let wanted = Scenario { speed_m_per_s: 18.0, partner_speed_m_per_s: 0.0, mass_kg: None };
    let test = TestedImpact::new(TESTED_M_PER_S, []).with_crush_deviation(2e-3);
    let second: Vec<SecondTest> = speeds
        .iter()
        .map(|speed| SecondTest { speed_m_per_s: *speed, mass_kg: None, sees_every_mass: false })
        .collect();
    let (now, after) = expected_widths(&[car(stiffness)], 0, &test, Inputs::default(), wanted, &second).unwrap();
    (now, after.into_iter().map(Option::unwrap).collect())
}

#[test]
fn a_test_at_the_speed_asked_for_helps_most_and_none_makes_it_worse() {
    let (now, after) = widths(0.03, &[10.0, 14.0, 16.0, 18.0]);
    assert!(after.iter().all(|width| *width <= now * (1.0 + 1e-9)), "{now} {after:?}");
    assert!(after.is_sorted_by(|slower, faster| slower >= faster), "{after:?}");
    // Nothing is extrapolated at that speed.
    assert!(after[3] < 0.6 * now, "{now} {after:?}");
}

#[test]
fn a_second_test_alike_halves_the_variance_of_what_the_first_shows() {
    // With the stiffness alone unsure, the same test again halves its variance: the width goes by the square root of a
    // half, but for what speed and law leave open at 18 m/s.
    let (now, after) = widths(0.3, &[TESTED_M_PER_S]);
    let ratio = after[0] / now;
    assert!((0.68..0.78).contains(&ratio), "{ratio}");
}
