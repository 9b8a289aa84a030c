//! What a motion says about the crash: sign of the pulse, events, findings in words.

use crumple_metrics::{
    CrashEvents, DynamicCrush, EventEnd, MetricsError, centroid_time_by_moment, centroid_time_from_crush,
    crash_events_within, largest_restitution,
};
use crumple_signal::{About, Motion, Notes, Signal, UsedStart, Velocity, Weight};

/// What is said of a pulse of the wrong sign.
pub const WRONG_SIGN: &str =
    "the pulse has the wrong sign: --sign flip at ingest turns it (where that was given: leave it out)";

/// Whether a motion is that of a pulse with deceleration positive: the vehicle would come to rest if the acceleration
/// were mirrored (`v` reaches `2·v0`) before it does as it is.
///
/// The velocity of the mirrored pulse is `2·v0 - v`, which is zero where v is `2·v0`: no second integration is needed.
/// Only samples at or after contact, t = 0, count. SAE J211-1 has x forward, so a frontal pulse is negative; nothing is
/// turned here, that is for who knows how the sensor was mounted.
///
/// A record that ends before either says nothing, neither does a motion from rest.
pub fn wrong_sign(velocity: &Signal<Velocity>, impact_speed_m_per_s: f64) -> bool {
    let v = velocity.samples();
    let first = v[velocity.index_at_or_after(0.0)..].iter().find(|&&v| v <= 0.0 || v >= 2.0 * impact_speed_m_per_s);
    impact_speed_m_per_s > 0.0 && first.is_some_and(|&v| v > 0.0)
}

/// The crash events of a motion; none, whatever the velocity does, where the motion starts from rest or the pulse has
/// the wrong sign. Errors: [`crumple_metrics::crash_events`].
///
/// The velocity at the end of the record stays in the result, since it needs no crash. Times are in s from contact: t_m
/// is the first zero of the velocity, interpolated linearly, and C the displacement there.
pub fn events_of(motion: &Motion, impact_speed_m_per_s: f64) -> Result<CrashEvents, MetricsError> {
    events_within(motion, impact_speed_m_per_s, 0.0)
}

/// [`events_of`], the impact speed being known to `speed_error_m_per_s`: [`crash_events_within`].
pub fn events_within(
    motion: &Motion,
    impact_speed_m_per_s: f64,
    speed_error_m_per_s: f64,
) -> Result<CrashEvents, MetricsError> {
    let events = crash_events_within(&motion.velocity, &motion.displacement, speed_error_m_per_s)?;
    if impact_speed_m_per_s > 0.0 && !wrong_sign(&motion.velocity, impact_speed_m_per_s) {
        return Ok(events);
    }
    Ok(CrashEvents { crush: None, rebound: None, later_zeros_s: Vec::new(), unstopped: None, ..events })
}

/// Relative gap of two centroid times that by parts are equal: 0.1 % is the error of the sampling or of the rule of
/// summation.
const CENTROID_GAP: f64 = 1e-3;

