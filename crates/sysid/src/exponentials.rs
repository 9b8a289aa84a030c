//! A record as a sum of exponentials: the free motion of a linear system.

use crumple_numerics::estimation::minimise::separable_covariance::{propagated, unknowns_covariance};
use crumple_numerics::estimation::minimise::variable_projection::{Separable, SeparableFit, minimize};
use crumple_numerics::estimation::minimise::{Stop, StopReason};
use crumple_numerics::estimation::random::uniform_at;
use crumple_numerics::estimation::statistics::autoregressive_effective_samples;
use crumple_numerics::lti::Complex;
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::era::era::era;
use crate::poles::cascade::{SectionChain, sections_of};
use crate::poles::pole_problem::{PoleProblem, scaled_poles};
use crate::poles::starts::random_poles;
use crate::poles::time_scale::unscaled;
use crate::{EraOptions, FitMeasures, Hold, IdentifyError, InformationCriteria, Order, fit_measures};

/// Starting points that are refined to the end, of all that were tried.
const REFINED: usize = 8;

/// Iterations after which starting points are compared: the loss at the start says little about where it leads.
const TRIAL_ITERATIONS: u32 = 4;

/// A fitted sum.
#[derive(Debug, Clone, PartialEq)]
pub struct ExponentialSumFit {
    /// Terms, conjugates side by side. Where exponents nearly coincide their amplitudes are huge and cancel.
    pub terms: Vec<ExponentialTerm>,
    /// The fitted curve.
    pub simulated: Vec<f64>,
    /// Its measures.
    pub fit: Option<FitMeasures>,
    /// Mean square error.
    pub loss: f64,
    /// Criteria with the effective number of samples.
    pub criteria: InformationCriteria,
    /// Standard deviations of natural frequency (rad/s) and damping ratio of every term; `None` where not determined.
    pub mode_deviations: Vec<Option<(f64, f64)>>,
    /// Covariance of what [`ExponentialSumFit::numbers`] lists, linearised and inflated for correlated residuals;
    /// `None` where exponents coincide or the sensitivities do not determine it.
    pub covariance: Option<DMatrix<f64>>,
    /// Condition number of the column-scaled sensitivities of all unknowns. Above 1e8 the curve is known but its terms
    /// are not.
    pub condition: f64,
    /// Iterations of the best start.
    pub iterations: u32,
    /// Evaluations of all starts.
    pub evaluations: u64,
    /// Why the best one stopped.
    pub stop_reason: StopReason,
    /// Whether one of its unknowns stands on a bound.
    pub on_bound: bool,
    /// Loss of every refined start, best first.
    pub losses: Vec<f64>,
}

