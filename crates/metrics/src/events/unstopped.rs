//! A crash in which the vehicle does not come to rest: small overlap, oblique or glancing impacts, a record that ends
//! early.

use crumple_signal::{Signal, Velocity};

use crate::events::time_zero::{EDR_CHANGE_M_PER_S, EDR_INTERVAL_S};
use crate::sums::in_samples;
use crate::sums::window_end;

/// The end of an event that does not stop the vehicle, and the lowest velocity up to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unstopped {
    /// Lowest velocity, m/s; positive.
    pub velocity_m_per_s: f64,
    /// Its time, s from time zero; the first of equals.
    pub time_s: f64,
    /// End of the event, s from time zero.
    pub end_s: f64,
    /// What ends it.
    pub end: EventEnd,
}

/// What ends an event that does not stop the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventEnd {
    /// The velocity changes by no more than 0.8 km/h in the 20 ms before it.
    Quiet,
    /// The record ends first.
    Record,
}

impl EventEnd {
    /// The name used in artifacts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quiet => "20 ms with no more than 0.8 km/h (49 CFR 563)",
            Self::Record => "end of the record",
        }
    }
}

/// The end of the event and the lowest velocity up to it, where the velocity stays positive.
///
/// The rule of event data recorders (49 CFR 563.5), counted from the strongest part so that a pause before it ends
/// nothing: of all 20 ms after time zero those with the largest loss of velocity, then the first 20 ms that begin later
/// and change the velocity by no more than 0.8 km/h; their last moment is the end. It lies up to 20 ms after the force
/// has gone. A second impact after such a pause is another event. Where the record ends first, its last sample is the
/// end, and the lowest velocity an upper bound.
///
/// `None` where no 20 ms take more than 0.8 km/h off, or the velocity at time zero is not positive: nothing happens, or
/// the motion starts from rest.
pub fn unstopped(velocity: &Signal<Velocity>, time_zero_s: f64) -> Option<Unstopped> {
    let v = velocity.samples();
    let from = velocity.index_at_or_after(time_zero_s);
    if v.get(from).is_none_or(|v| *v <= 0.0) {
        return None;
    }
    let (whole, part) = in_samples(EDR_INTERVAL_S, velocity.dt_s())?;
    let starts = from..v.len().saturating_sub(whole.saturating_add(usize::from(part > 0.0)));
    let loss = |k: usize| v[k] - window_end(v, k, whole, part);
    let strongest = starts.clone().reduce(|best, k| if loss(k) > loss(best) { k } else { best })?;
    if loss(strongest) <= EDR_CHANGE_M_PER_S {
        return None;
    }
    let quiet = (strongest + 1..starts.end).find(|k| loss(*k).abs() <= EDR_CHANGE_M_PER_S);
    let last_s = velocity.end_s();
    let (end_s, end) = match quiet {
        Some(k) => ((velocity.time_s(k) + EDR_INTERVAL_S).min(last_s), EventEnd::Quiet),
        None => (last_s, EventEnd::Record),
    };
    // 1e-6 of a sample: the slack of decimal time stamps.
    let slack_s = 1e-6 * velocity.dt_s();
    let up_to_the_end = (from..v.len()).take_while(|k| velocity.time_s(*k) <= end_s + slack_s);
    let lowest = up_to_the_end.reduce(|low, k| if v[k] < v[low] { k } else { low })?;
    Some(Unstopped {
        velocity_m_per_s: v[lowest],
        time_s: velocity.time_s(lowest) - time_zero_s,
        end_s: end_s - time_zero_s,
        end,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 15 m/s less the integral of a half sine of 60 ms that takes `loss`, beginning at `at`; 1 kHz, from -20 ms on.
    fn velocity(pulses: &[(f64, f64)], length_ms: i32) -> Signal<Velocity> {
        let lost = |t: f64, at: f64| 0.5 * (1.0 - (std::f64::consts::PI * ((t - at) / 0.06).clamp(0.0, 1.0)).cos());
        let at = |k: i32| {
            let t = 1e-3 * f64::from(k);
            15.0 - pulses.iter().map(|(at, loss)| loss * lost(t, *at)).sum::<f64>()
        };
        Signal::new(-0.02, 1e-3, (-20..length_ms).map(at).collect()).unwrap()
    }

    #[test]
    fn the_event_ends_with_its_first_quiet_20_ms() {
        let event = unstopped(&velocity(&[(0.0, 10.0)], 300), 0.0).unwrap();
        assert!((event.velocity_m_per_s - 5.0).abs() < 1e-12, "{event:?}");
        // The last 20 ms with 0.222 m/s begin at t with 10·(1 + cos(πt/60))/2 = 0.222: t = 54.29 ms, the next sample is
        // 55 ms.
        assert!((event.end_s - 0.075).abs() < 1e-9 && event.end == EventEnd::Quiet, "{event:?}");
        assert!((event.time_s - 0.06).abs() < 1e-9, "{event:?}");
    }

    #[test]
    fn a_weak_first_touch_is_no_event_of_its_own_and_a_second_impact_is_another() {
        let touched = unstopped(&velocity(&[(0.0, 1.0), (0.1, 9.0)], 400), 0.0).unwrap();
        assert!((touched.velocity_m_per_s - 5.0).abs() < 1e-12, "{touched:?}");
        let twice = unstopped(&velocity(&[(0.0, 9.0), (0.2, 3.0)], 400), 0.0).unwrap();
        assert!((twice.velocity_m_per_s - 6.0).abs() < 1e-12, "{twice:?}");
    }

    #[test]
    fn a_record_that_ends_first_says_so() {
        let event = unstopped(&velocity(&[(0.0, 10.0)], 41), 0.0).unwrap();
        assert_eq!((event.end, event.end_s == event.time_s), (EventEnd::Record, true));
        // 10·(1 - cos(2π/3))/2 are lost at 40 ms.
        assert!((event.velocity_m_per_s - 7.5).abs() < 1e-12 && (event.time_s - 0.04).abs() < 1e-12, "{event:?}");
    }

    #[test]
    fn nothing_happens_in_a_motion_that_keeps_its_velocity_or_starts_from_rest() {
        assert_eq!(unstopped(&velocity(&[(0.0, 0.2)], 300), 0.0), None);
        assert_eq!(unstopped(&velocity(&[(0.0, -10.0)], 300), 0.0), None);
        assert_eq!(unstopped(&velocity(&[(0.0, 10.0)], 10), 0.0), None, "shorter than 20 ms");
        assert_eq!(unstopped(&Signal::new(0.0, 1e-3, vec![0.0; 100]).unwrap(), 0.0), None);
        assert_eq!(unstopped(&Signal::new(0.0, 1e-3, vec![]).unwrap(), 0.0), None);
        assert_eq!(unstopped(&velocity(&[(0.0, 10.0)], 300), 9.0), None);
    }
}
