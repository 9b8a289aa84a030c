//! What a model answers: in time to an input or an initial state, and over frequency.

use nalgebra::{DMatrix, DVector};

use crate::linalg::dot;
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

/// Output of a discrete model driven by `input` from the state `initial`: `y[k] = c x[k] + d u[k]`.
///
/// An unstable model may overflow: the result is then not finite from some sample on, which the caller must check.
/// Errors: continuous model, several channels, wrong length of the state.
pub fn response(model: &StateSpace, input: &[f64], initial: &DVector<f64>) -> Result<Vec<f64>, LtiError> {
    simulate_from(model, initial, input.len(), |k| input[k])
}

/// The Markov parameters `y[0] = d`, `y[k] = c a^(k-1) b`: the response to `u[0] = 1` from rest.
pub fn impulse_response(model: &StateSpace, samples: usize) -> Result<Vec<f64>, LtiError> {
    simulate_from(model, &DVector::zeros(model.order()), samples, |k| if k == 0 { 1.0 } else { 0.0 })
}

/// Response to `u[k] = 1` from rest.
pub fn step_response(model: &StateSpace, samples: usize) -> Result<Vec<f64>, LtiError> {
    simulate_from(model, &DVector::zeros(model.order()), samples, |_| 1.0)
}

/// Response without input from the state `initial`: `y[k] = c a^k x0`.
pub fn free_response(model: &StateSpace, initial: &DVector<f64>, samples: usize) -> Result<Vec<f64>, LtiError> {
    simulate_from(model, initial, samples, |_| 0.0)
}

/// A motion that decays is over below this.
const OVER: f64 = 1e-280;

/// Ends a motion all of whose states are below 1e-280. Rounding holds what decays among the subnormal numbers for ever,
/// and sums of those take a hundred times as long.
pub fn end_what_decayed(state: &mut [f64]) {
    if state.iter().all(|x| x.abs() < OVER) {
        state.fill(0.0);
    }
}

fn simulate_from(
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
            end_what_decayed(x.as_mut_slice());
            y
        })
        .collect())
}

/// Outputs of a discrete model driven by `inputs` (one signal each, all of one length) from the state `initial`:
/// `y[k] = c x[k] + d u[k]`, one signal per output.
///
/// An unstable model may overflow: the result is then not finite from some sample on, which the caller must check.
/// Without inputs the response has no length; use a model with one input of zeros. Errors: continuous model, number or
/// lengths of the inputs, length of the state.
pub fn simulate(model: &StateSpace, inputs: &[Vec<f64>], initial: &[f64]) -> Result<Vec<Vec<f64>>, LtiError> {
    model.require_discrete()?;
    let (n, m, q) = (model.order(), model.b.ncols(), model.c.nrows());
    let samples = inputs.first().map_or(0, Vec::len);
    if inputs.len() != m || inputs.iter().any(|u| u.len() != samples) {
        return Err(LtiError::Shape {
            what: "the input",
            rows: samples,
            columns: inputs.len(),
            expected: format!("{m} signals of one length"),
        });
    }
    if initial.len() != n {
        return Err(LtiError::Shape {
            what: "the initial state",
            rows: initial.len(),
            columns: 1,
            expected: format!("{n} x 1"),
        });
    }
    // Rows contiguous: [a b] and [c d] times [x; u].
    let width = n + m;
    let stacked = |left: &DMatrix<f64>, right: &DMatrix<f64>| {
        let mut rows = Vec::with_capacity(left.nrows() * width);
        for i in 0..left.nrows() {
            rows.extend(left.row(i).iter());
            rows.extend(right.row(i).iter());
        }
        rows
    };
    let (ab, cd) = (stacked(&model.a, &model.b), stacked(&model.c, &model.d));
    let mut state = vec![0.0; width];
    state[..n].copy_from_slice(initial);
    let mut next = vec![0.0; n];
    let mut outputs = vec![Vec::with_capacity(samples); q];
    for k in 0..samples {
        for (slot, u) in state[n..].iter_mut().zip(inputs) {
            *slot = u[k];
        }
        for (output, row) in outputs.iter_mut().zip(cd.chunks_exact(width)) {
            output.push(dot(row, &state));
        }
        for (x, row) in next.iter_mut().zip(ab.chunks_exact(width)) {
            *x = dot(row, &state);
        }
        state[..n].copy_from_slice(&next);
        end_what_decayed(&mut state[..n]);
    }
    Ok(outputs)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use nalgebra::{DVector, dmatrix};

    use crate::lti::{discretize_zero_order_hold, to_transfer_function};

    #[test]
    fn a_motion_that_decays_is_over_and_holds_no_subnormal_number() {
        let model = StateSpace::new(
            dmatrix![0.5, 0.25; -0.25, 0.5],
            dmatrix![1.0; 0.0],
            dmatrix![1.0, 0.0],
            dmatrix![0.0],
            Some(1.0),
        );
        let model = model.unwrap();
        let impulse: Vec<f64> = (0..2000).map(|k| if k == 0 { 1.0 } else { 0.0 }).collect();
        let of_all = simulate(&model, &[impulse], &[0.0, 0.0]).unwrap().remove(0);
        for response in [impulse_response(&model, 2000).unwrap(), of_all] {
            // sqrt(0.3125)^k is 1e-280 after 1108 samples.
            assert!(response[1000] != 0.0 && response[1200..].iter().all(|y| *y == 0.0));
            assert!(response.iter().all(|y| *y == 0.0 || y.is_normal()));
        }
    }

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

    #[test]
    fn two_inputs_and_outputs_add_up_from_single_responses() {
        let (a, b) = (dmatrix![0.9, 0.2; -0.1, 0.7], dmatrix![1.0, 0.5; -0.3, 2.0]);
        let (c, d) = (dmatrix![1.0, 0.0; 0.4, -1.0], dmatrix![0.1, 0.0; 0.0, -0.2]);
        let model = StateSpace::new(a.clone(), b.clone(), c.clone(), d.clone(), Some(1e-3)).unwrap();
        let inputs: Vec<Vec<f64>> =
            (0..2).map(|j| (0..50).map(|k| (f64::from(k) * 0.3 + f64::from(j)).sin()).collect()).collect();
        let both = simulate(&model, &inputs, &[0.5, -1.0]).unwrap();
        for (i, both) in both.iter().enumerate() {
            let mut sum = vec![0.0; 50];
            for (j, input) in inputs.iter().enumerate() {
                let single = StateSpace::new(
                    a.clone(),
                    b.columns(j, 1).into_owned(),
                    c.rows(i, 1).into_owned(),
                    d.view((i, j), (1, 1)).into_owned(),
                    Some(1e-3),
                )
                .unwrap();
                // Half of the initial state each.
                let part = response(&single, input, &DVector::from_vec(vec![0.25, -0.5])).unwrap();
                for (s, p) in sum.iter_mut().zip(part) {
                    *s += p;
                }
            }
            for (found, expected) in both.iter().zip(&sum) {
                // Rounding of fifty steps of a stable recursion of size 5.
                assert!((found - expected).abs() < 1e-13, "{found} {expected}");
            }
        }
        assert!(simulate(&model, &inputs[..1], &[0.0, 0.0]).is_err());
        assert!(simulate(&model, &inputs, &[0.0]).is_err());
    }
}
