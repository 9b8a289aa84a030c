use crumple_signal::Sampled;
use serde::Serialize;

use crate::FilterError;

/// Shortest stretch of pre-event data that gives a zero level, s.
const SHORTEST_S: f64 = 0.01;
/// Slack for time stamps that are sums of a decimal interval, s.
const SLACK_S: f64 = 1e-9;

/// Where the zero level is read, s on the record's time axis, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Window {
    /// First sample at or after this time.
    pub from_s: f64,
    /// Last sample at or before this time.
    pub to_s: f64,
}

/// -50 ms to -10 ms: clear of the electrical noise of a trigger and of early contact.
impl Default for Window {
    fn default() -> Self {
        Self { from_s: -0.05, to_s: -0.01 }
    }
}

/// What is done about the zero level of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ZeroLevel {
    /// The samples stay as they are.
    None,
    /// The mean of the pre-event samples is subtracted.
    PreEvent(Window),
}

impl Default for ZeroLevel {
    fn default() -> Self {
        Self::PreEvent(Window::default())
    }
}

/// The zero level of a channel before the event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PreEvent {
    /// Mean of the samples in the window.
    pub mean: f64,
    /// How many they are.
    pub samples: usize,
    /// Time of the first, s.
    pub from_s: f64,
    /// Time of the last, s.
    pub to_s: f64,
}

/// Reads the zero level in the part of the window that the record covers; `None` if that is shorter than 10 ms.
///
/// A wrong zero level δ adds δ·t to the velocity and δ·t²/2 to the displacement: 0.1 g over 100 ms is 0.098 m/s and
/// 4.9 mm. Never the mean of the whole record: a crash pulse has one.
pub fn pre_event(samples: &Sampled, window: Window) -> Result<Option<PreEvent>, FilterError> {
    let Window { from_s, to_s } = window;
    if to_s < from_s {
        return Err(FilterError::Window { from_s, to_s });
    }
    let inside = |t: f64| t >= from_s - SLACK_S && t <= to_s + SLACK_S;
    let Some(first) = samples.times_s().position(inside) else { return Ok(None) };
    let count = samples.times_s().skip(first).take_while(|&t| inside(t)).count();
    let (from_s, to_s) = (samples.time_s(first), samples.time_s(first + count - 1));
    if to_s - from_s < SHORTEST_S - SLACK_S {
        return Ok(None);
    }
    let mean = samples.samples()[first..first + count].iter().sum::<f64>() / count as f64;
    Ok(Some(PreEvent { mean, samples: count, from_s, to_s }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(t0_s: f64, n: usize) -> Sampled {
        Sampled::new(t0_s, 1e-3, (0..n).map(|k| k as f64).collect()).unwrap()
    }

    #[test]
    fn both_ends_of_the_window_belong_to_it() {
        let found = pre_event(&ramp(-0.06, 200), Window::default()).unwrap().unwrap();
        assert_eq!((found.samples, found.mean), (41, 30.0));
    }

    #[test]
    fn ten_milliseconds_before_the_event_are_enough_and_nine_are_not() {
        assert_eq!(pre_event(&ramp(-0.02, 200), Window::default()).unwrap().unwrap().samples, 11);
        assert_eq!(pre_event(&ramp(-0.019, 200), Window::default()).unwrap(), None);
        assert_eq!(pre_event(&ramp(0.0, 200), Window::default()).unwrap(), None);
    }

    #[test]
    fn refuses_a_window_that_ends_before_it_starts() {
        let error = pre_event(&ramp(-0.06, 200), Window { from_s: -0.01, to_s: -0.05 }).unwrap_err();
        assert_eq!(error.to_string(), "the zero level window ends at -0.05 s, before it starts at -0.01 s");
    }
}
