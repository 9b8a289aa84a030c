//! ARX models: linear regression on past outputs and inputs.

use crumple_numerics::linalg::{CONDITION_LIMIT, Solution, TriangularFactor};
use crumple_numerics::lti::{Complex, StateSpace};
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::modes::discrete_mode_deviations;
use crate::{IdentifyError, InformationCriteria, IoData};

/// Samples per independent part of a long record. Parts are combined in order, so the result does not depend on the
/// number of threads.
const PART: usize = 65_536;

/// Number of parameters and delay of an ARX model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArxOrder {
    /// Past outputs.
    pub na: usize,
    /// Inputs.
    pub nb: usize,
    /// Samples between an input and its first effect; 0: within the same sample.
    pub nk: usize,
}

impl ArxOrder {
    /// States of the model that it is: the longest memory.
    pub fn states(&self) -> usize {
        self.na.max((self.nb + self.nk).saturating_sub(1))
    }
}

/// `y[k] = -sum A_i y[k-i] + sum_j B_j u[k-nk-j] + e[k]`, numbers of one output and one input, else matrices.
#[derive(Debug, Clone, PartialEq)]
pub struct Arx {
    /// Lags and delay, the same for every output and input.
    pub order: ArxOrder,
    /// `A_1 ... A_na`, outputs x outputs; the leading 1 is not part of it.
    pub a: Vec<DMatrix<f64>>,
    /// `B_0 ... B_(nb-1)`, outputs x inputs.
    pub b: Vec<DMatrix<f64>>,
    /// Covariance of the rows of all `A`, then of all `B`, for white `e` of variance 1; the same for every output.
    pub unit_covariance: DMatrix<f64>,
    /// Mean square of the one-step prediction errors of every output.
    pub losses: Vec<f64>,
    /// Rows of the regression.
    pub rows: usize,
    /// Condition number of the column-scaled regression, common to all outputs.
    pub condition: f64,
    /// Sampling interval, s.
    pub sample_time_s: f64,
}

/// Fits an ARX model of any outputs and inputs by least squares (QR, no normal equations).
///
/// All outputs have the same regressors, so that one triangular factor serves them all. Exact for data made by such a
/// model without noise. With noise it is unbiased only for noise that is white when filtered through `1/A`; otherwise
/// it is biased towards too much damping: use it as a starting point, or with an order of several times the number of
/// states. Errors: too few samples, condition above [`CONDITION_LIMIT`] (collinear outputs, noise-free data of lower
/// order).
pub fn arx(data: &IoData, order: ArxOrder) -> Result<Arx, IdentifyError> {
    arx_from(data, order, order.states())
}

/// The same on the rows from sample `first` on, so that several orders can be compared on the same equations.
pub fn arx_from(data: &IoData, order: ArxOrder, first: usize) -> Result<Arx, IdentifyError> {
    let ArxOrder { na, nb, nk } = order;
    let (m, q) = (data.inputs().len(), data.outputs().len());
    let p = q * na + m * nb;
    enough(data.samples(), p, first)?;
    let mut columns: Vec<(&[f64], usize)> = (1..=na).flat_map(|lag| late(data.outputs(), lag)).collect();
    columns.extend((nk..nk + nb).flat_map(|lag| late(data.inputs(), lag)));
    columns.extend(late(data.outputs(), 0));
    let factor = lagged_factor(&columns, first, data.samples());
    let Solution { coefficients, residual_squares, condition, inverse_square, .. } = solved(&factor, q)?;
    let rows = factor.rows();
    Ok(Arx {
        order,
        a: (0..na).map(|lag| DMatrix::from_fn(q, q, |i, j| -coefficients[(lag * q + j, i)])).collect(),
        b: (0..nb).map(|tap| DMatrix::from_fn(q, m, |i, j| coefficients[(na * q + tap * m + j, i)])).collect(),
        unit_covariance: inverse_square,
        losses: residual_squares.iter().map(|s| s / rows as f64).collect(),
        rows,
        condition,
        sample_time_s: data.sample_time_s(),
    })
}

/// Every signal with a lag.
fn late(signals: &[Vec<f64>], lag: usize) -> impl Iterator<Item = (&[f64], usize)> {
    signals.iter().map(move |signal| (&signal[..], lag))
}

