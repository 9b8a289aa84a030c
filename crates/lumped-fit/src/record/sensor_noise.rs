//! The noise of a sensor, from what it recorded before the event, and what filter and sums make of it in a wave.
//!
//! A displacement is summed twice: noise of the accelerometer becomes an error that is smooth over the whole window.
//! Such an error cannot be estimated from what a fit leaves of it, for there is hardly more than one of it in a record.
//! At its source it is short, and there are many of it.

use crumple_signal::TwoPassFilter;
use nalgebra::{DMatrix, DVector};

use crate::record::observation::ObservedWave;
use crate::record::sensor::FitQuantity;

/// Directions of the sensitivities below this share of the strongest are rounding.
const RANK_TOLERANCE: f64 = 1e-8;
/// Autocorrelation of neighbours among the rows that are whitened: through CFC 60 some 2 ms, so that frequencies up to
/// 250 Hz are seen, where the filter leaves 2 %.
const NEXT: f64 = 0.8;
/// Share of the variance that is taken as digits: white at those rows.
const DIGITS: f64 = 1e-5;
/// Mean square of a misfit, over that of the noise, up to which the noise explains it: with the 10 to 20 degrees of
/// freedom that both have in a window through CFC 60, noise alone exceeds it in 1 % of the records (F distribution).
pub(crate) const EXPLAINED: f64 = 4.0;

/// Stationary noise of an acceleration, white before the channel filter, and the error of the zero level that was read
/// from it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SensorNoise {
    /// Variance of the filtered acceleration, (m/s²)².
    pub variance: f64,
    /// Degrees of freedom of that variance: 1 for each independent sample before the event but one.
    pub freedom: f64,
    /// First of the samples that the zero level is the mean of, on the grid of the measurement.
    first: usize,
    /// How many they are.
    samples: usize,
    /// Autocorrelation of the filtered noise by lag in samples, from 1 at lag 0.
    lags: Vec<f64>,
    /// Sum of squares of the filter's response to an impulse.
    energy: f64,
}

impl SensorNoise {
    /// The noise of the sensor of a wave. `None` where the steps to the wave, or the acceleration before the event, are
    /// not known, and for a recorder that shows no noise there: muted, or a computed record, of which a filter brings
    /// the pulse there ([`BeforeEvent`](crumple_signal::BeforeEvent)).
    ///
    /// The pre-event samples have lost their mean, which is the zero level: `n` samples of autocorrelation time `τ`
    /// have the variance `s² / (1 - τ/n)`.
    pub fn of(wave: &ObservedWave) -> Option<Self> {
        let measurement = &wave.measurement;
        let quiet = measurement.before_event.filter(|quiet| quiet.noise > 0.0 && quiet.noise_samples > 1)?;
        if measurement.is_exact() {
            return None;
        }
        let (lags, energy) = match &measurement.filter {
            Some(filter) => filter.noise_autocorrelation()?,
            None => (vec![1.0], 1.0),
        };
        let n = quiet.noise_samples as f64;
        let time = both_sides(&lags, |r| r).clamp(1.0, 0.5 * n);
        let variance = quiet.noise.powi(2) / (1.0 - time / n);
        let freedom = (n / both_sides(&lags, |r| r * r) - 1.0).max(1.0);
        let first = ((quiet.from_s - measurement.first_s) / measurement.dt_s).round().max(0.0) as usize;
        Some(Self { variance, freedom, first, samples: quiet.samples, lags, energy })
    }

    /// Whether the mean square of an acceleration misfit, not yet at its least, is of the size of the noise.
    pub fn is_near(&self, misfit: &[f64]) -> bool {
        let mean_square = misfit.iter().map(|a| a * a).sum::<f64>() / misfit.len().max(1) as f64;
        mean_square <= EXPLAINED * EXPLAINED * self.variance
    }

