//! Whether the stated impact speed and the pulse can belong together.

use crumple_metrics::{CrashEvents, EventEnd};

use crate::Motion;

/// Largest coefficient of restitution of a vehicle against a barrier at [`AT_M_PER_S`] and above.
const LARGEST: f64 = 0.3;
/// 50 km/h.
const AT_M_PER_S: f64 = 50.0 / 3.6;
/// What is usual at such speeds: at most, about, at least.
const USUAL: [f64; 3] = [LARGEST, 0.15, 0.05];

/// The largest coefficient of restitution that a vehicle is believed at an impact speed: 0.3 at 50 km/h and above, more
/// at lower speeds, where less of the structure yields: `0.3·sqrt(50 km/h / v0)`, at most 1. A rule of thumb: 0.36 at
/// 35 km/h, 0.67 at 10 km/h.
pub fn largest_restitution(impact_speed_m_per_s: f64) -> f64 {
    (LARGEST * (AT_M_PER_S / impact_speed_m_per_s).sqrt().max(1.0)).min(1.0)
}

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
    let [high, usual, low] = USUAL.map(|e| 3.6 * change / (1.0 + e));
    let fits = format!("{usual:.0} km/h would fit this pulse at a rigid barrier ({high:.0} to {low:.0} km/h)");
    let stated = format!("{v0:.3} m/s ({:.1} km/h)", 3.6 * v0);
    match (events.restitution(v0), events.unstopped) {
        (Some(e), _) if e > largest_restitution(v0) => Some(format!(
            "is the impact speed of {stated} right? The velocity rebounds at {e:.2} of it, where a vehicle keeps at \
             most \
             {:.2}: {fits}; else check unit, zero level and class of the channel",
            largest_restitution(v0)
        )),
        (None, Some(unstopped)) => {
            let end = motion.velocity.samples().last().copied().unwrap_or(v0);
            let or_else = match unstopped.end {
                EventEnd::Record => "the record ends before the vehicle stops",
                EventEnd::Quiet => "the vehicle goes on, as after a glancing impact or with a partner that gives way",
            };
            Some(format!(
                "is the impact speed of {stated} right? The velocity never comes to rest and ends at {end:.3} m/s: \
                 {fits}; \
                 else {or_else}"
            ))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rule, Settings, Start, events_of, integrate};
    use crumple_signal::Signal;

    /// A half-sine of 90 ms that takes `change` off the speed.
    fn question(change_m_per_s: f64, v0: f64) -> Option<String> {
        let peak = change_m_per_s * std::f64::consts::PI / (2.0 * 0.09);
        let at = |t: f64| if t < 0.09 { -peak * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 };
        let a = Signal::new(0.0, 1e-4, (0..2000).map(|k| at(f64::from(k) * 1e-4)).collect()).unwrap();
        let settings = Settings {
            rule: Rule::Trapezoid,
            start: Start::Auto,
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
        for (stated_km_per_h, words) in [(35.0, "rebounds at 0.64"), (80.0, "never comes to rest")] {
            let question = question(true_change, stated_km_per_h / 3.6).unwrap();
            assert!(question.contains(words) && question.contains("50 km/h would fit"), "{question}");
        }
        // At walking pace a bumper springs back.
        assert_eq!(question(1.5 * 8.0 / 3.6, 8.0 / 3.6), None);
        assert!(question(1.4 * v0, v0).unwrap().contains("at most 0.30"));
    }

    #[test]
    fn nothing_is_asked_of_a_motion_from_rest_or_without_an_event() {
        assert_eq!(question(15.0, 0.0), None);
        assert_eq!(question(0.0, 15.0), None);
    }
}
