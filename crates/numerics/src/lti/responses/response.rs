//! Responses of sampled models with one input and one output.

use nalgebra::DVector;

use crate::lti::{LtiError, StateSpace};

/// Output of a discrete model driven by `input` from the state `initial`: `y[k] = c x[k] + d u[k]`.
///
/// An unstable model may overflow: the result is then not finite from some sample on, which the caller must check.
/// Errors: continuous model, several channels, wrong length of the state.
pub fn response(model: &StateSpace, input: &[f64], initial: &DVector<f64>) -> Result<Vec<f64>, LtiError> {
    simulate(model, initial, input.len(), |k| input[k])
}

/// The Markov parameters `y[0] = d`, `y[k] = c a^(k-1) b`: the response to `u[0] = 1` from rest.
pub fn impulse_response(model: &StateSpace, samples: usize) -> Result<Vec<f64>, LtiError> {
    simulate(model, &DVector::zeros(model.order()), samples, |k| if k == 0 { 1.0 } else { 0.0 })
}

/// Response to `u[k] = 1` from rest.
pub fn step_response(model: &StateSpace, samples: usize) -> Result<Vec<f64>, LtiError> {
    simulate(model, &DVector::zeros(model.order()), samples, |_| 1.0)
}

/// Response without input from the state `initial`: `y[k] = c a^k x0`.
pub fn free_response(model: &StateSpace, initial: &DVector<f64>, samples: usize) -> Result<Vec<f64>, LtiError> {
    simulate(model, initial, samples, |_| 0.0)
}

fn simulate(
    model: &StateSpace,
    initial: &DVector<f64>,
    samples: usize,
    input: impl Fn(usize) -> f64,
) -> Result<Vec<f64>, LtiError> {
    model.require_discrete()?;
    model.require_single()?;
    if initial.len() != model.order() {
        return Err(LtiError::Shape {
            what: "the initial state",
            rows: initial.len(),
            columns: 1,
            expected: format!("{} x 1", model.order()),
        });
    }
    let b = model.b.column(0);
    let c = model.c.row(0).transpose();
    let d = model.d[(0, 0)];
    let mut x = initial.clone();
    let mut next = x.clone();
    Ok((0..samples)
        .map(|k| {
            let u = input(k);
            let y = c.dot(&x) + d * u;
            next.gemv(1.0, &model.a, &x, 0.0);
            if u != 0.0 {
                next.axpy(u, &b, 1.0);
            }
            std::mem::swap(&mut x, &mut next);
            y
        })
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    fn decay() -> StateSpace {
        StateSpace::new(dmatrix![0.5], dmatrix![2.0], dmatrix![3.0], dmatrix![7.0], Some(1.0)).unwrap()
    }

    #[test]
    fn impulse_response_is_the_markov_sequence() {
        assert_eq!(impulse_response(&decay(), 4).unwrap(), [7.0, 6.0, 3.0, 1.5]);
    }

    #[test]
    fn step_is_the_running_sum_of_the_impulse() {
        assert_eq!(step_response(&decay(), 4).unwrap(), [7.0, 13.0, 16.0, 17.5]);
    }

    #[test]
    fn superposition_of_free_and_forced_motion() {
        let x0 = DVector::from_element(1, 4.0);
        let input = [1.0, 0.0, -2.0, 0.0];
        let all = response(&decay(), &input, &x0).unwrap();
        let free = free_response(&decay(), &x0, 4).unwrap();
        let forced = response(&decay(), &input, &DVector::zeros(1)).unwrap();
        for k in 0..4 {
            assert_eq!(all[k], free[k] + forced[k]);
        }
    }

    #[test]
    fn refuses_a_continuous_model_and_a_wrong_state() {
        let mut model = decay();
        assert!(response(&model, &[1.0], &DVector::zeros(2)).is_err());
        model.sample_time_s = None;
        assert!(impulse_response(&model, 3).is_err());
    }
}