    /// The noise with its level from a misfit too, where it explains that; `None` where it does not. `left`: sum of
    /// squares of the misfit in units of this noise, of so many independent rows more than numbers that were fitted.
    pub fn pooled(&self, left: f64, freedom: usize) -> Option<Self> {
        let own = freedom as f64;
        let both = self.freedom + own;
        let variance = self.variance * (self.freedom + left) / both;
        (left <= EXPLAINED * own || freedom == 0).then(|| Self { variance, freedom: both, ..self.clone() })
    }

    /// The same from a misfit in the units of [`in_units`](Self::in_units) at its least, and its sensitivities there.
    pub fn with_misfit(&self, wave: &ObservedWave, misfit: &[f64], sensitivities: &DMatrix<f64>) -> Option<Self> {
        let count = sensitivities.ncols();
        let mut all = sensitivities.clone().insert_column(count, 0.0);
        all.column_mut(count).copy_from_slice(misfit);
        let white = self.whitened(wave, &all)?;
        if count == 0 {
            return self.pooled(white.norm_squared(), white.nrows());
        }
        let basis = white.columns(0, count).into_owned().svd(true, false);
        let rank = basis.rank(RANK_TOLERANCE * basis.singular_values.max());
        let (u, misfit) = (basis.u?, white.column(count));
        let taken = u.columns(0, rank).tr_mul(&misfit).norm_squared();
        self.pooled((misfit.norm_squared() - taken).max(0.0), white.nrows() - rank)
    }

    /// An acceleration misfit in units of the noise: sums of squares of it rise by one where a slow change of the model
    /// is one standard deviation away.
    ///
    /// Noise of variance `s²` and autocorrelation time `τ` has the density of white noise of variance `s² τ` at low
    /// frequencies. A zero level read from `n` samples is one more unknown, that `n` samples hold at zero: of the mean
    /// of `N` samples the share `1 - sqrt(n/(N + n))` goes to it.
    pub fn in_units(&self, acceleration: &mut [f64]) {
        let (count, samples) = (acceleration.len() as f64, self.samples as f64);
        let mean = acceleration.iter().sum::<f64>() / count.max(1.0);
        let taken = mean * (1.0 - (samples / (count + samples)).sqrt());
        let unit = (self.variance / self.energy).sqrt();
        acceleration.iter_mut().for_each(|a| *a = (*a - taken) / unit);
    }

    /// Rows in those units as independent ones of unit variance, several for each independent sample: every row so far
    /// from the next that their autocorrelation is 0.8, through the root of the covariance of those. Fast changes, of
    /// which a filter leaves less noise than of slow ones, count for more than in the sum of squares of all rows. The
    /// last rows of a record are left out: through its mirror image the last sample enters twice. `None` where no row
    /// is left.
    pub fn whitened(&self, wave: &ObservedWave, rows: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let stride = self.lags.iter().take_while(|r| **r >= NEXT).count().max(1);
        let before_end = wave.measurement.samples.saturating_sub(wave.first + 2 * stride);
        let picked: Vec<usize> = (0..rows.nrows().min(before_end)).step_by(stride).collect();
        if picked.is_empty() {
            return None;
        }
        // A third of n³ products, 30 of them in the time of a sample.
        wave.work.spend((picked.len() as u64).pow(3) / 90);
        let lag = |i: usize, j: usize| self.lags.get(i.abs_diff(j) * stride).copied().unwrap_or(0.0);
        let ridge = |i: usize, j: usize| if i == j { DIGITS } else { 0.0 };
        let covariance = DMatrix::from_fn(picked.len(), picked.len(), |i, j| self.energy * (lag(i, j) + ridge(i, j)));
        covariance.cholesky()?.l_dirty().solve_lower_triangular(&rows.select_rows(&picked))
    }

    /// A record through the filter, with zeros before and after it.
    fn filtered(&self, filter: &Option<TwoPassFilter>, samples: &[f64]) -> Vec<f64> {
        let Some(filter) = filter else { return samples.to_vec() };
        let pad = self.lags.len() + 2;
        let mut padded = vec![0.0; samples.len() + 2 * pad];
        padded[pad..pad + samples.len()].copy_from_slice(samples);
        filter.from_rest().filtered(&padded)
    }

