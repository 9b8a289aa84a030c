//! Another sampling rate: by interpolation, or by keeping the samples of a filtered record that hold its information.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use crate::{FilterError, Sampled};

/// Zeros of the sinc to each side of its middle.
const ZEROS: f64 = 32.0;
/// Shape of the Kaiser window: side lobes of -100 dB.
const KAISER_BETA: f64 = 10.0;
/// Corner of the low-pass over half the lower rate: the window's transition ends at half the rate.
const CORNER: f64 = 0.9;
/// Rates whose ratio is a fraction with a denominator up to this need that many kernels, which are made once.
const MOST_KERNELS: usize = 4096;
/// Most samples made of one.
const MOST_UPSAMPLING: f64 = 1000.0;

/// How values between samples are found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Windowed sinc with a low-pass against aliasing: exact to 1e-4 up to 0.4 of the lower rate.
    #[default]
    Sinc,
    /// Straight lines between samples, no low-pass: what ISO/TS 18571 asks for; aliases what is above half the new
    /// rate.
    Linear,
}

/// A new sampling rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Resampling {
    /// The rate, Hz.
    pub rate_hz: f64,
    /// How values between samples are found.
    pub interpolation: Interpolation,
}

impl Interpolation {
    /// The name used in notes.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sinc => "windowed sinc",
            Self::Linear => "linear",
        }
    }
}

/// Brings a record to another sampling rate; its grid then contains t = 0, and no sample lies outside the record.
///
/// `sinc`: 32 zeros to each side, Kaiser window (β = 10), corner at 0.45 of the lower of both rates, weights that sum
/// to one. What lies below 0.4 of the lower rate passes to 1e-4, what lies above half of it is down by 80 dB. Near the
/// ends the record is continued by point reflection, as the class filters do; the first and last 36 intervals of the
/// lower rate, the reach of the kernel, are no better than that. `linear` errs by `T²·max|a''|/8`.
///
/// The figures follow from Kaiser's formulas (Oppenheim & Schafer, *Discrete-Time Signal Processing*, chapter 7):
/// β = 10 is an attenuation of 99 dB, and over 72 intervals the transition is 0.09 of the lower rate wide, half of it
/// to each side of the corner. Cost: 72 products for each new sample, times the ratio of the rates when it falls.
/// Weights are made once for each place between two samples; the places repeat where the ratio is a fraction.
///
/// # Errors
/// A rate that is not positive or above 1000 times the record's; a record of fewer than two samples, or one that no
/// point of the new grid falls into; a result that is not finite.
pub fn resample(record: &Sampled, to: Resampling) -> Result<Sampled, FilterError> {
    let (from_hz, to_hz) = (record.rate_hz(), to.rate_hz);
    if !(to_hz.is_finite() && to_hz > 0.0 && to_hz <= MOST_UPSAMPLING * from_hz) {
        return Err(FilterError::ResampleRate { to_hz, from_hz });
    }
    let dt_s = 1.0 / to_hz;
    let first = (record.t0_s() / dt_s - 1e-6).ceil();
    let last = (record.end_s() / dt_s + 1e-6).floor();
    if record.len() < 2 || last < first {
        return Err(FilterError::TooShortToResample { samples: record.len() });
    }
    let t0_s = first * dt_s;
    // A cast saturates; the rate is bounded by the record's, so the count is by its length.
    let count = (last - first) as usize + 1;
    let ratio = dt_s / record.dt_s();
    let start = (t0_s - record.t0_s()) / record.dt_s();
    let samples = match to.interpolation {
        Interpolation::Linear => (0..count).map(|k| linear(record.samples(), start + k as f64 * ratio)).collect(),
        Interpolation::Sinc => sinc(record.samples(), start, ratio, count),
    };
    Sampled::new(t0_s, dt_s, samples).map_err(FilterError::Result)
}

/// The value on the straight line between the samples around `position`, which counts samples from 0 and is kept inside
/// the record.
fn linear(x: &[f64], position: f64) -> f64 {
    let position = position.clamp(0.0, (x.len() - 1) as f64);
    let k = (position as usize).min(x.len() - 2);
    x[k] + (position - k as f64) * (x[k + 1] - x[k])
}

/// The kernel as a function of the distance from its middle: a sinc under a Kaiser window.
struct Shape {
    /// The window at equal steps from its middle to its edge; straight lines between them err by 1e-6.
    window: Vec<f64>,
    /// Corner, cycles a sample of the record.
    corner: f64,
    /// Samples to each side.
    reach: usize,
}

/// Steps of the tabulated window.
const WINDOW_STEPS: usize = 4096;

impl Shape {
    /// The kernel for a corner in cycles a sample; its 32 zeros to each side are `1/(2·corner)` samples apart.
    fn new(corner: f64) -> Self {
        let window = (0..=WINDOW_STEPS + 1).map(|i| {
            let u = i as f64 / WINDOW_STEPS as f64;
            bessel_i0(KAISER_BETA * (1.0 - u * u).max(0.0).sqrt())
        });
        Self { window: window.collect(), corner, reach: (ZEROS / (2.0 * corner)).ceil() as usize }
    }

