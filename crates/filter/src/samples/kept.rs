//! Which samples of a filtered record are kept: its information, not its sampling rate, decides.

use crumple_signal::Sampled;

use crate::FilterError;

/// Records up to this rate keep every sample, Hz.
const ORDINARY_HZ: f64 = 20e3;
/// The lowest rate that is kept unless the class asks for more, Hz.
const LOWEST_HZ: f64 = 10e3;
/// The kept rate over the -3 dB frequency of the filter, CFC/0.6: at half the kept rate both passes leave
/// `1/(1 + 50⁴)`.
const CORNERS: f64 = 100.0;

/// Every n-th sample to keep of a record behind a filter with this -3 dB frequency; 1: all of them.
///
/// A record above 20 kHz keeps at least 10 kHz, at least 100 times the -3 dB frequency, and at least `lowest_hz`. What
/// lies above half the kept rate and would fold back is down by `50⁴`, 136 dB: white noise of 1 m/s² a sample folds
/// back less than 2e-7 m/s². The trapezoidal rule over the kept samples errs by `(ω·T)²/12` of a component: 3e-4 at the
/// -3 dB frequency itself, 3e-6 at a tenth of it, where a crash pulse has its motion.
pub fn keep_every(rate_hz: f64, half_power_hz: f64, lowest_hz: f64) -> usize {
    if rate_hz <= ORDINARY_HZ * (1.0 + 1e-9) {
        return 1;
    }
    let needed_hz = LOWEST_HZ.max(CORNERS * half_power_hz).max(lowest_hz);
    // A typed interval gives a rate that is off by its last digit.
    ((rate_hz / needed_hz * (1.0 + 1e-9)).floor() as usize).max(1)
}

/// Every `every`-th sample; the one nearest to t = 0 is among them where the record reaches it.
///
/// # Errors
/// Never for a record that was sampled evenly; those of [`Sampled::new`].
pub fn kept(record: &Sampled, every: usize) -> Result<Sampled, FilterError> {
    let every = every.max(1);
    let zero = (-record.t0_s() / record.dt_s()).round();
    let first = if zero > 0.0 { zero as usize % every } else { 0 };
    // A record shorter than that keeps its first sample.
    let first = if first < record.len() { first } else { 0 };
    let samples = record.samples().iter().skip(first).step_by(every).copied().collect();
    let t0_s = record.t0_s() + first as f64 * record.dt_s();
    Sampled::new(t0_s, every as f64 * record.dt_s(), samples).map_err(FilterError::Result)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cfc, Coefficients, Mode, filter_both_ways};

    #[test]
    fn ordinary_rates_keep_all_and_others_a_multiple_of_the_corner() {
        let every = |rate_hz: f64, cfc: Cfc| keep_every(rate_hz, cfc.frequency_hz() / 0.6, 0.0);
        for rate_hz in [1e3, 10e3, 12.5e3, 20e3] {
            assert_eq!(every(rate_hz, Cfc::Cfc60), 1, "{rate_hz}");
        }
        assert_eq!([25e3, 100e3, 1e6, 4e6].map(|rate_hz| every(rate_hz, Cfc::Cfc60)), [2, 10, 100, 400]);
        assert_eq!([25e3, 100e3, 1e6].map(|rate_hz| every(rate_hz, Cfc::Cfc180)), [1, 3, 33]);
        assert_eq!([100e3, 1e6].map(|rate_hz| every(rate_hz, Cfc::Cfc1000)), [1, 6]);
        assert_eq!(keep_every(1e6, 100.0, 50e3), 20);
        // 1/1e-6 is not 1e6 to the last digit.
        assert_eq!(every(1.0 / 1e-6, Cfc::Cfc60), 100);
    }

    #[test]
    fn the_sample_at_time_zero_is_kept() {
        let record = Sampled::new(-7e-6, 1e-6, (0..40).map(f64::from).collect()).unwrap();
        let few = kept(&record, 5).unwrap();
        assert_eq!(few.samples()[..3], [2.0, 7.0, 12.0]);
        assert!((few.t0_s() + 5e-6).abs() < 1e-15 && (few.dt_s() - 5e-6).abs() < 1e-18);
        let after = Sampled::new(3e-6, 1e-6, vec![1.0; 9]).unwrap();
        assert_eq!((kept(&after, 4).unwrap().t0_s(), kept(&after, 4).unwrap().len()), (3e-6, 3));
    }

    /// The trapezoidal rule twice, and the last value of both.
    fn motion(record: &Sampled) -> (f64, f64) {
        let dt = record.dt_s();
        let (mut v, mut x) = (0.0, 0.0);
        for pair in record.samples().windows(2) {
            let before = v;
            v += 0.5 * dt * (pair[0] + pair[1]);
            x += 0.5 * dt * (before + v);
        }
        (v, x)
    }

    /// A pulse of 100 ms with noise as large as the pulse: velocity and crush from a hundredth of the samples are those
    /// from all of them.
    #[test]
    fn what_is_left_out_changes_no_motion() {
        let dt_s = 1e-6;
        let mut state = 1_u64;
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let pulse =
            |t: f64| if (0.0..0.1).contains(&t) { -200.0 * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 };
        let raw: Vec<f64> = (0..200_001).map(|k| pulse(k as f64 * dt_s - 0.05) + 400.0 * noise()).collect();
        for cfc in [Cfc::Cfc60, Cfc::Cfc180] {
            let coefficients = Coefficients::new(cfc, Mode::default(), dt_s);
            let full = Sampled::new(-0.05, dt_s, filter_both_ways(&raw, 0.0, &coefficients).unwrap()).unwrap();
            let every = keep_every(1e6, cfc.frequency_hz() / 0.6, 0.0);
            let few = kept(&full, every).unwrap();
            // From the first to the last sample that both have.
            let first = ((few.t0_s() - full.t0_s()) / dt_s).round() as usize;
            let between = full.samples()[first..=first + (few.len() - 1) * every].to_vec();
            let full = Sampled::new(few.t0_s(), dt_s, between).unwrap();
            let ((v, x), (v_few, x_few)) = (motion(&full), motion(&few));
            // Of the pulse's own change of velocity and what it comes to as a displacement.
            assert!((v - v_few).abs() < 5e-6 * 12.7, "cfc {cfc}: {v} {v_few}");
            assert!((x - x_few).abs() < 5e-6 * 1.27, "cfc {cfc}: {x} {x_few}");
        }
    }
}
