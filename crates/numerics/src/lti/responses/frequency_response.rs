//! Frequency response of a state-space model.

use nalgebra::{DMatrix, DVector};

use crate::lti::{Complex, LtiError, StateSpace};

/// `c (p I - a)^-1 b + d` of a model with one input and one output at angular frequencies in rad/s, with `p = i w` in
/// continuous and `p = exp(i w dt)` in discrete time.
///
/// At a pole on the axis the entry is not finite, which the caller must check. Errors: several channels.
pub fn frequency_response(model: &StateSpace, rad_per_s: &[f64]) -> Result<Vec<Complex>, LtiError> {
    model.require_single()?;
    let n = model.order();
    let complex = |x: f64| Complex::new(x, 0.0);
    let a = model.a.map(complex);
    let b = DVector::from_iterator(n, model.b.iter().copied().map(complex));
    let c = model.c.map(complex);
    let d = complex(model.d[(0, 0)]);
    Ok(rad_per_s
        .iter()
        .map(|w| {
            let p = match model.sample_time_s {
                None => Complex::new(0.0, *w),
                Some(dt) => Complex::new(0.0, w * dt).exp(),
            };
            let shifted = DMatrix::<Complex>::identity(n, n) * p - &a;
            match shifted.lu().solve(&b) {
                Some(x) => (&c * x)[(0, 0)] + d,
                None => complex(f64::INFINITY),
            }
        })
        .collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use nalgebra::dmatrix;

    use super::*;
    use crate::lti::discretize_zero_order_hold;
    use crate::lti::to_transfer_function;

    #[test]
    fn agrees_with_the_transfer_function_and_with_the_sampled_model_at_low_frequency() {
        let a = dmatrix![0.0, 1.0; -900.0, -6.0];
        let model = StateSpace::new(a, dmatrix![0.0; 1.0], dmatrix![3.0, 0.5], dmatrix![0.1], None).unwrap();
        let tf = to_transfer_function(&model).unwrap();
        let w = [0.0, 10.0, 30.0, 200.0];
        let values = frequency_response(&model, &w).unwrap();
        for (value, w) in values.iter().zip(w) {
            let exact = tf.at(Complex::new(0.0, w));
            // Rounding of a two by two system of condition 1e3.
            assert!((value - exact).norm() < 1e-12 * exact.norm(), "{w}: {value} {exact}");
        }
        let sampled = discretize_zero_order_hold(&model, 1e-5).unwrap();
        // A hold delays by half a sample: a phase of w dt/2 = 1e-3 at most here.
        for (sampled, exact) in frequency_response(&sampled, &w).unwrap().iter().zip(&values) {
            assert!((sampled - exact).norm() < 1.01e-3 * exact.norm(), "{sampled} {exact}");
        }
    }

    #[test]
    fn a_pole_on_the_axis_is_not_finite_and_two_channels_are_refused() {
        let zero = dmatrix![0.0];
        let unit = dmatrix![1.0];
        let integrator = StateSpace::new(zero.clone(), unit.clone(), unit.clone(), zero, None).unwrap();
        assert!(!frequency_response(&integrator, &[0.0]).unwrap()[0].norm().is_finite());
        let two = StateSpace::new(unit.clone(), dmatrix![1.0, 2.0], unit, dmatrix![0.0, 0.0], None).unwrap();
        assert!(frequency_response(&two, &[1.0]).is_err());
    }
}
