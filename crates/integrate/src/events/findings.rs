//! What a motion shows and what does not fit together, as notes.

use crumple_metrics::{CrashEvents, EventEnd, centroid_time_by_moment, centroid_time_from_crush};
use crumple_signal::{About, Motion, Notes, UsedStart, Weight};

use crate::{WRONG_SIGN, wrong_sign};

/// Relative gap of the two centroid times above which something does not fit: by parts they are equal, so 0.1 % is the
/// error of the sampling or of the rule of summation.
const CENTROID_GAP: f64 = 1e-3;

/// What a reader of the motion should know, in words: what the record does not show, and what does not fit together.
///
/// In this order, as far as they hold:
/// 1. the sign of the pulse is wrong: a warning, and nothing else is said ([`wrong_sign`]);
/// 2. the integration began with the record, not at time zero;
/// 3. the motion starts from rest: its velocity is the change of velocity, and nothing else is said;
/// 4. the record ends faster than the impact: a warning, the polarity may be wrong;
/// 5. the velocity never reaches zero: a warning, with the lowest velocity up to the end of the event (49 CFR 563.5)
///    where there is one, and nothing else is said;
/// 6. the lowest velocity is the last sample: a warning, restitution and delta-v are lower bounds;
/// 7. the rebound is faster than the impact: a warning, no passive vehicle does that. A velocity that never gets below
///    zero is noted as a restitution of 0;
/// 8. zeros of the velocity after the first, which are not used;
/// 9. the centroid time `t_c = C/v0` beside `∫t·a dt/∫a dt` up to t_m. They are equal by parts whatever v0 and the zero
///    level are, so a gap above 0.1 % is a warning about sampling or rule, never about the inputs.
///
/// `events` are those of `motion`; times in notes are in ms from time zero, but for the start of the integration, which
/// is on the record's axis.
pub fn findings(motion: &Motion, events: &CrashEvents, time_zero_s: f64, impact_speed_m_per_s: f64) -> Notes {
    let mut notes = Notes::new();
    if wrong_sign(&motion.velocity, time_zero_s, impact_speed_m_per_s) {
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
            "integrated from the start of the record ({:.1} ms) with the impact speed, \
             because a low-pass filter spreads the contact to both sides of time zero",
            1e3 * motion.velocity.t0_s()
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
                "the record ends at v = {:.3} m/s, faster than the impact at {impact_speed_m_per_s:.3} m/s: \
             a frontal pulse is negative (SAE J211-1), check the polarity of the channel",
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
    let from_crush = centroid_time_from_crush(crush.displacement_m, impact_speed_m_per_s);
    if let Some(by_moment) = centroid_time_by_moment(&motion.acceleration, time_zero_s, crush.time_s) {
        let gap = (by_moment - from_crush) / from_crush;
        let text = format!(
            "centroid time {:.3} ms from C/v0 and {:.3} ms from the pulse itself, {:+.3} % apart",
            1e3 * from_crush,
            1e3 * by_moment,
            1e2 * gap
        );
        if gap.abs() <= CENTROID_GAP {
            notes.info(text);
        } else {
            notes.concern(
                About::Motion,
                Weight::Marked,
                text + ": the sampling or the integration rule is crude for this pulse",
            );
        }
    }
    notes
}

/// What a velocity says that never reaches zero.
fn never_stops(events: &CrashEvents, impact_speed_m_per_s: f64) -> String {
    let text = format!(
        "the velocity never reaches zero, the record ends at v = {:.3} m/s: no dynamic crush, no rebound",
        events.end_velocity_m_per_s
    );
    let Some(unstopped) = events.unstopped else { return text };
    format!(
        "{text}; delta-v is {:.3} m/s at {:.1} ms, the lowest velocity up to the end of the event at {:.1} ms ({}){}",
        impact_speed_m_per_s - unstopped.velocity_m_per_s,
        1e3 * unstopped.time_s,
        1e3 * unstopped.end_s,
        unstopped.end.name(),
        if unstopped.end == EventEnd::Record { ": a lower bound, it still changes there" } else { "" }
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_metrics::crash_events;
    use crumple_signal::Signal;
    use crumple_signal::{IntegrationRule, IntegrationSettings, IntegrationStart, integrate};

    fn notes_of(a: Vec<f64>) -> Vec<String> {
        let settings = IntegrationSettings {
            rule: IntegrationRule::Trapezoid,
            start: IntegrationStart::Auto,
            time_zero_s: 0.0,
            impact_speed_m_per_s: 4.0,
            low_pass_filtered: false,
        };
        let motion = integrate(&Signal::new(0.0, 0.5, a).unwrap(), &settings).unwrap();
        let events = crash_events(&motion.velocity, &motion.displacement, 0.0).unwrap();
        findings(&motion, &events, 0.0, 4.0).to_texts()
    }

    #[test]
    fn a_record_that_ends_too_early_says_at_which_velocity() {
        assert_eq!(
            notes_of(vec![-2.0; 3]),
            ["warning: the velocity never reaches zero, the record ends at v = 2.000 m/s: no dynamic crush, no \
                 rebound"]
        );
    }

    #[test]
    fn a_pulse_of_the_wrong_polarity_is_flagged() {
        let notes = notes_of(vec![2.0; 3]);
        assert!(notes[0].starts_with("warning: the record ends at v = 6.000 m/s, faster than the impact"), "{notes:?}");
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
        assert_eq!(
            notes[1],
            "centroid time 1000.000 ms from C/v0 and 1000.000 ms from the pulse itself, +0.000 % apart"
        );
    }
}