    /// `U' Λ U` for the rows `U` of the compared samples of the wave and the covariance `Λ` that the noise and the zero
    /// level have there, in squared weighted units of the wave.
    ///
    /// With the sums `S` of the integration, the filter `H` and `m` that takes the mean before the event, white noise
    /// `n` becomes the error `S (H E n - 1 m'n)`: columns `E'H S'u - m 1'S'u`. An integration that starts with the
    /// record runs over the noise from which the zero level was read, and the two cancel in part. `E` extends the start
    /// of the record by its mirror image through the first sample, which enters twice: a velocity summed from there is
    /// off by half as much again.
    pub fn projected_noise_covariance(&self, wave: &ObservedWave, rows: &DMatrix<f64>) -> DMatrix<f64> {
        let mut columns = Vec::with_capacity(rows.ncols());
        for column in rows.column_iter() {
            let back = summed_back(wave, column.iter().copied());
            let total: f64 = back.iter().sum();
            let mut white = self.filtered(&wave.measurement.filter, &back);
            let start = (white.len() - back.len()) / 2;
            if let Some(filter) = wave.measurement.filter {
                fold_back(&filter, &mut white, start);
            }
            let first = start + self.first.min(back.len());
            white[first..].iter_mut().take(self.samples).for_each(|w| *w -= total / self.samples as f64);
            columns.push(DVector::from_vec(white));
        }
        let columns = DMatrix::from_columns(&columns);
        columns.tr_mul(&columns) * (wave.weight * wave.weight * self.variance / self.energy)
    }
}

/// Sum over lags of both signs of a function of the autocorrelation, 1 at lag 0.
fn both_sides(lags: &[f64], of: fn(f64) -> f64) -> f64 {
    2.0 * lags.iter().map(|r| of(*r)).sum::<f64>() - 1.0
}

/// Accelerations from every sample of a wave: differences undo the sums.
pub(crate) fn as_acceleration(quantity: FitQuantity, dt_s: f64, wave: &[f64]) -> Vec<f64> {
    match quantity {
        FitQuantity::Displacement => wave.windows(3).map(|x| (x[0] - 2.0 * x[1] + x[2]) / (dt_s * dt_s)).collect(),
        FitQuantity::Velocity => wave.windows(2).map(|v| (v[1] - v[0]) / dt_s).collect(),
        FitQuantity::Acceleration | FitQuantity::Force => wave.to_vec(),
    }
}

/// `S'u` on the grid of the acceleration, up to the last sample compared: what every sample of the acceleration adds to
/// the sum of `u` times the wave. Trapezoids; contact is taken at a sample.
fn summed_back(wave: &ObservedWave, u: impl Iterator<Item = f64>) -> Vec<f64> {
    let measurement = &wave.measurement;
    let contact = measurement.contact_index();
    let mut back = vec![0.0; wave.last() + 1];
    u.enumerate().for_each(|(k, u)| back[wave.first + k * wave.stride] = u);
    let start = if measurement.from_contact { contact.min(wave.last()) } else { 0 };
    let sums = match wave.quantity {
        FitQuantity::Displacement => 2,
        FitQuantity::Velocity => 1,
        FitQuantity::Acceleration | FitQuantity::Force => 0,
    };
    if sums == 2 && start < contact && contact < back.len() {
        // The displacement is shifted to zero at contact.
        back[contact] -= back.iter().sum::<f64>();
    }
    for _ in 0..sums {
        // The first sample begins a trapezoid and ends none.
        let mut after = 0.0;
        for k in (start + 1..back.len()).rev() {
            let own = std::mem::replace(&mut back[k], measurement.dt_s * after);
            back[k] += 0.5 * measurement.dt_s * own;
            after += own;
        }
        back[start] = 0.5 * measurement.dt_s * after;
    }
    back
}

