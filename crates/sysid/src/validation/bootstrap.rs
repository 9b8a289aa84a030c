//! Uncertainty of a model: the estimator is run again on records with new noise.
//!
//! New records come from the noise model of the measured one. What the replicates do is known against the system that
//! they were drawn from, so that an estimator's bias shows; the interval stands about the estimate itself. Percentiles
//! of the replicates would leave the estimate out where the estimator has a bias (Efron & Tibshirani, *An Introduction
//! to the Bootstrap*, 1993, ch. 10 and 13).

use std::f64::consts::TAU;

use crumple_numerics::estimation::statistics::{quantile, standard_deviation};
use crumple_numerics::lti::{Complex, Mode};
use rayon::prelude::*;

use crate::NoiseModel;

/// Standard deviations from the middle to the ends of a nominal 90 % interval, and of a 95 % one.
const NORMAL: [f64; 2] = [1.644_853_626_951_472_2, 1.959_963_984_540_054];

/// Share of the replicates that must have led to a model, or to a mode, for a result to be given.
const LEAST_SUCCESS: f64 = 0.5;

/// Scaled median absolute deviations beyond which a replicate has found something else.
const FAR: f64 = 5.0;

/// The median absolute deviation of normal values times this is their standard deviation.
const SCALED: f64 = 1.4826;

/// A frequency that varies by more is not determined.
const LARGEST_VARIATION: f64 = 0.2;

/// A driven mode that decays over fewer time constants than these has no interval.
const TIME_CONSTANTS: f64 = 2.0;

/// A free motion of as few time constants has one from so many periods on: a sine below half a period is an arc, whose
/// curvature frequency and damping share. Measured at damping 0.2: of nominal 90 %, 90 % hold at 0.6 periods, and half
/// at 0.4 periods in noise of a fifth of the peak.
const PERIODS: f64 = 0.5;

/// Weight of the damping ratio beside the logarithm of the frequency, where poles are matched.
const DAMPING_WEIGHT: f64 = 0.2;

/// How long a record is, s, and what moves it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RecordLength {
    /// An input.
    Driven(f64),
    /// Its start alone: the samples are a free motion. Its pulse stands high above the noise before it has decayed, so
    /// that a record of one time constant, as a crash pulse is, shows frequency and damping.
    Free(f64),
}

impl RecordLength {
    /// Whether a mode of this pole has too little of the record for an interval. Of a free motion two time constants
    /// are enough too: a pole without a period, or close to it, has nothing else.
    fn is_short_for(self, pole: Complex) -> bool {
        let decays = |duration_s: f64| pole.re.abs() * duration_s >= TIME_CONSTANTS;
        match self {
            Self::Driven(duration_s) => !decays(duration_s),
            Self::Free(duration_s) => !decays(duration_s) && pole.norm() * duration_s < TAU * PERIODS,
        }
    }
}

/// Settings of [`bootstrap`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BootstrapOptions {
    /// Number of replicates; 60 suffice.
    pub replicates: usize,
    /// Replicate `i` draws from stream `i` of this seed.
    pub seed: u64,
}

/// What is compared between models.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sample {
    /// Continuous poles, 1/s.
    pub poles: Vec<Complex>,
    /// Zeros, 1/s; empty where the method has none.
    pub zeros: Vec<Complex>,
    /// Frequency response on a grid of the caller's; empty where there is no input.
    pub response: Vec<Complex>,
}

/// Spread of one number over the replicates, and its nominal 90 % interval about the estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Standard deviation.
    pub deviation: f64,
    /// Mean of the replicates less the number that they were drawn from.
    pub bias: f64,
    /// `estimate - 1.645 sqrt(deviation² + bias²)`.
    pub lower: f64,
    /// The same above.
    pub upper: f64,
}

impl Spread {
    /// Of replicates drawn from a system with the number `centre`; `None` for fewer than two.
    pub fn about(estimate: f64, centre: f64, replicates: &[f64]) -> Option<Self> {
        let deviation = standard_deviation(replicates)?;
        let bias = replicates.iter().sum::<f64>() / replicates.len() as f64 - centre;
        let reach = NORMAL[0] * deviation.hypot(bias);
        let spread = Self { deviation, bias, lower: estimate - reach, upper: estimate + reach };
        reach.is_finite().then_some(spread)
    }

    /// The nominal 95 % interval about the estimate that this one stands about.
    pub fn interval_95(&self) -> (f64, f64) {
        let (middle, reach) = (0.5 * (self.lower + self.upper), NORMAL[1] * self.deviation.hypot(self.bias));
        (middle - reach, middle + reach)
    }