/// What a reader of the motion should know, in words: what the record does not show, and what does not fit together.
///
/// In this order, as far as they hold:
/// 1. the sign of the pulse is wrong: a warning, and nothing else is said ([`wrong_sign`]);
/// 2. the integration began before contact;
/// 3. the motion starts from rest: its velocity is the change of velocity, and nothing else is said;
/// 4. the record ends faster than the impact: a warning, the polarity may be wrong;
/// 5. the velocity never reaches zero: a warning, with the lowest velocity up to the end of the event (49 CFR 563.5)
///    where there is one, and nothing else is said;
/// 6. the lowest velocity is the last sample: a warning, restitution and delta-v are lower bounds;
/// 7. the rebound is faster than the impact: a warning, no passive vehicle does that. A velocity that never gets below
///    zero is noted as a restitution of 0;
/// 8. zeros of the velocity after the first, which are not used;
/// 9. the centroid time `t_c = C/v0` beside `∫t·a dt/∫a dt` up to t_m. A gap above 0.1 % that the motion itself does
///    not have is a warning about sampling or rule; one that it has comes from the velocities at contact and at the
///    stop.
///
/// `events` are those of `motion`; times in notes are in ms from contact.
pub fn findings(motion: &Motion, events: &CrashEvents, impact_speed_m_per_s: f64) -> Notes {
    let mut notes = Notes::new();
    if wrong_sign(&motion.velocity, impact_speed_m_per_s) {
        notes.concern(
            About::Pulse,
            Weight::Decisive,
            format!(
                "{WRONG_SIGN}; the velocity rises from {impact_speed_m_per_s:.3} to {:.3} m/s, no events are written",
                motion.velocity.samples().iter().copied().fold(impact_speed_m_per_s, f64::max)
            ),
        );
        return notes;
    }
    if motion.start == UsedStart::RecordStart {
        notes.info(format!(
            "integration starts {:.1} ms before contact: the low-pass filter spreads the contact to both sides of it",
            -1e3 * motion.velocity.t0_s()
        ));
    }
    if impact_speed_m_per_s == 0.0 {
        notes.info(format!(
            "integrated from rest: the velocity is the change of velocity, {:.3} m/s at the end; no crash events",
            events.end_velocity_m_per_s
        ));
        return notes;
    }
    if events.end_velocity_m_per_s > impact_speed_m_per_s {
        notes.concern(
            About::Pulse,
            Weight::Decisive,
            format!(
                "the record ends at {:.3} m/s, faster than the impact at {impact_speed_m_per_s:.3} m/s. Check the \
                 sign: a frontal pulse is negative (SAE J211-1)",
                events.end_velocity_m_per_s
            ),
        );
    }
    let (Some(crush), Some(rebound)) = (events.crush, events.rebound) else {
        // What is shown has no crush then, so that nothing of it changes.
        notes.concern(About::Motion, Weight::Slight, never_stops(events, impact_speed_m_per_s));
        return notes;
    };
    if rebound.still_separating {
        notes.concern(
            About::Motion,
            Weight::Slight,
            "still separating: the lowest velocity is the last sample, so restitution and delta-v are lower bounds",
        );
    }
    if rebound.velocity_m_per_s.abs() > impact_speed_m_per_s {
        notes.concern(
            About::Pulse,
            Weight::Decisive,
            format!(
                "the rebound at {:.3} m/s is faster than the impact at {impact_speed_m_per_s:.3} m/s, which no passive \
             vehicle does: check the unit of the acceleration, the zero level and the impact speed",
                rebound.velocity_m_per_s
            ),
        );
    } else if rebound.velocity_m_per_s > 0.0 {
        notes.info(format!(
            "the velocity left at {:.1} ms, {:.3} m/s, is within the error of the impact speed: the vehicle has \
             stopped",
            1e3 * crush.time_s,
            rebound.velocity_m_per_s
        ));
    } else if rebound.velocity_m_per_s == 0.0 {
        notes.info("the velocity never gets below zero: no rebound, coefficient of restitution 0");
    }
    if let Some(first) = events.later_zeros_s.first() {
        notes.info(format!(
            "the velocity passes zero {} more times after dynamic crush, first at {:.1} ms; only the first zero counts",
            events.later_zeros_s.len(),
            1e3 * first
        ));
    }
    compare_centroid_times(motion, crush, rebound.velocity_m_per_s.max(0.0), impact_speed_m_per_s, &mut notes);
    notes
}

