//! Output-error models in discrete time: the poles that simulate a record best.

use crumple_numerics::estimation::minimise::StopReason;
use crumple_numerics::estimation::minimise::separable_covariance::{nonlinear_covariance, propagated};
use crumple_numerics::estimation::statistics::autoregressive_effective_samples;
use crumple_numerics::linalg::dot;
use crumple_numerics::lti::{Complex, StateSpace};
use nalgebra::DMatrix;

use crate::output_error::options::OutputErrorOptions;
use crate::poles::multistart::{Search, best_search};
use crate::poles::starts::continuous;
use crate::poles::time_scale::unscaled;
use crate::transfer_function::{state_space, weigh_by_residuals};
use crate::{Hold, IdentifyError, InformationCriteria, InitialConditions, IoData, TransferFunctionOptions, sampled};

/// A model whose simulation fits best.
#[derive(Debug, Clone, PartialEq)]
pub struct OutputError {
    /// Sampled model; the delay is not part of it.
    pub model: StateSpace,
    /// Samples by which inputs act late.
    pub delay: usize,
    /// Mean square of the simulation error, of all outputs each divided by its root mean square.
    pub loss: f64,
    /// Information criteria of that loss.
    pub criteria: InformationCriteria,
    /// Poles of the chain, and standard deviations of natural frequency (rad/s) and damping ratio of each, from the
    /// covariance of the linearised fit inflated for correlated residuals; `None` where not determined.
    pub pole_deviations: Vec<(Complex, Option<(f64, f64)>)>,
    /// Condition number of the column-scaled sensitivities of the poles, all else projected out.
    pub condition: f64,
    /// Iterations of the best start.
    pub iterations: u32,
    /// Evaluations of all starts.
    pub evaluations: u64,
    /// Why the best start stopped.
    pub stop_reason: StopReason,
    /// Whether one of its unknowns stands on a bound.
    pub on_bound: bool,
    /// Loss of every refined start, best first: how alone the best one is.
    pub losses: Vec<f64>,
    /// Simulated outputs, the motion at the start among them.
    pub simulated: Vec<Vec<f64>>,
}

/// Finds the model of given order whose simulated output, from a free initial state, is nearest to the measured one.
///
/// The same search as that of [`transfer_function_fit`](crate::transfer_function_fit()), with as many zeros as
/// poles and inputs that are held between samples; what it finds is sampled. Every sampled model has such a form,
/// except one with an odd number of equal poles on the negative real axis, which a pair at the Nyquist frequency comes
/// close to. With one input or one output the model has `order` states, with several of both that many for each of the
/// fewer ones.
pub fn output_error(data: &IoData, options: OutputErrorOptions) -> Result<OutputError, IdentifyError> {
    fitted(data, options, &engine(options))
}

/// The same from given sampled poles alone, one list a start: those of a model that is near.
pub fn output_error_from(
    data: &IoData,
    options: OutputErrorOptions,
    poles: &[Vec<Complex>],
) -> Result<OutputError, IdentifyError> {
    let given = poles.iter().map(|poles| continuous(poles, options.order, data.sample_time_s())).collect();
    fitted(data, options, &TransferFunctionOptions { starts: Vec::new(), given, ..engine(options) })
}

/// The search as that of transfer functions.
fn engine(options: OutputErrorOptions) -> TransferFunctionOptions {
    let OutputErrorOptions { order, direct, delay, from_rest, random_starts, stop } = options;
    TransferFunctionOptions {
        hold: Hold::Zero,
        delay,
        initial: if from_rest { InitialConditions::Zero } else { InitialConditions::Estimate },
        stable: true,
        random_starts,
        stop,
        ..TransferFunctionOptions::new(order, order.saturating_sub(usize::from(!direct)))
    }
}

