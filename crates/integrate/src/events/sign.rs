//! Whether a pulse has the wrong sign, and the events of one that has not.

use crumple_metrics::{CrashEvents, MetricsError, crash_events};
use crumple_signal::{Motion, Signal, Velocity};

/// What is said of a pulse of the wrong sign.
pub const WRONG_SIGN: &str =
    "the pulse has the wrong sign: crumple-ingest --sign flip turns it (where that was given: leave it out)";

/// Whether a motion is that of a pulse with deceleration positive: the vehicle would come to rest if the acceleration
/// were mirrored (`v` reaches `2·v0`) before it does as it is.
///
/// The velocity of the mirrored pulse is `2·v0 - v`, which is zero where v is `2·v0`: no second integration is needed.
/// Only samples at or after time zero count. SAE J211-1 has x forward, so a frontal pulse is negative; nothing is
/// turned here, that is for who knows how the sensor was mounted.
///
/// A record that ends before either says nothing, neither does a motion from rest.
pub fn wrong_sign(velocity: &Signal<Velocity>, time_zero_s: f64, impact_speed_m_per_s: f64) -> bool {
    let v = velocity.samples();
    let first =
        v[velocity.index_at_or_after(time_zero_s)..].iter().find(|&&v| v <= 0.0 || v >= 2.0 * impact_speed_m_per_s);
    impact_speed_m_per_s > 0.0 && first.is_some_and(|&v| v > 0.0)
}

/// The crash events of a motion; none, whatever the velocity does, where the motion starts from rest or the pulse has
/// the wrong sign. Errors: [`crash_events`].
///
/// The velocity at the end of the record stays in the result, since it needs no crash. Times are in s from time zero:
/// t_m is the first zero of the velocity, interpolated linearly, and C the displacement there.
pub fn events_of(motion: &Motion, time_zero_s: f64, impact_speed_m_per_s: f64) -> Result<CrashEvents, MetricsError> {
    let events = crash_events(&motion.velocity, &motion.displacement, time_zero_s)?;
    if impact_speed_m_per_s > 0.0 && !wrong_sign(&motion.velocity, time_zero_s, impact_speed_m_per_s) {
        return Ok(events);
    }
    Ok(CrashEvents { crush: None, rebound: None, later_zeros_s: Vec::new(), unstopped: None, ..events })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wrong(v: &[f64]) -> bool {
        wrong_sign(&Signal::new(-0.5, 0.5, v.to_vec()).unwrap(), 0.0, 4.0)
    }

    #[test]
    fn a_velocity_that_doubles_before_it_vanishes_is_of_the_wrong_sign() {
        assert!(wrong(&[4.0, 4.0, 6.0, 8.5, 9.0]));
        assert!(wrong(&[4.0, 4.0, 9.0, 3.0, -1.0]));
        assert!(!wrong(&[4.0, 4.0, 1.0, -0.5, 9.0]));
        // Neither is reached, and what comes before time zero does not count.
        assert!(!wrong(&[4.0, 4.0, 5.0, 6.0]));
        assert!(!wrong(&[9.0, 4.0, 3.0]));
        assert!(!wrong_sign(&Signal::new(0.0, 0.5, vec![0.0, 1.0]).unwrap(), 0.0, 0.0));
        assert!(!wrong_sign(&Signal::new(0.0, 0.5, vec![]).unwrap(), 0.0, 4.0));
    }
}
