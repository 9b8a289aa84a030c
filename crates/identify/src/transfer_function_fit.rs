//! Continuous transfer functions from input and output records.

use crumple_lti::{Complex, Mode, StateSpace, TransferFunction, dot};
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::least_squares::{Solution, TriangularFactor};
use crate::pole_problem::{PoleProblem, scaled_poles};
use crate::propagation::root_deviations;
use crate::residual::{chi_square_95, effective_samples};
use crate::section_chain::{Section, SectionChain, sections_of};
use crate::separable::{Separable, SeparableFit, Stop, Termination, evaluate, minimize};
use crate::transfer_starts::{Start, StartProblem};
use crate::{FitMeasures, IdentifyError, InformationCriteria, IoData, fit_measures};

/// Starting points that are refined, of all that were tried.
const REFINED: usize = 14;

/// Of these at most so many of one kind, so that one kind of start cannot crowd out the others.
const REFINED_OF_A_KIND: usize = 4;

/// What the input does between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// It keeps the value of the last sample.
    Zero,
    /// It goes straight to the next sample: right for sampled accelerations, error O(dt²).
    First,
}

/// What is assumed of the system's motion before the record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InitialConditions {
    /// At rest.
    Zero,
    /// Any free motion, estimated with the model.
    Estimate,
    /// Estimated if that lowers the loss by more than an F-test at 5 % allows for chance.
    Auto,
}

/// Settings of [`transfer_function_fit`].
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunctionOptions {
    /// Number of poles.
    pub poles: usize,
    /// Number of zeros, at most that of the poles.
    pub zeros: usize,
    /// Input between samples.
    pub hold: Hold,
    /// Samples by which the input acts late.
    pub delay: usize,
    /// Motion before the record.
    pub initial: InitialConditions,
    /// Whether poles are kept from growing.
    pub stable: bool,
    /// Ways to starting points.
    pub starts: Vec<Start>,
    /// Number of random ones among them.
    pub random_starts: usize,
    /// Poles to start from as well, 1/s.
    pub given: Vec<Vec<Complex>>,
    /// When to stop.
    pub stop: Stop,
}

impl TransferFunctionOptions {
    /// Of so many poles and zeros: first-order hold, initial conditions estimated, every start, growth allowed.
    pub fn new(poles: usize, zeros: usize) -> Self {
        Self {
            poles,
            zeros,
            hold: Hold::First,
            delay: 0,
            initial: InitialConditions::Estimate,
            stable: false,
            starts: vec![
                Start::Svf,
                Start::Gpmf,
                Start::Iv,
                Start::N4sid,
                Start::Integrators,
                Start::Exponentials,
                Start::Random,
            ],
            random_starts: 24,
            given: Vec::new(),
            stop: Stop::default(),
        }
    }
}

/// A transfer function and the evidence for it.
#[derive(Debug, Clone, PartialEq)]
pub struct TransferFunctionFit {
    /// The transfer function, in units of the data.
    pub transfer_function: TransferFunction,
    /// The same as a cascade of sections, well conditioned where coefficients of a polynomial are not.
    pub state_space: StateSpace,
    /// Numerator of the free motion over the same denominator, highest power first: `y_free = N(s)/A(s)` of a unit
    /// impulse. Empty: from rest.
    pub initial_numerator: Vec<f64>,
    /// Poles, 1/s, with frequency and damping.
    pub modes: Vec<Mode>,
    /// Standard deviations of frequency (rad/s) and damping ratio of every mode; `None` where not determined.
    pub mode_deviations: Vec<Option<(f64, f64)>>,
    /// Zeros, 1/s.
    pub zeros: Vec<Complex>,
    /// Standard deviations of the numerator's coefficients (as many as zeros + 1, highest power first), from the
    /// covariance of the linearised fit inflated for correlated residuals.
    pub numerator_deviations: Vec<f64>,
    /// The same of the denominator without its leading 1.
    pub denominator_deviations: Vec<f64>,
    /// Covariance of both: the numerator's `zeros + 1` coefficients, then the denominator's; `None` where the
    /// sensitivities do not determine it.
    pub coefficient_covariance: Option<DMatrix<f64>>,
    /// Standard deviations of the real and imaginary parts of the zeros, 1/s; `None` where not determined.
    pub zero_deviations: Vec<Option<(f64, f64)>>,
    /// Condition number of the column-scaled sensitivities of all unknowns.
    pub condition: f64,
    /// Mean square of the error, square of the output's unit.
    pub loss: f64,
    /// Measures of the simulated output.
    pub fit: Option<FitMeasures>,
    /// Simulated output.
    pub simulated: Vec<f64>,
    /// Criteria with the effective number of samples.
    pub criteria: InformationCriteria,
    /// Whether the initial conditions were estimated.
    pub initial_estimated: bool,
    /// Kind of the best start.
    pub start: Start,
    /// Its iterations.
    pub iterations: usize,
    /// Evaluations of all starts.
    pub evaluations: usize,
    /// Why the best one stopped.
    pub termination: Termination,
    /// Loss of every refined start, best first.
    pub losses: Vec<f64>,
}