/// The centroid time `C/v0` beside that of the pulse. By parts, from the start t0 of the integration to t_m, the pulse
/// has `(t_m·v(t_m) - t0·v(t0) - x(t_m) + x(t0)) / (v(t_m) - v(t0))`, whatever the inputs are: only a gap from that is
/// one of sampling or rule. `left_m_per_s`: v(t_m).
fn compare_centroid_times(motion: &Motion, crush: DynamicCrush, left_m_per_s: f64, v0: f64, notes: &mut Notes) {
    let (velocity, displacement) = (&motion.velocity, &motion.displacement);
    let from_s = velocity.t0_s();
    let Some(by_moment) = centroid_time_by_moment(&motion.acceleration, crush.time_s) else { return };
    let (Some(first_v), Some(first_x)) = (velocity.samples().first(), displacement.samples().first()) else { return };
    let moment = crush.time_s * left_m_per_s - from_s * first_v - (crush.displacement_m - first_x);
    let by_parts = moment / (left_m_per_s - first_v);
    let from_crush = centroid_time_from_crush(crush.displacement_m, v0);
    let gap = by_moment / from_crush - 1.0;
    let text = format!(
        "centroid time: {:.3} ms from C/v0, {:.3} ms from the pulse, {:+.3} % apart",
        1e3 * from_crush,
        1e3 * by_moment,
        1e2 * gap
    );
    if (by_moment / by_parts - 1.0).abs() > CENTROID_GAP {
        let crude = ": the sampling or the integration rule is crude for this pulse";
        notes.concern(About::Motion, Weight::Marked, text + crude);
    } else if gap.abs() <= CENTROID_GAP {
        notes.info(text);
    } else {
        let at_contact = velocity.at(0.0).unwrap_or(*first_v);
        if (at_contact - v0).abs().max(left_m_per_s) <= CENTROID_GAP * v0 {
            notes.info(text + ": the record moves before contact");
            return;
        }
        notes.info(format!(
            "{text}: the velocity is {at_contact:.3} m/s at contact and {left_m_per_s:.3} m/s at the stop, the impact \
             speed {v0:.3} m/s"
        ));
    }
}

/// What a velocity says that never reaches zero.
fn never_stops(events: &CrashEvents, impact_speed_m_per_s: f64) -> String {
    let text = format!(
        "the velocity never reaches zero, the record ends at v = {:.3} m/s: dynamic crush and rebound are not in \
         the record",
        events.end_velocity_m_per_s
    );
    let Some(unstopped) = events.unstopped else { return text };
    if unstopped.end == EventEnd::Contact {
        return format!(
            "this impact leaves the vehicle {:.3} m/s, and another one follows: it has no dynamic crush and no \
             rebound; delta-v is {:.3} m/s at {:.1} ms",
            unstopped.velocity_m_per_s,
            impact_speed_m_per_s - unstopped.velocity_m_per_s,
            1e3 * unstopped.time_s
        );
    }
    format!(
        "{text}; delta-v is {:.3} m/s at {:.1} ms, the lowest velocity up to the end of the event at {:.1} ms ({}){}",
        impact_speed_m_per_s - unstopped.velocity_m_per_s,
        1e3 * unstopped.time_s,
        1e3 * unstopped.end_s,
        unstopped.end.name(),
        if unstopped.end == EventEnd::Record { ": a lower bound, it still changes there" } else { "" }
    )
}

/// Restitution that is usual at 50 km/h and above, and the lowest that is.
const USUAL: [f64; 2] = [0.15, 0.05];
/// Impact speeds of tests, km/h; another one explains no pulse.
const TESTED_KM_PER_H: std::ops::RangeInclusive<f64> = 5.0..=150.0;

