//! What the velocity of a vehicle shows: dynamic crush, rebound and separation, a record that ends before, and time
//! zero by threshold and by velocity change.

use crumple_signal::{Acceleration, Displacement, STANDARD_GRAVITY_M_PER_S2, Signal, Velocity};

use crate::impacts::lowest_in;
use crate::metric::definitions::{SEPARATION, TIME_ZERO_EDR, TIME_ZERO_THRESHOLD};
use crate::metric::value::same_grid;
use crate::sums::{cumulative, in_samples, window_end};
use crate::{Metric, MetricsError, PulseImpact, first_event, impacts};

/// The moment of largest crush: the first zero of velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DynamicCrush {
    /// Time t_m, s from contact.
    pub time_s: f64,
    /// Dynamic crush C = x(t_m), m.
    pub displacement_m: f64,
    /// Index of the first sample with v ≤ 0.
    pub index: usize,
}

/// The lowest velocity from dynamic crush to the end of the contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rebound {
    /// Lowest velocity v_s, m/s; positive only by what the impact speed is uncertain by.
    pub velocity_m_per_s: f64,
    /// Time t_s of the first such sample, s from contact.
    pub time_s: f64,
    /// Displacement there, m. An estimate of the residual crush, no measurement of it.
    pub displacement_m: f64,
    /// The record ends before the contact does, and the lowest velocity is its last sample.
    pub still_separating: bool,
}

/// What happens in a crash, as far as the record shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct CrashEvents {
    /// Dynamic crush; `None`: the velocity never reaches zero.
    pub crush: Option<DynamicCrush>,
    /// Rebound; `None` without dynamic crush.
    pub rebound: Option<Rebound>,
    /// Velocity of the last sample, m/s.
    pub end_velocity_m_per_s: f64,
    /// Zeros of velocity after the first, s from contact, either direction. Not used for anything.
    pub later_zeros_s: Vec<f64>,
    /// End of the event and lowest velocity up to it, where the velocity never reaches zero.
    pub unstopped: Option<Unstopped>,
    /// Every impact of the record; the other events are those of the [first event](first_event).
    pub impacts: Vec<PulseImpact>,
}

/// Finds the impacts of a motion, and dynamic crush and rebound of the first that is an [event](first_event).
///
/// Dynamic crush is at the first sample k ≥ 1 at or after contact, t = 0, with `v[k] ≤ 0`: `t_m = t[k-1] +
/// T·v[k-1]/(v[k-1] - v[k])`, `C = x[k-1] + (t_m - t[k-1])·v[k-1]/2`, which is the trapezoid up to the interpolated
/// zero. Interpolating linearly errs by at most `T²·max|a'|/(8·|a|)` in t_m. The rebound velocity is the lowest
/// sample from k to the end of the contact ([`impacts`](fn@impacts)): what drags or hits the vehicle later is no
/// rebound. A record that ends while the velocity is positive, or that has the next impact before the velocity is zero,
/// has neither; its last sample is not a crush. It has the lowest velocity up to the [end of the event](unstopped).
/// Noise around zero makes many later zeros, which is why only the first counts.
pub fn crash_events(
    velocity: &Signal<Velocity>,
    displacement: &Signal<Displacement>,
) -> Result<CrashEvents, MetricsError> {
    crash_events_within(velocity, displacement, 0.0)
}

