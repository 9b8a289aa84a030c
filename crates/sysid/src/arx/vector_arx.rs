//! ARX models of several outputs, each driven by the past of all.
//!
//! The coefficients of all outputs have the same regressors, so that one triangular factor serves them all.

use crumple_linalg::Solution;
use crumple_lti::StateSpace;
use nalgebra::DMatrix;

use crate::arx::arx::{enough, lagged_factor, solved};
use crate::{ArxOrder, IdentifyError, IoData};

/// `y[k] = -sum A_i y[k-i] + sum_j B_j u[k-nk-j] + e[k]` with matrices for coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct VectorArx {
    /// Lags and delay, the same for every output and input.
    pub order: ArxOrder,
    /// `A_1 ... A_na`, outputs x outputs.
    pub a: Vec<DMatrix<f64>>,
    /// `B_0 ... B_(nb-1)`, outputs x inputs.
    pub b: Vec<DMatrix<f64>>,
    /// Mean square of the one-step prediction errors of every output.
    pub losses: Vec<f64>,
    /// Condition number of the column-scaled regression, common to all outputs.
    pub condition: f64,
    /// Sampling interval, s.
    pub sample_time_s: f64,
}

/// Fits an ARX model to any number of outputs and inputs by least squares. What is said of [`arx`](crate::arx()) holds
/// here, for every output.
///
/// Errors: too few samples, condition above [`CONDITION_LIMIT`](crumple_linalg::CONDITION_LIMIT) (collinear outputs,
/// noise-free data of lower order).
pub fn vector_arx(data: &IoData, order: ArxOrder) -> Result<VectorArx, IdentifyError> {
    let ArxOrder { na, nb, nk } = order;
    let (m, q) = (data.inputs().len(), data.outputs().len());
    let p = q * na + m * nb;
    let (first, samples) = (order.states(), data.samples());
    enough(samples, p, first)?;
    let mut columns: Vec<(&[f64], usize)> = Vec::with_capacity(p + q);
    for lag in 1..=na {
        columns.extend(data.outputs().iter().map(|y| (&y[..], lag)));
    }
    for lag in nk..nk + nb {
        columns.extend(data.inputs().iter().map(|u| (&u[..], lag)));
    }
    columns.extend(data.outputs().iter().map(|y| (&y[..], 0)));
    let factor = lagged_factor(&columns, first, samples);
    let Solution { coefficients, residual_squares, condition, .. } = solved(&factor, q)?;
    let rows = factor.rows() as f64;
    Ok(VectorArx {
        order,
        a: (0..na).map(|lag| DMatrix::from_fn(q, q, |i, j| -coefficients[(lag * q + j, i)])).collect(),
        b: (0..nb).map(|tap| DMatrix::from_fn(q, m, |i, j| coefficients[(na * q + tap * m + j, i)])).collect(),
        losses: residual_squares.iter().map(|s| s / rows).collect(),
        condition,
        sample_time_s: data.sample_time_s(),
    })
}

impl VectorArx {
    /// The model as a state space in block observer form, `outputs` times the longest memory states, noise left out.
    /// Errors: not finite.
    pub fn state_space(&self) -> Result<StateSpace, IdentifyError> {
        let q = self.losses.len();
        let m = self.b.first().map_or(0, DMatrix::ncols);
        let blocks = self.order.states();
        let a = |lag: usize| self.a.get(lag.wrapping_sub(1)).cloned().unwrap_or_else(|| DMatrix::zeros(q, q));
        let b = |lag: usize| {
            let tap = lag.checked_sub(self.order.nk);
            tap.and_then(|t| self.b.get(t)).cloned().unwrap_or_else(|| DMatrix::zeros(q, m))
        };
        let n = blocks * q;
        let (mut state, mut input) = (DMatrix::zeros(n, n), DMatrix::zeros(n, m));
        let direct = b(0);
        for block in 0..blocks {
            let coefficient = a(block + 1);
            state.view_mut((block * q, 0), (q, q)).copy_from(&-&coefficient);
            if block + 1 < blocks {
                state.view_mut((block * q, (block + 1) * q), (q, q)).fill_with_identity();
            }
            input.rows_mut(block * q, q).copy_from(&(b(block + 1) - coefficient * &direct));
        }
        let output = DMatrix::from_fn(q, n, |i, k| f64::from(u8::from(i == k)));
        Ok(StateSpace::new(state, input, output, direct, Some(self.sample_time_s))?)
    }

