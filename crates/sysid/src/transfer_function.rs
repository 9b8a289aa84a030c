//! Continuous transfer functions of one or several inputs and outputs, with one denominator.

use crumple_numerics::estimation::minimise::Stop;
use crumple_numerics::estimation::minimise::separable_covariance::{propagated, unknowns_covariance};
use crumple_numerics::estimation::minimise::variable_projection::{SeparableFit, minimize};
use crumple_numerics::estimation::statistics::autoregressive_effective_samples;
use crumple_numerics::linalg::dot;
use crumple_numerics::lti::{Complex, Mode, StateSpace, TransferFunction};
use nalgebra::DMatrix;

use crate::modes::root_deviations;
use crate::poles::cascade::SectionChain;
use crate::poles::multistart::{Search, best_search};
use crate::poles::options::TransferFunctionOptions;
use crate::poles::search_outcome::SearchOutcome;
use crate::poles::time_scale::{combined, in_seconds, state_powers, unscaled};
use crate::{FitMeasures, IdentifyError, IoData, fit_measures};

/// Refinements with other weights; the second changes little.
const REWEIGHTED: usize = 2;

/// Transfer functions from every input to every output, and the evidence for them.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunctionFit {
    /// `entries[output][input]`, in units of the data; the denominator is the same for all.
    pub entries: Vec<Vec<TransferFunction>>,
    /// Standard deviations of the numerators' coefficients, `[output][input]`, as many as zeros + 1, highest power
    /// first, from the covariance of the linearised fit inflated for correlated residuals.
    pub numerator_deviations: Vec<Vec<Vec<f64>>>,
    /// The whole as one cascade of sections, well conditioned where coefficients of a polynomial are not, with as many
    /// states as poles times the lesser of the numbers of inputs and outputs.
    pub state_space: StateSpace,
    /// Poles, 1/s, with frequency and damping.
    pub modes: Vec<Mode>,
    /// Zeros of a single path, 1/s, and standard deviations of their real and imaginary parts; `None` where not
    /// determined.
    pub zeros: Vec<UncertainRoot>,
    /// Measures of every simulated output.
    pub fits: Vec<Option<FitMeasures>>,
    /// Simulated outputs.
    pub simulated: Vec<Vec<f64>>,
    /// Numerators of the free motions of every output over the same denominator, highest power first: `y_free =
    /// N(s)/A(s)` of a unit impulse. Empty: from rest.
    pub initial_numerators: Vec<Vec<f64>>,
    /// Covariance of the coefficients: the numerators of all entries, then the denominator after its leading 1; `None`
    /// where the sensitivities do not determine it.
    pub coefficient_covariance: Option<DMatrix<f64>>,
    /// Number of unknowns: poles, numerators, initial motions.
    pub parameters: usize,
    /// The search that found them; its first loss is that of the fit.
    pub search: SearchOutcome,
}

impl TransferFunctionFit {
    /// Covariance of the denominator's coefficients after the leading 1, by rows; empty where it is not finite.
    pub fn denominator_covariance(&self) -> Vec<Vec<f64>> {
        let n = self.search.denominator_deviations.len();
        let Some(all) = &self.coefficient_covariance else { return Vec::new() };
        let block = all.view((all.nrows() - n, all.ncols() - n), (n, n));
        if block.iter().any(|x| !x.is_finite()) {
            return Vec::new();
        }
        block.row_iter().map(|row| row.iter().copied().collect()).collect()
    }

