//! Uniformly sampled signals and the zero level before the event.

use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

use serde::Serialize;

use crate::{Quantity, QuantityKind};

// Zero level and noise of a channel before the event.

/// Shortest stretch of pre-event data that gives a zero level, s.
const SHORTEST_S: f64 = 0.01;

/// Runs of exact zeros at the start of a record up to this long are samples like others; longer ones are a muted
/// recorder.
const FEW_ZEROS: usize = 10;
/// A run of zeros that is less probable than this among the samples behind it is a muted recorder.
const BY_CHANCE: f64 = 1e-3;

/// Slack for time stamps that are sums of a decimal interval, s.
const SLACK_S: f64 = 1e-9;

/// Where the zero level is read, s from contact, both ends included.
///
/// The usual one, -50 ms to -10 ms, is clear of the electrical noise of a trigger and of early contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PreEventWindow {
    /// First sample at or after this time.
    pub from_s: f64,
    /// Last sample at or before this time.
    pub to_s: f64,
}

impl PreEventWindow {
    /// -50 ms to -10 ms.
    pub(crate) const USUAL: Self = Self { from_s: -0.05, to_s: -0.01 };

    /// The usual window with the ends that somebody states in place of its own.
    pub fn stated(from_s: Option<f64>, to_s: Option<f64>) -> Self {
        Self { from_s: from_s.unwrap_or(Self::USUAL.from_s), to_s: to_s.unwrap_or(Self::USUAL.to_s) }
    }
}

/// Zero level and noise before the event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PreEvent {
    /// Mean of the samples in the window, SI.
    pub zero_level: f64,
    /// Their standard deviation about it (divisor n), SI.
    pub noise_floor: f64,
    /// Time of the first, s.
    pub from_s: f64,
    /// Time of the last, s.
    pub to_s: f64,
    /// How many they are.
    pub samples: usize,
    /// Samples in front of them that are exactly 0 and not counted: the recorder was muted.
    pub muted: usize,
}

/// Mean and standard deviation from 50 ms to 10 ms before contact, as far as the record covers it; `None` if that is
/// less than 10 ms.
///
/// The mean is wrong by about the noise floor over the square root of the number of samples. A wrong zero level δ adds
/// δ·t to the velocity and δ·t²/2 to the displacement: 0.1 g over 100 ms is 0.098 m/s and 4.9 mm. Never the mean of the
/// whole record: a crash pulse has one.
///
/// A record that begins with more than ten samples of exactly 0 was muted until then (NHTSA's TDMS files): that run is
/// not counted. A window of nothing but such zeros is taken as it is, as computed records have it. A sensor with a
/// coarse step rests at 0 for long: it is not muted where the share of zeros behind the run makes such a run probable.
pub fn pre_event(samples: &Sampled) -> Option<PreEvent> {
    pre_event_within(samples, PreEventWindow::USUAL)
}

/// [`pre_event`] in another window: one that somebody stated, or a part of the usual one.
pub fn pre_event_within(samples: &Sampled, window: PreEventWindow) -> Option<PreEvent> {
    let from = samples.index_at_or_after(window.from_s - SLACK_S);
    let to = samples.index_at_or_after(window.to_s + SLACK_S);
    // A sample inside the slack belongs to the window; `index_at_or_after` has a slack of its own, in intervals.
    let to = if to < samples.len() && samples.time_s(to) <= window.to_s + SLACK_S { to + 1 } else { to };
    let muted = samples.samples().iter().take(to).take_while(|x| **x == 0.0).count();
    let muted = if (FEW_ZEROS + 1..to).contains(&muted) && !rests(&samples.samples()[..to], muted) { muted } else { 0 };
    let from = from.max(muted);
    let inside = samples.samples().get(from..to).filter(|inside| !inside.is_empty())?;
    let (from_s, to_s) = (samples.time_s(from), samples.time_s(to - 1));
    if to_s - from_s < SHORTEST_S - SLACK_S {
        return None;
    }
    let n = inside.len() as f64;
    let zero_level = inside.iter().sum::<f64>() / n;
    let noise_floor = (inside.iter().map(|x| (x - zero_level).powi(2)).sum::<f64>() / n).sqrt();
    let level = PreEvent { zero_level, noise_floor, from_s, to_s, samples: inside.len(), muted };
    // Samples near the end of the range of numbers have squares beyond it.
    (zero_level.is_finite() && noise_floor.is_finite()).then_some(level)
}

