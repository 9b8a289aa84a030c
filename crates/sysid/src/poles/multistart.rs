//! The search for the poles of transfer functions from many starts.
//!
//! Three stages: all starts are scored by one evaluation each, the best few (not too many of a kind) are refined by
//! Levenberg-Marquardt with variable projection, and the least loss wins. A long record is searched on a stretch of it
//! first. Everything runs in scaled units: time 0 to 1, signals divided by their root mean squares. Results are
//! collected by index, so that threads do not matter.

use crumple_numerics::estimation::minimise::Stop;
use crumple_numerics::estimation::minimise::variable_projection::{Separable, SeparableFit, evaluate, minimize};
use crumple_numerics::estimation::statistics::{autoregressive_effective_samples, chi_square_95};
use crumple_numerics::linalg::dot;
use crumple_numerics::lti::Complex;
use rayon::prelude::*;

use crate::poles::cascade::sections_of;
use crate::poles::options::{InitialConditions, TransferFunctionOptions};
use crate::poles::pole_problem::{PoleProblem, scaled_poles};
use crate::poles::starts::{MOST_CONTINUOUS, Start, StartProblem, poles_of_all};
use crate::poles::stretches::stretches;
use crate::poles::time_scale::{combined, unscaled};
use crate::{IdentifyError, IoData};

/// Starting points that are refined, of all that were tried.
const REFINED: usize = 14;

/// The same for orders above [`MOST_CONTINUOUS`], where a step costs the square of the order, and without random
/// starts.
const FEW_REFINED: usize = 6;

/// Of these at most so many of one kind, so that one kind of start cannot crowd out the others.
const REFINED_OF_A_KIND: usize = 4;

/// A record of more samples is searched on stretches of this length, at the full rate.
const STRETCH: usize = 20_000;

/// Starting points that are refined on a stretch: it is there to find the valley.
const REFINED_ON_STRETCH: usize = 4;

/// Steps over all samples from where a stretch leads.
const STEPS_OVER_ALL: u32 = 12;

/// Rise of the loss from a stretch to the whole record that the next stretch is not asked for.
const RISE: f64 = 1.05;

/// The search with or without an initial motion, as the options say, for the method of this name.
///
/// With [`InitialConditions::Auto`] both are run, and the free motion stays if it lowers the loss by more than
/// chance: the gain `(L0 - L1)/L1` times the degrees of freedom against the 95 % point of chi-squared with as many
/// degrees as numbers were added (the F-test for many samples).
///
/// With more outputs than inputs the free motions of all outputs, as many numbers each as there are poles, are more
/// than the state of one model: they can take the place of what a short impact drives, and leave numerators that mean
/// nothing. Then rest is tried too, from the poles found, and the smaller BIC decides.
pub(crate) fn best_search(
    method: &'static str,
    data: &IoData,
    options: &TransferFunctionOptions,
) -> Result<Search, IdentifyError> {
    check(method, data, options)?;
    let (inputs, outputs) = (data.inputs().len() as f64, data.outputs().len() as f64);
    let (n, samples) = (options.poles as f64, data.samples() as f64);
    match options.initial {
        InitialConditions::Zero => search(method, data, options, false),
        InitialConditions::Estimate if outputs > inputs => {
            let moving = search(method, data, options, true)?;
            let duration_s = samples * data.sample_time_s();
            let poles = unscaled(&moving.problem.chain(&moving.best.theta), duration_s).poles();
            let given = TransferFunctionOptions { starts: Vec::new(), given: vec![poles], ..options.clone() };
            let Ok(rest) = search(method, data, &given, false) else { return Ok(moving) };
            let residuals = rest.best.residual.chunks_exact(data.samples());
            let effective: f64 = residuals.map(autoregressive_effective_samples).sum();
            let gain = effective * (rest.best.cost / moving.best.cost.max(f64::MIN_POSITIVE)).ln();
            Ok(if gain > n * outputs * effective.max(1.0).ln() {
                moving
            } else {
                Search { start: moving.start, ..rest }
            })
        }
        InitialConditions::Estimate => search(method, data, options, true),
        InitialConditions::Auto => {
            let (rest, moving) = (search(method, data, options, false)?, search(method, data, options, true)?);
            let numerators = outputs * inputs * (options.zeros as f64 + 1.0);
            let gain = (rest.best.cost - moving.best.cost) / moving.best.cost.max(f64::MIN_POSITIVE);
            let added = n * outputs;
            let free = samples * outputs - n - numerators - added;
            let estimate = gain * free.max(1.0) > chi_square_95(added);
            Ok(if estimate { moving } else { rest })
        }
    }
}