    /// Mass, damping and stiffness of a body on a spring and a damper, `s^d/(m s² + c s + k)`, with their covariance to
    /// first order: of a single path from a force to a displacement (`derivative` 0), its velocity (1) or acceleration
    /// (2), in the units of the data.
    ///
    /// `m = 1/b, c = a1/b, k = a0/b` of `b s^d/(s² + a1 s + a0)`. `None` of other numbers of poles, where another
    /// coefficient of the numerator is not zero at 95 %, and where they are not determined.
    pub fn single_mass(&self, derivative: usize) -> Option<([f64; 3], DMatrix<f64>)> {
        let covariance = self.coefficient_covariance.as_ref()?;
        let [path] = &self.entries.first()?[..] else { return None };
        let ([_, a1, a0], numerator) = (path.denominator(), path.numerator()) else { return None };
        if self.entries.len() > 1 || derivative >= numerator.len() {
            return None;
        }
        let deviations = &self.numerator_deviations[0][0];
        let last = (numerator.len() - 1, deviations.len() - 1);
        let is_zero = |k: &usize| numerator[last.0 - k].abs() <= 1.96 * deviations[last.1 - k];
        if !(0..numerator.len()).filter(|k| *k != derivative).all(|k| is_zero(&k)) {
            return None;
        }
        let (b, count) = (numerator[numerator.len() - 1 - derivative], deviations.len());
        let places = [count - 1 - derivative, count, count + 1];
        let known = DMatrix::from_fn(3, 3, |i, k| covariance[(places[i], places[k])]);
        let of_coefficients = |x: &[f64]| vec![1.0 / x[0], x[1] / x[0], x[2] / x[0]];
        let values = of_coefficients(&[b, *a1, *a0]);
        let propagated = propagated(&of_coefficients, &[b, *a1, *a0], &known);
        let is_known = values.iter().chain(propagated.iter()).all(|x| x.is_finite());
        is_known.then(|| ([values[0], values[1], values[2]], propagated))
    }
}