impl TransferFunctionFit {
    /// Covariance of the denominator's coefficients after the leading 1, by rows; empty where it is not finite.
    pub fn denominator_covariance(&self) -> Vec<Vec<f64>> {
        let n = self.denominator_deviations.len();
        let Some(all) = &self.coefficient_covariance else { return Vec::new() };
        let own = all.view((all.nrows() - n, all.ncols() - n), (n, n));
        if own.iter().any(|x| !x.is_finite()) {
            return Vec::new();
        }
        own.row_iter().map(|row| row.iter().copied().collect()).collect()
    }
}

/// Finds the continuous transfer function with given numbers of poles and zeros whose simulated output is nearest to
/// the measured one.
///
/// Output error, `min |y - yh|²`, by variable projection: only the poles are iterated on, numerator and initial motion
/// are linear and solved for. The model is a cascade of second-order sections, discretised exactly for the declared
/// hold; its sensitivities are states of a larger cascade, exact too. (A filter in direct form loses the optimum at
/// high sampling rates: its coefficients differ from those of integrators by less than rounding allows.) Time is
/// scaled by the record's length and signals by their root mean square.
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
    if data.inputs().len() != 1 || data.outputs().len() != 1 {
        return Err(IdentifyError::Channels {
            method: "tfest",
            needed: "one input and one output",
            inputs: data.inputs().len(),
            outputs: data.outputs().len(),
        });
    }
    best_search(data, options)?.finish(data, options)
}

/// The search with or without an initial motion, as the options say.
pub(crate) fn best_search(data: &IoData, options: &TransferFunctionOptions) -> Result<Search, IdentifyError> {
    check(data, options)?;
    match options.initial {
        InitialConditions::Zero => search(data, options, false),
        InitialConditions::Estimate => search(data, options, true),
        InitialConditions::Auto => {
            let (rest, moving) = (search(data, options, false)?, search(data, options, true)?);
            let outputs = data.outputs().len() as f64;
            let samples = data.samples() as f64 * outputs;
            let n = options.poles as f64;
            let numerators = outputs * data.inputs().len() as f64 * (options.zeros as f64 + 1.0);
            let gain = (rest.best.cost - moving.best.cost) / moving.best.cost.max(f64::MIN_POSITIVE);
            let added = n * outputs;
            let free = samples - n - numerators - added;
            let estimate = gain * free.max(1.0) > chi_square_95(added);
            Ok(if estimate { moving } else { rest })
        }
    }
}