/// Whether a run of so many zeros at the start is probable ([`BY_CHANCE`]) where zeros are as frequent as behind it, by
/// Laplace's rule of succession `(k + 1)/(n + 2)`.
fn rests(samples: &[f64], run: usize) -> bool {
    let behind = &samples[run..];
    let zeros = behind.iter().filter(|x| **x == 0.0).count();
    let share = (zeros + 1) as f64 / (behind.len() + 2) as f64;
    share.powf(run as f64) >= BY_CHANCE
}

/// Share of equal neighbours from which on a sensor is coarse: noise of the size of its step makes `1/(2·√π)` = 0.28 of
/// them equal, smaller noise more.
const EQUAL_NEIGHBOURS: f64 = 0.3;
/// Neighbours that are not equal differ by so many steps at most, at their median. With so many equal ones a motion
/// passes a step in more than a sample, and most differ by one. Repeated samples of a fine sensor do not.
const STEPS_APART: f64 = 2.5;
/// Differences below this share of the largest sample are rounding of a unit.
const ROUNDING: f64 = 1e-9;

/// The step of a coarse sensor, whose samples repeat because its noise is smaller than the step: the smallest
/// difference of neighbours while the signal is active, from the first to the last sample of a tenth of the largest.
/// `None` for a finer sensor.
pub fn coarse_step(samples: &[f64]) -> Option<f64> {
    let largest = samples.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let is_active = |x: &f64| x.abs() > 0.1 * largest;
    let active = &samples[samples.iter().position(is_active)?..=samples.iter().rposition(is_active)?];
    let differences = active.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut steps: Vec<f64> = differences.filter(|step| *step > ROUNDING * largest).collect();
    let equal = active.len().saturating_sub(1 + steps.len());
    let smallest = steps.iter().copied().reduce(f64::min)?;
    let middle = steps.len() / 2;
    let median = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    let is_coarse = equal as f64 >= EQUAL_NEIGHBOURS * active.len() as f64 && median <= STEPS_APART * smallest;
    is_coarse.then_some(smallest)
}

// Uniformly sampled signals.

/// Why samples do not form a signal.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SignalError {
    /// The sampling interval is zero, negative or not finite.
    #[error("sampling interval {0} s is not a positive number")]
    Interval(f64),
    /// The time of the first sample is not finite.
    #[error("time of the first sample {0} s is not finite")]
    Start(f64),
    /// A sample is NaN or infinite.
    #[error("sample {index} (t = {time_s:.6} s) is {value}, a finite number is needed")]
    NotFinite {
        /// Index of the first such sample.
        index: usize,
        /// Its time.
        time_s: f64,
        /// NaN, inf or -inf.
        value: f64,
    },
    /// The samples measure something else.
    #[error("the samples are {found}, {needed} is needed")]
    Quantity {
        /// What they are.
        found: QuantityKind,
        /// What was asked for.
        needed: QuantityKind,
    },
}

/// Samples on a uniform time grid, whatever they measure: `t(k) = t0_s + k·dt_s`.
///
/// Always: `dt_s` is positive, `t0_s` and every sample are finite. The samples are shared: a clone or a
/// [`slice`](Self::slice) costs nothing, whatever the length of the record.
#[derive(Debug, Clone)]
pub struct Sampled {
    t0_s: f64,
    dt_s: f64,
    samples: Arc<Vec<f64>>,
    /// The part of the shared samples that is meant.
    part: Range<usize>,
}

/// Same grid and same samples.
impl PartialEq for Sampled {
    fn eq(&self, other: &Self) -> bool {
        self.t0_s == other.t0_s && self.dt_s == other.dt_s && self.samples() == other.samples()
    }
}

impl Sampled {
    /// Checks the grid and the samples and takes them. Errors: [`SignalError`].
    pub fn new(t0_s: f64, dt_s: f64, samples: Vec<f64>) -> Result<Self, SignalError> {
        if !(dt_s.is_finite() && dt_s > 0.0) {
            return Err(SignalError::Interval(dt_s));
        }
        if !t0_s.is_finite() {
            return Err(SignalError::Start(t0_s));
        }
        if let Some(index) = first_not_finite(&samples) {
            return Err(SignalError::NotFinite { index, time_s: t0_s + index as f64 * dt_s, value: samples[index] });
        }
        let part = 0..samples.len();
        Ok(Self { t0_s, dt_s, samples: Arc::new(samples), part })
    }