/// Finds the continuous transfer functions with given numbers of poles and zeros, all with one denominator, whose
/// simulated outputs are nearest to the measured ones.
///
/// Output error, `min |y - yh|²`, by variable projection: only the poles are iterated on, numerators and initial
/// motions are linear and solved for. The model is a cascade of second-order sections, discretised exactly for the
/// declared hold; its sensitivities are states of a larger cascade, exact too. (A filter in direct form loses the
/// optimum at high sampling rates: its coefficients differ from those of integrators by less than rounding allows.)
/// Time is scaled by the record's length and signals by their root mean square.
///
/// One structure has one set of modes, whatever drives it and wherever it is watched; numerators and initial motions
/// are those of every path. Outputs are weighed by what is left of them: the search divides each by its root mean
/// square, two more refinements by that of its residual, which is what the standard deviations rest on. Where the paths
/// are different systems, fit each by itself. Starts: those of every pair of an input and an output. The order of a
/// minimal model of several inputs *and* outputs is as many states as poles times the lesser of their numbers.
///
/// Without estimated initial conditions a record that starts in motion, as every crash record does, is fitted badly.
/// The optimum found is the best of several starts, not proven global. A numerator may be badly determined: look at
/// its standard deviations.
///
/// Methods of the starts: Garnier & Wang (ed.), *Identification of Continuous-time Models from Sampled Data*, 2008.
pub fn transfer_function_fit(
    data: &IoData,
    options: &TransferFunctionOptions,
) -> Result<TransferFunctionFit, IdentifyError> {
    let mut search = best_search("tfest", data, options)?;
    weigh_by_residuals(&mut search, data.samples(), options.stop);
    let Search { problem, best, .. } = &search;
    let (m, q, samples) = (data.inputs().len(), data.outputs().len(), data.samples());
    let duration = samples as f64 * data.sample_time_s();
    let (n, k, per_output) = (options.poles, best.theta.len(), best.coefficients.nrows());
    let b_count = options.zeros + 1;
    let gain = |i: usize, j: usize| search.output_scales[i] / search.input_scales[j];
    let unknowns: Vec<f64> = best.theta.iter().chain(best.coefficients.iter()).copied().collect();
    // Numerators of all entries, denominator without its 1, frequency and damping of every section.
    let describe = |unknowns: &[f64]| -> Vec<f64> {
        let (theta, c) = unknowns.split_at(k);
        let mut all = Vec::new();
        for (i, c) in c.chunks_exact(per_output).enumerate() {
            for j in 0..m {
                let numerator = search.numerator(theta, c, j, options.zeros, duration);
                all.extend(numerator.into_iter().map(|b| b * gain(i, j)));
            }
        }
        let chain = unscaled(&problem.chain(theta), duration);
        all.extend(&chain.denominator()[1..]);
        all.extend(chain.poles().iter().map(|s| s.norm()));
        all.extend(chain.poles().iter().map(|s| -s.re / s.norm()));
        all
    };
    let values = describe(&unknowns);
    let residuals: Vec<&[f64]> = best.residual.chunks_exact(samples).collect();
    let effective = residuals.iter().map(|residual| autoregressive_effective_samples(residual)).sum::<f64>();
    let (covariance, condition) = unknowns_covariance(problem, best, effective);
    let described = covariance.map(|covariance| propagated(&describe, &unknowns, &covariance));
    let deviations: Vec<f64> = match &described {
        Some(described) => described.diagonal().iter().map(|x| x.max(0.0).sqrt()).collect(),
        None => vec![f64::INFINITY; values.len()],
    };
    let numerators = q * m * b_count;
    let mut denominator = vec![1.0];
    denominator.extend(&values[numerators..numerators + n]);
    let entry = |i: usize, j: usize| (i * m + j) * b_count..(i * m + j + 1) * b_count;
    let entries = (0..q)
        .map(|i| (0..m).map(|j| TransferFunction::new(&values[entry(i, j)], &denominator)).collect())
        .collect::<Result<Vec<Vec<_>>, _>>()?;
    let chain = unscaled(&problem.chain(&best.theta), duration);
    let simulated: Vec<Vec<f64>> = data
        .outputs()
        .iter()
        .zip(&residuals)
        .zip(&search.output_scales)
        .map(|((y, residual), scale)| y.iter().zip(*residual).map(|(y, e)| y - e * scale).collect())
        .collect();
    let free_motion = |i: usize| -> Vec<f64> {
        let c: Vec<f64> = best.coefficients.column(i).iter().copied().collect();
        let sum =
            combined(&problem.chain(&best.theta).state_numerators(), &problem.state_coefficients(&best.theta, &c).1);
        // A unit impulse in scaled time has the area of the duration.
        in_seconds(&sum, n, duration).into_iter().map(|x| x * search.output_scales[i]).collect()
    };
    let coefficient_covariance = described.map(|all| all.view((0, 0), (numerators + n, numerators + n)).into_owned());
    Ok(TransferFunctionFit {
        zeros: if m * q == 1 { zeros(&entries[0][0], b_count, coefficient_covariance.as_ref())? } else { Vec::new() },
        entries,
        initial_numerators: if problem.free { (0..q).map(free_motion).collect() } else { Vec::new() },
        coefficient_covariance,
        numerator_deviations: (0..q).map(|i| (0..m).map(|j| deviations[entry(i, j)].to_vec()).collect()).collect(),
        state_space: state_space(&search, &chain, duration, &gain)?,
        modes: chain.poles().into_iter().map(Mode::continuous).collect(),
        fits: data.outputs().iter().zip(&simulated).map(|(y, yh)| fit_measures(y, yh)).collect(),
        simulated,
        parameters: unknowns.len(),
        search: SearchOutcome::new(&search, condition, n, &deviations[numerators..]),
    })
}

/// A root with the standard deviations of its real and imaginary part, where they are known.
pub type UncertainRoot = (Complex, Option<(f64, f64)>);

/// Zeros with the standard deviations of their parts from the covariance of the `count` coefficients of the numerator.
fn zeros(
    path: &TransferFunction,
    count: usize,
    covariance: Option<&DMatrix<f64>>,
) -> Result<Vec<UncertainRoot>, IdentifyError> {
    let zeros = path.zeros()?;
    // Coefficients that vanish exactly are not part of the polynomial.
    let (shown, dropped) = (path.numerator().len(), count - path.numerator().len());
    let deviations = match covariance.map(|all| all.view((dropped, dropped), (shown, shown)).into_owned()) {
        Some(of_numerator) => root_deviations(path.numerator(), &of_numerator, &zeros),
        None => vec![None; zeros.len()],
    };
    Ok(zeros.into_iter().zip(deviations).collect())
}

