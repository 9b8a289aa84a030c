//! What a motion says about the crash: sign of the pulse, events, findings in words.

use crumple_metrics::{
    CrashEvents, DynamicCrush, EDR_CHANGE_M_PER_S, EventEnd, MetricsError, Unstopped, centroid_time_by_moment,
    centroid_time_from_crush, crash_events_within, largest_restitution,
};
use crumple_signal::{About, Motion, Note, Notes, Signal, UsedStart, Velocity, Weight, remarks};

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
        let highest_m_per_s = motion.velocity.samples().iter().copied().fold(impact_speed_m_per_s, f64::max);
        notes.push(WrongSign { impact_speed_m_per_s, highest_m_per_s });
        return notes;
    }
    if motion.start == UsedStart::RecordStart {
        notes.push(StartsBeforeContact { lead_s: -motion.velocity.t0_s() });
    }
    let end_velocity_m_per_s = events.end_velocity_m_per_s;
    if impact_speed_m_per_s == 0.0 {
        notes.push(FromRest { end_velocity_m_per_s });
        return notes;
    }
    if end_velocity_m_per_s > impact_speed_m_per_s {
        notes.push(EndsFaster { end_velocity_m_per_s, impact_speed_m_per_s });
    }
    let (Some(crush), Some(rebound)) = (events.crush, events.rebound) else {
        // What is shown has no crush then, so that nothing of it changes.
        notes.push(never_stops(events, impact_speed_m_per_s));
        return notes;
    };
    if rebound.still_separating {
        notes.push(StillSeparating {});
    }
    let rebound_m_per_s = rebound.velocity_m_per_s;
    if rebound_m_per_s.abs() > impact_speed_m_per_s {
        notes.push(ReboundTooFast { rebound_m_per_s, impact_speed_m_per_s });
    } else if rebound_m_per_s > 0.0 {
        notes.push(NoRebound { time_s: Some(crush.time_s), left_m_per_s: Some(rebound_m_per_s) });
    } else if rebound_m_per_s == 0.0 {
        notes.push(NoRebound { time_s: None, left_m_per_s: None });
    }
    if let Some(first_s) = events.later_zeros_s.first().copied() {
        notes.push(LaterZeros { count: events.later_zeros_s.len(), first_s });
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
    let from_crush_s = centroid_time_from_crush(crush.displacement_m, v0);
    let gap = by_moment / from_crush_s - 1.0;
    if (by_moment / by_parts - 1.0).abs() > CENTROID_GAP {
        notes.push(CentroidTimesApart { from_crush_s, from_pulse_s: by_moment, gap });
    } else {
        notes.push(CentroidTimes {
            from_crush_s,
            from_pulse_s: by_moment,
            gap,
            at_contact_m_per_s: velocity.at(0.0).unwrap_or(*first_v),
            at_stop_m_per_s: left_m_per_s,
            impact_speed_m_per_s: v0,
        });
    }
}

/// Both centroid times and their gap in words.
fn centroid_times(from_crush_s: f64, from_pulse_s: f64, gap: f64) -> String {
    format!(
        "centroid time: {:.3} ms from C/v0, {:.3} ms from the pulse, {:+.3} % apart",
        1e3 * from_crush_s,
        1e3 * from_pulse_s,
        1e2 * gap
    )
}