/// Errors: no parameters, or no row to spare for `parameters` of an output after `first` samples of memory.
pub(crate) fn enough(samples: usize, parameters: usize, first: usize) -> Result<(), IdentifyError> {
    if parameters == 0 {
        return Err(IdentifyError::OrderZero);
    }
    let needed = first + parameters + 1;
    if samples < needed {
        let why = format!("{parameters} parameters after {first} samples of memory");
        return Err(IdentifyError::TooShort { method: "arx", samples, needed, why });
    }
    Ok(())
}

/// The regression of so many outputs. Errors: not determined by the data.
pub(crate) fn solved(factor: &TriangularFactor, outputs: usize) -> Result<Solution, IdentifyError> {
    let solution = factor.solve(outputs, 0.0).ok_or(IdentifyError::NotConverged("the regression of arx"))?;
    if solution.condition > CONDITION_LIMIT {
        let (condition, limit) = (solution.condition, CONDITION_LIMIT);
        return Err(IdentifyError::IllConditioned { method: "arx", condition, limit });
    }
    Ok(solution)
}

/// Triangular factor of the rows `first..samples` of signals, each late by its lag.
pub(crate) fn lagged_factor(columns: &[(&[f64], usize)], first: usize, samples: usize) -> TriangularFactor {
    let width = columns.len();
    let rows_per_block = TriangularFactor::block_rows(width);
    let starts: Vec<usize> = (first..samples).step_by(PART).collect();
    let factors: Vec<TriangularFactor> = starts
        .into_par_iter()
        .map(|start| {
            let end = (start + PART).min(samples);
            let mut factor = TriangularFactor::new(width);
            let mut block = vec![0.0; rows_per_block * width];
            for k in (start..end).step_by(rows_per_block) {
                let count = rows_per_block.min(end - k);
                let block = &mut block[..count * width];
                // Every column of the block is a stretch of a signal.
                for (target, (signal, lag)) in block.chunks_exact_mut(count).zip(columns) {
                    target.copy_from_slice(&signal[k - lag..k - lag + count]);
                }
                factor.push(count, block);
            }
            factor
        })
        .collect();
    let mut factor = TriangularFactor::new(width);
    for part in &factors {
        factor.merge(part);
    }
    factor
}

/// Fits every order of a list on the same rows and returns the models with their information criteria, in the order of
/// the list. Orders that cannot be fitted are errors in their place.
///
/// The rows are those after the longest memory of the list. An order with a memory of more than half of the samples, or
/// with parameters for half of them, would leave the others too few samples to be compared on: it is left out. For a
/// scan over the delay fix `na`, `nb` and list `nk`; the smallest BIC is the usual choice.
pub fn arx_scan(data: &IoData, orders: &[ArxOrder]) -> Vec<Result<(Arx, InformationCriteria), IdentifyError>> {
    let samples = data.samples();
    let parameters = |order: &ArxOrder| order.na + order.nb * data.inputs().len();
    let needed = |order: &ArxOrder| (2 * order.states()).max(2 * parameters(order) + 1);
    let fitting = orders.iter().filter(|order| needed(order) <= samples);
    let memory = fitting.map(ArxOrder::states).max().unwrap_or(0);
    orders
        .par_iter()
        .map(|order| {
            if needed(order) > samples {
                return Err(IdentifyError::TooShort {
                    method: "arx",
                    samples,
                    needed: needed(order),
                    why: format!(
                        "{} parameters after {} samples of memory, in a scan that compares by half of the samples",
                        parameters(order),
                        order.states()
                    ),
                });
            }
            let model = arx_from(data, *order, memory)?;
            let criteria = InformationCriteria::new(model.losses[0], model.rows as f64, parameters(order));
            Ok((model, criteria))
        })
        .collect()
}

impl Arx {
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

    /// Covariance of the coefficients of an output, in the order of
    /// [`unit_covariance`](Self::unit_covariance), for white `e`.
    pub fn covariance(&self, output: usize) -> DMatrix<f64> {
        let rows = self.rows as f64;
        &self.unit_covariance * (self.losses[output] * rows / (rows - self.unit_covariance.nrows() as f64))
    }