    /// The same samples on a time axis whose first sample is at `t0_s`, which must be finite.
    pub fn starting_at(&self, t0_s: f64) -> Result<Self, SignalError> {
        if !t0_s.is_finite() {
            return Err(SignalError::Start(t0_s));
        }
        Ok(Self { t0_s, ..self.clone() })
    }

    /// Time of sample 0, s.
    pub fn t0_s(&self) -> f64 {
        self.t0_s
    }

    /// Sampling interval, s.
    pub fn dt_s(&self) -> f64 {
        self.dt_s
    }

    /// Sampling rate, Hz.
    pub fn rate_hz(&self) -> f64 {
        1.0 / self.dt_s
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.part.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.part.is_empty()
    }

    /// The samples, SI.
    pub fn samples(&self) -> &[f64] {
        &self.samples[self.part.clone()]
    }

    /// The samples, taken out; copied if they are shared with another signal or part of a longer one.
    pub fn into_samples(self) -> Vec<f64> {
        let Self { samples, part, .. } = self;
        match Arc::try_unwrap(samples) {
            Ok(whole) if part.len() == whole.len() => whole,
            Ok(whole) => whole[part].to_vec(),
            Err(shared) => shared[part].to_vec(),
        }
    }

    /// Time of sample `index`, s. `index` may lie past the end.
    pub fn time_s(&self, index: usize) -> f64 {
        self.t0_s + index as f64 * self.dt_s
    }

    /// Time of the last sample, s; `t0_s` if there is none.
    pub fn end_s(&self) -> f64 {
        self.time_s(self.len().saturating_sub(1))
    }

    /// All sample times, s.
    pub fn times_s(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.len()).map(|k| self.time_s(k))
    }

    /// First index whose time is at or after `t_s`, with a slack of `1e-6·dt` for rounding; at most `len`.
    pub fn index_at_or_after(&self, t_s: f64) -> usize {
        let k = ((t_s - self.t0_s) / self.dt_s - 1e-6).ceil();
        if k <= 0.0 { 0 } else { (k as usize).min(self.len()) }
    }

    /// The part with indices `from..to` (clamped to the record), on the same grid. Nothing is copied.
    pub fn slice(&self, from: usize, to: usize) -> Self {
        let to = to.min(self.len());
        let from = from.min(to);
        Self {
            t0_s: self.time_s(from),
            dt_s: self.dt_s,
            samples: Arc::clone(&self.samples),
            part: self.part.start + from..self.part.start + to,
        }
    }

    /// Linear interpolation at `t_s`; `None` outside the record.
    pub fn at(&self, t_s: f64) -> Option<f64> {
        let x = (t_s - self.t0_s) / self.dt_s;
        if self.is_empty() || x < -1e-9 || x > self.len() as f64 - 1.0 + 1e-9 {
            return None;
        }
        let k = (x.max(0.0) as usize).min(self.len() - 1);
        let next = (k + 1).min(self.len() - 1);
        let w = (x - k as f64).clamp(0.0, 1.0);
        let samples = self.samples();
        Some(samples[k] + w * (samples[next] - samples[k]))
    }
}

/// Index of the first NaN or infinity. Whole blocks are checked at once, at the speed of memory.
fn first_not_finite(samples: &[f64]) -> Option<usize> {
    const BLOCK: usize = 1024;
    let bad = samples.chunks(BLOCK).position(|block| !block.iter().fold(true, |all, x| all & x.is_finite()))?;
    samples[bad * BLOCK..].iter().position(|x| !x.is_finite()).map(|k| bad * BLOCK + k)
}

/// Samples that know what they measure: `Signal<Acceleration>` is in m/s².
#[derive(Debug, Clone, PartialEq)]
pub struct Signal<Q> {
    sampled: Sampled,
    quantity: PhantomData<Q>,
}

