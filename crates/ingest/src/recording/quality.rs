//! What can be measured on a channel before anything touches it. Reported, never applied.

use crumple_artifact::records::QualityV1;
use crumple_signal::{FreeFall, PreEvent, PreEventWindow, Sampled, free_fall, pre_event};

/// Dropouts are looked for up to this time, s.
const ACTIVE_UNTIL_S: f64 = 0.150;
/// Length of the end of a record that is looked at for drift, s.
const END_S: f64 = 0.020;

/// State of a channel as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// `None` without 10 ms of data before the event.
    pub pre_event: Option<PreEvent>,
    /// Whether gravity may change what it reads.
    pub feels_gravity: bool,
    /// Of an acceleration whose level before the event is that of a free fall.
    pub fall: Option<FreeFall>,
    /// What stands of it in the artifact.
    pub record: QualityV1,
}

impl Quality {
    /// The level that is no motion, where the record shows it: that at rest, or before the event.
    pub fn zero_level(&self) -> Option<f64> {
        self.fall.map(|fall| fall.rest_level).or(self.pre_event.map(|before| before.zero_level))
    }
}

/// Measures a channel whose t = 0 is the event.
///
/// Zero level and noise floor: mean and standard deviation of the raw samples from -50 ms to -10 ms ([`pre_event`]).
///
/// `feels_gravity`: it may be in free fall before the event.
pub fn measure(wave: &Sampled, time_jitter: f64, feels_gravity: bool) -> Quality {
    let pre_event = pre_event(wave, PreEventWindow::default());
    let fall = pre_event.filter(|_| feels_gravity).and_then(|before| free_fall(wave, &before));
    let samples = wave.samples();
    let (minimum, maximum) =
        samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let (minimum, maximum) = if samples.is_empty() { (0.0, 0.0) } else { (minimum, maximum) };
    let zero = fall.map(|fall| fall.rest_level).or(pre_event.map(|p| p.zero_level)).unwrap_or(0.0);
    let (constant_run, constant_run_from_s) = constant_run(wave, minimum, maximum, zero);
    let record = QualityV1 {
        zero_level: pre_event.map(|before| before.zero_level),
        noise_floor: pre_event.map(|before| before.noise_floor),
        pre_event_from_s: pre_event.map(|before| before.from_s),
        pre_event_to_s: pre_event.map(|before| before.to_s),
        sample_rate_hz: wave.rate_hz(),
        time_jitter,
        minimum,
        maximum,
        clipped_run: clipped_run(samples, minimum, maximum, zero),
        constant_run: Some(constant_run),
        constant_run_from_s,
        end_level: end_level(wave, zero),
        rest_level: fall.map(|fall| fall.rest_level),
    };
    Quality { pre_event, feels_gravity, fall, record }
}

/// The signal is active from the first to the last sample after time zero, up to 150 ms, that is farther from the zero
/// level than a tenth of the range. Runs at the extremes are clipping and not counted here.
fn constant_run(wave: &Sampled, minimum: f64, maximum: f64, zero: f64) -> (u64, Option<f64>) {
    let from = wave.index_at_or_after(0.0);
    let window = &wave.samples()[from..wave.index_at_or_after(ACTIVE_UNTIL_S).max(from)];
    let far = |x: &f64| (x - zero).abs() > 0.1 * (maximum - minimum);
    let (Some(first), Some(last)) = (window.iter().position(far), window.iter().rposition(far)) else {
        return (0, None);
    };
    let (mut longest, mut at, mut run) = (0, first, 0);
    for k in first..=last {
        let x = window[k];
        run = if k > first && x == window[k - 1] { run + 1 } else { 1 };
        if run > longest && !(far(&x) && (x == minimum || x == maximum)) {
            (longest, at) = (run, k + 1 - run);
        }
    }
    (longest as u64, Some(wave.time_s(from + at)))
}

fn end_level(wave: &Sampled, zero: f64) -> Option<f64> {
    let from = wave.index_at_or_after(wave.end_s() - END_S);
    let window = wave.samples().get(from..).filter(|w| w.len() >= 2 && from > 0)?;
    Some(window.iter().sum::<f64>() / window.len() as f64 - zero).filter(|level| level.is_finite())
}

/// A recorder that runs into its range repeats the extreme value. An extreme near the zero level is the quiet part of a
/// one-sided pulse and not counted: it must lie at least a tenth of the range away.
fn clipped_run(samples: &[f64], minimum: f64, maximum: f64, zero: f64) -> u64 {
    let far = 0.1 * (maximum - minimum);
    let longest = |extreme: f64| {
        let (mut longest, mut run) = (0, 0);
        for x in samples {
            run = if *x == extreme { run + 1 } else { 0 };
            longest = longest.max(run);
        }
        longest
    };
    [minimum, maximum].into_iter().filter(|x| far > 0.0 && (x - zero).abs() > far).map(longest).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_tops_are_clipping_and_quiet_starts_are_not() {
        let quiet = Sampled::new(-0.02, 1e-3, vec![0.0, 0.0, 0.0, 0.0, -1.0, -3.0, -1.0]).unwrap();
        assert_eq!(measure(&quiet, 0.0, true).record.clipped_run, 1);
        let flat = Sampled::new(0.0, 1e-3, vec![0.0, -3.0, -3.0, -3.0, -3.0, 1.0, 0.0]).unwrap();
        assert_eq!(measure(&flat, 0.0, true).record.clipped_run, 4);
        let dead = Sampled::new(0.0, 1e-3, vec![7.0; 60]).unwrap();
        assert_eq!(measure(&dead, 0.0, true).record.clipped_run, 0);
    }
}
