//! Centred moving averages.

/// Samples of the running sum after which it is summed afresh, so that rounding does not grow with the record.
const AFRESH: usize = 1024;

/// Samples in a moving average of a width: the odd number nearest to `width/dt`, at least 1. Odd, so that the window
/// has a sample in its middle and no phase; the width is met to one interval.
pub fn samples_of_width(width_s: f64, dt_s: f64) -> usize {
    // A float-to-integer cast saturates.
    2 * ((width_s / dt_s - 1.0) / 2.0).round().max(0.0) as usize + 1
}

/// Subtracts a level, then replaces each sample by the mean of the `width` samples around it; `width` is odd.
///
/// No phase. Near the ends the window shrinks, the sample staying in its middle, so that a straight line passes
/// unchanged everywhere. Gain `|sin(π·f·w)/(π·f·w)|` for a width of w seconds (-3 dB at 0.443/w, first zero at 1/w):
/// a crude low-pass that lets through side lobes of -13 dB. Rounding about 1e-13 of the largest sample.
pub fn moving_average(samples: &[f64], level: f64, width: usize) -> Vec<f64> {
    let n = samples.len();
    let half = width / 2;
    let mut output = Vec::with_capacity(n);
    let mut sum = 0.0;
    for k in 0..n {
        let reach = half.min(k).min(n - 1 - k);
        if reach < half || k % AFRESH == 0 || k == half {
            sum = samples[k - reach..=k + reach].iter().sum();
        } else {
            sum += samples[k + half] - samples[k - half - 1];
        }
        output.push(sum / (2 * reach + 1) as f64 - level);
    }
    output
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Amplitude gain of a moving average of `width` samples: `|sin(π·f·w·T)/(w·sin(π·f·T))|`.
    fn moving_average_gain(width: usize, dt_s: f64, frequency_hz: f64) -> f64 {
        let x = std::f64::consts::PI * frequency_hz * dt_s;
        if x.sin() == 0.0 { 1.0 } else { ((width as f64 * x).sin() / (width as f64 * x.sin())).abs() }
    }

    #[test]
    fn the_window_shrinks_at_the_ends() {
        // Literals: means of 1, 3, 5, 3, 1 samples.
        assert_eq!(moving_average(&[1.0, 2.0, 6.0, 2.0, 4.0], 0.0, 5), [1.0, 3.0, 3.0, 4.0, 4.0]);
        assert_eq!(moving_average(&[5.0, 7.0], 2.0, 1), [3.0, 5.0]);
        assert_eq!(moving_average(&[], 0.0, 3), [] as [f64; 0]);
        assert_eq!(
            (samples_of_width(5e-3, 1e-3), samples_of_width(4.4e-3, 1e-4), samples_of_width(0.0, 1.0)),
            (5, 45, 1)
        );
    }

    #[test]
    fn the_running_sum_is_the_sum_however_long_the_record() {
        let samples: Vec<f64> = (0..10_000).map(|k| 1e3 * (0.1 * f64::from(k)).sin()).collect();
        let averaged = moving_average(&samples, 0.0, 101);
        for k in 50..9950 {
            let mean = samples[k - 50..=k + 50].iter().sum::<f64>() / 101.0;
            // 1024 additions of numbers up to 1e3 to a sum up to 2e4, divided by 101: 1e-11.
            assert!((averaged[k] - mean).abs() < 1e-10, "{k}");
        }
    }

    #[test]
    fn a_sine_passes_with_the_gain_of_the_closed_form() {
        let (dt_s, f) = (1e-3, 40.0);
        let wave: Vec<f64> = (0..1000).map(|k| (2.0 * std::f64::consts::PI * f * f64::from(k) * dt_s).sin()).collect();
        let gain = moving_average_gain(11, dt_s, f);
        for (y, x) in moving_average(&wave, 0.0, 11).iter().zip(&wave).skip(5).take(990) {
            assert!((y - gain * x).abs() < 1e-12);
        }
    }
}
