//! Covariance of fitted parameters under residuals that are correlated in time.
//!
//! The misfit of a lumped model to a crash is slow: neighbouring residuals are nearly equal, and the textbook
//! covariance `s² (J'J)^-1` is far too small. Here the residuals' own autocovariance stands between the sensitivities.

use crate::linalg::jacobi_svd;
use nalgebra::{DMatrix, DVector};

use super::autocorrelation::{autocovariance, first_zero_lag, geyer_autocorrelation_time};
use super::distributions::student_95;

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
    pub middle: &'a dyn Fn(&DMatrix<f64>) -> DMatrix<f64>,
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
            let of_sensor = (sensor.middle)(&rows);
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
            let known = widened[(i, i)].max(0.0) + 1.96 * 1.96 * of_resolution[(i, i)].max(0.0);
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
    use super::*;
    use crate::estimation::random::RandomNumbers;

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