pub(crate) fn check(data: &IoData, options: &TransferFunctionOptions) -> Result<(), IdentifyError> {
    let (poles, zeros) = (options.poles, options.zeros);
    if poles == 0 {
        return Err(IdentifyError::OrderZero);
    }
    if zeros > poles {
        return Err(IdentifyError::NotProper { zeros, poles });
    }
    if data.inputs().is_empty() {
        return Err(IdentifyError::Channels {
            method: "tfest",
            needed: "one input at least",
            inputs: 0,
            outputs: data.outputs().len(),
        });
    }
    // Of one output: poles, its initial motion, numerators.
    let unknowns = 2 * poles + (zeros + 1) * data.inputs().len();
    let needed = options.delay + 2 * unknowns;
    if data.samples() < needed {
        return Err(IdentifyError::TooShort {
            method: "tfest",
            samples: data.samples(),
            needed,
            why: format!("twice the {unknowns} unknowns of {poles} poles and {zeros} zeros"),
        });
    }
    for (name, signals) in [("input", data.inputs()), ("output", data.outputs())] {
        if signals.iter().any(|signal| signal.iter().all(|x| *x == 0.0)) {
            return Err(IdentifyError::Silent(name));
        }
    }
    Ok(())
}

/// The best stationary point from all starts.
pub(crate) struct Search {
    pub(crate) problem: PoleProblem,
    pub(crate) best: SeparableFit,
    pub(crate) start: Start,
    pub(crate) evaluations: usize,
    pub(crate) losses: Vec<f64>,
    pub(crate) input_scales: Vec<f64>,
    pub(crate) output_scales: Vec<f64>,
}

pub(crate) fn search(data: &IoData, options: &TransferFunctionOptions, free: bool) -> Result<Search, IdentifyError> {
    let (input_scales, output_scales) = (data.input_scales(), data.output_scales());
    let n = options.poles;
    let scaled = |signal: &[f64], scale: f64, delay: usize| -> Vec<f64> {
        std::iter::repeat_n(0.0, delay).chain(signal[..signal.len() - delay].iter().map(|x| x / scale)).collect()
    };
    let layout: Vec<usize> = (0..n / 2).map(|_| 2).chain((n % 2 == 1).then_some(1)).collect();
    let problem = PoleProblem {
        inputs: data.inputs().iter().zip(&input_scales).map(|(u, scale)| scaled(u, *scale, options.delay)).collect(),
        hold: options.hold,
        output: data.outputs().iter().zip(&output_scales).map(|(y, scale)| scaled(y, *scale, 0)).collect(),
        layout,
        numerator: (options.zeros + 1).min(n),
        direct: options.zeros == n,
        free,
        start: Vec::new(),
        stable: options.stable,
    };
    let duration = data.samples() as f64 * data.sample_time_s();
    // Of several inputs and outputs every pair alone: they share the poles.
    let pairs: Vec<StartProblem<'_>> = problem
        .output
        .iter()
        .flat_map(|output| problem.inputs.iter().map(move |input| (input, output)))
        .map(|(input, output)| StartProblem {
            input,
            output,
            hold: options.hold,
            poles: n,
            numerator: options.zeros + 1,
            free,
        })
        .collect();
    let mut candidates: Vec<(Start, Vec<Complex>)> = options
        .starts
        .par_iter()
        .map(|start| {
            // Those of poles that no record enters are the same for every pair.
            let alike = matches!(start, Start::Random | Start::Integrators);
            let pairs = if alike { &pairs[..1] } else { &pairs[..] };
            let found = pairs.iter().flat_map(|pair| pair.poles_by(*start, options.random_starts));
            found.map(|poles| (*start, poles)).collect::<Vec<_>>()
        })
        .collect::<Vec<_>>()
        .concat();
    candidates.extend(options.given.iter().map(|poles| (Start::Given, scaled_poles(poles, duration))));
    let tried = candidates.len();
    let mut scored: Vec<(f64, Start, Vec<f64>)> = candidates
        .into_par_iter()
        .filter_map(|(start, poles)| {
            let bounds = problem.bounds();
            let mut theta = problem.unknowns(&sections_of(&poles, false))?;
            theta.iter_mut().zip(&bounds).for_each(|(x, (low, high))| *x = x.clamp(*low, *high));
            Some((evaluate(&problem, &theta)?.cost, start, theta))
        })
        .collect();
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<(Start, Vec<f64>)> = Vec::new();
    for (_, start, theta) in scored {
        let alike = chosen.iter().filter(|(other, _)| *other == start).count();
        if chosen.len() < REFINED && alike < REFINED_OF_A_KIND {
            chosen.push((start, theta));
        }
    }
    let mut fits: Vec<(Start, SeparableFit)> = chosen
        .par_iter()
        .filter_map(|(start, theta)| Some((*start, minimize(&problem, theta, options.stop)?)))
        .collect();
    fits.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    let evaluations = tried + fits.iter().map(|(_, fit)| fit.evaluations).sum::<usize>();
    // In units of the output if there is one, else the mean over outputs divided by their root mean squares.
    let unit = if let [scale] = output_scales[..] { scale * scale } else { 1.0 / output_scales.len() as f64 };
    let losses = fits.iter().map(|(_, fit)| fit.cost * unit / data.samples() as f64).collect();
    match fits.into_iter().next() {
        Some((start, best)) => Ok(Search { problem, best, start, evaluations, losses, input_scales, output_scales }),
        None => Err(IdentifyError::NoStart { method: "tfest", starts: tried }),
    }
}