/// Fits `sum C_i exp(s_i t)` to a record by least squares.
///
/// Starts from the matrix pencil (ERA of the thinned record), from exponents that coincide or nearly do on a grid of
/// decays of a tenth to fifty over the record, and from seeded random ones over that range and over all frequencies;
/// variable projection with exact sensitivities takes all a few iterations on and the best eight to the end. The
/// exponentials are taken as states of a cascade, so that coinciding exponents are ordinary points (`t exp(s t)` among
/// the states), and conditions at the start hold exactly.
///
/// Real exponentials of similar rates are nearly dependent: four of them follow a crash curve to a fraction of a
/// percent with terms that noise of a micrometre changes altogether. Believe [`ExponentialSumFit::condition`].
///
/// Golub & Pereyra, Inverse Problems 19, 2003; Hua & Sarkar, IEEE Trans. ASSP 38(5), 1990.
pub fn exponential_sum(
    record: &[f64],
    dt_s: f64,
    options: &ExponentialOptions,
) -> Result<ExponentialSumFit, IdentifyError> {
    let n = options.terms;
    let samples = record.len();
    let scale = check(record, dt_s, options)?;
    let duration = samples as f64 * dt_s;
    let problem = free_motion(record.iter().map(|y| y / scale).collect(), scale, duration, options);
    let dt = problem.dt();
    let candidates = starting_exponents(&problem.output[0], dt, duration, options);
    let starts = candidates.len();
    let (fits, evaluations) = refined(&problem, &candidates, options);
    let unit = scale * scale / samples as f64;
    let losses: Vec<f64> = fits.iter().map(|fit| fit.cost * unit).collect();
    let Some(best) = fits.into_iter().next() else {
        return Err(IdentifyError::NoStart { method: "exponentials", starts });
    };
    let simulated: Vec<f64> = record.iter().zip(&best.residual).map(|(y, e)| y - e * scale).collect();
    let effective = autoregressive_effective_samples(&best.residual);
    let c: Vec<f64> = best.coefficients.column(0).iter().copied().collect();
    let (covariance, condition) = unknowns_covariance(&problem, &best, effective);
    let terms_of = |unknowns: &[f64]| {
        let (theta, c) = unknowns.split_at(best.theta.len());
        terms(&problem.chain(theta), &problem.state_coefficients(theta, c).1, duration, scale)
    };
    let unknowns: Vec<f64> = best.theta.iter().chain(&c).copied().collect();
    let fitted_terms = terms_of(&unknowns);
    let parts = parts(&fitted_terms);
    // Frequency and damping of every term, then the numbers of the terms.
    let describe = |unknowns: &[f64]| -> Vec<f64> {
        let terms = terms_of(unknowns);
        let frequencies = terms.iter().map(|term| term.exponent.norm());
        let dampings = terms.iter().map(|term| -term.exponent.re / term.exponent.norm());
        frequencies.chain(dampings).chain(values(&parts, &terms)).collect()
    };
    let described = covariance.map(|covariance| propagated(&describe, &unknowns, &covariance));
    let mode_deviations = (0..n).map(|i| {
        let deviation = |k: usize| {
            let variance = described.as_ref()?[(k, k)];
            variance.is_finite().then(|| variance.max(0.0).sqrt())
        };
        deviation(i).zip(deviation(n + i))
    });
    let number_covariance =
        described.as_ref().map(|all| all.view((2 * n, 2 * n), (all.nrows() - 2 * n, all.nrows() - 2 * n)));
    Ok(ExponentialSumFit {
        mode_deviations: mode_deviations.collect(),
        covariance: number_covariance
            .filter(|part| part.iter().all(|x| x.is_finite()))
            .map(nalgebra::Matrix::into_owned),
        terms: fitted_terms,
        fit: fit_measures(record, &simulated),
        simulated,
        loss: best.cost * unit,
        criteria: InformationCriteria::new(best.cost * unit, effective, best.theta.len() + c.len()),
        condition,
        iterations: best.iterations,
        evaluations,
        stop_reason: best.stop,
        on_bound: best.on_bound.contains(&true),
        losses,
    })
}

impl ExponentialSumFit {
    /// Amplitudes and exponents, named by the terms from 1 on, conjugates once:
    /// `re_amplitude_1, im_amplitude_1, re_per_s_1, im_rad_per_s_1` of an oscillating term, without the imaginary parts
    /// of a real one.
    pub fn numbers(&self) -> Vec<(String, f64)> {
        let parts = parts(&self.terms);
        let name = |(term, part): &(usize, Part)| format!("{}_{}", part.name(), term + 1);
        parts.iter().map(name).zip(values(&parts, &self.terms)).collect()
    }
}

/// The search for exponents of a free motion: `scaled` is the record divided by `scale`, time in units of `duration_s`.
fn free_motion(scaled: Vec<f64>, scale: f64, duration_s: f64, options: &ExponentialOptions) -> PoleProblem {
    let n = options.terms;
    let layout =
        if options.real { vec![1; n] } else { (0..n / 2).map(|_| 2).chain((n % 2 == 1).then_some(1)).collect() };
    PoleProblem {
        inputs: Vec::new(),
        hold: Hold::First,
        output: vec![scaled],
        layout,
        numerator: 0,
        direct: false,
        free: true,
        start: options
            .start
            .iter()
            .enumerate()
            .map(|(d, x)| x / scale * duration_s.powi(i32::try_from(d).unwrap_or(0)))
            .collect(),
        stable: options.stable,
    }
}