/// [`crash_events`], a stop being known to `speed_error_m_per_s`: where the lowest velocity of a contact that ends in
/// the record is positive and no larger, the vehicle has stopped there without a rebound.
pub fn crash_events_within(
    velocity: &Signal<Velocity>,
    displacement: &Signal<Displacement>,
    speed_error_m_per_s: f64,
) -> Result<CrashEvents, MetricsError> {
    same_grid(("the velocity", velocity), ("the displacement", displacement))?;
    let (v, x, dt) = (velocity.samples(), displacement.samples(), velocity.dt_s());
    let zero_between = |k: usize| velocity.time_s(k - 1) + dt * v[k - 1] / (v[k - 1] - v[k]);
    let impacts = impacts(velocity);
    let event = first_event(&impacts);
    let next = event.and_then(|k| impacts.get(k + 1)).map_or(v.len(), |next| next.samples[0]);
    let contact = event.map(|k| &impacts[k]);
    let from = velocity.index_at_or_after(0.0).max(1);
    let zero = (from..next).find(|&k| v[k] <= 0.0 && v[k - 1] > 0.0);
    // A zero after the contact is what drag or an error of the zero level make of the velocity that is left.
    let stop = contact.filter(|c| c.is_whole && zero.is_none_or(|k| k > c.samples[1])).map(|c| c.lowest(v));
    let stop = stop.filter(|k| v[*k] > 0.0 && v[*k] <= speed_error_m_per_s && *k > from);
    let first = stop.or(zero);
    let crush = first.map(|k| {
        let (time_s, left) = stop.map_or_else(|| (zero_between(k), 0.0), |k| (velocity.time_s(k), v[k]));
        let since_sample = time_s - velocity.time_s(k - 1);
        DynamicCrush { time_s, displacement_m: x[k - 1] + since_sample * (v[k - 1] + left) / 2.0, index: k }
    });
    let rebound = first.map(|start| {
        let lowest = lowest_in(v, start, contact.map_or(v.len() - 1, |contact| contact.samples[1].max(start)));
        Rebound {
            velocity_m_per_s: v[lowest],
            time_s: velocity.time_s(lowest),
            displacement_m: x[lowest],
            still_separating: lowest + 1 == v.len() && v[lowest] < 0.0 && contact.is_none_or(|c| !c.is_whole),
        }
    });
    // A sample at exactly zero belongs to the interval that reaches it.
    let is_zero = |k: &usize| (v[k - 1] < 0.0 && v[*k] >= 0.0) || (v[k - 1] > 0.0 && v[*k] <= 0.0);
    let later = first.map_or(v.len(), |first| first + 1)..v.len();
    let later_zeros_s = later.filter(is_zero).map(zero_between).collect();
    let unstopped = match contact.filter(|_| next < v.len() && v[from - 1] > 0.0) {
        _ if crush.is_some() => None,
        Some(contact) => {
            let (k, end_s) = (contact.lowest(v), contact.end_s);
            Some(Unstopped { velocity_m_per_s: v[k], time_s: velocity.time_s(k), end_s, end: EventEnd::Contact })
        }
        None => unstopped(velocity),
    };
    Ok(CrashEvents { crush, rebound, end_velocity_m_per_s: v[v.len() - 1], later_zeros_s, unstopped, impacts })
}

impl CrashEvents {
    /// Coefficient of restitution e = -v_s/v0 against a rigid barrier; 0 where the velocity never gets below zero.
    pub fn restitution(&self, impact_speed_m_per_s: f64) -> Option<f64> {
        // `+ 0.0` turns the -0.0 of a vehicle that stops dead into 0.
        self.rebound.map(|rebound| -rebound.velocity_m_per_s.min(0.0) / impact_speed_m_per_s + 0.0)
    }

    /// Change of velocity, m/s: v0 - v_s, or where the velocity never reaches zero v0 less the lowest up to the end of
    /// the event.
    pub fn delta_v_m_per_s(&self, impact_speed_m_per_s: f64) -> Option<f64> {
        self.lowest().map(|(velocity_m_per_s, _)| impact_speed_m_per_s - velocity_m_per_s)
    }

    /// When the velocity is the one of [`delta_v_m_per_s`](Self::delta_v_m_per_s), s from contact.
    pub fn time_of_delta_v_s(&self) -> Option<f64> {
        self.lowest().map(|(_, time_s)| time_s)
    }

    /// Samples up to the impact after the [first event](first_event), of so many.
    pub(crate) fn samples_of_event(&self, samples: usize) -> usize {
        let next = first_event(&self.impacts).and_then(|k| self.impacts.get(k + 1));
        next.map_or(samples, |next| next.samples[0])
    }

    fn lowest(&self) -> Option<(f64, f64)> {
        let stopped = self.rebound.map(|rebound| (rebound.velocity_m_per_s, rebound.time_s));
        stopped.or_else(|| self.unstopped.map(|unstopped| (unstopped.velocity_m_per_s, unstopped.time_s)))
    }
}

/// Stretch at the end of the record, s.
const STRETCH_S: f64 = 0.02;

