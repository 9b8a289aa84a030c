//! Zero level and noise of a channel before the event.

use serde::Serialize;

use crate::Sampled;

/// Shortest stretch of pre-event data that gives a zero level, s.
const SHORTEST_S: f64 = 0.01;
/// Runs of exact zeros at the start of a record up to this long are samples like others; longer ones are a muted
/// recorder.
const FEW_ZEROS: usize = 10;
/// Slack for time stamps that are sums of a decimal interval, s.
const SLACK_S: f64 = 1e-9;

/// Where the zero level is read, s on the record's time axis, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PreEventWindow {
    /// First sample at or after this time.
    pub from_s: f64,
    /// Last sample at or before this time.
    pub to_s: f64,
}

/// -50 ms to -10 ms: clear of the electrical noise of a trigger and of early contact.
impl Default for PreEventWindow {
    fn default() -> Self {
        Self { from_s: -0.05, to_s: -0.01 }
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

/// Mean and standard deviation in the part of the window that the record covers; `None` if that is shorter than 10 ms.
///
/// The mean is wrong by about the noise floor over the square root of the number of samples. A wrong zero level δ adds
/// δ·t to the velocity and δ·t²/2 to the displacement: 0.1 g over 100 ms is 0.098 m/s and 4.9 mm. Never the mean of the
/// whole record: a crash pulse has one.
///
/// A record that begins with more than ten samples of exactly 0 was muted until then (NHTSA's TDMS files): that run is
/// not counted. A window of nothing but such zeros is taken as it is, as computed records have it.
pub fn pre_event(samples: &Sampled, window: PreEventWindow) -> Option<PreEvent> {
    let from = samples.index_at_or_after(window.from_s - SLACK_S);
    let to = samples.index_at_or_after(window.to_s + SLACK_S);
    // A sample inside the slack belongs to the window; `index_at_or_after` has a slack of its own, in intervals.
    let to = if to < samples.len() && samples.time_s(to) <= window.to_s + SLACK_S { to + 1 } else { to };
    let muted = samples.samples().iter().take(to).take_while(|x| **x == 0.0).count();
    let muted = if (FEW_ZEROS + 1..to).contains(&muted) { muted } else { 0 };
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

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(t0_s: f64, dt_s: f64, n: usize) -> Sampled {
        Sampled::new(t0_s, dt_s, (0..n).map(|k| k as f64).collect()).unwrap()
    }

    #[test]
    fn both_ends_of_the_window_belong_to_it() {
        let level = pre_event(&ramp(-0.06, 1e-3, 200), PreEventWindow::default()).unwrap();
        assert_eq!((level.samples, level.zero_level), (41, 30.0));
        // Variance of the integers -20..=20: 20·21/3.
        assert!((level.noise_floor - 140.0_f64.sqrt()).abs() < 1e-12);
        // -50.0 to -10.0 ms at 10 kHz: samples 0 to 400.
        let level = pre_event(&ramp(-0.05, 1e-4, 3500), PreEventWindow::default()).unwrap();
        assert_eq!((level.samples, level.zero_level), (401, 200.0));
    }

    #[test]
    fn a_muted_start_is_not_counted() {
        let record = |muted: usize| {
            let at = |k: usize| if k < muted { 0.0 } else { 2.0 };
            Sampled::new(-0.05, 1e-4, (0..3500).map(at).collect()).unwrap()
        };
        let level_after =
            |muted| pre_event(&record(muted), PreEventWindow::default()).map(|f| (f.zero_level, f.muted, f.samples));
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
    fn ten_milliseconds_before_the_event_are_enough_and_nine_are_not() {
        let samples = |t0_s| pre_event(&ramp(t0_s, 1e-3, 200), PreEventWindow::default()).map(|level| level.samples);
        assert_eq!((samples(-0.02), samples(-0.019), samples(0.0)), (Some(11), None, None));
        assert_eq!(pre_event(&ramp(-0.02, 1e-4, 2701), PreEventWindow::default()).map(|f| f.samples), Some(101));
        assert_eq!(pre_event(&ramp(-0.0199, 1e-4, 2701), PreEventWindow::default()), None);
    }

    #[test]
    fn a_window_that_ends_before_it_starts_and_samples_beyond_squares_have_none() {
        assert_eq!(pre_event(&ramp(-0.06, 1e-3, 200), PreEventWindow { from_s: -0.01, to_s: -0.05 }), None);
        let huge = Sampled::new(-0.06, 1e-3, (0..100).map(|k| if k % 2 == 0 { 1e300 } else { -1e300 }).collect());
        assert_eq!(pre_event(&huge.unwrap(), PreEventWindow::default()), None);
    }
}