/// All starts taken a few iterations on, the best of them to the end: fits, best first, and the evaluations of all.
fn refined(
    problem: &PoleProblem,
    candidates: &[Vec<Complex>],
    options: &ExponentialOptions,
) -> (Vec<SeparableFit>, u64) {
    let trial = Stop { max_iterations: TRIAL_ITERATIONS.min(options.stop.max_iterations), ..options.stop };
    let mut trials: Vec<SeparableFit> = candidates
        .par_iter()
        .filter_map(|poles| {
            let theta = problem.unknowns(&sections_of(poles, options.real))?;
            let bounds = problem.bounds();
            let theta: Vec<f64> = theta.iter().zip(bounds).map(|(x, (low, high))| x.clamp(low, high)).collect();
            minimize(problem, &theta, trial)
        })
        .collect();
    let tried = trials.iter().map(|fit| fit.evaluations).sum::<u64>();
    // Stable sort: equal losses keep the order of the starts.
    trials.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    trials.truncate(REFINED);
    let mut fits: Vec<SeparableFit> = trials
        .par_iter()
        .filter_map(|begun| {
            let rest = options.stop.max_iterations.saturating_sub(begun.iterations);
            let fit = minimize(problem, &begun.theta, Stop { max_iterations: rest, ..options.stop })?;
            Some(SeparableFit { iterations: begun.iterations + fit.iterations, ..fit })
        })
        .collect();
    fits.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let evaluations = tried + fits.iter().map(|fit| fit.evaluations).sum::<u64>();
    (fits, evaluations)
}

/// The record's root mean square. Errors: what cannot be fitted.
fn check(record: &[f64], dt_s: f64, options: &ExponentialOptions) -> Result<f64, IdentifyError> {
    let data = crate::IoData::new(Vec::new(), vec![record.to_vec()], dt_s)?;
    if options.terms == 0 {
        return Err(IdentifyError::OrderZero);
    }
    if options.start.len() > options.terms {
        return Err(IdentifyError::Conditions { conditions: options.start.len(), terms: options.terms });
    }
    let needed = 4 * options.terms;
    if record.len() < needed {
        return Err(IdentifyError::TooShort {
            method: "exponentials",
            samples: record.len(),
            needed,
            why: format!("four for each of {} terms", options.terms),
        });
    }
    if record.iter().all(|y| *y == 0.0) {
        return Err(IdentifyError::Silent("record"));
    }
    Ok(data.output_scales()[0])
}

// What a sum of exponentials is fitted with.

/// Settings of [`exponential_sum`](crate::exponential_sum()).
#[derive(Debug, Clone, PartialEq)]
pub struct ExponentialOptions {
    /// Number of terms; a damped wave counts as two.
    pub terms: usize,
    /// Whether every exponent is real.
    pub real: bool,
    /// Value and derivatives at the first sample that the sum must have, from the value on: for a crash from contact
    /// `[0, v0]`, for a compartment behind a crushing front `[0, v0, 0]`. At most as many as terms.
    pub start: Vec<f64>,
    /// Whether terms must not grow.
    pub stable: bool,
    /// Random starting points beside that of the matrix pencil.
    pub random_starts: usize,
    /// Exponents to start from, 1/s; where there are any, nothing else is tried but the random ones.
    pub given: Vec<Vec<Complex>>,
    /// When to stop.
    pub stop: Stop,
}

impl ExponentialOptions {
    /// Of so many terms: real or complex, not growing, free at the start, 20 random starts.
    pub fn new(terms: usize) -> Self {
        Self {
            terms,
            real: false,
            start: Vec::new(),
            stable: true,
            random_starts: 20,
            given: Vec::new(),
            stop: Stop::default(),
        }
    }
}

// Exponents that the fit of a sum of exponentials starts from.

/// Samples to which a record is thinned for the matrix pencil, at least.
const THINNED: usize = 250;

/// Slowest and fastest decay of a start for a slow curve, in units of one over the record.
const SLOWEST: f64 = 0.1;

const FASTEST_OF_SLOW: f64 = 50.0;

/// Decays on the grid of those starts.
const DECAYS: usize = 8;

/// Ratio of neighbouring decays of one start on the grid.
const SPREADS: [f64; 2] = [1.0, 1.4];