/// What a velocity says that never reaches zero.
fn never_stops(events: &CrashEvents, impact_speed_m_per_s: f64) -> Note {
    let unstopped = events.unstopped;
    if let Some(Unstopped { velocity_m_per_s, time_s, end: EventEnd::Contact, .. }) = unstopped {
        let delta_v_m_per_s = impact_speed_m_per_s - velocity_m_per_s;
        return AnotherFollows { left_m_per_s: velocity_m_per_s, delta_v_m_per_s, time_s }.into();
    }
    NeverStops {
        end_velocity_m_per_s: events.end_velocity_m_per_s,
        lowest_m_per_s: unstopped.map(|unstopped| unstopped.velocity_m_per_s),
        delta_v_m_per_s: unstopped.map(|unstopped| impact_speed_m_per_s - unstopped.velocity_m_per_s),
        time_s: unstopped.map(|unstopped| unstopped.time_s),
        end_of_event_s: unstopped.map(|unstopped| unstopped.end_s),
        end_of_event: unstopped.map(|unstopped| unstopped.end.name().to_owned()),
    }
    .into()
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
pub fn question_speed(events: &CrashEvents, impact_speed_m_per_s: f64) -> Option<Note> {
    let v0 = impact_speed_m_per_s;
    if v0.is_nan() || v0 <= 0.0 {
        return None;
    }
    let change = events.delta_v_m_per_s(v0)?;
    let fitting = |e: f64| change / (1.0 + e);
    let [usual_m_per_s, highest_m_per_s] = USUAL.map(fitting);
    let lowest_m_per_s = fitting(largest_restitution(f64::INFINITY));
    match (events.restitution(v0), events.unstopped) {
        (Some(restitution), _) if restitution > largest_restitution(v0) => {
            let largest = largest_restitution(v0);
            let question = SpeedOrChannel {
                impact_speed_m_per_s,
                restitution,
                largest,
                usual_m_per_s,
                lowest_m_per_s,
                highest_m_per_s,
            };
            Some(question.into())
        }
        // The next impact, or what the record does not show any more, may stop it.
        (None, Some(unstopped)) if unstopped.end == EventEnd::Quiet => {
            let question = SpeedOrPartner {
                impact_speed_m_per_s,
                end_velocity_m_per_s: unstopped.velocity_m_per_s,
                usual_m_per_s,
                lowest_m_per_s,
                highest_m_per_s,
            };
            Some(question.into())
        }
        _ => None,
    }
}

/// The impact speed that would fit, from the largest restitution to the lowest that is usual.
fn fits(usual_m_per_s: f64, lowest_m_per_s: f64, highest_m_per_s: f64) -> String {
    let [usual, low, high] = [usual_m_per_s, lowest_m_per_s, highest_m_per_s].map(|speed| 3.6 * speed);
    if TESTED_KM_PER_H.contains(&usual) {
        format!("{usual:.0} km/h would fit ({low:.0} to {high:.0} km/h); if it is right, check")
    } else {
        "no speed of a test fits this pulse; check".to_owned()
    }
}

remarks! {
    /// Remarks of a motion and its events.
    pub REMARKS;

    /// The acceleration has the wrong sign: the velocity rises where the vehicle should be stopped.
    CR311 WrongSign { impact_speed_m_per_s: f64, highest_m_per_s: f64 }
    bears on (About::Pulse, Weight::Decisive)
    decided "The velocity reaches twice the impact speed before it reaches zero: with the other sign the vehicle \
             would have stopped. SAE J211-1 has x forward, so that a frontal pulse is negative."
    means "No events are written. Velocity and displacement show a vehicle that speeds up."
    remedy "turn the pulse at ingest with --sign flip; where that was given, leave it out"
    says format!(
        "{WRONG_SIGN}; the velocity rises from {impact_speed_m_per_s:.3} to {highest_m_per_s:.3} m/s, no events are \
         written"
    );

    /// The integration begins before contact.
    CR312 StartsBeforeContact { lead_s: f64 }
    bears on (About::Motion, Weight::None)
    decided "The pulse went through a low-pass filter and has samples before contact: integrate.start = \"auto\" takes \
             up to 50 ms of them. Or integrate.start asks for it."
    means "A filter without phase puts half of the jump at contact before it: a start at contact would lose that \
           velocity, 0.05 m/s of a jump of 10 g at CFC 60."
    remedy "nothing; integrate.start = \"time-zero\" begins at contact"
    says format!(
        "integration starts {:.1} ms before contact: the low-pass filter spreads the contact to both sides of it",
        1e3 * lead_s
    );

    /// The motion starts from rest, so that its velocity is the change of velocity.
    CR313 FromRest { end_velocity_m_per_s: f64 }
    bears on (About::Motion, Weight::None)
    decided "The impact speed is 0."
    means "There are no crash events: no dynamic crush, no rebound and no model of the structure."
    remedy "nothing for a sled; for a vehicle state the speed: --impact-speed 35km/h at ingest"
    says format!(
        "integrated from rest: the velocity is the change of velocity, {end_velocity_m_per_s:.3} m/s at the end; no \
         crash events"
    );

    /// The record ends faster than the impact was.
    CR314 EndsFaster { end_velocity_m_per_s: f64, impact_speed_m_per_s: f64 }
    bears on (About::Pulse, Weight::Decisive)
    decided "The velocity of the last sample is above the impact speed. SAE J211-1 has x forward, so that a frontal \
             pulse is negative."
    means "The sign, the zero level or the channel may be wrong, and crush and delta-v with it."
    remedy "check the sign of the pulse: --sign flip at ingest turns it"
    says format!(
        "the record ends at {end_velocity_m_per_s:.3} m/s, faster than the impact at {impact_speed_m_per_s:.3} m/s. \
         Check the sign: a frontal pulse is negative (SAE J211-1)"
    );

    /// The velocity never reaches zero: the vehicle does not stop in the record.
    CR315 NeverStops {
        end_velocity_m_per_s: f64, lowest_m_per_s: Option<f64>, delta_v_m_per_s: Option<f64>, time_s: Option<f64>,
        end_of_event_s: Option<f64>, end_of_event: Option<String>
    }
    bears on (About::Motion, Weight::Slight)
    decided "No sample from contact on is at or below zero. The event ends with the first 20 ms that change the \
             velocity by no more than 0.8 km/h (49 CFR 563.5), or with the record."
    means "There is no dynamic crush and no restitution. Delta-v is counted up to the end of the event."
    remedy "use delta-v; for the crush the impact speed must be right and the record long enough"
    says {
        let text = "the velocity never reaches zero: dynamic crush and rebound are not in the record";
        let [end, lowest, change] = [Some(*end_velocity_m_per_s), *lowest_m_per_s, *delta_v_m_per_s]
            .map(|speed| speed.map_or_else(String::new, |speed| format!("{:.1} km/h", 3.6 * speed)));
        let rises = lowest_m_per_s.is_some_and(|lowest| end_velocity_m_per_s - lowest >= EDR_CHANGE_M_PER_S);
        let after = format!(". It rises after that, to {end} at the end: drift, rotation or another push");
        match (time_s, end_of_event) {
            (Some(time_s), Some(event)) => format!(
                "{text}. It is lowest, {lowest}, at {:.1} ms: delta-v {change}{}{}",
                1e3 * time_s,
                if event == EventEnd::Record.name() { ", a lower bound, for it still changes there" } else { "" },
                if rises { after.as_str() } else { "" }
            ),
            _ => format!("{text}. It is {end} at the end of the record"),
        }
    };

    /// The impact leaves the vehicle speed, and another impact follows before it stops.
    CR316 AnotherFollows { left_m_per_s: f64, delta_v_m_per_s: f64, time_s: f64 }
    bears on (About::Motion, Weight::Slight)
    decided "The force of the impact ends while the velocity is positive, and the next impact begins. 15 ms without a \
             force separate two impacts."
    means "This impact has no dynamic crush and no rebound. Delta-v is counted up to the end of its force."
    remedy "use delta-v; --impact 2 at ingest takes the next impact"
    says format!(
        "this impact leaves the vehicle {left_m_per_s:.3} m/s, and another one follows: it has no dynamic crush and no \
         rebound; delta-v is {delta_v_m_per_s:.3} m/s at {:.1} ms",
        1e3 * time_s
    );

    /// The record ends while the vehicle still rebounds.
    CR317 StillSeparating {}
    bears on (About::Motion, Weight::Slight)
    decided "The lowest velocity is the last sample, and the force of the impact has not ended there."
    means "Restitution and delta-v are lower bounds. Dynamic crush and its time hold."
    remedy "use a longer record, or quote restitution and delta-v as lower bounds"
    says "still separating: the lowest velocity is the last sample, so restitution and delta-v are lower bounds";

    /// The vehicle rebounds faster than it came.
    CR318 ReboundTooFast { rebound_m_per_s: f64, impact_speed_m_per_s: f64 }
    bears on (About::Pulse, Weight::Decisive)
    decided "The rebound velocity is larger than the impact speed. A passive structure gives back less than it took."
    means "Unit, zero level or impact speed is wrong: crush, restitution and models are wrong with it."
    remedy "check the unit of the acceleration, its zero level, and the impact speed"
    says format!(
        "the rebound at {rebound_m_per_s:.3} m/s is faster than the impact at {impact_speed_m_per_s:.3} m/s, which no \
         passive vehicle does: check the unit of the acceleration, the zero level and the impact speed"
    );

    /// The vehicle stops and does not rebound.
    CR319 NoRebound { time_s: Option<f64>, left_m_per_s: Option<f64> }
    bears on (About::Motion, Weight::None)
    decided "The lowest velocity of the impact is zero, or positive and no larger than the stated error of the impact \
             speed."
    means "The coefficient of restitution is 0."
    remedy "nothing"
    says match time_s.zip(*left_m_per_s) {
        Some((time_s, left_m_per_s)) => format!(
            "the velocity left at {:.1} ms, {left_m_per_s:.3} m/s, is within the error of the impact speed: the \
             vehicle has stopped",
            1e3 * time_s
        ),
        None => "the velocity never gets below zero: no rebound, coefficient of restitution 0".to_owned(),
    };

    /// The velocity passes zero again after dynamic crush.
    CR320 LaterZeros { count: usize, first_s: f64 }
    bears on (About::Motion, Weight::None)
    decided "Changes of sign after the first zero are counted. Noise around zero makes many of them."
    means "Dynamic crush is at the first zero. The later ones are used for nothing."
    remedy "nothing"
    says format!(
        "the velocity passes zero {count} more times after dynamic crush, first at {:.1} ms; only the first zero \
         counts",
        1e3 * first_s
    );

    /// The centroid time of the pulse, from crush over impact speed and from the acceleration.
    CR321 CentroidTimes {
        from_crush_s: f64, from_pulse_s: f64, gap: f64, at_contact_m_per_s: f64, at_stop_m_per_s: f64,
        impact_speed_m_per_s: f64
    }
    bears on (About::Motion, Weight::None)
    decided "Both are equal where the velocity is the impact speed at contact and zero at the stop. The \
             acceleration is also compared with the motion by parts: 0.1 % is the error of sampling and summation."
    means "A larger gap comes from another velocity at contact or at the stop, not from the sampling."
    remedy "nothing; where the velocity at contact differs from the impact speed, check time zero and the zero level"
    says {
        let text = centroid_times(*from_crush_s, *from_pulse_s, *gap);
        let off_m_per_s = (at_contact_m_per_s - impact_speed_m_per_s).abs().max(*at_stop_m_per_s);
        if gap.abs() <= CENTROID_GAP {
            text
        } else if off_m_per_s <= CENTROID_GAP * impact_speed_m_per_s {
            text + ": the record moves before contact"
        } else {
            format!(
                "{text}: the velocity is {at_contact_m_per_s:.3} m/s at contact and {at_stop_m_per_s:.3} m/s at the \
                 stop, the impact speed {impact_speed_m_per_s:.3} m/s"
            )
        }
    };

    /// Both centroid times differ by more than the motion explains: the samples are too few for this pulse.
    CR322 CentroidTimesApart { from_crush_s: f64, from_pulse_s: f64, gap: f64 }
    bears on (About::Motion, Weight::Marked)
    decided "The time from the acceleration is compared with the one that the motion itself gives by parts; 0.1 % is \
             left."
    means "The sum over the samples is not the integral of the pulse: velocity and crush are off by about as much."
    remedy "use a record with a higher sampling rate, or integrate.rule = \"trapezoid\""
    says centroid_times(*from_crush_s, *from_pulse_s, *gap)
        + ": the sampling or the integration rule is crude for this pulse";

    /// The vehicle rebounds faster than vehicles do, so that impact speed or acceleration may be wrong.
    CR323 SpeedOrChannel {
        impact_speed_m_per_s: f64, restitution: f64, largest: f64, usual_m_per_s: f64, lowest_m_per_s: f64,
        highest_m_per_s: f64
    }
    bears on (About::ImpactSpeed, Weight::Decisive)
    decided "Against a barrier a restitution of 0.3 at 50 km/h and above is believed, below that \
             0.3 sqrt(50 km/h / v0): a rule of thumb. The change of velocity over one and the restitution is the \
             speed that fits: 0.15 is usual, 0.05 the lowest."
    means "Crush and energy go with the impact speed and its square. Delta-v needs no impact speed: it holds if the \
           acceleration does."
    remedy "check the impact speed first, then unit, zero level and class of the channel"
    says format!(
        "check the impact speed ({:.1} km/h): the car would rebound at {:.0} % of it, at this speed cars stay below \
         {:.0} %. {} unit, zero level and class of the channel",
        3.6 * impact_speed_m_per_s,
        100.0 * restitution,
        100.0 * largest,
        fits(*usual_m_per_s, *lowest_m_per_s, *highest_m_per_s)
    );

    /// The impact ends and the vehicle still moves, so that the impact speed may be wrong.
    CR324 SpeedOrPartner {
        impact_speed_m_per_s: f64, end_velocity_m_per_s: f64, usual_m_per_s: f64, lowest_m_per_s: f64,
        highest_m_per_s: f64
    }
    bears on (About::ImpactSpeed, Weight::Marked)
    decided "The velocity is positive where 20 ms change it by no more than 0.8 km/h (49 CFR 563.5). The change of \
             velocity over one and a restitution of 0.15 (0.05 to 0.3) is the speed that fits."
    means "A full impact on a rigid wall stops the vehicle: then the speed is wrong, and the motion with it. A \
           glancing impact, a small overlap say, or a partner that gives way, leaves the vehicle speed: then delta-v \
           holds, and there is no dynamic crush."
    remedy "check the impact speed; where the impact was glancing, state it: crumple run RECORD --overlap glancing"
    says format!(
        "check the impact speed ({:.1} km/h): the car would not stop, it would still move at {:.0} km/h. {} whether \
         the impact was glancing or the partner gave way",
        3.6 * impact_speed_m_per_s,
        3.6 * end_velocity_m_per_s,
        fits(*usual_m_per_s, *lowest_m_per_s, *highest_m_per_s)
    );
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
            ["warning: the velocity never reaches zero: dynamic crush and rebound are not in the record. It is 7.2 \
                 km/h at the end of the record"]
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
        question_speed(&events, v0).map(|question| question.text)
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