impl<Q: Quantity> Signal<Q> {
    /// Checks the grid and the samples and takes them. Errors: [`SignalError`].
    pub fn new(t0_s: f64, dt_s: f64, samples: Vec<f64>) -> Result<Self, SignalError> {
        Sampled::new(t0_s, dt_s, samples).map(Self::from)
    }

    /// The untyped samples.
    pub fn into_sampled(self) -> Sampled {
        self.sampled
    }

    /// A signal of the same quantity on the same grid with other samples, which must be finite.
    pub fn with_samples(&self, samples: Vec<f64>) -> Result<Self, SignalError> {
        Self::new(self.t0_s(), self.dt_s(), samples)
    }
}

/// Declares that the samples measure `Q`; the caller has checked it.
impl<Q: Quantity> From<Sampled> for Signal<Q> {
    fn from(sampled: Sampled) -> Self {
        Self { sampled, quantity: PhantomData }
    }
}

impl<Q> std::ops::Deref for Signal<Q> {
    type Target = Sampled;

    fn deref(&self) -> &Sampled {
        &self.sampled
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Acceleration;

    fn ramp(t0_s: f64, dt_s: f64, n: usize) -> Sampled {
        Sampled::new(t0_s, dt_s, (0..n).map(|k| k as f64).collect()).unwrap()
    }

    #[test]
    fn both_ends_of_the_window_belong_to_it() {
        let level = pre_event(&ramp(-0.06, 1e-3, 200)).unwrap();
        assert_eq!((level.samples, level.zero_level), (41, 30.0));
        // Variance of the integers -20..=20: 20·21/3.
        assert!((level.noise_floor - 140.0_f64.sqrt()).abs() < 1e-12);
        // -50.0 to -10.0 ms at 10 kHz: samples 0 to 400.
        let level = pre_event(&ramp(-0.05, 1e-4, 3500)).unwrap();
        assert_eq!((level.samples, level.zero_level), (401, 200.0));
    }

    #[test]
    fn a_muted_start_is_not_counted() {
        let record = |muted: usize| {
            let at = |k: usize| if k < muted { 0.0 } else { 2.0 };
            Sampled::new(-0.05, 1e-4, (0..3500).map(at).collect()).unwrap()
        };
        let level_after = |muted| pre_event(&record(muted)).map(|f| (f.zero_level, f.muted, f.samples));
        assert_eq!(level_after(0), Some((2.0, 0, 401)));
        assert_eq!(level_after(200), Some((2.0, 200, 201)));
        // Ten zeros may be measured ones.
        assert_eq!(level_after(10).map(|(_, muted, samples)| (muted, samples)), Some((0, 401)));
        // Less than 10 ms are left.
        assert_eq!(level_after(350), None);
        // Nothing but zeros: a computed record.
        assert_eq!(level_after(500), Some((0.0, 0, 401)));
        assert_eq!(level_after(3500), Some((0.0, 0, 401)));
    }

    #[test]
    fn a_sensor_with_a_coarse_step_is_not_muted() {
        // Seven of eight samples at rest are 0, in runs of up to 30; the first run has 24.
        let at = |k: usize| if k > 24 && (k * 7919 + k * k * 31) % 97 < 12 { 0.5 } else { 0.0 };
        let samples: Vec<f64> = (0..3500).map(at).collect();
        let run = samples.iter().take_while(|x| **x == 0.0).count();
        assert!(run > FEW_ZEROS, "{run}");
        let level = pre_event(&Sampled::new(-0.05, 1e-4, samples).unwrap()).unwrap();
        assert_eq!((level.muted, level.samples), (0, 401));
        // Zeros that are as rare as in the noise of a fine sensor do not explain the run.
        let at = |k: usize| if k > 24 && !k.is_multiple_of(9) { 0.1 * (k as f64).sin() } else { 0.0 };
        let fine = Sampled::new(-0.05, 1e-4, (0..3500).map(at).collect()).unwrap();
        assert_eq!(pre_event(&fine).unwrap().muted, 25);
    }

    #[test]
    fn the_step_of_a_coarse_sensor_is_found_and_a_fine_one_has_none() {
        let mut state = 1_u64;
        // A uniform number of the generator MMIX by Knuth.
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        // The sum of twelve is a normal one but for its tails.
        let mut noise = |size: f64| size * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0);
        let mut record = |step: f64, sd: f64| -> Vec<f64> {
            let pulse = |k: i32| if k < 500 { 0.0 } else { -200.0 * (f64::from(k - 500) * 3.1e-3).sin() };
            (0..1500).map(|k| ((pulse(k) + noise(sd)) / step).round() * step).collect()
        };
        assert!((coarse_step(&record(2.0, 0.4)).unwrap() - 2.0).abs() < 1e-9);
        // Noise of two steps: it does not repeat. Nor does a fine sensor.
        assert_eq!(coarse_step(&record(0.5, 1.0)), None);
        assert_eq!(coarse_step(&record(1e-6, 1.0)), None);
        // Every sample of a fine sensor twice.
        let twice: Vec<f64> = record(1e-6, 1.0).into_iter().flat_map(|x| [x, x]).collect();
        assert_eq!(coarse_step(&twice), None);
        assert_eq!((coarse_step(&[]), coarse_step(&[0.0; 50]), coarse_step(&[3.0; 50])), (None, None, None));
    }

