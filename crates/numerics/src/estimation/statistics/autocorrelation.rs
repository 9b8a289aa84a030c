//! Autocorrelation of residuals in time, and how many independent samples it leaves.
//!
//! Three rules for three uses, each named by where it stops the sum `1 + 2 sum r_k`. Of a lumped model's misfit, slow
//! and not like any simple noise: all lags before the first that is not positive ([`geyer_autocorrelation_time`]). Of
//! noise that is drawn again in blocks: a window of five times the sum ([`sokal_autocorrelation_time`]). Criteria of
//! linear models count `N (1 - r)/(1 + r)` with the lag-1 autocorrelation, right for a first-order autoregression
//! ([`autoregressive_effective_samples`]).
//!
//! Covariance of fitted parameters under residuals that are correlated in time.
//!
//! The misfit of a lumped model to a crash is slow: neighbouring residuals are nearly equal, and the textbook
//! covariance `s² (J'J)^-1` is far too small. Here the residuals' own autocovariance stands between the sensitivities.

use nalgebra::{DMatrix, DVector};

use crate::estimation::statistics::{NORMAL_95, student_95};
use crate::linalg::{dot, jacobi_svd, real_transform};

/// Lag-1 autocorrelation of residuals, within 0 and 0.999 999; 0 for residuals that do not vary.
///
/// White residuals give about 0; the smooth misfit of a model to a crash gives nearly 1.
pub fn lag_1_autocorrelation(residuals: &[f64]) -> f64 {
    let mean = residuals.iter().sum::<f64>() / residuals.len().max(1) as f64;
    let power: f64 = residuals.iter().map(|r| (r - mean).powi(2)).sum();
    if power == 0.0 || !power.is_finite() {
        return 0.0;
    }
    let product: f64 = residuals.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum();
    (product / power).clamp(0.0, 0.999_999)
}

/// Autocovariance of residuals about zero at lags 0 .. `lags`, each divided by their number (so that any triangular
/// window of it is positive semidefinite).
pub fn autocovariance(residuals: &[f64], lags: usize) -> Vec<f64> {
    let n = residuals.len().max(1) as f64;
    (0..lags.min(residuals.len())).map(|lag| at_lag(residuals, lag) / n).collect()
}

/// `sum r[k] r[k + lag]`.
fn at_lag(residuals: &[f64], lag: usize) -> f64 {
    residuals[lag..].iter().zip(residuals).map(|(a, b)| a * b).sum()
}

/// First lag at which the autocovariance is not positive; at least 1.
pub fn first_zero_lag(covariance: &[f64]) -> usize {
    covariance.iter().skip(1).position(|c| *c <= 0.0).map_or(covariance.len(), |k| k + 1).max(1)
}

/// Autocorrelation time in samples: `1 + 2 sum r_k` over the lags before the first that is not positive; at least 1,
/// and 1 for residuals that are all zero.
///
/// Time: lags up to that one times the samples; above 20,000 samples all lags by two Fourier transforms.
///
/// Geyer's initial positive sequence ("Practical Markov chain Monte Carlo", Statistical Science 7(4), 1992), about zero
/// and not about the mean: a constant misfit is one sample. A slow swing of `m` periods in the window counts as about
/// `3 m` samples.
pub fn geyer_autocorrelation_time(residuals: &[f64]) -> f64 {
    let power = at_lag(residuals, 0);
    if power <= 0.0 || !power.is_finite() {
        return 1.0;
    }
    let sum: f64 = if residuals.len() > DIRECT_UP_TO {
        all_lags(residuals).into_iter().skip(1).take_while(|product| *product > 0.0).sum()
    } else {
        (1..residuals.len()).map(|lag| at_lag(residuals, lag)).take_while(|product| *product > 0.0).sum()
    };
    (1.0 + 2.0 * sum / power).max(1.0)
}

/// Residuals up to which lags are summed one by one: a tenth of a second for residuals of one sign.
const DIRECT_UP_TO: usize = 20_000;