    /// Whether the estimator is off by more than it varies in noise like this.
    pub fn is_biased(&self) -> bool {
        self.bias.abs() > self.deviation
    }
}

/// Spread of a frequency response at one frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandPoint {
    /// Modulus, below and above.
    pub magnitude: (f64, f64),
    /// Phase relative to that of the model, below and above, rad.
    pub phase_change_rad: (f64, f64),
}

/// Why a mode has no interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoSpread {
    /// Most replicates do not find it again.
    NotFoundAgain,
    /// Its frequency varies by more than 20 %.
    NotDetermined,
    /// The record is shorter than two of its time constants, and of a free motion than half of its period too.
    ShortRecord,
}

/// What the replicates say.
#[derive(Debug, Clone, PartialEq)]
pub struct Bootstrap {
    /// Replicates that led to a model.
    pub replicates: usize,
    /// Those that did not.
    pub failed: usize,
    /// Natural frequency, rad/s, and damping ratio of every pole in the order of the model, or why there is none.
    pub modes: Vec<Result<(Spread, Spread), NoSpread>>,
    /// Real part of every zero.
    pub zero_re: Vec<Option<Spread>>,
    /// Imaginary part of every zero.
    pub zero_im: Vec<Option<Spread>>,
    /// Frequency response on the caller's grid.
    pub band: Vec<Option<BandPoint>>,
}

/// Runs the estimator again on records that the noise model draws.
///
/// `estimate` is what it made of the measured record, `drawn_from` the system of the noise model in the same terms.
/// `refit` gets new outputs and returns what the estimator makes of them; `None` is a failure that is counted.
/// Replicates run in parallel and are collected by index. Poles belong to the nearest of `drawn_from`, each once, by
/// the logarithm of the frequency and the damping ratio. `None`: fewer than half of the replicates led to a model.
pub fn bootstrap(
    (estimate, drawn_from): (&Sample, &Sample),
    noise: &NoiseModel,
    length: RecordLength,
    options: BootstrapOptions,
    refit: impl Fn(&[Vec<f64>]) -> Option<Sample> + Sync,
) -> Option<Bootstrap> {
    let samples: Vec<Option<Sample>> =
        (0..options.replicates).into_par_iter().map(|index| refit(&noise.replicate(options.seed, index))).collect();
    let samples: Vec<Sample> = samples.into_iter().flatten().collect();
    if samples.len() < 2 || (samples.len() as f64) < LEAST_SUCCESS * options.replicates as f64 {
        return None;
    }
    Some(Bootstrap {
        replicates: samples.len(),
        failed: options.replicates - samples.len(),
        modes: mode_spreads(&estimate.poles, &drawn_from.poles, &samples, length),
        zero_re: zero_spreads((estimate, drawn_from), &samples, |z| z.re),
        zero_im: zero_spreads((estimate, drawn_from), &samples, |z| z.im),
        band: (0..estimate.response.len()).map(|k| band_point((estimate, drawn_from), &samples, k)).collect(),
    })
}

/// Of every pole of the estimate: the pole that it stands for in the system drawn from, found again in the replicates.
fn mode_spreads(
    estimate: &[Complex],
    drawn_from: &[Complex],
    samples: &[Sample],
    length: RecordLength,
) -> Vec<Result<(Spread, Spread), NoSpread>> {
    let numbers = |s: Complex| [s.norm(), Mode::continuous(s).damping_ratio.unwrap_or(0.0)];
    let found: Vec<Vec<Option<Complex>>> =
        samples.iter().map(|sample| matched(drawn_from, &sample.poles, pole_distance)).collect();
    let stands_for = matched(estimate, drawn_from, pole_distance);
    let spread = |(own, centre): (&Complex, Option<Complex>)| {
        let centre = centre.ok_or(NoSpread::NotFoundAgain)?;
        let place = drawn_from.iter().position(|s| *s == centre).ok_or(NoSpread::NotFoundAgain)?;
        let values: Vec<[f64; 2]> = found.iter().filter_map(|replicate| Some(numbers(replicate[place]?))).collect();
        let values = within_reach(values);
        if (values.len() as f64) < LEAST_SUCCESS * samples.len() as f64 {
            return Err(NoSpread::NotFoundAgain);
        }
        let [frequency, damping] = [0, 1].map(|i| {
            let all: Vec<f64> = values.iter().map(|value| value[i]).collect();
            Spread::about(numbers(*own)[i], numbers(centre)[i], &all).ok_or(NoSpread::NotFoundAgain)
        });
        let (frequency, damping) = (frequency?, damping?);
        if length.is_short_for(*own) {
            return Err(NoSpread::ShortRecord);
        }
        if frequency.deviation > LARGEST_VARIATION * own.norm() {
            return Err(NoSpread::NotDetermined);
        }
        Ok((frequency, damping))
    };
    estimate.iter().zip(stands_for).map(spread).collect()
}