    /// One-step predictions of every output; the first samples, which lack their past, are the measured ones.
    ///
    /// `yh[k] = -sum A_i y[k-i] + sum B_j u[k-nk-j]`: measured outputs of the past, not simulated ones.
    pub fn predict(&self, data: &IoData) -> Vec<Vec<f64>> {
        let first = self.order.states().min(data.samples());
        let mut predicted: Vec<Vec<f64>> = data.outputs().iter().map(|y| y[..first].to_vec()).collect();
        for k in first..data.samples() {
            for (i, predicted) in predicted.iter_mut().enumerate() {
                let past: f64 = self
                    .a
                    .iter()
                    .enumerate()
                    .flat_map(|(lag, a)| {
                        data.outputs()
                            .iter()
                            .zip(a.row(i).iter())
                            .map(move |(y, a)| -a * y[k - 1 - lag])
                            .collect::<Vec<_>>()
                    })
                    .sum();
                let driven: f64 = self
                    .b
                    .iter()
                    .enumerate()
                    .flat_map(|(tap, b)| {
                        let lag = self.order.nk + tap;
                        data.inputs().iter().zip(b.row(i).iter()).map(move |(u, b)| b * u[k - lag]).collect::<Vec<_>>()
                    })
                    .sum();
                predicted.push(past + driven);
            }
        }
        predicted
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_estimation::random::uniform_at;
    use crumple_lti::simulate;

    #[test]
    fn a_coupled_model_of_two_outputs_and_inputs_comes_back() {
        let truth = VectorArx {
            order: ArxOrder { na: 2, nb: 2, nk: 1 },
            a: vec![nalgebra::dmatrix![-1.5, 0.1; 0.2, -1.2], nalgebra::dmatrix![0.7, 0.0; -0.1, 0.5]],
            b: vec![nalgebra::dmatrix![1.0, -0.5; 0.3, 2.0], nalgebra::dmatrix![0.2, 0.0; 0.0, -0.4]],
            losses: vec![0.0; 2],
            condition: 1.0,
            sample_time_s: 0.1,
        };
        let u: Vec<Vec<f64>> = (0..2).map(|j| (0..300).map(|k| uniform_at(j, k) - 0.5).collect()).collect();
        let model = truth.state_space().unwrap();
        let y = simulate(&model, &u, &[0.1, -0.2, 0.3, 0.4]).unwrap();
        let data = IoData::new(u, y, 0.1).unwrap();
        let estimated = vector_arx(&data, truth.order).unwrap();
        for (estimated, exact) in estimated.a.iter().chain(&estimated.b).zip(truth.a.iter().chain(&truth.b)) {
            // Rounding times a condition number below 100.
            assert!((estimated - exact).amax() < 1e-12, "{estimated} {exact}");
        }
        let predicted = estimated.predict(&data);
        for (predicted, measured) in predicted.iter().zip(data.outputs()) {
            assert!(predicted.iter().zip(measured).all(|(x, y)| (x - y).abs() < 1e-12));
        }
        for fit in crate::compare(&estimated.state_space().unwrap(), &data).unwrap() {
            assert!(fit.unwrap().fit_percent.unwrap() > 100.0 - 1e-8, "{fit:?}");
        }
    }

    #[test]
    fn two_copies_of_one_output_are_refused() {
        let u: Vec<f64> = (0..100).map(|k| uniform_at(0, k)).collect();
        let data = IoData::new(vec![u.clone()], vec![u.clone(), u], 0.1).unwrap();
        let error = vector_arx(&data, ArxOrder { na: 1, nb: 1, nk: 1 }).unwrap_err();
        assert!(matches!(error, IdentifyError::IllConditioned { .. }), "{error}");
    }
}