    /// The kernel for a place between two samples; `fraction` is its distance from the one before, 0 to 1.
    fn at(&self, fraction: f64) -> Kernel {
        let half_width = self.reach as f64;
        let step = 2.0 * PI * self.corner;
        let (turn_sin, turn_cos) = step.sin_cos();
        let first = 1.0 - half_width - fraction;
        // The sines are of equally spaced angles, so each comes from the one before by a rotation.
        let (mut sin, mut cos) = (step * first).sin_cos();
        let mut weights: Vec<f64> = (0..2 * self.reach)
            .map(|i| {
                let distance = first + i as f64;
                let x = step * distance;
                let sinc = if x.abs() < 1e-9 { 1.0 } else { sin / x };
                (sin, cos) = (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin);
                let place = (distance.abs() / half_width).min(1.0) * WINDOW_STEPS as f64;
                let below = place as usize;
                let (w0, w1) = (self.window[below], self.window[below + 1]);
                sinc * (w0 + (place - below as f64) * (w1 - w0))
            })
            .collect();
        let sum: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|w| *w /= sum);
        Kernel { weights }
    }
}

/// Weights of the samples around a position, for one place of it between two samples.
struct Kernel {
    weights: Vec<f64>,
}

impl Kernel {
    /// The value after sample `k`.
    fn at(&self, x: &[f64], k: usize) -> f64 {
        let reach = self.weights.len() / 2;
        if k + 1 >= reach && k + reach < x.len() {
            let window = &x[k + 1 - reach..=k + reach];
            return self.weights.iter().zip(window).map(|(w, x)| w * x).sum();
        }
        let around = (0..self.weights.len()).map(|i| reflected(x, (k + 1 + i).cast_signed() - reach.cast_signed()));
        self.weights.iter().zip(around).map(|(w, x)| w * x).sum()
    }
}

/// A sample of the record continued by point reflection about its ends, `2·x[0] - x[-k]` on the left, and beyond the
/// length of the record by the reflection of its far end.
fn reflected(x: &[f64], k: isize) -> f64 {
    let last = x.len().cast_signed() - 1;
    let inside = |k: isize| x[k.clamp(0, last) as usize];
    if k < 0 {
        2.0 * x[0] - inside(-k)
    } else if k > last {
        2.0 * inside(last) - inside(2 * last - k)
    } else {
        inside(k)
    }
}

/// `count` values of the band-limited interpolant at the positions `start + k·ratio`, in samples of the record;
/// `ratio` is the new interval over the old.
///
/// Where q new intervals are a whole number of old ones, for a q up to 4096, the q sets of weights are made once; for
/// any other ratio the 2·reach weights of every sample are made afresh.
fn sinc(x: &[f64], start: f64, ratio: f64, count: usize) -> Vec<f64> {
    // Cycles a sample of the record; half the lower rate is 0.5 or 0.5/ratio.
    let corner = CORNER * 0.5 / ratio.max(1.0);
    let shape = Shape::new(corner);
    let place = |k: usize| {
        let position = (start + k as f64 * ratio).clamp(0.0, (x.len() - 1) as f64);
        // A position a rounding below a sample is at that sample.
        let sample = (position + 1e-9).floor();
        (sample as usize, (position - sample).max(0.0))
    };
    // Whole turns after which the places between samples repeat, to a millionth of a sample over the whole record.
    let period = (1..=MOST_KERNELS.min(count)).find(|&q| {
        let turns = q as f64 * ratio;
        turns >= 0.5 && (turns - turns.round()).abs() * (count as f64) < 1e-6 * q as f64
    });
    match period {
        Some(period) => {
            let turns = (period as f64 * ratio).round() as usize;
            let kernels: Vec<(usize, Kernel)> = (0..period)
                .map(|k| {
                    let (sample, fraction) = place(k);
                    (sample, shape.at(fraction))
                })
                .collect();
            (0..count)
                .map(|k| {
                    let (sample, kernel) = &kernels[k % period];
                    kernel.at(x, (sample + k / period * turns).min(x.len() - 1))
                })
                .collect()
        }
        None => (0..count)
            .map(|k| {
                let (sample, fraction) = place(k);
                shape.at(fraction).at(x, sample)
            })
            .collect(),
    }
}

