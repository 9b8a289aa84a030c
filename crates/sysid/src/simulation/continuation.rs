//! Simulation of a model beyond the samples it was identified from.

use crumple_numerics::lti::{StateSpace, discretize_first_order_hold, discretize_zero_order_hold, simulate};
use nalgebra::DMatrix;

use crate::simulation::initial_state::free_outputs;
use crate::{Hold, IdentifyError, IoData, simulate_fitted};

/// A continuous model as a sampled one that gives the same outputs for an input of the declared kind.
///
/// With straight lines between samples the state is shifted by `b_next u[k]`, so that no later input is needed.
/// Returned with it: the shifted state of rest, a column per unit of the first sample of every input.
///
/// With `x[k+1] = A x[k] + b_now u[k] + b_next u[k+1]` the state `z = x - b_next u` has
/// `z[k+1] = A z[k] + (A b_next + b_now) u[k]` and `y = C z + (D + C b_next) u`. Errors: a discretisation beyond the
/// range of `f64`.
pub fn sampled(model: &StateSpace, hold: Hold, dt_s: f64) -> Result<(StateSpace, DMatrix<f64>), IdentifyError> {
    match hold {
        Hold::Zero => Ok((discretize_zero_order_hold(model, dt_s)?, DMatrix::zeros(model.order(), model.b.ncols()))),
        Hold::First => {
            let held = discretize_first_order_hold(model, dt_s)?;
            let b = &held.a * &held.b_next + &held.b_now;
            let d = &held.d + &held.c * &held.b_next;
            let rest = -&held.b_next;
            Ok((StateSpace::new(held.a, b, held.c, d, Some(dt_s))?, rest))
        }
    }
}

/// Simulates `whole` from a given initial state, or from the one that fits its beginning, `first`, best: its prediction
/// of the samples after. The measured outputs after `first` are not looked at.
///
/// One signal per output, as long as `whole`. Errors: a model of other channels, a simulation that overflows.
pub fn continued(
    model: &StateSpace,
    first: &IoData,
    whole: &IoData,
    start: Option<&[f64]>,
) -> Result<Vec<Vec<f64>>, IdentifyError> {
    let start = match start {
        Some(start) => start.to_vec(),
        None => simulate_fitted(model, first)?.1,
    };
    if whole.inputs().is_empty() {
        return Ok(free_outputs(model, &start, whole.samples()));
    }
    Ok(simulate(model, whole.inputs(), &start)?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use nalgebra::{DVector, dmatrix};

    #[test]
    fn straight_lines_in_standard_form_give_the_response_of_the_hold() {
        let model = StateSpace::new(
            dmatrix![0.0, 1.0; -900.0, -6.0],
            dmatrix![0.0; 1.0],
            dmatrix![3.0, 0.5],
            dmatrix![0.1],
            None,
        )
        .unwrap();
        let dt = 5e-3;
        let u: Vec<f64> = (0..200).map(|k| 2.0 + (f64::from(k) * 0.11).sin()).collect();
        let held = discretize_first_order_hold(&model, dt).unwrap();
        let x0 = DVector::from_vec(vec![0.4, -1.0]);
        let exact = held.response(&u, &x0).unwrap();
        let (standard, rest) = sampled(&model, Hold::First, dt).unwrap();
        let shifted = &x0 + rest.column(0) * u[0];
        let estimated = simulate(&standard, std::slice::from_ref(&u), shifted.as_slice()).unwrap();
        for (estimated, exact) in estimated[0].iter().zip(&exact) {
            // Rounding of 200 stable steps.
            assert!((estimated - exact).abs() < 1e-13, "{estimated} {exact}");
        }
        // The state is found from the first half, and the second half is predicted.
        let whole = IoData::single(u, exact.clone(), dt).unwrap();
        let predicted = continued(&standard, &whole.slice(0, 100).unwrap(), &whole, None).unwrap();
        assert!(predicted[0].iter().zip(&exact).all(|(f, e)| (f - e).abs() < 1e-12));
    }
}
