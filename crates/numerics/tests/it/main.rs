//! Continuous to sampled and back, by every rule: the identity, also where a textbook formula divides by zero.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

use crumple_numerics::lti::{
    InputHold, LtiError, StateSpace, discretize_first_order_hold, discretize_zero_order_hold, to_continuous,
    undo_zero_order_hold,
};
use nalgebra::{DMatrix, dmatrix};
use proptest::prelude::*;

type Rule = (
    &'static str,
    fn(&StateSpace, f64) -> Result<StateSpace, LtiError>,
    fn(&StateSpace) -> Result<StateSpace, LtiError>,
);

fn first_order(model: &StateSpace, dt_s: f64) -> Result<StateSpace, LtiError> {
    discretize_first_order_hold(model, dt_s)?.state_space()
}

fn undo_first_order(model: &StateSpace) -> Result<StateSpace, LtiError> {
    to_continuous(model, InputHold::First).map(|continuous| continuous.model)
}

const RULES: [Rule; 2] = [
    ("zero-order hold", discretize_zero_order_hold, undo_zero_order_hold),
    ("first-order hold", first_order, undo_first_order),
];

/// Largest difference of any matrix, relative to its norm.
fn difference(x: &StateSpace, y: &StateSpace) -> f64 {
    [(&x.a, &y.a), (&x.b, &y.b), (&x.c, &y.c), (&x.d, &y.d)]
        .into_iter()
        .map(|(x, y)| (x - y).norm() / y.norm().max(1.0))
        .fold(0.0, f64::max)
}

fn check(model: &StateSpace, dt_s: f64, tolerance: f64, what: &str) {
    for (name, there, back) in RULES {
        let again = back(&there(model, dt_s).unwrap()).unwrap();
        let worst = difference(&again, model);
        assert!(worst < tolerance, "{what}, {name}: {worst:e}");
    }
}

/// Two inputs, two outputs.
fn model(a: DMatrix<f64>) -> StateSpace {
    let n = a.nrows();
    StateSpace::new(
        a,
        DMatrix::from_fn(n, 2, |i, j| 1.0 + 0.5 * i as f64 - 0.7 * j as f64),
        DMatrix::from_fn(2, n, |i, j| 0.3 * i as f64 + 1.0 - 0.4 * j as f64),
        dmatrix![0.1, -0.2; 0.3, 0.4],
        None,
    )
    .unwrap()
}

#[test]
fn defective_and_rigid_models_are_ordinary() {
    // A is known to rounding over dt.
    let tolerance = 1e-13 / 0.1;
    // Rigid body, z = 1 twice and defective.
    check(&model(dmatrix![0.0, 1.0; 0.0, 0.0]), 0.1, tolerance, "rigid body");
    // One rigid body beside an oscillator.
    check(&model(dmatrix![0.0, 1.0, 0.0; 0.0, 0.0, 0.0; 1.0, 0.0, -3.0]), 0.1, tolerance, "rigid body and lag");
    // Jordan blocks of three equal poles, and two poles apart by 1e-9.
    check(&model(dmatrix![-2.0, 1.0, 0.0; 0.0, -2.0, 1.0; 0.0, 0.0, -2.0]), 0.1, tolerance, "three equal poles");
    check(&model(dmatrix![-2.0, 1.0; 1e-18, -2.0]), 0.1, tolerance, "poles apart by 1e-9");
    // Nothing but zeros.
    check(&model(DMatrix::zeros(3, 3)), 0.1, tolerance, "no dynamics");
}

#[test]
fn nearly_singular_samples_come_back() {
    // e^(s dt) = 1e-5: eleven digits of the sample's matrix are left for the fast pole.
    let fast = model(dmatrix![-115.0, 3.0; 0.0, -1.0]);
    for (name, there, back) in &RULES[..2] {
        let again = back(&there(&fast, 0.1).unwrap()).unwrap();
        assert!(difference(&again, &fast) < 1e-9, "{name}: {:e}", difference(&again, &fast));
    }
}

#[test]
fn a_pole_just_below_the_nyquist_frequency_comes_back() {
    let w = 0.999 * std::f64::consts::PI;
    // The logarithm's condition is 1/(pi - w dt), 3e2.
    check(&model(dmatrix![-0.1, -w; w, -0.1]), 1.0, 1e-12, "near Nyquist");
}

proptest! {
    #[test]
    fn round_trips_are_the_identity(entries in prop::collection::vec(-1.0..1.0_f64, 16), dt_s in 0.2..1.0_f64) {
        // Norm below 4, so |Im s| dt stays inside the strip of the principal logarithm for most; the rest is skipped.
        let model = model(DMatrix::from_vec(4, 4, entries));
        prop_assume!(model.poles().unwrap().iter().all(|s| s.im.abs() * dt_s < 3.0 && (s.re * dt_s - 2.0).abs() > 0.1));
        for (name, there, back) in RULES {
            let again = back(&there(&model, dt_s).unwrap()).unwrap();
            // 1e-12: rounding times the condition of the logarithm (below 10 inside that strip) over dt.
            prop_assert!(difference(&again, &model) < 1e-12 / dt_s, "{name}: {:e}", difference(&again, &model));
        }
        // The general way gives the same as the logarithm of the whole.
        let sampled = discretize_zero_order_hold(&model, dt_s).unwrap();
        let general = to_continuous(&sampled, InputHold::Zero).unwrap();
        prop_assert!(difference(&general.model, &model) < 1e-12 / dt_s);
    }
}
