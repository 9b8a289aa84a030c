//! Exact discretisation with an input linear between samples.

use nalgebra::{DMatrix, DVector};

use crate::lti::model::check_sample_time;
use crate::lti::{LtiError, StateSpace, matrix_exponential};

/// A sampled model driven by this sample of the input and the next:
/// `x[k+1] = a x[k] + b_now u[k] + b_next u[k+1]`, `y[k] = c x[k] + d u[k]`.
///
/// The state is that of the continuous model at the samples, unlike in the textbook form that shifts it to get rid
/// of `u[k+1]`; so initial conditions keep their meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstOrderHold {
    /// State matrix.
    pub a: DMatrix<f64>,
    /// Input matrix of the sample at the start of the interval.
    pub b_now: DMatrix<f64>,
    /// Input matrix of the sample at its end.
    pub b_next: DMatrix<f64>,
    /// Output matrix.
    pub c: DMatrix<f64>,
    /// Direct term.
    pub d: DMatrix<f64>,
    /// Sampling interval, s.
    pub sample_time_s: f64,
}

/// Discretises for an input that is linear between samples; exact for such inputs, error O(dt²) for smooth ones.
///
/// `exp([[a, b, 0], [0, 0, I/dt], [0, 0, 0]] dt)` has `[Ad, G1, G2]` as its first block row, and
/// `b_now = G1 - G2`, `b_next = G2`. Source: Van Loan, "Computing integrals involving the matrix exponential", IEEE
/// Trans. Autom. Control 23(3), 1978.
pub fn discretize_first_order_hold(model: &StateSpace, dt_s: f64) -> Result<FirstOrderHold, LtiError> {
    model.require_continuous()?;
    check_sample_time(dt_s)?;
    let (n, m) = model.b.shape();
    let mut big = DMatrix::zeros(n + 2 * m, n + 2 * m);
    big.view_mut((0, 0), (n, n)).copy_from(&(&model.a * dt_s));
    big.view_mut((0, n), (n, m)).copy_from(&(&model.b * dt_s));
    big.view_mut((n, n + m), (m, m)).fill_with_identity();
    let e = matrix_exponential(&big)?;
    let g1 = e.view((0, n), (n, m)).into_owned();
    let g2 = e.view((0, n + m), (n, m)).into_owned();
    Ok(FirstOrderHold {
        a: e.view((0, 0), (n, n)).into_owned(),
        b_now: g1 - &g2,
        b_next: g2,
        c: model.c.clone(),
        d: model.d.clone(),
        sample_time_s: dt_s,
    })
}

impl FirstOrderHold {
    /// The textbook form without the next sample: the state is `x - b_next u`, the direct term grows by `c b_next`.
    /// Same response to every input. Errors: not finite.
    pub fn state_space(&self) -> Result<StateSpace, LtiError> {
        StateSpace::new(
            self.a.clone(),
            &self.b_now + &self.a * &self.b_next,
            self.c.clone(),
            &self.d + &self.c * &self.b_next,
            Some(self.sample_time_s),
        )
    }

    /// Response of a model with one input and one output to `input` from the state `initial`.
    /// Errors: [`LtiError::NotSingle`], [`LtiError::Shape`].
    pub fn response(&self, input: &[f64], initial: &DVector<f64>) -> Result<Vec<f64>, LtiError> {
        if self.b_now.ncols() != 1 || self.c.nrows() != 1 {
            return Err(LtiError::NotSingle { inputs: self.b_now.ncols(), outputs: self.c.nrows() });
        }
        if initial.len() != self.a.nrows() {
            return Err(LtiError::Shape {
                what: "the initial state",
                rows: initial.len(),
                columns: 1,
                expected: format!("{} x 1", self.a.nrows()),
            });
        }
        let mut x = initial.clone();
        let mut output = Vec::with_capacity(input.len());
        for (k, &u) in input.iter().enumerate() {
            output.push((&self.c * &x)[0] + self.d[(0, 0)] * u);
            if let Some(&next) = input.get(k + 1) {
                x = &self.a * x + self.b_now.column(0) * u + self.b_next.column(0) * next;
            }
        }
        Ok(output)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn ramp_through_a_lag_is_exact_at_every_sample() {
        let lag = StateSpace::new(dmatrix![-5.0], dmatrix![5.0], dmatrix![1.0], dmatrix![0.0], None).unwrap();
        let dt = 0.1;
        let input: Vec<f64> = (0..30).map(|k| 2.0 + 3.0 * f64::from(k) * dt).collect();
        let output =
            discretize_first_order_hold(&lag, dt).unwrap().response(&input, &DVector::from_element(1, 1.0)).unwrap();
        for (k, y) in output.iter().enumerate() {
            let t = k as f64 * dt;
            // y' = -5 y + 5 (2 + 3 t), y(0) = 1: y = 2 + 3 t - 3/5 + (1 - 7/5) e^{-5t}
            let exact = 1.4 + 3.0 * t - 0.4 * (-5.0 * t).exp();
            // 30 steps of a contracting recursion: a few roundings.
            assert!((y - exact).abs() < 1e-14, "sample {k}: {y} against {exact}");
        }
    }

    #[test]
    fn double_integrator_of_a_ramp_is_the_cubic() {
        let mass =
            StateSpace::new(dmatrix![0.0, 1.0; 0.0, 0.0], dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0], None)
                .unwrap();
        let input: Vec<f64> = (0..11).map(f64::from).collect();
        let output = discretize_first_order_hold(&mass, 1.0).unwrap().response(&input, &DVector::zeros(2)).unwrap();
        // t^3/6 at t = 10, rounding of ten steps.
        assert!((output[10] - 1000.0 / 6.0).abs() < 1e-11);
    }
}