/// Exponents to start from, in units of one over `duration_s`: those given, else the matrix pencil's and slow ones; and
/// random ones. `scaled` is the record in units of its root mean square, `dt` its interval in those of the duration.
///
/// Each start has as many exponents as the sum has terms, pairs conjugate; real ones for a sum of real exponentials.
/// Smooth curves (a displacement) need the slow starts: there the matrix pencil sees little but rounding.
pub(crate) fn starting_exponents(
    scaled: &[f64],
    dt: f64,
    duration_s: f64,
    options: &ExponentialOptions,
) -> Vec<Vec<Complex>> {
    let n = options.terms;
    let mut candidates: Vec<Vec<Complex>> = if options.given.is_empty() {
        exponential_poles(scaled, dt, n).into_iter().collect()
    } else {
        options.given.iter().map(|poles| scaled_poles(poles, duration_s)).collect()
    };
    candidates.extend((0..options.random_starts).map(|k| random_poles(k, n, 0.2 * std::f64::consts::PI / dt)));
    if options.given.is_empty() {
        candidates.extend(slow_starts(n, options));
    }
    if options.real {
        for poles in &mut candidates {
            for s in poles.iter_mut() {
                // The imaginary part spreads a pair.
                *s = Complex::new(s.re - s.im.abs() * if s.im > 0.0 { 0.5 } else { 0.25 }, 0.0);
            }
        }
    }
    candidates
}

/// Poles of the thinned signal taken for a free motion: ERA, which is the matrix pencil with a filtered rank.
/// `None` where ERA has no model of that order, or one with a pole at the Nyquist frequency.
fn exponential_poles(signal: &[f64], dt: f64, count: usize) -> Option<Vec<Complex>> {
    let every = (signal.len() / THINNED).max(1);
    let thin: Vec<f64> = signal.iter().step_by(every).copied().collect();
    let dt = dt * every as f64;
    let model = era(&thin, EraOptions { order: Order::Given(count), ..EraOptions::new(dt) }).ok()?;
    let poles: Vec<Complex> = model.modes.iter().filter_map(|m| m.mode.map(|mode| mode.pole)).collect();
    // A negative real z has a pole at the Nyquist frequency without partner.
    (poles.len() == count && poles.iter().all(|s| s.im.abs() < 0.99 * std::f64::consts::PI / dt)).then_some(poles)
}

/// Exponents for curves that are slow against the sampling, in scaled time: around one decay each, and, where random
/// starts are asked for, as many that are spread evenly in the logarithm.
fn slow_starts(terms: usize, options: &ExponentialOptions) -> Vec<Vec<Complex>> {
    let decay = |share: f64| SLOWEST * (FASTEST_OF_SLOW / SLOWEST).powf(share);
    let middle = (terms as f64 - 1.0) / 2.0;
    let mut starts: Vec<Vec<Complex>> = SPREADS
        .iter()
        .flat_map(|spread| (0..DECAYS).map(move |d| (spread, decay((d as f64 + 0.5) / DECAYS as f64))))
        .map(|(spread, r)| (0..terms).map(|i| Complex::new(-r * spread.powf(i as f64 - middle), 0.0)).collect())
        .collect();
    starts.extend((0..options.random_starts).map(|k| {
        // Streams of their own.
        let stream = 1000 + k;
        if options.real {
            (0..terms).map(|i| Complex::new(-decay(uniform_at(stream, i)), 0.0)).collect()
        } else {
            random_poles(stream, terms, FASTEST_OF_SLOW)
        }
    }));
    starts
}

// The terms of a sum of exponentials, and the numbers they are made of.

/// `amplitude exp(exponent t)`, t from the first sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExponentialTerm {
    /// Amplitude, unit of the record.
    pub amplitude: Complex,
    /// Exponent, 1/s and rad/s.
    pub exponent: Complex,
}