/// Errors: no pole, more zeros than poles, no input, fewer samples than twice the unknowns of one output (beyond the
/// delay), a silent signal.
fn check(method: &'static str, data: &IoData, options: &TransferFunctionOptions) -> Result<(), IdentifyError> {
    let (poles, zeros) = (options.poles, options.zeros);
    if poles == 0 {
        return Err(IdentifyError::OrderZero);
    }
    if zeros > poles {
        return Err(IdentifyError::NotProper { zeros, poles });
    }
    if data.inputs().is_empty() {
        return Err(IdentifyError::Channels {
            method,
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
            method,
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
    /// The problem that was solved, with its scaled signals.
    pub(crate) problem: PoleProblem,
    /// Unknowns, coefficients and residual of the least loss.
    pub(crate) best: SeparableFit,
    /// Where the best one started.
    pub(crate) start: Start,
    /// Evaluations of all starts, of scoring and refining.
    pub(crate) evaluations: u64,
    /// Mean square errors of all refined starts, best first; units as in `SearchOutcome`.
    pub(crate) losses: Vec<f64>,
    /// What inputs and outputs were divided by.
    pub(crate) input_scales: Vec<f64>,
    pub(crate) output_scales: Vec<f64>,
}

/// The search with a free motion or without.
///
/// Errors: none of the starts gave a finite response.
fn search(
    method: &'static str,
    data: &IoData,
    options: &TransferFunctionOptions,
    free: bool,
) -> Result<Search, IdentifyError> {
    let (problem, input_scales, output_scales) = problem(data, options, free);
    let searched = if data.samples() > STRETCH && !options.starts.is_empty() {
        by_stretches(method, data, &problem, options)?
    } else {
        let few = options.poles > MOST_CONTINUOUS || options.random_starts == 0;
        let most = if few { FEW_REFINED } else { REFINED };
        let candidates = candidates(&problem, options, data.samples() as f64 * data.sample_time_s());
        refined(&problem, candidates, options, most)
    };
    let Searched { fits, evaluations, starts } = searched;
    // In units of the output if there is one, else the mean over outputs divided by their root mean squares.
    let unit = if let [scale] = output_scales[..] { scale * scale } else { 1.0 / output_scales.len() as f64 };
    let losses = fits.iter().map(|(_, fit)| fit.cost * unit / data.samples() as f64).collect();
    match fits.into_iter().next() {
        Some((start, best)) => Ok(Search { problem, best, start, evaluations, losses, input_scales, output_scales }),
        None => Err(IdentifyError::NoStart { method, starts }),
    }
}

/// Refined starts, best first.
struct Searched {
    fits: Vec<(Start, SeparableFit)>,
    /// Evaluations of all starts, of scoring and refining.
    evaluations: u64,
    /// Starts that were tried.
    starts: usize,
}

/// The record in scaled units, and what inputs and outputs were divided by.
fn problem(data: &IoData, options: &TransferFunctionOptions, free: bool) -> (PoleProblem, Vec<f64>, Vec<f64>) {
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
    (problem, input_scales, output_scales)
}

/// Starting poles of every kind asked for, in scaled time.
fn candidates(problem: &PoleProblem, options: &TransferFunctionOptions, duration: f64) -> Vec<(Start, Vec<Complex>)> {
    let n = options.poles;
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
            free: problem.free,
        })
        .collect();
    let together = IoData::new(problem.inputs.clone(), problem.output.clone(), problem.dt());
    let mut candidates: Vec<(Start, Vec<Complex>)> = options
        .starts
        .par_iter()
        .map(|start| {
            // Those of poles that no record enters are the same for every pair.
            let alike = matches!(start, Start::Random | Start::Integrators);
            let pairs = if alike { &pairs[..1] } else { &pairs[..] };
            let of_pairs = pairs.iter().flat_map(|pair| pair.poles_by(*start, options.random_starts));
            let of_all = together.iter().flat_map(|data| poles_of_all(*start, data, n, problem.direct));
            of_pairs.chain(of_all).map(|poles| (*start, poles)).collect::<Vec<_>>()
        })
        .collect::<Vec<_>>()
        .concat();
    candidates.extend(options.given.iter().map(|poles| (Start::Given, scaled_poles(poles, duration))));
    candidates
}

/// Scores all candidates and refines the best `most`.
fn refined(
    problem: &PoleProblem,
    candidates: Vec<(Start, Vec<Complex>)>,
    options: &TransferFunctionOptions,
    most: usize,
) -> Searched {
    let starts = candidates.len();
    let mut scored: Vec<(f64, Start, Vec<f64>)> = candidates
        .into_par_iter()
        .filter_map(|(start, poles)| {
            let theta = within_bounds(problem, problem.unknowns(&sections_of(&poles, false))?);
            // So few that all are refined need no ranking.
            let cost = if starts <= REFINED_OF_A_KIND { 0.0 } else { evaluate(problem, &theta)?.cost };
            Some((cost, start, theta))
        })
        .collect();
    scored.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut chosen: Vec<(Start, Vec<f64>)> = Vec::new();
    for (_, start, theta) in scored {
        let alike = chosen.iter().filter(|(other, _)| *other == start).count();
        if chosen.len() < most && alike < REFINED_OF_A_KIND {
            chosen.push((start, theta));
        }
    }
    let mut fits: Vec<(Start, SeparableFit)> = chosen
        .par_iter()
        .filter_map(|(start, theta)| Some((*start, minimize(problem, theta, options.stop)?)))
        .collect();
    fits.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    let evaluations = starts as u64 + fits.iter().map(|(_, fit)| fit.evaluations).sum::<u64>();
    Searched { fits, evaluations, starts }
}

fn within_bounds(problem: &PoleProblem, mut theta: Vec<f64>) -> Vec<f64> {
    theta.iter_mut().zip(problem.bounds()).for_each(|(x, (low, high))| *x = x.clamp(low, high));
    theta
}

/// The search of a long record: that of a stretch at the full rate, then some steps over all samples from where it
/// leads. The next stretch is asked for only where the loss of the whole is higher than that of the stretch by more
/// than [`RISE`]: a stretch that shows too little, or a slow mode that needs the whole record, thinned.
fn by_stretches(
    method: &'static str,
    data: &IoData,
    problem: &PoleProblem,
    options: &TransferFunctionOptions,
) -> Result<Searched, IdentifyError> {
    let late = data.delayed(options.delay);
    let here = TransferFunctionOptions { delay: 0, ..options.clone() };
    let stop = Stop { max_iterations: STEPS_OVER_ALL.min(options.stop.max_iterations), ..options.stop };
    let duration_s = |data: &IoData| data.samples() as f64 * data.sample_time_s();
    let mut searched = Searched { fits: Vec::new(), evaluations: 0, starts: 0 };
    for (first, stretch) in stretches(&late, STRETCH)? {
        check(method, &stretch, &here)?;
        // Only what starts with the record can start from rest.
        let (part, _, scales) = self::problem(&stretch, &here, problem.free || first > 0);
        let found = refined(&part, candidates(&part, &here, duration_s(&stretch)), &here, REFINED_ON_STRETCH);
        searched.evaluations += found.evaluations;
        searched.starts += found.starts;
        let Some((start, of_stretch)) = found.fits.into_iter().next() else { continue };
        let chain = unscaled(&part.chain(&of_stretch.theta), duration_s(&stretch) / duration_s(data));
        let Some(theta) = problem.unknowns(chain.sections()) else { continue };
        let Some(of_all) = minimize(problem, &within_bounds(problem, theta), stop) else { continue };
        searched.evaluations += of_all.evaluations;
        // Mean squares of both in the units of the whole.
        let unit = |k: usize| (scales[k] / data.output_scales()[k]).powi(2);
        let parts = of_stretch.residual.chunks_exact(stretch.samples()).zip(0..);
        let before = parts.map(|(e, k)| dot(e, e) * unit(k)).sum::<f64>() / stretch.samples() as f64;
        let good = of_all.cost / data.samples() as f64 <= RISE * before;
        let of_all = SeparableFit { iterations: of_stretch.iterations + of_all.iterations, ..of_all };
        searched.fits.push((start, of_all));
        if good {
            break;
        }
    }
    searched.fits.sort_by(|a, b| a.1.cost.total_cmp(&b.1.cost));
    Ok(searched)
}

impl Search {
    /// Numerator of one input for the output of `c`, in 1/s, signals scaled, `zeros + 1` coefficients, highest power
    /// first.
    ///
    /// The sum of the states' numerators, weighed by the coefficients `c` of one output, plus the direct term times
    /// the denominator; the coefficient of `(sT)^j` is divided by `T^(n-j)`. Gains of the signal scales are left to
    /// the caller.
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
