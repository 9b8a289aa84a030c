//! First contact from the record itself: threshold, event data recorder, contact switch.

use crumple_metrics::{EDR_INTERVAL_S, ThresholdRule, time_zero_by_threshold, time_zero_by_velocity_change};
use crumple_signal::{Acceleration, Sampled, Signal};

/// Stretch at the start of a contact switch that is taken as open, s.
const OPEN_S: f64 = 0.001;

/// A time zero estimated from a record, and how far off it may be. True contact lies between `time_s - earlier_by_s`
/// and `time_s + later_by_s`. An error δ of it moves the crush by about v0·δ: 9 mm at 50 km/h for 0.65 ms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeZeroEstimate {
    /// On the record's time axis, s.
    pub time_s: f64,
    /// How much earlier (positive) true contact may have been, s.
    pub earlier_by_s: f64,
    /// How much later it may have been, s.
    pub later_by_s: f64,
}

/// Time zero by threshold, [`time_zero_by_threshold`], with how late it may be.
///
/// Meant for a signal of CFC 60 without zero level. Lags true contact, by 0.65 ms on a half-sine of 100 ms; it cannot
/// have been before the last change of sign, which is what `earlier_by_s` says (at most the start of the record).
///
/// The rule: the first sample with |a| of 0.5 g or more that stays there for 3 ms, the crossing interpolated linearly,
/// so noise and short spikes are passed over. A soft front can cross zero once more after contact; true contact is then
/// earlier than `earlier_by_s` says. `None` where no stretch of 3 ms holds 0.5 g.
pub fn threshold_crossing(acceleration: &Signal<Acceleration>) -> Option<TimeZeroEstimate> {
    let time_s = time_zero_by_threshold(acceleration, ThresholdRule::default()).value?;
    let a = acceleration.samples();
    let first = acceleration.index_at_or_after(time_s).min(a.len() - 1);
    let sign = a[first].signum();
    let rest = a[..first].iter().rposition(|a| a * sign <= 0.0).unwrap_or(0);
    Some(TimeZeroEstimate { time_s, earlier_by_s: (time_s - acceleration.time_s(rest)).max(0.0), later_by_s: 0.0 })
}

/// Time zero of an event data recorder, [`time_zero_by_velocity_change`].
///
/// The interval may begin before contact, by up to its length: that is what `later_by_s` says.
///
/// The rule (49 CFR 563.5): the first sample after which the velocity changes by more than 0.8 km/h within 20 ms,
/// either way. The change is the trapezoid of the acceleration, so no impact speed is needed. `None` for a pulse that
/// never changes the velocity that fast, which is a mean of 1.13 g over 20 ms.
pub fn edr_start(acceleration: &Signal<Acceleration>) -> Option<TimeZeroEstimate> {
    let time_s = time_zero_by_velocity_change(acceleration).value?;
    Some(TimeZeroEstimate { time_s, earlier_by_s: 0.0, later_by_s: EDR_INTERVAL_S })
}