/// Residues of the free motion at its poles.
///
/// `free` are coefficients of the chain's states, one each, in scaled time and units; `scale` takes the unit back
/// out. The residue at a simple pole `s_i` is `N(s_i)/prod_(j != i)(s_i - s_j)`: it grows without bound as poles
/// meet, where two large terms cancel. Exponents come in 1/s.
pub(crate) fn terms(chain: &SectionChain, free: &[f64], duration: f64, scale: f64) -> Vec<ExponentialTerm> {
    let numerators = chain.state_numerators();
    let poles = chain.poles();
    let seconds = unscaled(chain, duration).poles();
    poles
        .iter()
        .enumerate()
        .map(|(i, s)| {
            let numerator: Complex = numerators
                .iter()
                .zip(free)
                .map(|(p, c)| p.iter().fold(Complex::new(0.0, 0.0), |sum, p| sum * s + p) * *c)
                .sum();
            let slope: Complex = poles
                .iter()
                .enumerate()
                .filter(|(j, _)| *j != i)
                .map(|(_, other)| s - other)
                .fold(Complex::new(1.0, 0.0), |product, difference| product * difference);
            ExponentialTerm { amplitude: numerator / slope * scale, exponent: seconds[i] }
        })
        .collect()
}

/// One number of a term.
/// A real amplitude or exponent has no imaginary part to vary.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Part {
    ReAmplitude,
    ImAmplitude,
    RePerS,
    ImRadPerS,
}

impl Part {
    /// Name in records, to which the number of the term is added.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::ReAmplitude => "re_amplitude",
            Self::ImAmplitude => "im_amplitude",
            Self::RePerS => "re_per_s",
            Self::ImRadPerS => "im_rad_per_s",
        }
    }

    fn value_in(self, term: &ExponentialTerm) -> f64 {
        match self {
            Self::ReAmplitude => term.amplitude.re,
            Self::ImAmplitude => term.amplitude.im,
            Self::RePerS => term.exponent.re,
            Self::ImRadPerS => term.exponent.im,
        }
    }
}

/// The numbers that terms of their kind have, conjugates once.
pub(crate) fn parts(terms: &[ExponentialTerm]) -> Vec<(usize, Part)> {
    let parts_of = |exponent: Complex| match exponent.im {
        0.0 => &[Part::ReAmplitude, Part::RePerS][..],
        im if im > 0.0 => &[Part::ReAmplitude, Part::ImAmplitude, Part::RePerS, Part::ImRadPerS][..],
        _ => &[],
    };
    terms.iter().enumerate().flat_map(|(i, term)| parts_of(term.exponent).iter().map(move |part| (i, *part))).collect()
}