/// What weighs on the extension before the sample at `start`, `2 w[0] - w[i]` at `-i`, weighs on the record.
fn fold_back(filter: &TwoPassFilter, weights: &mut [f64], start: usize) {
    let added = filter.samples_added.min(start).min(weights.len() - start - 1);
    for i in 1..=added {
        let weight = weights[start - i];
        weights[start] += 2.0 * weight;
        weights[start + i] -= weight;
    }
    weights[..start].fill(0.0);
}

#[cfg(test)]
pub(crate) mod tests {
    use std::f64::consts::SQRT_2;

    use crumple_numerics::estimation::random::RandomNumbers;
    use crumple_signal::{BeforeEvent, IntegrationRule, Measurement, Sampled, coarse_step, integrate_twice};

    use super::*;

    const DT_S: f64 = 2e-4;
    /// Samples from 50 ms before contact to 80 ms after it.
    const SAMPLES: usize = 651;
    const CONTACT: usize = 250;

    /// CFC 60 at 5 kHz as ISO 6487 designs it.
    fn cfc_60() -> TwoPassFilter {
        let wa = (std::f64::consts::PI * 125.0 * DT_S).tan();
        let d = 1.0 + SQRT_2 * wa + wa * wa;
        let a0 = wa * wa / d;
        let (b1, b2) = (2.0 * (1.0 - wa * wa) / d, (SQRT_2 * wa - 1.0 - wa * wa) / d);
        TwoPassFilter { coefficients: [a0, 2.0 * a0, a0, b1, b2], samples_added: 50 }
    }

    /// White noise of one m/s² as a laboratory records it: less the mean before the event, filtered, summed from the
    /// first sample and shifted to zero at contact. The displacement from the first sample on, and how it was measured.
    pub(crate) fn recorded_noise(seed: u64) -> (Vec<f64>, Measurement) {
        let mut random = RandomNumbers::seeded(seed);
        let mut noise: Vec<f64> = (0..SAMPLES).map(|_| random.normal()).collect();
        let zero_level = noise[..=200].iter().sum::<f64>() / 201.0;
        noise.iter_mut().for_each(|a| *a -= zero_level);
        let filter = cfc_60();
        let filtered = filter.filtered(&noise);
        let mut displacement = integrate_twice(&filtered, DT_S, IntegrationRule::Trapezoid, 0.0, 0.0).1;
        let at_contact = displacement[CONTACT];
        displacement.iter_mut().for_each(|x| *x -= at_contact);
        let record = Sampled::new(-0.05, DT_S, filtered).unwrap();
        let measurement = Measurement {
            dt_s: DT_S,
            first_s: -0.05,
            samples: SAMPLES,
            filter: Some(filter),
            from_contact: false,
            rule: Some(IntegrationRule::Trapezoid),
            before_event: BeforeEvent::of(&record, Some(&filter), None),
        };
        (displacement, measurement)
    }

    fn wave(seed: u64) -> ObservedWave {
        let (displacement, measurement) = recorded_noise(seed);
        let record = Sampled::new(-0.05, DT_S, displacement).unwrap();
        ObservedWave::new(&record, (None, FitQuantity::Displacement), measurement, (0.0, 0.08), 100).unwrap()
    }

    #[test]
    fn the_error_of_a_displacement_is_as_large_as_the_noise_before_the_event_says() {
        let tries = 2000;
        let (mut observed, mut stated) = (0.0, 0.0);
        for seed in 0..tries {
            let wave = wave(seed);
            let mut last = DMatrix::zeros(wave.samples.len(), 1);
            last[(wave.samples.len() - 1, 0)] = 1.0;
            observed += wave.samples[wave.samples.len() - 1].powi(2);
            stated += SensorNoise::of(&wave).unwrap().projected_noise_covariance(&wave, &last)[(0, 0)];
        }
        // The mean square of 2000 displacements is known to sqrt(2/2000) = 3.2 %, three of them allowed.
        let ratio = observed / stated;
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }

