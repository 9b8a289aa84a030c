//! Lines of machines that run, told from modes of a structure that noise drives.
//!
//! A mode that noise drives has amplitudes that come and go: its band-passed motion is Gaussian, of kurtosis 3. A
//! machine holds its amplitude: a sine has 1.5, and a sine with the share `r` of the power of the band `3 - 1.5 r²`
//! (Jacobsen, Andersen & Brincker, *Using enhanced frequency domain decomposition as a robust technique to harmonic
//! excitation in operational modal analysis*, ISMA 2006; *Eliminating the influence of harmonic components in
//! operational modal analysis*, IMAC XXV, 2007). And it does not decay.

use std::f64::consts::TAU;

use crumple_numerics::linalg::real_transform;

use crate::IoData;

/// Kurtosis half way from a sine to noise: the line holds 0.71 of the power of its band.
const HALF_WAY: f64 = 2.25;

/// Width of the band in lines of the record's spectrum: as many amplitudes are independent, and the kurtosis of noise
/// is known to `3/sqrt(n)` (first order, of exponential squares of the amplitude).
const LINES: f64 = 32.0;

/// The band ends within this share of the frequency on either side.
const NARROW: f64 = 0.25;

/// Share of the record at either end that the filter does not reach.
const ENDS: f64 = 0.03;

/// The line of a machine that runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HarmonicLine {
    /// Its frequency, rad/s.
    pub frequency_rad_per_s: f64,
    /// Its damping ratio as models find it: zero within its error.
    pub damping_ratio: f64,
    /// Kurtosis of the outputs in its band.
    pub kurtosis: f64,
}

/// The line, where a mode of outputs without an input, of this frequency (rad/s) and damping ratio, is one: its damping
/// is zero within two deviations, and its band is nearer to a sine than to noise.
///
/// The deviation of a damping ratio is `sqrt(zeta/(w T))`: that of the radius of the poles of an autoregression of
/// order two, `var(a2) = (1 - a2²)/N` (Box & Jenkins, *Time Series Analysis*, 1970, ch. 7), for `a2 = exp(-2 zeta w
/// dt)`.
pub fn harmonic_line(data: &IoData, frequency_rad_per_s: f64, damping_ratio: f64) -> Option<HarmonicLine> {
    let duration_s = data.samples() as f64 * data.sample_time_s();
    if damping_ratio > 4.0 / (frequency_rad_per_s * duration_s) {
        return None;
    }
    let kurtosis = band_kurtosis(data, frequency_rad_per_s / TAU)?;
    (kurtosis < HALF_WAY).then_some(HarmonicLine { frequency_rad_per_s, damping_ratio, kurtosis })
}

/// Kurtosis of the outputs in a band about a frequency (Hz), mean over the outputs with the power of the band, of each
/// divided by that of the output. `None` where the record has too few lines below that frequency.
fn band_kurtosis(data: &IoData, hz: f64) -> Option<f64> {
    let samples = data.samples();
    let middle = hz * samples as f64 * data.sample_time_s();
    if 0.5 * LINES > NARROW * middle {
        return None;
    }
    let transform = real_transform(samples);
    let (mut sum, mut weights) = (0.0, 0.0);
    for y in data.outputs() {
        let mean = y.iter().sum::<f64>() / samples as f64;
        let mut signal: Vec<f64> = y.iter().map(|x| x - mean).collect();
        let power: f64 = signal.iter().map(|x| x * x).sum();
        let mut lines = transform.forward.make_output_vec();
        transform.forward.process(&mut signal, &mut lines).ok()?;
        for (k, line) in lines.iter_mut().enumerate() {
            // A raised cosine, half as high at the edges of the band.
            let away = (k as f64 - middle).abs() / LINES;
            *line *= if away < 1.0 { 0.5 + 0.5 * (0.5 * TAU * away).cos() } else { 0.0 };
        }
        transform.inverse.process(&mut lines, &mut signal).ok()?;
        let end = (ENDS * samples as f64) as usize;
        let kept = &signal[end..samples - end];
        let moment = |power: i32| kept.iter().map(|x| x.powi(power)).sum::<f64>() / kept.len() as f64;
        let (square, fourth) = (moment(2), moment(4));
        let weight = square / power;
        if weight > 0.0 {
            sum += weight * fourth / (square * square);
            weights += weight;
        }
    }
    Some(sum / weights).filter(|kurtosis| kurtosis.is_finite())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_numerics::estimation::random::RandomNumbers;

    const DT_S: f64 = 0.02;

    /// A mode of 1 % damping at 4 Hz that noise drives, and a sine of so many deviations of it.
    fn record(seed: u64, sine: f64, hz: f64) -> IoData {
        let mut random = RandomNumbers::seeded(seed);
        let (radius, turn) = ((-0.01 * TAU * 4.0 * DT_S).exp(), TAU * 4.0 * DT_S);
        let mut y = vec![0.0; 6000];
        for k in 2..y.len() {
            y[k] = 2.0 * radius * turn.cos() * y[k - 1] - radius * radius * y[k - 2] + random.normal();
        }
        let deviation = (y.iter().map(|x| x * x).sum::<f64>() / 6000.0).sqrt();
        let wave = |k: usize| sine * 2.0_f64.sqrt() * deviation * (TAU * hz * DT_S * k as f64).sin();
        IoData::new(Vec::new(), vec![y.iter().enumerate().map(|(k, y)| y + wave(k)).collect()], DT_S).unwrap()
    }

    #[test]
    fn a_sine_is_told_from_a_mode_by_the_kurtosis_of_its_band() {
        for seed in 0..20 {
            // The band holds a tenth of the mode's skirt at 7.3 Hz.
            let machine = band_kurtosis(&record(seed, 0.5, 7.3), 7.3).unwrap();
            assert!((machine - 1.5).abs() < 0.1, "{seed}: {machine}");
            // 120 s of a mode with a time constant of 4 s: 3 known to 3/sqrt(30), skewed upwards.
            let mode = band_kurtosis(&record(seed, 0.0, 7.3), 4.0).unwrap();
            assert!(mode > HALF_WAY - 0.3, "{seed}: {mode}");
        }
        let data = record(1, 0.5, 7.3);
        assert!(harmonic_line(&data, TAU * 7.3, 2e-4).is_some());
        // A damping of 1 % is none of a machine, whatever the kurtosis; and the mode is none.
        assert_eq!(harmonic_line(&data, TAU * 7.3, 0.01), None);
        assert_eq!(harmonic_line(&record(1, 0.0, 7.3), TAU * 4.0, 0.01), None);
        assert_eq!(band_kurtosis(&data, 0.1), None);
    }
}
