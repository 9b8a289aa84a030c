//! Sums of exponentials fitted to a record.

use crumple_estimation::minimise::separable_covariance::{propagated, unknowns_covariance};
use crumple_estimation::minimise::variable_projection::{Separable, SeparableFit, minimize};
use crumple_estimation::minimise::{Stop, StopReason};
use crumple_estimation::statistics::autoregressive_effective_samples;
use crumple_lti::Complex;
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::exponentials::options::ExponentialOptions;
use crate::exponentials::starts::starting_exponents;
use crate::exponentials::terms::{ExponentialTerm, Part, parts, terms, values};
use crate::poles::cascade::sections_of;
use crate::poles::pole_problem::PoleProblem;
use crate::{FitMeasures, Hold, IdentifyError, InformationCriteria, fit_measures};

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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_estimation::random::RandomNumbers;

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