/// Refines again with every output divided by the root mean square of its residual: the maximum-likelihood weights of
/// white noises that are independent of each other.
///
/// Starts from the optimum of equal weights. With independent white noises of unknown variances these weights
/// maximise the likelihood once they no longer change. Nothing happens for one output.
pub(crate) fn weigh_by_residuals(search: &mut Search, samples: usize, stop: Stop) {
    for _ in 0..if search.problem.output.len() > 1 { REWEIGHTED } else { 0 } {
        let rms = |residual: &[f64]| (dot(residual, residual) / samples as f64).sqrt();
        let weights: Vec<f64> = search.best.residual.chunks_exact(samples).map(rms).collect();
        // A perfect fit has no noise to weigh by.
        if weights.iter().any(|w| *w < 1e-9) {
            return;
        }
        for ((output, scale), weight) in search.problem.output.iter_mut().zip(&mut search.output_scales).zip(&weights) {
            output.iter_mut().for_each(|y| *y /= weight);
            *scale *= weight;
        }
        let Some(again) = minimize(&search.problem, &search.best.theta, stop) else { return };
        search.evaluations += again.evaluations;
        search.best = SeparableFit { iterations: search.best.iterations + again.iterations, ..again };
    }
}

/// Copies of the chain, one per input, read by every output; with fewer outputs than inputs the transpose, one per
/// output.
///
/// With `n` poles, `m` inputs, `q` outputs: `min(m, q) n` states. For `m <= q` copy `j` is driven by input `j` and
/// every output reads all copies; else output `i` reads copy `i`, which all inputs drive. Block diagonal, seconds,
/// units of the data.
pub(crate) fn state_space(
    search: &Search,
    chain: &SectionChain,
    duration: f64,
    gain: &impl Fn(usize, usize) -> f64,
) -> Result<StateSpace, IdentifyError> {
    let Search { problem, best, .. } = search;
    let (m, q, n) = (problem.inputs.len(), problem.output.len(), chain.order());
    let powers = state_powers(chain);
    let coefficients: Vec<Vec<Vec<f64>>> = (0..q)
        .map(|i| {
            let c: Vec<f64> = best.coefficients.column(i).iter().copied().collect();
            problem.state_coefficients(&best.theta, &c).0
        })
        .collect();
    let path = |i: usize, j: usize, s: usize| coefficients[i][j][s] * duration.powi(powers[s]) * gain(i, j);
    let entry = |s: usize| if s == chain.entry() { 1.0 } else { 0.0 };
    let copies = m.min(q);
    let block = if m <= q { chain.matrix() } else { chain.matrix().transpose() };
    let mut a = DMatrix::zeros(copies * n, copies * n);
    for copy in 0..copies {
        a.view_mut((copy * n, copy * n), (n, n)).copy_from(&block);
    }
    let (b, c) = if m <= q {
        (
            DMatrix::from_fn(copies * n, m, |row, j| if row / n == j { entry(row % n) } else { 0.0 }),
            DMatrix::from_fn(q, copies * n, |i, column| path(i, column / n, column % n)),
        )
    } else {
        (
            DMatrix::from_fn(copies * n, m, |row, j| path(row / n, j, row % n)),
            DMatrix::from_fn(q, copies * n, |i, column| if column / n == i { entry(column % n) } else { 0.0 }),
        )
    };
    let per_input = problem.columns_per_input();
    let d = DMatrix::from_fn(q, m, |i, j| {
        if problem.direct { best.coefficients[(j * per_input + problem.numerator, i)] * gain(i, j) } else { 0.0 }
    });
    Ok(StateSpace::new(a, b, c, d, None)?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::uniform_at;
    use crumple_numerics::lti::{Complex, discretize_first_order_hold, simulate};

    const DT_S: f64 = 2e-3;

    /// Two modes and a lag, every path different; inputs are straight lines between samples.
    fn record(m: usize, q: usize, noise: f64) -> (IoData, StateSpace) {
        let a = nalgebra::dmatrix![
            -3.0, 40.0, 0.0, 0.0;
            -40.0, -3.0, 0.0, 0.0;
            0.0, 0.0, -10.0, 110.0;
            0.0, 0.0, -110.0, -10.0
        ];
        let b = DMatrix::from_fn(4, m, |i, j| 30.0 * (1.0 + 0.3 * i as f64 - 0.8 * j as f64));
        let c = DMatrix::from_fn(q, 4, |i, j| 1.0 - 0.4 * j as f64 + 0.7 * i as f64);
        let model = StateSpace::new(a, b, c, DMatrix::zeros(q, m), None).unwrap();
        let sampled = discretize_first_order_hold(&model, DT_S).unwrap().state_space().unwrap();
        // The shifted state of that form at rest is -G u at the start; with u[0] = 0 they are the same.
        let u: Vec<Vec<f64>> = (0..m)
            .map(|j| (0..400).map(|k| if k == 0 { 0.0 } else { uniform_at(j + 7, k / 4) - 0.5 }).collect())
            .collect();
        let mut y = simulate(&sampled, &u, &[0.3, -0.2, 0.1, 0.4]).unwrap();
        for (i, y) in y.iter_mut().enumerate() {
            y.iter_mut().enumerate().for_each(|(k, y)| *y += noise * (uniform_at(i + 90, k) - 0.5));
        }
        (IoData::new(u, y, DT_S).unwrap(), model)
    }

    fn at(model: &StateSpace, s: Complex, output: usize, input: usize) -> Complex {
        let complex = |m: &DMatrix<f64>| m.map(|x| Complex::new(x, 0.0));
        let n = model.order();
        let x = (DMatrix::identity(n, n) * s - complex(&model.a)).lu().solve(&complex(&model.b)).unwrap();
        (complex(&model.c) * x)[(output, input)] + model.d[(output, input)]
    }

    #[test]
    fn every_path_comes_back_for_several_inputs_outputs_and_both() {
        for (m, q) in [(2, 1), (1, 3), (2, 2), (3, 2)] {
            let (data, truth) = record(m, q, 0.0);
            let fit = transfer_function_fit(&data, &TransferFunctionOptions::new(4, 3)).unwrap();
            assert_eq!(fit.state_space.order(), 4 * m.min(q));
            for exact in truth.poles().unwrap() {
                let miss = fit.modes.iter().map(|mode| (mode.pole - exact).norm()).fold(f64::INFINITY, f64::min);
                // A perfect fit: rounding over the sensitivity of the poles.
                assert!(miss < 1e-7 * exact.norm(), "{m} {q}: {miss} {exact}");
            }
            for s in [Complex::new(0.0, 20.0), Complex::new(1.0, 90.0)] {
                for i in 0..q {
                    for j in 0..m {
                        let exact = at(&truth, s, i, j);
                        assert!((fit.entries[i][j].at(s) - exact).norm() < 1e-7 * exact.norm().max(0.1), "{m} {q}");
                        assert!(
                            (at(&fit.state_space, s, i, j) - exact).norm() < 1e-7 * exact.norm().max(0.1),
                            "{m} {q}"
                        );
                    }
                }
            }
            assert!(fit.fits.iter().all(|fit| fit.unwrap().fit_percent.unwrap() > 99.9999));
        }
    }

    #[test]
    fn deviations_cover_the_error_of_noisy_paths() {
        let (data, truth) = record(2, 2, 0.2);
        let fit = transfer_function_fit(&data, &TransferFunctionOptions::new(4, 3)).unwrap();
        for ((estimated, deviation), exact) in
            fit.modes.iter().zip(&fit.search.mode_deviations).zip(truth.poles().unwrap())
        {
            let (w, zeta) = deviation.unwrap();
            // Four deviations; the data are fixed.
            assert!((estimated.natural_frequency_rad_per_s - exact.norm()).abs() < 4.0 * w && w < 0.02 * exact.norm());
            assert!((estimated.damping_ratio.unwrap() + exact.re / exact.norm()).abs() < 4.0 * zeta);
        }
    }
}