fn fitted(
    data: &IoData,
    options: OutputErrorOptions,
    engine: &TransferFunctionOptions,
) -> Result<OutputError, IdentifyError> {
    let mut search = best_search("output error", data, engine)?;
    weigh_by_residuals(&mut search, data.samples(), options.stop);
    let Search { problem, best, losses, input_scales, output_scales, .. } = &search;
    let samples = data.samples();
    let residuals = best.residual.chunks_exact(samples);
    let rms = data.output_scales();
    let relative = |(residual, k): (&[f64], usize)| dot(residual, residual) * (output_scales[k] / rms[k]).powi(2);
    let count = best.residual.len() as f64;
    let loss = residuals.clone().zip(0..).map(relative).sum::<f64>() / count;
    let parameters = best.theta.len() + best.coefficients.len();
    let effective = residuals.map(autoregressive_effective_samples).sum();
    let (covariance, condition) = nonlinear_covariance(problem, best, effective);
    // In units of one sample, in which the matrix has entries of order 1.
    let chain = unscaled(&problem.chain(&best.theta), samples as f64);
    let gain = |i: usize, j: usize| output_scales[i] / input_scales[j];
    let StateSpace { a, b, c, d, .. } =
        sampled(&state_space(&search, &chain, samples as f64, &gain)?, Hold::Zero, 1.0)?.0;
    let poles: Vec<Complex> = chain.poles().into_iter().map(Complex::exp).collect();
    let deviations = match covariance {
        Some(covariance) => mode_deviations(&search, &covariance, samples as f64 * data.sample_time_s()),
        None => vec![None; poles.len()],
    };
    let simulated = data.outputs().iter().zip(best.residual.chunks_exact(samples)).zip(output_scales);
    let simulated = simulated.map(|((y, e), scale)| y.iter().zip(e).map(|(y, e)| y - e * scale).collect()).collect();
    // Those of a single output are in its unit.
    let unit = if let [scale] = rms[..] { scale * scale } else { 1.0 };
    Ok(OutputError {
        model: StateSpace::new(a, b, c, d, Some(data.sample_time_s()))?,
        pole_deviations: poles.into_iter().zip(deviations).collect(),
        condition,
        delay: options.delay,
        loss,
        criteria: InformationCriteria::new(loss, count, parameters),
        iterations: best.iterations,
        evaluations: search.evaluations,
        stop_reason: best.stop,
        on_bound: best.on_bound.contains(&true),
        losses: losses.iter().map(|loss| loss / unit).collect(),
        simulated,
    })
}