/// Without replicates that lie far from the others in the logarithm of the frequency, or in the damping ratio.
fn within_reach(values: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let coordinates = |value: &[f64; 2]| [value[0].max(f64::MIN_POSITIVE).ln(), value[1]];
    let bounds = [0, 1].map(|i| {
        let all: Vec<f64> = values.iter().map(|value| coordinates(value)[i]).collect();
        let middle = median(all.clone());
        let deviation = median(all.iter().map(|x| (x - middle).abs()).collect());
        (middle, FAR * SCALED * deviation)
    });
    let is_near = |value: &[f64; 2]| {
        coordinates(value).iter().zip(bounds).all(|(x, (middle, reach))| (x - middle).abs() <= reach)
    };
    values.into_iter().filter(is_near).collect()
}

/// Not a number for none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5).unwrap_or(f64::NAN)
}

/// Of every zero of the estimate; where the system drawn from has none to stand for it, about the replicates' mean.
fn zero_spreads(
    (estimate, drawn_from): (&Sample, &Sample),
    samples: &[Sample],
    part: fn(Complex) -> f64,
) -> Vec<Option<Spread>> {
    let distance = |a: Complex, b: Complex| (a - b).norm();
    let found: Vec<Vec<Option<Complex>>> =
        samples.iter().map(|sample| matched(&estimate.zeros, &sample.zeros, distance)).collect();
    let has_them = drawn_from.zeros.len() == estimate.zeros.len();
    let centres = if has_them { matched(&estimate.zeros, &drawn_from.zeros, distance) } else { Vec::new() };
    let spread = |(k, zero): (usize, &Complex)| {
        let values: Vec<f64> = found.iter().filter_map(|replicate| Some(part(replicate[k]?))).collect();
        if (values.len() as f64) < LEAST_SUCCESS * samples.len() as f64 {
            return None;
        }
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let centre = centres.get(k).copied().flatten().map_or(mean, part);
        Spread::about(part(*zero), centre, &values)
    };
    estimate.zeros.iter().enumerate().map(spread).collect()
}

/// The modulus by its logarithm, which a band about it keeps positive.
fn band_point((estimate, drawn_from): (&Sample, &Sample), samples: &[Sample], k: usize) -> Option<BandPoint> {
    let own = *estimate.response.get(k)?;
    let values: Vec<Complex> = samples.iter().filter_map(|s| s.response.get(k).copied()).collect();
    let change = |of: &dyn Fn(Complex) -> f64| {
        let all: Vec<f64> = values.iter().map(|x| of(x / own)).collect();
        let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
        Spread::about(0.0, drawn_from.response.get(k).map_or(mean, |h| of(h / own)), &all)
    };
    let (modulus, phase) = (change(&|x| x.norm().ln())?, change(&|x| x.arg())?);
    Some(BandPoint {
        magnitude: (own.norm() * modulus.lower.exp(), own.norm() * modulus.upper.exp()),
        phase_change_rad: (phase.lower, phase.upper),
    })
}

/// By frequency and damping; a little by the sign of the imaginary part, so that of a pair each goes to its own.
fn pole_distance(a: Complex, b: Complex) -> f64 {
    let damping = |s: Complex| Mode::continuous(s).damping_ratio.unwrap_or(0.0);
    let frequency = (a.norm().max(f64::MIN_POSITIVE) / b.norm().max(f64::MIN_POSITIVE)).ln().abs();
    let other_side = if (a.im > 0.0) != (b.im > 0.0) { 1e-9 } else { 0.0 };
    frequency + DAMPING_WEIGHT * (damping(a) - damping(b)).abs() + other_side
}