impl Search {
    /// From scaled unknowns to a transfer function in units of the data, with its covariance.
    fn finish(self, data: &IoData, options: &TransferFunctionOptions) -> Result<TransferFunctionFit, IdentifyError> {
        let Self { problem, best, .. } = &self;
        let samples = data.samples();
        let duration = samples as f64 * data.sample_time_s();
        let k = best.theta.len();
        let c: Vec<f64> = best.coefficients.column(0).iter().copied().collect();
        let unknowns: Vec<f64> = best.theta.iter().chain(&c).copied().collect();
        let (input_scale, output_scale) = (self.input_scales[0], self.output_scales[0]);
        let gain = output_scale / input_scale;
        // Numerator, denominator without its 1, frequency and damping of every section.
        let describe = |unknowns: &[f64]| -> Vec<f64> {
            let (theta, c) = unknowns.split_at(k);
            let chain = unscaled(&problem.chain(theta), duration);
            let mut all: Vec<f64> =
                self.numerator(theta, c, 0, options.zeros, duration).into_iter().map(|b| b * gain).collect();
            all.extend(&chain.denominator()[1..]);
            all.extend(chain.poles().iter().map(|s| s.norm()));
            all.extend(chain.poles().iter().map(|s| -s.re / s.norm()));
            all
        };
        let values = describe(&unknowns);
        let effective = effective_samples(&best.residual);
        let (covariance, condition) = unknowns_covariance(problem, best, effective);
        let n = options.poles;
        let b_count = options.zeros + 1;
        let described = covariance.map(|covariance| propagated(&describe, &unknowns, &covariance));
        let deviations: Vec<f64> = match &described {
            Some(described) => described.diagonal().iter().map(|x| x.max(0.0).sqrt()).collect(),
            None => vec![f64::INFINITY; values.len()],
        };
        let chain = unscaled(&problem.chain(&best.theta), duration);
        let mut denominator = vec![1.0];
        denominator.extend(&values[b_count..b_count + n]);
        let transfer_function = TransferFunction::new(&values[..b_count], &denominator)?;
        let simulated: Vec<f64> =
            data.outputs()[0].iter().zip(&best.residual).map(|(y, e)| y - e * output_scale).collect();
        let loss = best.cost * output_scale * output_scale / samples as f64;
        let (forced, free) = problem.state_coefficients(&best.theta, &c);
        let forced = &forced[0];
        let initial_numerator = if problem.free {
            let numerators = problem.chain(&best.theta).state_numerators();
            let sum = combined(&numerators, &free);
            // A unit impulse in scaled time has the area of the duration.
            in_seconds(&sum, n, duration).into_iter().map(|x| x * output_scale).collect()
        } else {
            Vec::new()
        };
        let direct = if problem.direct { c[problem.numerator] * gain } else { 0.0 };
        let zeros = transfer_function.zeros()?;
        // Coefficients that vanish exactly are not part of the polynomial.
        let shown = transfer_function.numerator();
        let dropped = b_count - shown.len();
        let zero_deviations = match &described {
            Some(covariance) => {
                let of_numerator = covariance.view((dropped, dropped), (shown.len(), shown.len())).into_owned();
                root_deviations(shown, &of_numerator, &zeros)
            }
            None => vec![None; zeros.len()],
        };
        Ok(TransferFunctionFit {
            coefficient_covariance: described.map(|c| c.view((0, 0), (b_count + n, b_count + n)).into_owned()),
            zero_deviations,
            zeros,
            transfer_function,
            state_space: cascade(&chain, forced, duration, gain, direct)?,
            initial_numerator,
            modes: chain.poles().into_iter().map(Mode::continuous).collect(),
            mode_deviations: (0..n)
                .map(|i| {
                    let (w, zeta) = (deviations[b_count + n + i], deviations[b_count + 2 * n + i]);
                    (w.is_finite() && zeta.is_finite()).then_some((w, zeta))
                })
                .collect(),
            numerator_deviations: deviations[..b_count].to_vec(),
            denominator_deviations: deviations[b_count..b_count + n].to_vec(),
            condition,
            loss,
            fit: fit_measures(&data.outputs()[0], &simulated),
            simulated,
            criteria: InformationCriteria::new(loss, effective, unknowns.len()),
            initial_estimated: problem.free,
            start: self.start,
            iterations: best.iterations,
            evaluations: self.evaluations,
            termination: best.termination,
            losses: self.losses.clone(),
        })
    }