/// A question about the impact speed, with the speed that would fit: the motion rebounds faster than a vehicle does, or
/// never comes to rest. `None` where the speed may be right, or where nothing stops the motion at all.
///
/// The change of velocity `dv = v0 - v_s` does not depend on the stated speed, so `dv/(1 + e)` is the impact speed for
/// a restitution e against a rigid barrier. A partner that gives way, or a glancing impact, leaves speed as well.
pub fn question_speed(motion: &Motion, events: &CrashEvents, impact_speed_m_per_s: f64) -> Option<String> {
    let v0 = impact_speed_m_per_s;
    if v0.is_nan() || v0 <= 0.0 {
        return None;
    }
    let change = events.delta_v_m_per_s(v0)?;
    let fitting = |e: f64| 3.6 * change / (1.0 + e);
    let (high, [usual, low]) = (fitting(largest_restitution(f64::INFINITY)), USUAL.map(fitting));
    let stated = format!("check the impact speed ({:.1} km/h)", 3.6 * v0);
    let fits = if TESTED_KM_PER_H.contains(&usual) {
        format!("{usual:.0} km/h would fit ({high:.0} to {low:.0} km/h); if it is right, check")
    } else {
        "no speed of a test fits this pulse; check".to_owned()
    };
    match (events.restitution(v0), events.unstopped) {
        (Some(e), _) if e > largest_restitution(v0) => Some(format!(
            "{stated}: the car would rebound at {:.0} % of it, real cars stay below {:.0} %. {fits} unit, zero level \
             and class of the channel",
            100.0 * e,
            100.0 * largest_restitution(v0)
        )),
        // The next impact, or what the record does not show any more, may stop it.
        (None, Some(unstopped)) if unstopped.end == EventEnd::Quiet => {
            let end = motion.velocity.samples().last().copied().unwrap_or(v0);
            Some(format!(
                "{stated}: the car would not stop, it would still move at {:.0} km/h. {fits} whether the impact was \
                 glancing or the partner gave way",
                3.6 * end
            ))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_metrics::crash_events;
    use crumple_signal::{IntegrationRule, IntegrationSettings, IntegrationStart, Signal, integrate};

    use crate::events_of;

    fn wrong(v: &[f64]) -> bool {
        wrong_sign(&Signal::new(-0.5, 0.5, v.to_vec()).unwrap(), 4.0)
    }

    #[test]
    fn a_velocity_that_doubles_before_it_vanishes_is_of_the_wrong_sign() {
        assert!(wrong(&[4.0, 4.0, 6.0, 8.5, 9.0]));
        assert!(wrong(&[4.0, 4.0, 9.0, 3.0, -1.0]));
        assert!(!wrong(&[4.0, 4.0, 1.0, -0.5, 9.0]));
        // Neither is reached, and what comes before contact does not count.
        assert!(!wrong(&[4.0, 4.0, 5.0, 6.0]));
        assert!(!wrong(&[9.0, 4.0, 3.0]));
        assert!(!wrong_sign(&Signal::new(0.0, 0.5, vec![0.0, 1.0]).unwrap(), 0.0));
        assert!(!wrong_sign(&Signal::new(0.0, 0.5, vec![]).unwrap(), 4.0));
    }

    fn notes_of(a: Vec<f64>) -> Vec<String> {
        let settings = IntegrationSettings {
            rule: IntegrationRule::Trapezoid,
            start: IntegrationStart::Auto,
            impact_speed_m_per_s: 4.0,
            low_pass_filtered: false,
        };
        let motion = integrate(&Signal::new(0.0, 0.5, a).unwrap(), &settings).unwrap();
        let events = crash_events(&motion.velocity, &motion.displacement).unwrap();
        findings(&motion, &events, 4.0).to_texts()
    }

    #[test]
    fn a_record_that_ends_too_early_says_at_which_velocity() {
        assert_eq!(
            notes_of(vec![-2.0; 3]),
            ["warning: the velocity never reaches zero, the record ends at v = 2.000 m/s: dynamic crush and \
                 rebound are not in the record"]
        );
    }

    #[test]
    fn a_pulse_of_the_wrong_polarity_is_flagged() {
        let notes = notes_of(vec![2.0; 3]);
        assert!(notes[0].starts_with("warning: the record ends at 6.000 m/s, faster than the impact"), "{notes:?}");
    }

    #[test]
    fn a_rebound_faster_than_the_impact_is_flagged() {
        // From 4 m/s by 1 m/s a sample to -5 m/s.
        let faster = "warning: the rebound at -5.000 m/s is faster than the impact at 4.000 m/s";
        assert!(notes_of(vec![-2.0; 10]).iter().any(|note| note.starts_with(faster)));
        assert!(notes_of(vec![-2.0; 9]).iter().all(|note| !note.contains("faster than the impact")));
    }

    #[test]
    fn a_record_cut_during_rebound_is_still_separating() {
        let notes = notes_of(vec![-2.0; 7]);
        assert!(notes[0].starts_with("warning: still separating"), "{notes:?}");
        assert_eq!(notes[1], "centroid time: 1000.000 ms from C/v0, 1000.000 ms from the pulse, +0.000 % apart");
    }

    /// The notes on the centroid of a half sine of 90 ms and 14 m/s, sampled at an interval, with a level before
    /// contact.
    fn of_centroid(dt_s: f64, level_before: f64) -> Vec<String> {
        let peak = 1.1 * 14.0 * std::f64::consts::PI / (2.0 * 0.09);
        let at = |t: f64| match t {
            t if t < 0.0 => level_before,
            t if t < 0.09 => -peak * (std::f64::consts::PI * t / 0.09).sin(),
            _ => 0.0,
        };
        let samples = (0..(0.25 / dt_s) as usize).map(|k| at(k as f64 * dt_s - 0.05)).collect();
        let settings = IntegrationSettings {
            rule: IntegrationRule::Trapezoid,
            start: IntegrationStart::RecordStart,
            impact_speed_m_per_s: 14.0,
            low_pass_filtered: true,
        };
        let motion = integrate(&Signal::new(-0.05, dt_s, samples).unwrap(), &settings).unwrap();
        let events = events_of(&motion, 14.0).unwrap();
        findings(&motion, &events, 14.0).to_texts().into_iter().filter(|note| note.contains("centroid")).collect()
    }

    #[test]
    fn a_gap_of_centroid_times_is_blamed_on_what_causes_it() {
        let fine = of_centroid(1e-4, 0.0);
        assert!(fine[0].ends_with("% apart"), "{fine:?}");
        // 5 m/s² for 50 ms before contact: the vehicle arrives with 13.75 m/s, which is no fault of the sampling.
        let early = of_centroid(1e-4, -5.0);
        assert!(early[0].contains("the velocity is 13.750 m/s at contact"), "{early:?}");
        let coarse = of_centroid(1e-2, 0.0);
        assert!(coarse[0].ends_with("is crude for this pulse"), "{coarse:?}");
    }

    /// A half-sine of 90 ms that takes `change` off the speed.
    fn question(change_m_per_s: f64, v0: f64) -> Option<String> {
        let peak = change_m_per_s * std::f64::consts::PI / (2.0 * 0.09);
        let at = |t: f64| if t < 0.09 { -peak * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 };
        let a = Signal::new(0.0, 1e-4, (0..2000).map(|k| at(f64::from(k) * 1e-4)).collect()).unwrap();
        let settings = IntegrationSettings {
            rule: IntegrationRule::Trapezoid,
            start: IntegrationStart::Auto,
            impact_speed_m_per_s: v0,
            low_pass_filtered: false,
        };
        let motion = integrate(&a, &settings).unwrap();
        let events = events_of(&motion, v0).unwrap();
        question_speed(&motion, &events, v0)
    }

    #[test]
    fn a_speed_that_does_not_fit_the_pulse_is_questioned_with_one_that_does() {
        let v0 = 50.0 / 3.6;
        let true_change = 1.15 * v0;
        assert_eq!(question(true_change, v0), None);
        for (stated_km_per_h, words) in
            [(35.0, "rebound at 64 % of it"), (80.0, "not stop, it would still move at 23 km/h")]
        {
            let question = question(true_change, stated_km_per_h / 3.6).unwrap();
            assert!(question.contains(words) && question.contains("50 km/h would fit"), "{question}");
        }
        // At walking pace a bumper springs back.
        assert_eq!(question(1.5 * 8.0 / 3.6, 8.0 / 3.6), None);
        assert!(question(1.4 * v0, v0).unwrap().contains("below 30 %"));
    }

    #[test]
    fn no_speed_is_named_that_nobody_tests_at() {
        let question = question(15.0 * 9.806_65, 13.9).unwrap();
        assert!(question.contains("no speed of a test fits"), "{question}");
    }

    #[test]
    fn nothing_is_asked_of_a_motion_from_rest_or_without_an_event() {
        assert_eq!(question(15.0, 0.0), None);
        assert_eq!(question(0.0, 15.0), None);
    }
}