/// Time zero from a contact switch: where its signal first crosses the middle between its level at the start of the
/// record (mean of the first millisecond) and the level farthest from it, linearly interpolated; right to a sample.
///
/// Either direction counts as closing, whatever the unit of the switch. Bounces after the first crossing are not looked
/// at. A switch that is closed when the record begins is taken as open and found where it opens, so the record has to
/// begin before contact. `None` for a constant or an empty record. This is the first rule to use where there is such a
/// channel: threshold and recorder infer contact from the pulse and are late or early.
pub fn contact_edge(switch: &Sampled) -> Option<TimeZeroEstimate> {
    let s = switch.samples();
    let open = ((OPEN_S / switch.dt_s()).round() as usize).clamp(1, s.len().max(1)).min(s.len());
    if open == 0 {
        return None;
    }
    let level = s[..open].iter().sum::<f64>() / open as f64;
    let farthest = s.iter().fold(0.0_f64, |far, x| if (x - level).abs() > far.abs() { x - level } else { far });
    if farthest == 0.0 {
        return None;
    }
    let travelled = |k: usize| (s[k] - level) / farthest;
    let first = (0..s.len()).find(|&k| travelled(k) >= 0.5)?;
    let crossing = match first.checked_sub(1) {
        None => 0.0,
        Some(before) => before as f64 + (0.5 - travelled(before)) / (travelled(first) - travelled(before)),
    };
    let time_s = switch.t0_s() + crossing * switch.dt_s();
    Some(TimeZeroEstimate { time_s, earlier_by_s: switch.dt_s(), later_by_s: switch.dt_s() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_metrics::event_end_by_velocity_change;
    use crumple_signal::STANDARD_GRAVITY_M_PER_S2;

    const THRESHOLD_M_PER_S2: f64 = 0.5 * STANDARD_GRAVITY_M_PER_S2;

    fn ramp(slope: f64) -> Signal<Acceleration> {
        // From 5 ms on; before it a little of the other sign.
        let at = |t: f64| if t < 0.005 { 0.1 } else { -slope * (t - 0.005) };
        Signal::new(0.0, 1e-4, (0..600).map(|k| at(f64::from(k) * 1e-4)).collect()).unwrap()
    }

    #[test]
    fn the_threshold_is_interpolated_and_says_how_late_it_may_be() {
        let zero = threshold_crossing(&ramp(2000.0)).unwrap();
        // 0.5 g = 4.903325 m/s² is reached after 2.4517 ms of the ramp; binary rounding only.
        assert!((zero.time_s - 0.005 - THRESHOLD_M_PER_S2 / 2000.0).abs() < 1e-12, "{zero:?}");
        // The last sample at rest is the one at which the ramp starts from zero.
        assert!((zero.earlier_by_s - THRESHOLD_M_PER_S2 / 2000.0).abs() < 1e-4 + 1e-12, "{zero:?}");
    }

    #[test]
    fn a_spike_shorter_than_the_hold_is_passed_over() {
        let mut samples = ramp(2000.0).samples().to_vec();
        samples[10..40].fill(50.0);
        let with_spike = Signal::new(0.0, 1e-4, samples.clone()).unwrap();
        assert!(threshold_crossing(&with_spike).unwrap().time_s > 0.007);
        samples[10..41].fill(50.0);
        let held = Signal::new(0.0, 1e-4, samples).unwrap();
        assert!(threshold_crossing(&held).unwrap().time_s < 0.0011);
        assert_eq!(threshold_crossing(&Signal::new(0.0, 1e-4, vec![0.0; 50]).unwrap()), None);
        assert_eq!(threshold_crossing(&Signal::new(0.0, 1e-4, vec![]).unwrap()), None);
    }

    #[test]
    fn the_recorder_s_interval_begins_before_contact() {
        // 10 m/s² from 30 ms to 80 ms: 0.2222 m/s are gathered after 22.2 ms, so the interval of 20 ms holds less at
        // most 0.2 m/s; with 20 m/s² it takes 11.1 ms.
        let step = |level: f64| {
            let at = |k: i32| if (300..800).contains(&k) { level } else { 0.0 };
            Signal::new(0.0, 1e-4, (0..1200).map(at).collect()).unwrap()
        };
        assert_eq!(edr_start(&step(-10.0)), None);
        let zero = edr_start(&step(-20.0)).unwrap();
        // The last sample of the interval is at 41.1 ms: 111 full steps and half of the first, 0.223 m/s.
        assert!((zero.time_s - 0.0211).abs() < 1.5e-4, "{zero:?}");
        let end = event_end_by_velocity_change(&step(-20.0), zero.time_s).unwrap();
        assert!((end - (0.08 - 0.0111)).abs() < 1.5e-4, "{end}");
        assert_eq!(edr_start(&Signal::new(0.0, 1e-4, vec![]).unwrap()), None);
    }

    #[test]
    fn a_switch_closes_in_the_middle_of_its_edge_whichever_way() {
        for (open, closed) in [(0.0, 5.0), (5.0, 0.0), (1.0, -3.0)] {
            let samples = (0..100).map(|k| if k < 50 { open } else { closed }).collect();
            let zero = contact_edge(&Sampled::new(-0.005, 1e-4, samples).unwrap()).unwrap();
            assert!((zero.time_s + 0.5e-4).abs() < 1e-12, "{zero:?}");
        }
        assert_eq!(contact_edge(&Sampled::new(0.0, 1e-4, vec![5.0; 9]).unwrap()), None);
        assert_eq!(contact_edge(&Sampled::new(0.0, 1e-4, vec![]).unwrap()), None);
    }
}