    /// Numerator of one input for the output of `c`, in 1/s, signals scaled, `zeros + 1` coefficients, highest power first.
    pub(crate) fn numerator(&self, theta: &[f64], c: &[f64], input: usize, zeros: usize, duration: f64) -> Vec<f64> {
        let chain = self.problem.chain(theta);
        let n = chain.order();
        let (forced, _) = self.problem.state_coefficients(theta, c);
        let mut polynomial = vec![0.0];
        polynomial.extend(combined(&chain.state_numerators(), &forced[input]));
        if self.problem.direct {
            let direct = c[input * self.problem.columns_per_input() + self.problem.numerator];
            polynomial.iter_mut().zip(chain.denominator()).for_each(|(b, a)| *b += direct * a);
        }
        // The coefficient of (sT)^j over (sT)^n: multiplied by T^(j-n).
        let mut unscaled = Vec::with_capacity(zeros + 1);
        for (index, b) in polynomial.iter().enumerate().skip(n - zeros) {
            unscaled.push(b * duration.powi(-i32::try_from(index).unwrap_or(i32::MAX)));
        }
        unscaled
    }
}

/// Covariance of all unknowns of a fit (poles, then linear ones), for as many independent samples as there effectively
/// are, and the condition number of their column-scaled sensitivities.
pub(crate) fn unknowns_covariance(
    problem: &PoleProblem,
    best: &SeparableFit,
    effective: f64,
) -> (Option<DMatrix<f64>>, f64) {
    let samples = problem.output[0].len();
    let outputs = problem.output.len();
    let (Some(basis), Some(sensitivities)) =
        (problem.basis(&best.theta), problem.sensitivities(&best.theta, &best.coefficients))
    else {
        return (None, f64::INFINITY);
    };
    // The linear unknowns of an output move that output alone.
    let width = sensitivities.len() + outputs * basis.columns.len() + 1;
    let rows = samples * outputs;
    let mut factor = TriangularFactor::new(width);
    let mut block: Vec<f64> = Vec::with_capacity(width * rows);
    block.extend(sensitivities.iter().flatten());
    for output in 0..outputs {
        for column in &basis.columns {
            block.resize(block.len() + output * samples, 0.0);
            block.extend(column);
            block.resize(block.len() + (outputs - 1 - output) * samples, 0.0);
        }
    }
    block.extend(&best.residual);
    factor.push(rows, &mut block);
    let Some(Solution { inverse_square, condition, .. }) = factor.solve(1, 0.0) else {
        return (None, f64::INFINITY);
    };
    let unknowns = inverse_square.nrows() as f64;
    let variance = dot(&best.residual, &best.residual) / (rows as f64 - unknowns).max(1.0);
    (Some(inverse_square * (variance * rows as f64 / effective)), condition)
}