/// `sum r[k] r[k + lag]` for all lags: the inverse transform of the power spectrum, with as many zeros as samples
/// behind the residuals so that nothing comes around. Rounding: some 1e-16 of the power.
fn all_lags(residuals: &[f64]) -> Vec<f64> {
    let length = (2 * residuals.len()).next_power_of_two();
    let plan = real_transform(length);
    let (forward, inverse) = (plan.forward, plan.inverse);
    let mut padded = residuals.to_vec();
    padded.resize(length, 0.0);
    let mut spectrum = forward.make_output_vec();
    if forward.process(&mut padded, &mut spectrum).is_err() {
        return Vec::new();
    }
    for value in &mut spectrum {
        *value = value.norm_sqr().into();
    }
    if inverse.process(&mut spectrum, &mut padded).is_err() {
        return Vec::new();
    }
    padded.truncate(residuals.len());
    padded.iter_mut().for_each(|value| *value /= length as f64);
    padded
}

/// Independent samples that residuals are worth: their number over [`geyer_autocorrelation_time`], at least 1. `None`
/// for residuals that are all zero, or none.
pub fn effective_samples(residuals: &[f64]) -> Option<f64> {
    let varies = residuals.iter().any(|r| *r != 0.0) && residuals.iter().all(|r| r.is_finite());
    varies.then(|| (residuals.len() as f64 / geyer_autocorrelation_time(residuals)).max(1.0))
}

/// `1 + 2 sum r_k` up to the first lag that is five times the sum so far (Sokal's window), at least 1.
///
/// In samples: the mean of `N` such residuals has the variance of `N` over this many independent ones. Sokal, *Monte
/// Carlo Methods in Statistical Mechanics*, 1989.
pub fn sokal_autocorrelation_time(residual: &[f64]) -> f64 {
    let energy = dot(residual, residual);
    if energy <= 0.0 || !energy.is_finite() {
        return 1.0;
    }
    let mut time = 1.0;
    for lag in 1..residual.len() {
        if lag as f64 > 5.0 * time {
            break;
        }
        time += 2.0 * dot(&residual[lag..], &residual[..residual.len() - lag]) / energy;
        if time < 1.0 {
            return 1.0;
        }
    }
    time
}

/// Number of independent samples that correlated residuals are worth, `N (1 - rho)/(1 + rho)` with `rho` the lag-one
/// autocorrelation, from 2 to N: exact for a first-order autoregression.
pub fn autoregressive_effective_samples(residual: &[f64]) -> f64 {
    let n = residual.len() as f64;
    let energy = dot(residual, residual);
    if residual.len() < 2 || energy <= 0.0 {
        return n;
    }
    let rho = (dot(&residual[1..], &residual[..residual.len() - 1]) / energy).clamp(0.0, 1.0);
    (n * (1.0 - rho) / (1.0 + rho)).max(2.0_f64.min(n))
}

/// Singular values below this share of the largest are those of the differences, not of the model.
const RANK_TOLERANCE: f64 = 1e-8;
/// The band of the residual autocovariance, in lags of its first zero.
const BAND: usize = 3;
/// How much shorter the autocorrelation time of residuals is than that of the noise, in parts of `p τ/N`: by trial on
/// straight lines through noise of known autocorrelation, see the tests.
const REMOVED: f64 = 3.0;
/// An error of the size of the resolution hangs together over this share of the window.
const RESOLUTION_SHARE: usize = 4;

/// The covariance of fitted parameters, in the coordinates of the sensitivities, with rank and weakest direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    /// Covariance of the estimate, from the residuals and the resolution.
    pub matrix: DMatrix<f64>,
    /// Half-width of the 95 % interval of each coordinate; infinite where the record says nothing.
    pub half_width: DVector<f64>,
    /// Largest over smallest singular value of the sensitivities with columns of one length; infinite without full
    /// rank.
    pub condition: f64,
    /// Directions that the record determines at all.
    pub rank: usize,
    /// Unit vector in the coordinates along which the displacement changes least.
    pub weakest: DVector<f64>,
    /// Root mean square change of the displacement for one unit along it, m.
    pub weakest_change_m: f64,
    /// Number of independent samples that the residuals are worth.
    pub effective_samples: f64,
}

/// The residuals of one wave, and what is known of their errors.
#[derive(Clone, Copy)]
pub struct Block<'a> {
    /// Residuals of the wave.
    pub samples: usize,
    /// What the wave is known to at best, in the unit of the residuals.
    pub resolution: f64,
    /// The error of its sensor, where that was measured apart from the residuals.
    pub sensor: Option<SensorError<'a>>,
}

