//! What a model leaves of the measured acceleration, and whether that looks like noise.

use crumple_numerics::estimation::statistics::NORMAL_95;

/// Share of the compared window up to which lags are looked at.
const LAGS: usize = 4;
/// Most lags, beside lag 0: no picture shows more, and a record of 2 s at 20 kHz has 10,000 of them.
const MOST_LAGS: usize = 300;

/// Acceleration of the test minus that of a model over the compared window.
#[derive(Debug, Clone, PartialEq)]
pub struct Residual {
    /// Root mean square, m/s².
    pub rms_m_per_s2: f64,
    /// That over the root mean square of the test.
    pub share_of_test: f64,
    /// Samples compared.
    pub samples: usize,
    /// Distance of the lags, s.
    pub lag_s: f64,
    /// Autocorrelation of what is left but its mean, at the lags 0, 1, ... up to a quarter of the window; of more than
    /// 301 lags every second, third, ...
    pub autocorrelation: Vec<f64>,
    /// 95 % limits of the autocorrelation of white noise of so many samples: `1.96/sqrt(N)` to either side of zero.
    pub limit: f64,
    /// Share of the lags from 1 on that lie outside the limits; of white noise one in twenty does.
    pub share_outside: f64,
}

/// The residual of two accelerations on one grid of `dt_s`, m/s²; `None` where it vanishes or leaves the range of
/// numbers, or of a test of zeros.
///
/// The model's acceleration is that of its motion, the test's went through the filter: what the filter takes from the
/// model is part of the residual.
pub fn residual(test: &[f64], model: &[f64], dt_s: f64) -> Option<Residual> {
    let left: Vec<f64> = test.iter().zip(model).map(|(test, model)| test - model).collect();
    let count = left.len() as f64;
    let mean = left.iter().sum::<f64>() / count;
    let about_mean: Vec<f64> = left.iter().map(|left| left - mean).collect();
    let power = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>();
    let (whole, of_test, varying) = (power(&left), power(test), power(&about_mean));
    if !(varying > 0.0 && of_test > 0.0 && (whole / of_test).is_finite()) {
        return None;
    }
    let at_lag = |lag: usize| about_mean.iter().zip(&about_mean[lag..]).map(|(a, b)| a * b).sum::<f64>() / varying;
    let lags = left.len() / LAGS;
    let step = lags.div_ceil(MOST_LAGS).max(1);
    let autocorrelation: Vec<f64> = (0..=lags).step_by(step).map(at_lag).collect();
    let limit = NORMAL_95 / count.sqrt();
    let outside = autocorrelation.iter().skip(1).filter(|r| r.abs() > limit).count();
    Some(Residual {
        rms_m_per_s2: (whole / count).sqrt(),
        share_of_test: (whole / of_test).sqrt(),
        samples: left.len(),
        lag_s: step as f64 * dt_s,
        limit,
        share_outside: outside as f64 / autocorrelation.len().saturating_sub(1).max(1) as f64,
        autocorrelation,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(left: impl Fn(usize) -> f64, samples: usize) -> Residual {
        let test: Vec<f64> = (0..samples).map(|k| -100.0 + left(k)).collect();
        residual(&test, &vec![-100.0; samples], 1e-4).unwrap()
    }

    #[test]
    fn a_wave_is_left_over_and_noise_is_not() {
        let wave = of(|k| (k as f64 * 0.05).sin(), 800);
        assert_eq!((wave.samples, wave.autocorrelation.len()), (800, 201));
        assert!((wave.rms_m_per_s2 - 0.5_f64.sqrt()).abs() < 0.01 && (wave.share_of_test - 0.00707).abs() < 1e-4);
        assert!((wave.limit - 1.96 / 800_f64.sqrt()).abs() < 1e-5 && wave.share_outside > 0.9);
        // A sine comes back after its period of 125.7 samples.
        assert_eq!(wave.autocorrelation[0], 1.0);
        assert!(wave.autocorrelation[63] < -0.8 && wave.autocorrelation[126] > 0.7);
        // A linear congruential generator, its upper bits.
        let step = |state: &u64| Some(state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
        let states: Vec<u64> = std::iter::successors(Some(1), step).skip(10).take(1000).collect();
        let noise = of(|k| (states[k] >> 11) as f64 / (1_u64 << 53) as f64 - 0.5, 1000);
        assert!(noise.share_outside < 0.12, "{}", noise.share_outside);
        assert_eq!(residual(&[1.0, 2.0], &[1.0, 2.0], 1e-4), None);
        assert_eq!(residual(&[], &[], 1e-4), None);
    }

    #[test]
    fn a_long_record_has_no_more_lags_than_a_picture() {
        // 10,000 lags of a sine of 2,000 samples, every 34th of them.
        let long = of(|k| (k as f64 * std::f64::consts::TAU / 2000.0).sin(), 40_000);
        assert_eq!(long.autocorrelation.len(), 295);
        assert!((long.lag_s - 34e-4).abs() < 1e-15);
        // 59 times 34 samples are one period but six samples.
        assert!(long.autocorrelation[59] > 0.94, "{}", long.autocorrelation[59]);
    }
}