/// |mean a| over the last 20 ms of the record, m/s²: the drift of a vehicle that should be free.
///
/// Above 0.5 g the zero level is wrong or the vehicle still touches. From the velocity, interpolated at the start of
/// the stretch. Absent for a record of less than 20 ms after `from_s`.
pub fn acceleration_after_separation(velocity: &Signal<Velocity>, from_s: f64) -> Metric {
    let end_s = velocity.end_s();
    let start_s = end_s - STRETCH_S;
    let slack_s = 1e-6 * velocity.dt_s();
    match velocity.at(start_s).zip(velocity.samples().last()) {
        Some((start, end)) if start_s >= from_s - slack_s => {
            Metric::with_value(&SEPARATION, ((end - start) / STRETCH_S).abs()).over(start_s, end_s)
        }
        _ => Metric::absent(&SEPARATION, "the record ends less than 20 ms after the lowest velocity"),
    }
}

/// The end of an event that does not stop the vehicle, and the lowest velocity up to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unstopped {
    /// Lowest velocity, m/s; positive.
    pub velocity_m_per_s: f64,
    /// Its time, s from contact; the first of equals.
    pub time_s: f64,
    /// End of the event, s from contact.
    pub end_s: f64,
    /// What ends it.
    pub end: EventEnd,
}

/// What ends an event that does not stop the vehicle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventEnd {
    /// The velocity changes by no more than 0.8 km/h in the 20 ms before it.
    Quiet,
    /// The force of the impact ends, and another impact follows.
    Contact,
    /// The record ends first.
    Record,
}

impl EventEnd {
    /// The name used in artifacts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quiet => "20 ms with no more than 0.8 km/h (49 CFR 563)",
            Self::Contact => "end of the force, another impact follows",
            Self::Record => "end of the record",
        }
    }
}

/// The end of the event and the lowest velocity up to it, where the velocity stays positive.
///
/// The rule of event data recorders (49 CFR 563.5), counted from the strongest part so that a pause before it ends
/// nothing: of all 20 ms after contact those with the largest loss of velocity, then the first 20 ms that begin later
/// and change the velocity by no more than 0.8 km/h; their last moment is the end. It lies up to 20 ms after the force
/// has gone. A second impact after such a pause is another event. Where the record ends first, its last sample is the
/// end, and the lowest velocity an upper bound.
///
/// `None` where no 20 ms take more than 0.8 km/h off, or the velocity at contact is not positive: nothing happens, or
/// the motion starts from rest.
pub fn unstopped(velocity: &Signal<Velocity>) -> Option<Unstopped> {
    let v = velocity.samples();
    let from = velocity.index_at_or_after(0.0);
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
    Some(Unstopped { velocity_m_per_s: v[lowest], time_s: velocity.time_s(lowest), end_s, end })
}

/// Interval of the rule for event data recorders, s.
pub const EDR_INTERVAL_S: f64 = 0.02;
/// Change of velocity in it, m/s (0.8 km/h).
pub const EDR_CHANGE_M_PER_S: f64 = 0.8 / 3.6;

/// A level that must hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThresholdRule {
    /// |a| reached, m/s²: 0.5 g.
    pub threshold_m_per_s2: f64,
    /// Time it is held, s: 3 ms.
    pub hold_s: f64,
}

impl Default for ThresholdRule {
    fn default() -> Self {
        Self { threshold_m_per_s2: 0.5 * STANDARD_GRAVITY_M_PER_S2, hold_s: 0.003 }
    }
}

/// Time at which |a| crosses the threshold to stay there, s on the signal's axis, interpolated linearly.
///
/// The first sample with |a| at or above the threshold that stays there for 3 ms. On a CFC 60 signal without zero
/// level. It lags true contact, by 0.65 ms for a half-sine of 22 g over 90 ms; the price in displacement is v0 times
/// that. Absent where nothing holds.
pub fn time_zero_by_threshold(acceleration: &Signal<Acceleration>, rule: ThresholdRule) -> Metric {
    let a = acceleration.samples();
    let dt = acceleration.dt_s();
    let above = |k: usize| a[k].abs() >= rule.threshold_m_per_s2;
    let absent = || Metric::absent(&TIME_ZERO_THRESHOLD, "no stretch of the record holds the threshold");
    let Some(hold) = in_samples(rule.hold_s, dt).map(|(whole, part)| whole + usize::from(part > 0.0)) else {
        return absent();
    };
    let mut since = None;
    for k in 0..a.len() {
        if !above(k) {
            since = None;
            continue;
        }
        let start: usize = *since.get_or_insert(k);
        if k - start >= hold {
            let at = if start == 0 {
                0.0
            } else {
                let (low, high) = (a[start - 1].abs(), a[start].abs());
                (start - 1) as f64 + (rule.threshold_m_per_s2 - low) / (high - low)
            };
            return Metric::with_value(&TIME_ZERO_THRESHOLD, acceleration.t0_s() + at * dt);
        }
    }
    absent()
}