/// Modified Bessel function of the first kind, order 0, by its power series `Σ (x²/4)^k/(k!)²`; for arguments up to 20,
/// to rounding. The Kaiser window is `I0(β·√(1 - u²))`, u from -1 to 1; its constant factor drops out of weights that
/// sum to one.
fn bessel_i0(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..60 {
        term *= quarter / f64::from(k * k);
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    sum
}

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
    use crate::{Cfc, CfcMode, Coefficients, IntegrationRule, filter_both_ways, integrate_twice};

    fn tone(rate_hz: f64, n: usize, f: f64) -> Sampled {
        let wave = (0..n).map(|k| (2.0 * PI * f * (k as f64 / rate_hz - 0.05)).sin());
        Sampled::new(-0.05, 1.0 / rate_hz, wave.collect()).unwrap()
    }

    fn largest_error(resampled: &Sampled, f: f64, margin: usize) -> f64 {
        (margin..resampled.len() - margin)
            .map(|k| (resampled.samples()[k] - (2.0 * PI * f * resampled.time_s(k)).sin()).abs())
            .fold(0.0, f64::max)
    }

    #[test]
    fn a_tone_below_0_4_of_the_lower_rate_is_found_again_at_any_rate() {
        for to_hz in [8000.0, 9600.0, 12_345.678, 20_000.0, 51_200.0] {
            let resampled = resample(
                &tone(20_000.0, 6000, 3000.0),
                Resampling { rate_hz: to_hz, interpolation: Interpolation::Sinc },
            )
            .unwrap();
            // The promise of the kernel; the margin is its reach.
            let margin = (40.0 * (to_hz / 20_000.0_f64).max(1.0)).ceil() as usize;
            assert!(
                largest_error(&resampled, 3000.0, margin) < 1e-4,
                "{to_hz}: {}",
                largest_error(&resampled, 3000.0, margin)
            );
            assert!(
                (resampled.time_s(resampled.index_at_or_after(0.0))).abs() < 1e-12,
                "{to_hz}: the grid contains t = 0"
            );
        }
    }

    #[test]
    fn a_tone_above_half_the_new_rate_is_gone_and_with_straight_lines_it_aliases() {
        let record = tone(20_000.0, 6000, 6500.0);
        let at = |interpolation| {
            let resampled = resample(&record, Resampling { rate_hz: 10_000.0, interpolation }).unwrap();
            resampled.samples()[100..2900].iter().fold(0.0_f64, |largest, x| largest.max(x.abs()))
        };
        // -80 dB.
        assert!(at(Interpolation::Sinc) < 1e-4, "{}", at(Interpolation::Sinc));
        assert!(at(Interpolation::Linear) > 0.9);
    }

    #[test]
    fn a_straight_line_stays_one_to_its_ends() {
        let line = Sampled::new(-0.01, 1e-4, (0..300).map(|k| 3.0 - 0.5 * f64::from(k)).collect()).unwrap();
        for interpolation in [Interpolation::Linear, Interpolation::Sinc] {
            let resampled = resample(&line, Resampling { rate_hz: 25_000.0, interpolation }).unwrap();
            for (k, y) in resampled.samples().iter().enumerate() {
                let expected = 3.0 - 0.5 * (resampled.time_s(k) + 0.01) / 1e-4;
                // Weights that are symmetric to their truncation, 1e-5, times a slope of 0.5 over 32 samples.
                assert!((y - expected).abs() < 1e-4, "{interpolation:?} {k}: {y} {expected}");
            }
        }
    }

    #[test]
    fn refuses_rates_that_are_none() {
        let record = tone(1000.0, 100, 10.0);
        for rate_hz in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e7] {
            let to = Resampling { rate_hz, interpolation: Interpolation::Sinc };
            assert!(matches!(resample(&record, to), Err(FilterError::ResampleRate { .. })), "{rate_hz}");
        }
        let to = Resampling { rate_hz: 1e-3, interpolation: Interpolation::Linear };
        assert_eq!(resample(&record, to).unwrap().len(), 1);
        let after_zero = record.starting_at(0.1).unwrap();
        assert!(matches!(resample(&after_zero, to), Err(FilterError::TooShortToResample { .. })));
    }

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
        let pulse = |t: f64| if (0.0..0.1).contains(&t) { -200.0 * (PI * t / 0.1).sin() } else { 0.0 };
        let raw: Vec<f64> = (0..200_001).map(|k| pulse(k as f64 * dt_s - 0.05) + 400.0 * noise()).collect();
        for cfc in [Cfc::Cfc60, Cfc::Cfc180] {
            let coefficients = Coefficients::new(cfc, CfcMode::default(), dt_s);
            let full = Sampled::new(-0.05, dt_s, filter_both_ways(&raw, 0.0, &coefficients).unwrap()).unwrap();
            let every = keep_every(1e6, cfc.frequency_hz() / 0.6, 0.0);
            let few = kept(&full, every).unwrap();
            // From the first to the last sample that both have.
            let first = ((few.t0_s() - full.t0_s()) / dt_s).round() as usize;
            let between = full.samples()[first..=first + (few.len() - 1) * every].to_vec();
            let full = Sampled::new(few.t0_s(), dt_s, between).unwrap();
            let motion = |record: &Sampled| {
                let (v, x) = integrate_twice(record.samples(), record.dt_s(), IntegrationRule::Trapezoid, 0.0, 0.0);
                (v[v.len() - 1], x[x.len() - 1])
            };
            let ((v, x), (v_few, x_few)) = (motion(&full), motion(&few));
            // Of the pulse's own change of velocity and what it comes to as a displacement.
            assert!((v - v_few).abs() < 5e-6 * 12.7, "cfc {cfc}: {v} {v_few}");
            assert!((x - x_few).abs() < 5e-6 * 1.27, "cfc {cfc}: {x} {x_few}");
        }
    }
}