/// Their values, in this order.
pub(crate) fn values(parts: &[(usize, Part)], terms: &[ExponentialTerm]) -> Vec<f64> {
    parts.iter().map(|(term, part)| part.value_in(&terms[*term])).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::RandomNumbers;

    fn sum(terms: &[(f64, f64)], dt: f64, samples: usize) -> Vec<f64> {
        (0..samples).map(|k| terms.iter().map(|(c, s)| c * (s * k as f64 * dt).exp()).sum()).collect()
    }

    #[test]
    fn maxwell_terms_come_back_with_and_without_conditions() {
        // x = C1 + e^(-33 t)(...): a constant and a damped wave, x(0) = 0, x'(0) = v0, x''(0) = 0.
        let (a, b, v0) = (-33.0, 39.0, 9.7);
        // Solve for the three real amplitudes by hand: C + A = 0, a A + b B = v0, (a² - b²) A + 2 a b B = 0.
        let big_a = 2.0 * a * v0 / (a * a + b * b);
        let big_b = (v0 - a * big_a) / b;
        let record: Vec<f64> = (0..300)
            .map(|k| {
                let t = f64::from(k) * 5e-4;
                -big_a + (a * t).exp() * (big_a * (b * t).cos() + big_b * (b * t).sin())
            })
            .collect();
        for start in [vec![], vec![0.0], vec![0.0, v0], vec![0.0, v0, 0.0]] {
            let options = ExponentialOptions { start: start.clone(), ..ExponentialOptions::new(3) };
            let fit = exponential_sum(&record, 5e-4, &options).unwrap();
            let wave = fit.terms.iter().find(|t| t.exponent.im > 0.0).unwrap();
            // A clean record: rounding times a condition of 1e4.
            assert!((wave.exponent - Complex::new(a, b)).norm() < 1e-6, "{start:?}: {:?}", fit.terms);
            assert!((wave.amplitude - Complex::new(big_a, -big_b) / 2.0).norm() < 1e-7, "{:?}", fit.terms);
            let value: Complex = fit.terms.iter().map(|t| t.amplitude).sum();
            let slope: Complex = fit.terms.iter().map(|t| t.amplitude * t.exponent).sum();
            if start.len() > 1 {
                // Exact by construction, but for the cancellation among the terms.
                assert!(value.norm() < 1e-12 && (slope.re - v0).abs() < 1e-10, "{value} {slope}");
            }
        }
    }

    #[test]
    fn four_real_terms_of_the_crash_paper_are_a_curve_not_four_numbers() {
        // The first paper's fit.
        let exact = [(-253.6, -7.754), (83.75, -6.238), (333.0, -9.603), (-163.2, -10.87)];
        let mut record = sum(&exact, 1e-3, 200);
        let first = record[0];
        record.iter_mut().for_each(|x| *x -= first);
        let options = ExponentialOptions { real: true, ..ExponentialOptions::new(4) };
        let fit = exponential_sum(&record, 1e-3, &options).unwrap();
        assert!(fit.fit.unwrap().rmse < 1e-6, "{:?}", fit.fit);
        assert!(fit.condition > 1e8, "{}", fit.condition);
        assert!(fit.terms.iter().all(|t| t.exponent.im == 0.0 && t.exponent.re <= 0.0));
    }

    #[test]
    fn a_slow_curve_in_noise_is_fitted_no_worse_than_by_its_own_exponents() {
        let exact = [(-253.6, -7.754), (83.75, -6.238), (333.0, -9.603), (-163.2, -10.87)];
        let clean = sum(&exact, 1e-4, 2001);
        let options = ExponentialOptions { real: true, ..ExponentialOptions::new(4) };
        for seed in 0..10 {
            for deviation in [1e-4, 1e-3] {
                let mut random = RandomNumbers::of_stream(1, seed);
                let record: Vec<f64> = clean.iter().map(|x| x + deviation * random.normal()).collect();
                let given = vec![exact.iter().map(|(_, s)| Complex::new(*s, 0.0)).collect()];
                let still = Stop { max_iterations: 0, ..Stop::default() };
                let own = ExponentialOptions { given, random_starts: 0, stop: still, ..options.clone() };
                let own = exponential_sum(&record, 1e-4, &own).unwrap();
                let fit = exponential_sum(&record, 1e-4, &options).unwrap();
                // Rounding of the loss.
                assert!(fit.loss <= own.loss * (1.0 + 1e-9), "{seed} {deviation}: {} {}", fit.loss, own.loss);
            }
        }
    }

    #[test]
    fn a_half_sine_is_followed_by_coalescing_exponents() {
        // Part of the half wave and all of it: what four exponents that coincide reach, at -3.80/s and -4.97/s (scan of
        // t^i exp(-r t), i = 0 to 3, by orthogonalisation).
        for (samples, reached) in [(2001, 99.6665), (2601, 98.780)] {
            let record: Vec<f64> = (0..samples).map(|k| (std::f64::consts::PI * f64::from(k) / 2600.0).sin()).collect();
            let options = ExponentialOptions { real: true, ..ExponentialOptions::new(4) };
            let fit = exponential_sum(&record, 1e-4, &options).unwrap();
            assert!(fit.fit.unwrap().fit_percent.unwrap() > reached, "{:?} {:?}", fit.fit, fit.terms);
        }
    }

    #[test]
    fn coinciding_exponents_are_no_obstacle() {
        let record: Vec<f64> = (0..200).map(|k| f64::from(k) * 1e-3 * (-20.0 * f64::from(k) * 1e-3).exp()).collect();
        let fit = exponential_sum(&record, 1e-3, &ExponentialOptions::new(2)).unwrap();
        // A double exponent is known to the root of the rounding unit; the curve to rounding.
        assert!(fit.fit.unwrap().rmse < 1e-12, "{:?}", fit.fit);
        assert!(fit.terms.iter().all(|t| (t.exponent + 20.0).norm() < 1e-3), "{:?}", fit.terms);
    }

    #[test]
    fn refuses_more_conditions_than_terms() {
        let options = ExponentialOptions { start: vec![0.0, 1.0], ..ExponentialOptions::new(1) };
        assert!(exponential_sum(&[1.0; 50], 1e-3, &options).is_err());
        assert!(exponential_sum(&[0.0; 50], 1e-3, &ExponentialOptions::new(2)).is_err());
    }
}