/// Rule of event data recorders: the first sample after which the velocity changes by more than 0.8 km/h within 20 ms,
/// s on the signal's axis (49 CFR 563.5). The point may precede contact by up to 20 ms.
pub fn time_zero_by_velocity_change(acceleration: &Signal<Acceleration>) -> Metric {
    let absent = || Metric::absent(&TIME_ZERO_EDR, "no 20 ms of the record change the velocity by more than 0.8 km/h");
    match changes_of_velocity(acceleration).position(|change| change > EDR_CHANGE_M_PER_S) {
        Some(k) => {
            let from_s = acceleration.time_s(k);
            Metric::with_value(&TIME_ZERO_EDR, from_s).over(from_s, from_s + EDR_INTERVAL_S)
        }
        None => absent(),
    }
}

/// End of the event by the same rule: the first sample at or after `from_s` after which the velocity changes by no more
/// than 0.8 km/h within 20 ms, s on the signal's axis.
pub fn event_end_by_velocity_change(acceleration: &Signal<Acceleration>, from_s: f64) -> Option<f64> {
    let first = acceleration.index_at_or_after(from_s);
    let after = changes_of_velocity(acceleration).skip(first).position(|change| change <= EDR_CHANGE_M_PER_S)?;
    Some(acceleration.time_s(first + after))
}