    /// Standard deviations of natural frequency (rad/s) and damping ratio of the poles of
    /// [`state_space`](Self::state_space), given in its order, from the covariance: for white equation errors. `None`
    /// of several outputs, for poles at zero, multiple ones, and those that are not roots of `A` but of the delay.
    pub fn mode_deviations(&self, poles: &[Complex]) -> Vec<Option<(f64, f64)>> {
        if self.losses.len() != 1 {
            return vec![None; poles.len()];
        }
        let na = self.a.len();
        let a: Vec<f64> = self.a.iter().map(|a| a[(0, 0)]).collect();
        let covariance = self.covariance(0).view((0, 0), (na, na)).into_owned();
        discrete_mode_deviations(&a, &covariance, poles, self.sample_time_s)
    }

    /// One-step predictions of every output; the first samples, which lack their past, are the measured ones.
    ///
    /// `yh[k] = -sum A_i y[k-i] + sum B_j u[k-nk-j]`: measured outputs of the past, not simulated ones.
    pub fn predict(&self, data: &IoData) -> Vec<Vec<f64>> {
        let first = self.order.states().min(data.samples());
        let sum = |i: usize, k: usize, matrices: &[DMatrix<f64>], signals: &[Vec<f64>], lag: usize| -> f64 {
            let of_lag = |(t, x): (usize, &DMatrix<f64>)| -> f64 {
                signals.iter().enumerate().map(|(j, s)| x[(i, j)] * s[k - lag - t]).sum()
            };
            matrices.iter().enumerate().map(of_lag).sum()
        };
        let predicted = |(i, y): (usize, &Vec<f64>)| {
            let from_past = (first..y.len())
                .map(|k| sum(i, k, &self.b, data.inputs(), self.order.nk) - sum(i, k, &self.a, data.outputs(), 1));
            y[..first].iter().copied().chain(from_past).collect()
        };
        data.outputs().iter().enumerate().map(predicted).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::uniform_at;
    use crumple_numerics::lti::simulate;

    /// Uniform on [-1, 1).
    fn noise(k: usize) -> f64 {
        2.0 * uniform_at(4, k) - 1.0
    }

    /// Output of the ARX(2,2,nk) model below, driven by noise.
    fn record(nk: usize, equation_noise: f64, samples: usize) -> IoData {
        let u: Vec<f64> = (0..samples).map(noise).collect();
        let mut y = vec![0.0; samples];
        for k in 0..samples {
            let at = |s: &[f64], lag: usize| if k >= lag { s[k - lag] } else { 0.0 };
            y[k] = 1.6 * at(&y, 1) - 0.8 * at(&y, 2)
                + 0.5 * at(&u, nk)
                + 0.3 * at(&u, nk + 1)
                + equation_noise * noise(k + 1_000_000);
        }
        IoData::single(u, y, 0.01).unwrap()
    }

    #[test]
    fn clean_data_give_the_coefficients_back() {
        for nk in [0, 1, 3] {
            let model = arx(&record(nk, 0.0, 400), ArxOrder { na: 2, nb: 2, nk }).unwrap();
            for (estimated, exact) in model.a.iter().chain(&model.b).zip([-1.6, 0.8, 0.5, 0.3]) {
                // Rounding times a condition number below 100.
                assert!((estimated[0] - exact).abs() < 1e-13, "{estimated} {exact}");
            }
        }
    }

    #[test]
    fn covariance_covers_the_error_and_the_scan_finds_the_delay() {
        let data = record(2, 0.1, 3000);
        let model = arx(&data, ArxOrder { na: 2, nb: 2, nk: 2 }).unwrap();
        for (i, (estimated, exact)) in model.a.iter().chain(&model.b).zip([-1.6, 0.8, 0.5, 0.3]).enumerate() {
            // Four standard deviations: one in 16,000 by chance, and the data are fixed.
            let deviation = model.covariance(0)[(i, i)].sqrt();
            assert!(
                (estimated[0] - exact).abs() < 4.0 * deviation && deviation < 0.01,
                "{estimated} {exact} {deviation}"
            );
        }
        // Uniform noise of half-width 0.1 has variance 0.01/3; 3000 samples know it to 3 %.
        assert!((model.losses[0] / (0.01 / 3.0) - 1.0).abs() < 0.1);
        let orders: Vec<ArxOrder> = (0..6).map(|nk| ArxOrder { na: 2, nb: 2, nk }).collect();
        let scan = arx_scan(&data, &orders);
        let best = scan.iter().flatten().min_by(|a, b| a.1.bic.total_cmp(&b.1.bic)).unwrap();
        assert_eq!(best.0.order.nk, 2);
    }

    #[test]
    fn a_scan_leaves_out_structures_that_the_record_is_too_short_for() {
        let data = record(2, 0.1, 60);
        let short: Vec<ArxOrder> = (0..6).map(|nk| ArxOrder { na: 2, nb: 2, nk }).collect();
        // One that no sample is left for; and one that fits alone, but leaves the others next to no rows.
        let long = [ArxOrder { na: 2, nb: 2, nk: 70 }, ArxOrder { na: 1, nb: 1, nk: 50 }];
        let orders: Vec<ArxOrder> = long.iter().chain(&short).copied().collect();
        let scan = arx_scan(&data, &orders);
        assert!(arx(&data, long[1]).is_ok());
        assert_eq!(
            scan[0].clone().unwrap_err().to_string(),
            "60 samples, arx needs 142 (4 parameters after 71 samples of memory, in a scan that compares by half of \
             the samples)"
        );
        assert!(matches!(scan[1], Err(IdentifyError::TooShort { needed: 100, .. })), "{:?}", scan[1]);
        assert_eq!(scan[2..], arx_scan(&data, &short));
        assert!(scan[2..].iter().all(Result::is_ok));
    }

    #[test]
    fn state_space_simulates_and_prediction_follows() {
        let data = record(0, 0.0, 300);
        let model = arx(&data, ArxOrder { na: 2, nb: 2, nk: 0 }).unwrap();
        let fit = crate::compare(&model.state_space().unwrap(), &data).unwrap()[0].unwrap();
        assert!(fit.fit_percent.unwrap() > 100.0 - 1e-9, "{fit:?}");
        let predicted = crate::fit_measures(&data.outputs()[0], &model.predict(&data)[0]).unwrap();
        assert!(predicted.fit_percent.unwrap() > 100.0 - 1e-9);
    }

    #[test]
    fn refuses_what_the_data_do_not_determine() {
        let order = ArxOrder { na: 4, nb: 4, nk: 0 };
        let error = arx(&record(0, 0.0, 300), order).unwrap_err();
        assert!(matches!(error, IdentifyError::IllConditioned { .. }), "{error}");
        let error = arx(&record(0, 0.0, 8), order).unwrap_err();
        assert_eq!(error.to_string(), "8 samples, arx needs 13 (8 parameters after 4 samples of memory)");
    }

    #[test]
    fn a_coupled_model_of_two_outputs_and_inputs_comes_back() {
        let truth = Arx {
            order: ArxOrder { na: 2, nb: 2, nk: 1 },
            a: vec![nalgebra::dmatrix![-1.5, 0.1; 0.2, -1.2], nalgebra::dmatrix![0.7, 0.0; -0.1, 0.5]],
            b: vec![nalgebra::dmatrix![1.0, -0.5; 0.3, 2.0], nalgebra::dmatrix![0.2, 0.0; 0.0, -0.4]],
            unit_covariance: DMatrix::identity(8, 8),
            losses: vec![0.0; 2],
            rows: 0,
            condition: 1.0,
            sample_time_s: 0.1,
        };
        let u: Vec<Vec<f64>> = (0..2).map(|j| (0..300).map(|k| uniform_at(j, k) - 0.5).collect()).collect();
        let model = truth.state_space().unwrap();
        let y = simulate(&model, &u, &[0.1, -0.2, 0.3, 0.4]).unwrap();
        let data = IoData::new(u, y, 0.1).unwrap();
        let estimated = arx(&data, truth.order).unwrap();
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
        let error = arx(&data, ArxOrder { na: 1, nb: 1, nk: 1 }).unwrap_err();
        assert!(matches!(error, IdentifyError::IllConditioned { .. }), "{error}");
    }
}
