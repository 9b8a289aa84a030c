//! Exact discretisation with a held input, and back.

use nalgebra::DMatrix;

use crate::lti::matrix::exponential::one_norm;
use crate::lti::model::check_sample_time;
use crate::lti::{LtiError, StateSpace, matrix_exponential, matrix_logarithm};

/// The sampled model whose response to a zero-order hold is the continuous one's, exactly.
///
/// `exp([[a, b], [0, 0]] dt) = [[Ad, Bd], [0, I]]`; `c` and `d` stay. No inverse of `a`, so a rigid body (pole at
/// zero) is an ordinary case. Source: Van Loan, IEEE Trans. Autom. Control 23(3), 1978.
pub fn discretize_zero_order_hold(model: &StateSpace, dt_s: f64) -> Result<StateSpace, LtiError> {
    model.require_continuous()?;
    check_sample_time(dt_s)?;
    let (n, m) = model.b.shape();
    let a = &model.a * dt_s;
    let b = &model.b * dt_s;
    // The result is linear in b: scaled down to a, it costs no extra squarings.
    let scale = power_of_two_above(one_norm(&b) / one_norm(&a).max(0.1));
    let e = matrix_exponential(&augmented(&a, &(b / scale), 0.0))?;
    StateSpace::new(
        e.view((0, 0), (n, n)).into_owned(),
        e.view((0, n), (n, m)).into_owned() * scale,
        model.c.clone(),
        model.d.clone(),
        Some(dt_s),
    )
}

/// The continuous model of which the sampled one is the zero-order-hold discretisation.
///
/// `ln [[Ad, Bd], [0, I]] / dt = [[a, b], [0, 0]]`. Unlike `b = a (Ad - I)⁻¹ Bd` it survives a pole at `z = 1`.
/// Of the many continuous models that share the samples it is the one with `|Im s| < pi/dt`.
///
/// Errors: a real pole `z <= 0` has no continuous counterpart ([`LtiError::NegativeRealEigenvalue`]).
pub fn undo_zero_order_hold(model: &StateSpace) -> Result<StateSpace, LtiError> {
    let dt_s = model.require_discrete()?;
    let (n, m) = model.b.shape();
    // Linear in b again; a small block keeps the matrix as near to the identity as Ad itself.
    let scale = power_of_two_above(one_norm(&model.b) * 8.0);
    let log = matrix_logarithm(&augmented(&model.a, &(&model.b / scale), 1.0))?;
    StateSpace::new(
        log.view((0, 0), (n, n)).into_owned() / dt_s,
        log.view((0, n), (n, m)).into_owned() * (scale / dt_s),
        model.c.clone(),
        model.d.clone(),
        None,
    )
}

/// `[[a, b], [0, corner·I]]`.
fn augmented(a: &DMatrix<f64>, b: &DMatrix<f64>, corner: f64) -> DMatrix<f64> {
    let (n, m) = b.shape();
    let mut result = DMatrix::zeros(n + m, n + m);
    result.view_mut((0, 0), (n, n)).copy_from(a);
    result.view_mut((0, n), (n, m)).copy_from(b);
    result.view_mut((n, n), (m, m)).fill_with_identity();
    result.view_mut((n, n), (m, m)).scale_mut(corner);
    result
}

/// A power of two at or above `x`, so that scaling by it does not round; 1 for anything below 1.
fn power_of_two_above(x: f64) -> f64 {
    if x.is_finite() && x > 1.0 { x.log2().ceil().exp2() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    fn mass_spring_damper(m: f64, c: f64, k: f64) -> StateSpace {
        StateSpace::new(
            dmatrix![0.0, 1.0; -k / m, -c / m],
            dmatrix![0.0; 1.0 / m],
            dmatrix![1.0, 0.0],
            dmatrix![0.0],
            None,
        )
        .unwrap()
    }

    #[test]
    fn free_mass_under_constant_force_follows_the_parabola() {
        let d = discretize_zero_order_hold(&mass_spring_damper(2.0, 0.0, 0.0), 0.5).unwrap();
        // x = F t^2 / 2m, v = F t / m: exact in f64 up to one rounding.
        assert!((&d.a - dmatrix![1.0, 0.5; 0.0, 1.0]).norm() < 1e-15);
        assert!((&d.b - dmatrix![0.0625; 0.25]).norm() < 1e-15);
    }

    #[test]
    fn rigid_body_comes_back_where_the_inverse_formula_divides_by_zero() {
        let continuous = mass_spring_damper(873.0, 0.0, 0.0);
        let back = undo_zero_order_hold(&discretize_zero_order_hold(&continuous, 1e-4).unwrap()).unwrap();
        // Rounding unit over dt: 2e-12 absolute in a, relative to its entry 1.
        assert!((&back.a - &continuous.a).norm() < 1e-11, "{}", back.a);
        assert!((&back.b - &continuous.b).norm() < 1e-11 * continuous.b.norm(), "{}", back.b);
    }

    #[test]
    fn alternating_pole_has_no_continuous_counterpart() {
        let unit = dmatrix![1.0];
        let model = StateSpace::new(dmatrix![-0.5], unit.clone(), unit.clone(), unit, Some(1e-3)).unwrap();
        assert_eq!(undo_zero_order_hold(&model), Err(LtiError::NegativeRealEigenvalue { re: -0.5 }));
    }

    proptest! {
        #[test]
        fn round_trip_is_the_identity(
            frequency in 1.0..3000.0_f64, damping in 0.0..0.99_f64, mass in 1.0..2000.0_f64, gain in 1e-6..1e6_f64,
        ) {
            let dt = 1e-4;
            let mut model = mass_spring_damper(mass, 2.0 * damping * frequency * mass, frequency * frequency * mass);
            model.b *= gain;
            let back = undo_zero_order_hold(&discretize_zero_order_hold(&model, dt).unwrap()).unwrap();
            // Scaled to its natural frequency a has entries of 1, and Ad those of exp(a w dt). The logarithm divides
            // their rounding by w dt, and once more in the entries that differ from the identity by (w dt)^2 only;
            // 1e-13 is 450 roundings: room for the squarings and roots of a 3 x 3 matrix.
            let scale = dmatrix![frequency, 1.0; frequency * frequency, frequency];
            let worst = (&back.a - &model.a).component_div(&scale).amax() / frequency;
            prop_assert!(worst < 1e-13 / (frequency * dt) / (frequency * dt).min(1.0), "{worst:e}");
            // b moves by the same (w dt)^-2 times a few roundings, 1e-4 rad at the slowest: 1e8 * 1e-15.
            prop_assert!((&back.b - &model.b).norm() <= 1e-7 * model.b.norm());
        }
    }
}
