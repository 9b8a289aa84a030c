//! The search for the poles of transfer functions from many starts.
//!
//! Three stages: all starts are scored by one evaluation each, the best few (not too many of a kind) are refined by
//! Levenberg-Marquardt with variable projection, and the least loss wins. Everything runs in scaled units: time 0 to
//! 1, signals divided by their root mean squares. Results are collected by index, so that threads do not matter.

use crumple_numerics::estimation::minimise::variable_projection::{Separable, SeparableFit, evaluate, minimize};
use crumple_numerics::estimation::statistics::chi_square_95;
use crumple_numerics::lti::Complex;
use rayon::prelude::*;

use crate::poles::cascade::sections_of;
use crate::poles::options::{InitialConditions, TransferFunctionOptions};
use crate::poles::pole_problem::{PoleProblem, scaled_poles};
use crate::poles::starts::{Start, StartProblem};
use crate::poles::time_scale::combined;
use crate::{IdentifyError, IoData};

/// Starting points that are refined, of all that were tried.
const REFINED: usize = 14;

/// Of these at most so many of one kind, so that one kind of start cannot crowd out the others.
const REFINED_OF_A_KIND: usize = 4;

/// The search with or without an initial motion, as the options say.
///
/// With [`InitialConditions::Auto`] both are run, and the free motion stays if it lowers the loss by more than
/// chance: the gain `(L0 - L1)/L1` times the degrees of freedom against the 95 % point of chi-squared with as many
/// degrees as numbers were added (the F-test for many samples).
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

/// Errors: no pole, more zeros than poles, no input, fewer samples than twice the unknowns of one output (beyond the
/// delay), a silent signal.
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
            let starting_poles = pairs.iter().flat_map(|pair| pair.poles_by(*start, options.random_starts));
            starting_poles.map(|poles| (*start, poles)).collect::<Vec<_>>()
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
            // So few that all are refined need no ranking.
            let cost = if tried <= REFINED_OF_A_KIND { 0.0 } else { evaluate(&problem, &theta)?.cost };
            Some((cost, start, theta))
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
    let evaluations = tried as u64 + fits.iter().map(|(_, fit)| fit.evaluations).sum::<u64>();
    // In units of the output if there is one, else the mean over outputs divided by their root mean squares.
    let unit = if let [scale] = output_scales[..] { scale * scale } else { 1.0 / output_scales.len() as f64 };
    let losses = fits.iter().map(|(_, fit)| fit.cost * unit / data.samples() as f64).collect();
    match fits.into_iter().next() {
        Some((start, best)) => Ok(Search { problem, best, start, evaluations, losses, input_scales, output_scales }),
        None => Err(IdentifyError::NoStart { method: "tfest", starts: tried }),
    }
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