    #[test]
    fn whitened_noise_is_independent_and_of_unit_variance() {
        let (mut sum, mut beside) = (0.0, 0.0);
        for seed in 0..200 {
            let wave = wave(seed).dense();
            let mut noise = SensorNoise::of(&wave).unwrap();
            noise.variance = noise.energy;
            let mut rows = as_acceleration(wave.quantity, DT_S, &wave.samples);
            noise.in_units(&mut rows);
            let white = noise.whitened(&wave, &DMatrix::from_vec(rows.len(), 1, rows)).unwrap();
            sum += white.norm_squared() / white.len() as f64;
            beside += white.rows(1, white.len() - 1).dot(&white.rows(0, white.len() - 1)) / white.len() as f64;
        }
        // Some 8000 numbers: the variance is known to 1.6 %, the covariance of neighbours to 1.1 %; the sums take the
        // mean of three samples, of which the fastest changes lose a part.
        let (variance, neighbours) = (sum / 200.0, beside / 200.0);
        assert!((0.85..1.05).contains(&variance) && neighbours.abs() < 0.1, "{variance} {neighbours}");
    }

    #[test]
    fn noise_explains_itself_and_not_three_times_itself() {
        let (mut explained, mut larger, mut freedom) = (0, 0, 0.0);
        for seed in 0..100 {
            let wave = wave(seed).dense();
            let noise = SensorNoise::of(&wave).unwrap();
            let mut misfit = as_acceleration(wave.quantity, DT_S, &wave.samples);
            noise.in_units(&mut misfit);
            let constant = DMatrix::from_element(misfit.len(), 1, 1.0);
            let threefold: Vec<f64> = misfit.iter().map(|a| 3.0 * a).collect();
            larger += usize::from(noise.with_misfit(&wave, &threefold, &constant).is_some());
            if let Some(pooled) = noise.with_misfit(&wave, &misfit, &constant) {
                explained += 1;
                freedom = pooled.freedom - noise.freedom;
            }
        }
        // Beyond the limit lies 1 %; a ninefold variance falls below four times the other in 4 % (F, 48 and 7 degrees).
        assert!(explained >= 94 && larger <= 14, "{explained} {larger}");
        // A row in 1.6 ms of the 80 ms but at the end, less the constant.
        assert_eq!(freedom.round(), 48.0);
    }

    #[test]
    fn a_window_too_short_for_any_row_has_no_whitened_noise() {
        let mut wave = wave(0).dense();
        let noise = SensorNoise::of(&wave).unwrap();
        wave.measurement.samples = wave.first + 5;
        let misfit = as_acceleration(wave.quantity, DT_S, &wave.samples[..12]);
        let constant = DMatrix::from_element(misfit.len(), 1, 1.0);
        assert_eq!(noise.with_misfit(&wave, &misfit, &constant), None);
    }

    #[test]
    fn a_misfit_that_nothing_moves_has_the_level_of_all_its_rows() {
        let wave = wave(0).dense();
        let noise = SensorNoise::of(&wave).unwrap();
        let misfit = as_acceleration(wave.quantity, DT_S, &wave.samples);
        let pooled = noise.with_misfit(&wave, &vec![0.0; misfit.len()], &DMatrix::zeros(misfit.len(), 0)).unwrap();
        assert_eq!(pooled.freedom - noise.freedom, 49.0);
    }

    #[test]
    fn a_muted_recorder_and_an_unknown_filter_give_no_noise() {
        let mut wave = wave(0);
        wave.measurement = wave.measurement.exact();
        assert_eq!(SensorNoise::of(&wave), None);
        let (_, mut measurement) = recorded_noise(0);
        let zeros = Sampled::new(-0.05, DT_S, vec![0.0; SAMPLES]).unwrap();
        measurement.before_event = BeforeEvent::of(&zeros, Some(&cfc_60()), None);
        wave.measurement = measurement;
        assert_eq!(SensorNoise::of(&wave), None);
    }