    #[test]
    fn ten_milliseconds_before_the_event_are_enough_and_nine_are_not() {
        let samples = |t0_s| pre_event(&ramp(t0_s, 1e-3, 200)).map(|level| level.samples);
        assert_eq!((samples(-0.02), samples(-0.019), samples(0.0)), (Some(11), None, None));
        assert_eq!(pre_event(&ramp(-0.02, 1e-4, 2701)).map(|f| f.samples), Some(101));
        assert_eq!(pre_event(&ramp(-0.0199, 1e-4, 2701)), None);
    }

    #[test]
    fn a_window_that_ends_before_it_starts_and_samples_beyond_squares_have_none() {
        assert_eq!(pre_event_within(&ramp(-0.06, 1e-3, 200), PreEventWindow { from_s: -0.01, to_s: -0.05 }), None);
        let huge = Sampled::new(-0.06, 1e-3, (0..100).map(|k| if k % 2 == 0 { 1e300 } else { -1e300 }).collect());
        assert_eq!(pre_event(&huge.unwrap()), None);
    }

    #[test]
    fn refuses_a_nan_and_names_its_place() {
        let error = Signal::<Acceleration>::new(-0.1, 0.1, vec![0.0, 1.0, f64::NAN]).unwrap_err();
        assert_eq!(error.to_string(), "sample 2 (t = 0.100000 s) is NaN, a finite number is needed");
    }

    #[test]
    fn a_nan_late_in_a_long_record_is_found_where_it_is() {
        for bad in [0, 1023, 1024, 4999] {
            let mut samples = vec![1.0; 5000];
            samples[bad] = f64::INFINITY;
            let error = Sampled::new(0.0, 1.0, samples).unwrap_err();
            assert!(matches!(error, SignalError::NotFinite { index, .. } if index == bad), "{error:?}");
        }
    }

    #[test]
    fn a_slice_shares_its_samples_and_equals_a_record_of_its_own() {
        let whole = Sampled::new(0.0, 0.5, (0..8).map(f64::from).collect()).unwrap();
        let part = whole.slice(2, 6).slice(1, 99);
        assert_eq!(part, Sampled::new(1.5, 0.5, vec![3.0, 4.0, 5.0]).unwrap());
        assert!(std::ptr::eq(&raw const whole.samples()[3], &raw const part.samples()[0]));
        assert_eq!(part.clone().into_samples(), [3.0, 4.0, 5.0]);
        assert_eq!(part.starting_at(7.0).unwrap().t0_s(), 7.0);
        assert_eq!((part.at(2.0), part.at(1.0)), (Some(4.0), None));
    }

    #[test]
    fn finds_the_sample_at_time_zero_despite_rounding() {
        let s = Sampled::new(-0.02, 1e-4, vec![0.0; 2701]).unwrap();
        assert_eq!(s.index_at_or_after(0.0), 200);
        assert_eq!(s.index_at_or_after(-1.0), 0);
        assert_eq!(s.index_at_or_after(9.0), 2701);
    }

    #[test]
    fn interpolates_inside_and_not_outside() {
        let s = Sampled::new(0.0, 0.5, vec![0.0, 1.0, 3.0]).unwrap();
        assert_eq!(s.at(0.75), Some(2.0));
        assert_eq!(s.at(1.0), Some(3.0));
        assert_eq!(s.at(1.1), None);
    }
}