/// An error of known covariance `Λ`.
#[derive(Clone, Copy)]
pub struct SensorError<'a> {
    /// `U' Λ U` for the rows `U` of the wave, in squared units of the residuals.
    pub projected_noise_covariance: &'a dyn Fn(&DMatrix<f64>) -> DMatrix<f64>,
    /// Degrees of freedom of its level.
    pub freedom: f64,
    /// Whether it is all that the residuals hold; else the residuals' own covariance is added.
    pub explains_residuals: bool,
}

/// The sandwich `P = (J'J)^-1 J' Λ J (J'J)^-1` from sensitivities `j_m` and residuals, both in metres.
///
/// `Λ` is the banded matrix of the residuals' autocovariance with triangular weights (Newey & West 1987), three times
/// as wide as its first zero; a fit of `p` parameters has removed part of slow noise from them, for which `Λ` is raised
/// by `Ne/(Ne - p)`, `Ne` the number of samples over the autocorrelation time, and to that time's widening of white
/// noise if it is less on average. To it comes an error of the resolution that is correlated over a quarter of the
/// window. Intervals use Student's factor for `Ne - p` (at least 1) degrees of freedom on the first part, 1.96 on the
/// second. Linear: right while the response is straight over the interval; true only if the model is. `None` for no
/// parameters, more parameters than samples, or a parameter without any effect.
pub fn covariance(j_m: &DMatrix<f64>, residuals_m: &[f64], resolution_m: f64) -> Option<Covariance> {
    let block = Block { samples: residuals_m.len(), resolution: resolution_m, sensor: None };
    covariance_of_blocks(j_m, residuals_m, &[block])
}

