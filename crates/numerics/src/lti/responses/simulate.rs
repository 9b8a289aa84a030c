//! Responses of sampled models with any number of inputs and outputs.

use crate::linalg::dot;

use crate::lti::{LtiError, StateSpace};

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
    let stacked = |left: &nalgebra::DMatrix<f64>, right: &nalgebra::DMatrix<f64>| {
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
    }
    Ok(outputs)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use nalgebra::{DVector, dmatrix};

    use super::*;

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
                let part = crate::lti::response(&single, input, &DVector::from_vec(vec![0.25, -0.5])).unwrap();
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