    /// A half sine of 300 m/s² over 90 ms from contact, less its level before it, through a filter; noise and offset
    /// before the filter, in steps.
    fn pulse(lead_s: f64, noise: f64, step: f64, filter: Option<&TwoPassFilter>, seed: u64) -> Sampled {
        let mut random = RandomNumbers::seeded(seed);
        let first = (lead_s / DT_S).round() as usize;
        let at = |k: usize| {
            let t = (k as f64 - first as f64) * DT_S;
            if (0.0..0.09).contains(&t) { -300.0 * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 }
        };
        let raw = (0..first + 750).map(|k| {
            let sample = at(k) + 3.43 + noise * random.normal();
            if step > 0.0 { (sample / step).round() * step } else { sample }
        });
        let mut raw: Vec<f64> = raw.collect();
        let level = raw[..first - 50].iter().sum::<f64>() / (first - 50) as f64;
        raw.iter_mut().for_each(|a| *a -= level);
        let recorded = filter.map_or_else(|| raw.clone(), |filter| filter.filtered(&raw));
        Sampled::new(-(first as f64) * DT_S, DT_S, recorded).unwrap()
    }

    /// A class at 5 kHz, `factor` times CFC 60.
    fn class(factor: f64) -> TwoPassFilter {
        let wa = (std::f64::consts::PI * factor * 125.0 * DT_S).tan();
        let d = 1.0 + SQRT_2 * wa + wa * wa;
        let (b1, b2) = (2.0 * (1.0 - wa * wa) / d, (SQRT_2 * wa - 1.0 - wa * wa) / d);
        let a0 = wa * wa / d;
        TwoPassFilter { coefficients: [a0, 2.0 * a0, a0, b1, b2], samples_added: 50 }
    }

    #[test]
    fn the_pulse_that_a_filter_brings_before_contact_is_no_noise() {
        for (filter, name) in [(class(1.0), "60"), (class(3.0), "180"), (class(10.0), "600")] {
            for lead_s in [0.03, 0.05, 0.3] {
                let free = pulse(lead_s, 0.0, 0.0, Some(&filter), 1);
                assert_eq!(BeforeEvent::of(&free, Some(&filter), None), None, "CFC {name}, {lead_s} s");
            }
        }
    }

    #[test]
    fn noise_before_a_pulse_is_that_of_the_sensor() {
        // 0.02 g at 5 kHz, the noise that decides a model; the pulse brings 0.07 m/s² to -10 ms through CFC 60, where
        // the noise is 0.04.
        let (noise, filter) = (0.196, cfc_60());
        let energy = filter.noise_autocorrelation().unwrap().1;
        let (mut variance, mut until) = (0.0, f64::INFINITY);
        let tries: u32 = 400;
        for seed in 0..tries {
            let record = pulse(0.05, noise, 0.0, Some(&filter), seed.into());
            let before = BeforeEvent::of(&record, Some(&filter), None).unwrap();
            variance += before.noise.powi(2) / f64::from(tries);
            until = until.min(-0.04 + before.noise_samples as f64 * DT_S);
        }
        // The mean of the window takes a share of some 1/6 of the variance; each variance has 4 to 6 degrees of
        // freedom, so that of 400 is known to sqrt(2/2000) = 3.2 %: three of them, and a ninth of the pulse on top.
        let share = variance / (noise * noise * energy);
        assert!((0.72..1.02).contains(&share), "{share}");
        // Every window keeps 10 ms at least.
        assert!(until >= -0.03 - DT_S, "{until}");
    }

    #[test]
    fn a_coarse_sensor_has_the_noise_of_its_step() {
        // Steps of 10 m/s² and noise of a fifth of that: most samples at rest are equal, or all.
        for (seed, noise) in [(1, 0.0), (2, 1.0), (3, 1.5), (4, 2.0)] {
            let record = pulse(0.05, noise, 10.0, None, seed);
            let step = coarse_step(record.samples());
            assert!(step.is_some_and(|step| (step - 10.0).abs() < 1e-9), "{noise} {step:?}");
            let before = BeforeEvent::of(&record, None, step).unwrap();
            assert!(before.noise >= step.unwrap() / 12.0_f64.sqrt(), "{noise} {before:?}");
        }
        // A computed record that rests has none.
        assert_eq!(BeforeEvent::of(&pulse(0.05, 0.0, 0.0, None, 1), None, None), None);
    }
}