/// Covariance of `describe(unknowns)` by central differences.
pub(crate) fn propagated(
    describe: &impl Fn(&[f64]) -> Vec<f64>,
    unknowns: &[f64],
    covariance: &DMatrix<f64>,
) -> DMatrix<f64> {
    let count = describe(unknowns).len();
    let mut jacobian = DMatrix::zeros(count, unknowns.len());
    for i in 0..unknowns.len() {
        let h = 1e-6 * unknowns[i].abs().max(1e-3);
        let moved = |sign: f64| {
            let mut x = unknowns.to_vec();
            x[i] += sign * h;
            describe(&x)
        };
        for (j, (up, down)) in moved(1.0).iter().zip(moved(-1.0)).enumerate() {
            jacobian[(j, i)] = (up - down) / (2.0 * h);
        }
    }
    &jacobian * covariance * jacobian.transpose()
}

/// `sum c_s p_s` of polynomials of one length.
fn combined(polynomials: &[Vec<f64>], c: &[f64]) -> Vec<f64> {
    let mut sum = vec![0.0; polynomials.first().map_or(0, Vec::len)];
    for (polynomial, c) in polynomials.iter().zip(c) {
        for (sum, p) in sum.iter_mut().zip(polynomial) {
            *sum += c * p;
        }
    }
    sum
}

/// A numerator of degree below `n` over a chain of order `n`, of an impulse: from scaled time to seconds.
fn in_seconds(polynomial: &[f64], n: usize, duration: f64) -> Vec<f64> {
    let length = polynomial.len();
    polynomial
        .iter()
        .enumerate()
        .map(|(index, b)| {
            let degree = i32::try_from(length - 1 - index).unwrap_or(0);
            // Time response: N(sT)/A(sT) of an impulse delta(t/T) = T delta(t).
            b * duration.powi(degree - i32::try_from(n).unwrap_or(0)) * duration
        })
        .collect()
}

/// The chain in 1/s from one in scaled time.
pub(crate) fn unscaled(chain: &SectionChain, duration: f64) -> SectionChain {
    SectionChain::new(
        chain
            .sections()
            .iter()
            .map(|section| match *section {
                Section::First(r) => Section::First(r / duration),
                Section::Second(p, q) => Section::Second(p / duration, q / duration / duration),
            })
            .collect(),
    )
}

/// State space of a chain in seconds from coefficients in scaled time.
fn cascade(
    chain: &SectionChain,
    forced: &[f64],
    duration: f64,
    gain: f64,
    direct: f64,
) -> Result<StateSpace, IdentifyError> {
    let n = chain.order();
    let powers = state_powers(chain);
    let b = DMatrix::from_fn(n, 1, |i, _| if i == chain.entry() { 1.0 } else { 0.0 });
    let c = DMatrix::from_fn(1, n, |_, s| forced[s] * duration.powi(powers[s]) * gain);
    Ok(StateSpace::new(chain.matrix(), b, c, DMatrix::from_element(1, 1, direct), None)?)
}

/// Power of the duration that belongs to every state: one of degree d in the numerator is `(sT)^d/(sT)^n`.
pub(crate) fn state_powers(chain: &SectionChain) -> Vec<i32> {
    let n = chain.order();
    let degree = |numerator: &Vec<f64>| n - 1 - numerator.iter().position(|x| *x != 0.0).unwrap_or(n - 1);
    let power = |degree: usize| i32::try_from(degree).unwrap_or(0) - i32::try_from(n).unwrap_or(0);
    chain.state_numerators().iter().map(|numerator| power(degree(numerator))).collect()
}
