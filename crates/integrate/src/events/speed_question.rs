//! Whether the stated impact speed and the pulse can belong together.

use crumple_metrics::{CrashEvents, EventEnd, largest_restitution};
use crumple_signal::Motion;

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
        (None, Some(unstopped)) => {
            let end = motion.velocity.samples().last().copied().unwrap_or(v0);
            let or_else = match unstopped.end {
                EventEnd::Record => "whether the record ends too early",
                EventEnd::Quiet => "whether the impact was glancing or the partner gave way",
            };
            Some(format!(
                "{stated}: the car would not stop, it would still move at {:.0} km/h. {fits} {or_else}",
                3.6 * end
            ))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::events_of;
    use crumple_signal::Signal;
    use crumple_signal::{IntegrationRule, IntegrationSettings, IntegrationStart, integrate};

    /// A half-sine of 90 ms that takes `change` off the speed.
    fn question(change_m_per_s: f64, v0: f64) -> Option<String> {
        let peak = change_m_per_s * std::f64::consts::PI / (2.0 * 0.09);
        let at = |t: f64| if t < 0.09 { -peak * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 };
        let a = Signal::new(0.0, 1e-4, (0..2000).map(|k| at(f64::from(k) * 1e-4)).collect()).unwrap();
        let settings = IntegrationSettings {
            rule: IntegrationRule::Trapezoid,
            start: IntegrationStart::Auto,
            time_zero_s: 0.0,
            impact_speed_m_per_s: v0,
            low_pass_filtered: false,
        };
        let motion = integrate(&a, &settings).unwrap();
        let events = events_of(&motion, 0.0, v0).unwrap();
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