/// |Change of velocity| in the 20 ms that begin at each sample, m/s, by the trapezoid, its end interpolated.
fn changes_of_velocity(acceleration: &Signal<Acceleration>) -> impl Iterator<Item = f64> {
    let v = cumulative(acceleration.samples(), acceleration.dt_s());
    // An interval longer than any record leaves no start.
    let (whole, part) = in_samples(EDR_INTERVAL_S, acceleration.dt_s()).unwrap_or((v.len(), 0.0));
    let starts = 0..v.len().saturating_sub(whole + usize::from(part > 0.0));
    starts.map(move |k| (window_end(&v, k, whole, part) - v[k]).abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(v: &[f64], x: &[f64]) -> CrashEvents {
        crash_events(&Signal::new(0.0, 0.5, v.to_vec()).unwrap(), &Signal::new(0.0, 0.5, x.to_vec()).unwrap()).unwrap()
    }

    #[test]
    fn the_first_zero_counts_and_later_ones_are_listed() {
        let events = motion(&[2.0, 1.0, -1.0, -2.0, 2.0], &[0.0, 0.75, 0.75, 0.0, 0.0]);
        // Halfway between 0.5 s and 1.0 s: literals, exact in binary.
        assert_eq!(events.crush, Some(DynamicCrush { time_s: 0.75, displacement_m: 0.875, index: 2 }));
        let rebound = events.rebound.unwrap();
        assert_eq!((rebound.velocity_m_per_s, rebound.time_s, rebound.still_separating), (-2.0, 1.5, false));
        assert_eq!(events.later_zeros_s, [1.75]);
        assert_eq!(events.restitution(4.0), Some(0.5));
        assert_eq!(events.delta_v_m_per_s(4.0), Some(6.0));
    }

    #[test]
    fn a_velocity_that_stays_positive_has_no_crush_and_no_rebound() {
        let events = motion(&[2.0, 1.0, 0.5], &[0.0, 0.75, 1.125]);
        assert_eq!((events.crush, events.rebound), (None, None));
        assert_eq!(events.end_velocity_m_per_s, 0.5);
        assert_eq!((events.restitution(2.0), events.delta_v_m_per_s(2.0)), (None, None));
    }

    #[test]
    fn a_minimum_at_the_last_sample_is_still_separating() {
        assert!(motion(&[1.0, -1.0, -2.0], &[0.0; 3]).rebound.unwrap().still_separating);
    }

    #[test]
    fn a_vehicle_that_stops_dead_has_no_restitution() {
        let events = motion(&[1.0, 0.0, 0.0], &[0.0, 0.25, 0.25]);
        assert_eq!(events.restitution(1.0), Some(0.0));
        assert!(!events.rebound.unwrap().still_separating);
    }

    #[test]
    fn refuses_velocity_and_displacement_of_different_lengths() {
        let error =
            crash_events(&Signal::new(0.0, 0.5, vec![1.0, 0.0]).unwrap(), &Signal::new(0.0, 0.5, vec![1.0]).unwrap())
                .unwrap_err();
        assert_eq!(
            error.to_string(),
            "the velocity has 2 samples from 0 s, the displacement has 1 from 0 s: one grid is needed"
        );
    }

    #[test]
    fn a_free_vehicle_has_no_acceleration() {
        let v = Signal::new(0.0, 0.005, vec![5.0, 0.0, -1.0, -1.0, -1.0, -1.0, -1.5]).unwrap();
        // 0.5 m/s over 20 ms.
        assert!((acceleration_after_separation(&v, 0.01).value.unwrap() - 25.0).abs() < 1e-10);
        assert_eq!(acceleration_after_separation(&v, 0.02).value, None);
    }

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
        let event = unstopped(&velocity(&[(0.0, 10.0)], 300)).unwrap();
        assert!((event.velocity_m_per_s - 5.0).abs() < 1e-12, "{event:?}");
        // The last 20 ms with 0.222 m/s begin at t with 10·(1 + cos(πt/60))/2 = 0.222: t = 54.29 ms, the next sample is
        // 55 ms.
        assert!((event.end_s - 0.075).abs() < 1e-9 && event.end == EventEnd::Quiet, "{event:?}");
        assert!((event.time_s - 0.06).abs() < 1e-9, "{event:?}");
    }

    #[test]
    fn a_weak_first_touch_is_no_event_of_its_own_and_a_second_impact_is_another() {
        let touched = unstopped(&velocity(&[(0.0, 1.0), (0.1, 9.0)], 400)).unwrap();
        assert!((touched.velocity_m_per_s - 5.0).abs() < 1e-12, "{touched:?}");
        let twice = unstopped(&velocity(&[(0.0, 9.0), (0.2, 3.0)], 400)).unwrap();
        assert!((twice.velocity_m_per_s - 6.0).abs() < 1e-12, "{twice:?}");
    }

    #[test]
    fn a_record_that_ends_first_says_so() {
        let event = unstopped(&velocity(&[(0.0, 10.0)], 41)).unwrap();
        assert_eq!((event.end, event.end_s == event.time_s), (EventEnd::Record, true));
        // 10·(1 - cos(2π/3))/2 are lost at 40 ms.
        assert!((event.velocity_m_per_s - 7.5).abs() < 1e-12 && (event.time_s - 0.04).abs() < 1e-12, "{event:?}");
    }

    #[test]
    fn nothing_happens_in_a_motion_that_keeps_its_velocity_or_starts_from_rest() {
        assert_eq!(unstopped(&velocity(&[(0.0, 0.2)], 300)), None);
        assert_eq!(unstopped(&velocity(&[(0.0, -10.0)], 300)), None);
        assert_eq!(unstopped(&velocity(&[(0.0, 10.0)], 10)), None, "shorter than 20 ms");
        assert_eq!(unstopped(&Signal::new(0.0, 1e-3, vec![0.0; 100]).unwrap()), None);
        assert_eq!(unstopped(&Signal::new(0.0, 1e-3, vec![]).unwrap()), None);
        let earlier = Signal::new(-9.0, 1e-3, velocity(&[(0.0, 10.0)], 300).samples().to_vec()).unwrap();
        assert_eq!(unstopped(&earlier), None, "ends before contact");
    }

    #[test]
    fn a_spike_does_not_hold_and_a_step_does() {
        let mut a = vec![0.0; 100];
        a[20] = 50.0;
        a[50..].fill(-10.0);
        let signal = Signal::new(-0.02, 1e-3, a).unwrap();
        let rule = ThresholdRule { threshold_m_per_s2: 5.0, hold_s: 0.003 };
        // Halfway between samples 49 and 50.
        assert!((time_zero_by_threshold(&signal, rule).value.unwrap() - 0.0295).abs() < 1e-12);
        let quiet = Signal::new(0.0, 1e-3, vec![1.0; 100]).unwrap();
        assert_eq!(time_zero_by_threshold(&quiet, rule).value, None);
        // The spike alone is 0.05 m/s; 0.23 m/s need 23 intervals of 10 m/s².
        assert_eq!(time_zero_by_velocity_change(&quiet).value, None);
    }
}