/// Standard deviations of frequency (rad/s) and damping ratio of every pole from the covariance of the chain's
/// unknowns.
fn mode_deviations(search: &Search, covariance: &DMatrix<f64>, duration_s: f64) -> Vec<Option<(f64, f64)>> {
    let theta = &search.best.theta;
    let describe = |theta: &[f64]| -> Vec<f64> {
        let poles = search.problem.chain(theta).poles();
        poles.iter().map(|s| s.norm() / duration_s).chain(poles.iter().map(|s| -s.re / s.norm())).collect()
    };
    let described = propagated(&describe, theta, covariance);
    let deviation = |i: usize| Some(described[(i, i)].max(0.0).sqrt()).filter(|_| described[(i, i)].is_finite());
    (0..theta.len()).map(|i| deviation(i).zip(deviation(theta.len() + i))).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::uniform_at;
    use crumple_numerics::lti::simulate;

    fn data(m: usize, q: usize, delay: usize) -> (IoData, Vec<Complex>) {
        // Poles 0.9 +- 0.3i and 0.5, with every coupling different.
        let a = nalgebra::dmatrix![0.9, 0.3, 0.0; -0.3, 0.9, 0.1; 0.0, 0.0, 0.5];
        let b = DMatrix::from_fn(3, m, |i, j| 1.0 + 0.3 * i as f64 - 0.8 * j as f64);
        let c = DMatrix::from_fn(q, 3, |i, j| 1.0 - 0.4 * j as f64 + 0.7 * i as f64);
        let d = DMatrix::from_fn(q, m, |i, j| 0.2 + 0.1 * (i + j) as f64);
        let model = StateSpace::new(a, b, c, d, Some(0.01)).unwrap();
        let u: Vec<Vec<f64>> = (0..m).map(|j| (0..300).map(|k| uniform_at(j + 40, k) - 0.5).collect()).collect();
        let late: Vec<Vec<f64>> = u
            .iter()
            .map(|u| std::iter::repeat_n(0.0, delay).chain(u[..300 - delay].iter().copied()).collect())
            .collect();
        let y = simulate(&model, &late, &[1.0, -2.0, 0.5]).unwrap();
        (IoData::new(u, y, 0.01).unwrap(), model.poles().unwrap())
    }

    #[test]
    fn poles_come_back_for_any_inputs_and_outputs_with_delay_and_motion_at_the_start() {
        for (m, q, delay) in [(1, 1, 0), (2, 1, 3), (1, 3, 0), (2, 2, 0), (3, 2, 0), (2, 3, 1)] {
            let (data, poles) = data(m, q, delay);
            let estimated = output_error(&data, OutputErrorOptions { delay, ..OutputErrorOptions::new(3) }).unwrap();
            assert_eq!(estimated.model.order(), 3 * m.min(q));
            for estimated in estimated.model.poles().unwrap() {
                let miss = poles.iter().map(|exact| (estimated - exact).norm()).fold(f64::INFINITY, f64::min);
                // A perfect fit: rounding over the sensitivity of the poles.
                assert!(miss < 1e-8, "{m} inputs, {q} outputs: {estimated} {poles:?}");
            }
            assert!(estimated.loss < 1e-18, "{}", estimated.loss);
            if delay == 0 {
                let fit = crate::compare(&estimated.model, &data).unwrap()[0].unwrap();
                assert!(fit.fit_percent.unwrap() > 99.9999, "{fit:?}");
            }
        }
    }

    #[test]
    fn no_transfer_function_of_the_order_simulates_better() {
        use crate::{TransferFunctionOptions, transfer_function_fit};
        const DT_S: f64 = 1e-3;
        for system in 0..20 {
            // Fourth order, slow and stiff: two real poles apart, and a pair; gains of either sign.
            let draw = |k: usize| uniform_at(900 + system, k);
            let (slow, fast) = (-1.0 - 2.0 * draw(0), -20.0 - 60.0 * draw(1));
            let (re, im) = (-5.0 - 30.0 * draw(2), 40.0 + 100.0 * draw(3));
            let a = nalgebra::dmatrix![slow, 0.0, 0.0, 0.0; 0.0, fast, 0.0, 0.0; 0.0, 0.0, re, im; 0.0, 0.0, -im, re];
            let b = DMatrix::from_element(4, 1, 1.0);
            let c = DMatrix::from_fn(1, 4, |_, j| (draw(4 + j) - 0.5) * [1.0, 30.0, 60.0, 60.0][j]);
            let model = StateSpace::new(a, b, c, DMatrix::zeros(1, 1), None).unwrap();
            let held = crumple_numerics::lti::discretize_first_order_hold(&model, DT_S).unwrap();
            let u: Vec<f64> = (0..500).map(|k| uniform_at(950 + system, k) - 0.5).collect();
            let mut x = nalgebra::DVector::zeros(4);
            let mut y = Vec::new();
            for k in 0..u.len() {
                y.push((&model.c * &x)[0]);
                let next = u.get(k + 1).copied().unwrap_or(0.0);
                x = &held.a * x + held.b_now.column(0) * u[k] + held.b_next.column(0) * next;
            }
            let rms = crate::data::scale(&y);
            for (k, y) in y.iter_mut().enumerate() {
                // Uniform noise of 10 %: deviation 1/sqrt 12 without the factor.
                *y += 0.1 * 12.0_f64.sqrt() * rms * (uniform_at(980 + system, k) - 0.5);
            }
            let data = IoData::single(u, y, DT_S).unwrap();
            let sampled = output_error(&data, OutputErrorOptions::new(4)).unwrap();
            // Output error is stable by construction.
            let options = TransferFunctionOptions { stable: true, ..TransferFunctionOptions::new(4, 3) };
            let reference = transfer_function_fit(&data, &options).unwrap();
            let scale = data.output_scales()[0];
            let (sampled, reference) = (sampled.loss * scale * scale, reference.search.losses[0]);
            // Sampled models of the order hold every continuous one under straight lines; 0.1 % for where they stop.
            assert!(sampled <= 1.001 * reference, "{system}: {sampled} {reference}");
        }
    }

    #[test]
    fn deviations_are_the_spread_over_records() {
        let (clean, poles) = data(1, 1, 0);
        let exact: Vec<f64> = poles.iter().map(|z| (z.ln() / 0.01).norm()).collect();
        let rms = crate::data::scale(&clean.outputs()[0]);
        let records = 60;
        let (mut squares, mut expected) = (0.0, 0.0);
        for seed in 0..records {
            // Uniform noise of 5 %: deviation 1/sqrt 12 without the factor.
            let noise = |k: usize| 0.05 * rms * 12.0_f64.sqrt() * (uniform_at(5000 + seed, k) - 0.5);
            let y = clean.outputs()[0].iter().enumerate().map(|(k, y)| y + noise(k)).collect();
            let noisy = IoData::new(clean.inputs().to_vec(), vec![y], 0.01).unwrap();
            let estimated = output_error(&noisy, OutputErrorOptions { random_starts: 0, ..OutputErrorOptions::new(3) });
            let estimated = estimated.unwrap();
            let (pole, deviations) = estimated.pole_deviations.iter().find(|(z, _)| z.im > 0.0).unwrap();
            let (frequency, damping) = deviations.unwrap();
            let error = (pole.ln() / 0.01).norm() - exact[poles.iter().position(|z| z.im > 0.0).unwrap()];
            squares += error * error;
            expected += frequency * frequency;
            assert!(damping.is_finite() && estimated.condition < 1e6, "{estimated:?}");
        }
        let ratio = (squares / expected).sqrt();
        // Of 60 records a standard deviation is known to 9 %: three of these, and a tenth for effective samples.
        assert!((0.65..1.4).contains(&ratio), "{ratio}");
    }
}