/// For every entry of `reference` one of `candidates`, the closest pairs first; `None` where none is left.
fn matched(
    reference: &[Complex],
    candidates: &[Complex],
    distance: impl Fn(Complex, Complex) -> f64,
) -> Vec<Option<Complex>> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::with_capacity(reference.len() * candidates.len());
    for (i, r) in reference.iter().enumerate() {
        pairs.extend(candidates.iter().enumerate().map(|(j, f)| (distance(*r, *f), i, j)));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut result = vec![None; reference.len()];
    let mut used = vec![false; candidates.len()];
    for (_, i, j) in pairs {
        if result[i].is_none() && !used[j] {
            result[i] = Some(candidates[j]);
            used[j] = true;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crate::{ArxOrder, IoData, NoiseOptions, arx, noise_model};
    use crumple_numerics::estimation::random::RandomNumbers;

    #[test]
    fn poles_go_to_their_nearest_each_once() {
        let c = Complex::new;
        let reference = [c(-1.0, 5.0), c(-1.0, -5.0), c(-3.0, 0.0)];
        let estimated = [c(-2.9, 0.0), c(-1.1, -5.2), c(-1.1, 5.2)];
        let wanted = [Some(estimated[2]), Some(estimated[1]), Some(estimated[0])];
        assert_eq!(matched(&reference, &estimated, pole_distance), wanted);
        assert_eq!(matched(&reference[..2], &estimated[..1], pole_distance), [None, Some(estimated[0])]);
    }

    #[test]
    fn a_mode_needs_two_time_constants_or_half_a_period_of_a_free_motion() {
        let (swings, creeps) = (Complex::new(-5.0, 25.0), Complex::new(-25.0, 0.0));
        let is_short = |pole: Complex, s: f64| {
            (RecordLength::Driven(s).is_short_for(pole), RecordLength::Free(s).is_short_for(pole))
        };
        let short = |pole| [0.05, 0.09, 0.13, 0.41].map(|duration_s| is_short(pole, duration_s));
        assert_eq!(short(swings), [(true, true), (true, true), (true, false), (false, false)]);
        assert_eq!(short(creeps), [(true, true), (false, false), (false, false), (false, false)]);
    }

    #[test]
    fn an_interval_holds_the_estimate_whatever_the_bias() {
        let spread = Spread::about(3.0, 3.0, &[3.5, 3.6, 3.7]).unwrap();
        assert!((spread.bias - 0.6).abs() < 1e-12 && (spread.deviation - 0.1).abs() < 1e-12 && spread.is_biased());
        let reach = NORMAL[0] * 0.37_f64.sqrt();
        assert!((spread.lower - (3.0 - reach)).abs() < 1e-12 && (spread.upper - (3.0 + reach)).abs() < 1e-12);
        assert_eq!(Spread::about(3.0, 3.0, &[3.5]), None);
    }

    #[test]
    fn intervals_of_a_biased_regression_hold_estimate_and_truth() {
        const DT_S: f64 = 0.01;
        let sample = |data: &IoData| {
            let model = arx(data, ArxOrder { na: 2, nb: 3, nk: 0 }).ok()?.state_space().ok()?;
            let poles = model.poles().ok()?.into_iter().filter_map(|z| Some(Mode::discrete(z, DT_S)?.pole));
            Some(Sample { poles: poles.collect(), ..Sample::default() })
        };
        // z² - 1.6 z + 0.8 = 0, white noise on the output: the regression finds too much damping.
        let truth = Mode::discrete(Complex::new(0.8, 0.4), DT_S).unwrap();
        let mut holds = [[0; 2]; 2];
        for seed in 0..20 {
            let mut random = RandomNumbers::seeded(seed);
            let u: Vec<f64> = (0..500).map(|_| random.uniform() - 0.5).collect();
            let mut y = vec![0.0; 500];
            for k in 2..500 {
                y[k] = 1.6 * y[k - 1] - 0.8 * y[k - 2] + 0.3 * u[k] + 0.5 * u[k - 1] + 0.2 * u[k - 2];
            }
            y.iter_mut().for_each(|y| *y += 0.2 * random.normal());
            let data = IoData::single(u.clone(), y, DT_S).unwrap();
            let noise = noise_model(&data, NoiseOptions::new(2)).unwrap();
            let own = sample(&data).unwrap();
            let centre = Sample { poles: noise.poles.clone(), ..Sample::default() };
            let options = BootstrapOptions { replicates: 60, seed: 1 };
            let refit = |y: &[Vec<f64>]| sample(&IoData::single(u.clone(), y[0].clone(), DT_S).ok()?);
            let estimated = bootstrap((&own, &centre), &noise, RecordLength::Driven(5.0), options, refit).unwrap();
            let (frequency, damping) = estimated.modes[0].unwrap();
            let estimate = Mode::continuous(own.poles[0]);
            for (holds, mode) in holds.iter_mut().zip([estimate, truth]) {
                let numbers = [mode.natural_frequency_rad_per_s, mode.damping_ratio.unwrap()];
                for ((holds, spread), x) in holds.iter_mut().zip([frequency, damping]).zip(numbers) {
                    *holds += i32::from((spread.lower..=spread.upper).contains(&x));
                }
            }
        }
        // The estimate always. The truth: 90 % of 20, and a binomial number falls below 14 once in 400.
        assert!(holds[0] == [20; 2] && holds[1].iter().all(|h| *h >= 14), "{holds:?}");
    }
}