/// The same for residuals of several waves, one after the other, in one unit. Errors hang together within a wave, not
/// from one to another; each wave pays for as many parameters as it has part in the fit. The error of a sensor enters
/// with its own covariance, and Student's factor for its own degrees of freedom; where it explains the residuals, their
/// autocovariance is left out.
pub fn covariance_of_blocks(j_m: &DMatrix<f64>, residuals_m: &[f64], blocks: &[Block<'_>]) -> Option<Covariance> {
    let (n, p) = j_m.shape();
    let whole = blocks.iter().map(|b| b.samples).sum::<usize>() == n && blocks.iter().all(|b| b.samples > 0);
    if p == 0 || n <= p || residuals_m.len() != n || !whole {
        return None;
    }
    let norms: Vec<f64> = j_m.column_iter().map(|c| c.norm()).collect();
    if norms.iter().any(|norm| *norm == 0.0 || !norm.is_finite()) {
        return None;
    }
    let scaled = DMatrix::from_fn(n, p, |i, j| j_m[(i, j)] / norms[j]);
    let triangle = scaled.clone().qr();
    let svd = jacobi_svd(&triangle.r())?;
    let rank = svd.values.iter().filter(|s| **s > RANK_TOLERANCE * svd.values[0]).count();
    // Left vectors of the whole: orthonormal columns.
    let u = triangle.q() * svd.left.columns(0, rank);

    let mut effective_samples = 0.0;
    let mut noise = DMatrix::zeros(rank, rank);
    let mut resolution = DMatrix::zeros(rank, rank);
    // Of the sensors, and the same times the square of Student's factor.
    let (mut sensors, mut widened) = (DMatrix::zeros(rank, rank), DMatrix::zeros(rank, rank));
    // Trace of the noise as the autocorrelation times give it.
    let mut expected = 0.0;
    let mut first = 0;
    for &Block { samples, resolution: resolution_m, sensor } in blocks {
        let residuals = &residuals_m[first..first + samples];
        let rows = u.rows(first, samples).into_owned();
        first += samples;
        // Parameters that this wave pays for.
        let part = if blocks.len() == 1 { 1.0 } else { rows.norm_squared() / rank as f64 };
        // A fit takes the slowest noise out of the residuals, which then look faster than they are.
        let time = geyer_autocorrelation_time(residuals);
        let time = time * (1.0 + REMOVED * part * p as f64 * time / samples as f64);
        effective_samples += (samples as f64 / time).max(1.0);
        if let Some(sensor) = sensor {
            let of_sensor = (sensor.projected_noise_covariance)(&rows);
            widened += &of_sensor * student_95(sensor.freedom).powi(2);
            sensors += of_sensor;
        }
        if !sensor.is_some_and(|sensor| sensor.explains_residuals) {
            let covariance = autocovariance(residuals, samples);
            let band = (BAND * first_zero_lag(&covariance)).min(samples - 1);
            let weights: Vec<f64> =
                covariance[..=band].iter().enumerate().map(|(k, c)| c * (1.0 - k as f64 / (band + 1) as f64)).collect();
            noise += middle(&rows, &weights);
            expected += part * rank as f64 * covariance[0] * time;
        }
        let length = (samples / RESOLUTION_SHARE).max(1);
        let weights: Vec<f64> =
            (0..length).map(|k| resolution_m * resolution_m * (1.0 - k as f64 / length as f64)).collect();
        resolution += middle(&rows, &weights);
    }
    let freedom = (effective_samples - p as f64).max(1.0);
    let raise = effective_samples.max(freedom + 1.0) / freedom;
    // A short band sees too little of slow noise: on average over the directions never less than the autocorrelation
    // time says.
    let share = expected / noise.trace();
    let noise = noise * (raise * if share.is_finite() { share.max(1.0) } else { 1.0 });

    // (J'J)^-1 J' = D^-1 V S^-1 U'.
    let back = DMatrix::from_fn(p, rank, |i, k| svd.right[(i, k)] / svd.values[k] / norms[i]);
    let propagated = |middle: DMatrix<f64>| &back * middle * back.transpose();
    let (of_noise, of_resolution) = (propagated(noise), propagated(resolution));
    let (of_sensors, widened) = (propagated(sensors), propagated(widened));
    let t = student_95(freedom);
    let half_width = DVector::from_fn(p, |i, _| {
        // A direction without effect leaves every parameter that has part in it open.
        if (rank..p).any(|k| svd.right[(i, k)].abs() > 1e-6) {
            f64::INFINITY
        } else {
            let known = widened[(i, i)].max(0.0) + NORMAL_95 * NORMAL_95 * of_resolution[(i, i)].max(0.0);
            (t * t * of_noise[(i, i)].max(0.0) + known).sqrt()
        }
    });
    // The weakest direction in the coordinates themselves, where one unit means the same for all.
    let plain = jacobi_svd(&j_m.clone().qr().r())?;
    let weakest = plain.right.column(p - 1).into_owned();
    let weakest_change_m = plain.values[p - 1] / (n as f64).sqrt();
    let condition = if rank == p { svd.values[0] / svd.values[p - 1] } else { f64::INFINITY };
    let matrix = of_noise + of_sensors + of_resolution;
    let finite = matrix.iter().all(|x| x.is_finite()) && half_width.iter().all(|x| !x.is_nan());
    finite.then_some(Covariance { matrix, half_width, condition, rank, weakest, weakest_change_m, effective_samples })
}

impl Covariance {
    /// Adds errors that the residuals do not show: `by_errors`, the change of each coordinate by one deviation of each
    /// of them, normal and independent.
    pub fn add(&mut self, by_errors: &DMatrix<f64>) {
        let more = by_errors * by_errors.transpose();
        for (half, variance) in self.half_width.iter_mut().zip(more.diagonal().iter()) {
            *half = half.hypot(NORMAL_95 * variance.sqrt());
        }
        self.matrix += more;
    }

    /// Correlation matrix; zero beside a parameter without deviation.
    pub fn correlation(&self) -> DMatrix<f64> {
        let deviation = self.matrix.diagonal().map(|v| v.max(0.0).sqrt());
        DMatrix::from_fn(deviation.len(), deviation.len(), |i, j| {
            let product = deviation[i] * deviation[j];
            if i == j {
                1.0
            } else if product > 0.0 {
                (self.matrix[(i, j)] / product).clamp(-1.0, 1.0)
            } else {
                0.0
            }
        })
    }
}

/// `U' Λ U` for the symmetric Toeplitz matrix of these first lags.
fn middle(u: &DMatrix<f64>, lags: &[f64]) -> DMatrix<f64> {
    let (n, p) = u.shape();
    let mut sum = DMatrix::zeros(p, p);
    for (lag, weight) in lags.iter().enumerate() {
        let product = u.rows(lag, n - lag).tr_mul(&u.rows(0, n - lag)) * *weight;
        if lag > 0 {
            sum += product.transpose();
        }
        sum += product;
    }
    sum
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crate::estimation::random::RandomNumbers;

    #[test]
    fn tells_smooth_from_alternating() {
        let smooth: Vec<f64> = (0..200).map(|k| (f64::from(k) * 0.03).sin()).collect();
        assert!(lag_1_autocorrelation(&smooth) > 0.98);
        let alternating: Vec<f64> = (0..200).map(|k| if k % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(lag_1_autocorrelation(&alternating), 0.0);
        assert_eq!(lag_1_autocorrelation(&[0.0; 5]), 0.0);
        assert_eq!((geyer_autocorrelation_time(&alternating), geyer_autocorrelation_time(&[0.0; 5])), (1.0, 1.0));
    }

    #[test]
    fn long_residuals_go_by_the_transform_and_agree() {
        // A first-order autoregression of a known generator, and residuals of one sign, which no lag ends.
        let mut state = 1_u64;
        let mut last = 0.0;
        let noise: Vec<f64> = (0..DIRECT_UP_TO + 1000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                last = 0.9 * last + (state >> 11) as f64 * 0.5_f64.powi(53) - 0.5;
                last
            })
            .collect();
        let transformed = all_lags(&noise);
        let power = at_lag(&noise, 0);
        for lag in [0, 1, 7, 100, 5000] {
            // Rounding of two transforms of 2^16 samples.
            assert!((transformed[lag] - at_lag(&noise, lag)).abs() < 1e-12 * power, "{lag}");
        }
        let time = geyer_autocorrelation_time(&vec![1.0; 1_000_000]);
        // 1 + 2 sum (1 - k/N) = N.
        assert!((time / 1e6 - 1.0).abs() < 1e-9, "{time}");
    }

    #[test]
    fn a_swing_counts_three_samples_a_period() {
        let swing: Vec<f64> = (0..1000).map(|k| (f64::from(k) * 0.01 * std::f64::consts::PI).sin()).collect();
        // Five periods: 1 + 2 (half a swing of a cosine, 50/pi·2) = 64; the window's ends take a little off.
        let time = geyer_autocorrelation_time(&swing);
        assert!((50.0..=70.0).contains(&time), "{time}");
        // About three samples a period.
        let worth = effective_samples(&swing).unwrap();
        assert!((14.0..=20.0).contains(&worth), "{worth}");
        assert_eq!((effective_samples(&[0.0; 4]), effective_samples(&[])), (None, None));
        assert_eq!(effective_samples(&[1.0, -1.0, 1.0, -1.0]), Some(4.0));
    }

    fn noise(seed: u64, rho: f64, n: usize) -> Vec<f64> {
        let mut random = RandomNumbers::seeded(seed);
        let mut last = random.normal();
        (0..n)
            .map(|_| {
                last = rho * last + (1.0 - rho * rho).sqrt() * random.normal();
                last
            })
            .collect()
    }

    /// Share of intervals that hold the truth, for a straight line through noise of unit power.
    fn coverage(rho: f64) -> f64 {
        let n = 250;
        let j = DMatrix::from_fn(n, 2, |i, k| if k == 0 { 1.0 } else { i as f64 / n as f64 - 0.5 });
        let tries = 400;
        let mut inside = 0;
        for seed in 0..tries {
            let y = DVector::from_vec(noise(seed, rho, n));
            let found = j.clone().svd(true, true).solve(&y, 1e-12).unwrap();
            let rest = &y - &j * &found;
            let covariance = covariance(&j, rest.as_slice(), 0.0).unwrap();
            // The true line is zero.
            inside += (0..2).filter(|&i| found[i].abs() <= covariance.half_width[i]).count();
        }
        inside as f64 / (2 * tries) as f64
    }

    #[test]
    fn intervals_hold_the_truth_about_as_often_as_they_say() {
        for (rho, lowest) in [(0.0, 0.90), (0.8, 0.90), (0.95, 0.88)] {
            let share = coverage(rho);
            // 800 intervals: the share itself is known to 0.8 %. At 0.95 the record holds six independent samples.
            assert!(share >= lowest && share <= 0.995, "rho {rho}: {share}");
        }
    }

    #[test]
    fn a_direction_without_effect_lowers_the_rank_and_opens_its_parameters() {
        let j = DMatrix::from_fn(60, 3, |i, k| match k {
            0 => 1.0,
            1 => i as f64,
            _ => 2.0 * i as f64,
        });
        let found = covariance(&j, &noise(1, 0.0, 60), 0.0).unwrap();
        assert_eq!((found.rank, found.condition), (2, f64::INFINITY));
        assert!(found.half_width[0].is_finite() && found.half_width[1].is_infinite());
        // 2 units of the second against one of the third.
        assert!((found.weakest[1] / found.weakest[2] + 2.0).abs() < 1e-6, "{}", found.weakest);
    }
}
