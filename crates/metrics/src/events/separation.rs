//! After separation: residual acceleration, restitution of two bodies.

use crumple_signal::{Signal, Velocity};

use crate::Metric;
use crate::metric::definitions::{RESTITUTION_TWO, SEPARATION};

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

/// Coefficient of restitution of two bodies, `(v2' - v1')/(v1 - v2)` from their velocities before and after.
pub fn restitution_of_two_bodies(before_m_per_s: [f64; 2], after_m_per_s: [f64; 2]) -> Metric {
    let closing = before_m_per_s[0] - before_m_per_s[1];
    if closing == 0.0 {
        return Metric::absent(&RESTITUTION_TWO, "the bodies do not approach each other");
    }
    Metric::with_value(&RESTITUTION_TWO, (after_m_per_s[1] - after_m_per_s[0]) / closing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_vehicle_has_no_acceleration() {
        let v = Signal::new(0.0, 0.005, vec![5.0, 0.0, -1.0, -1.0, -1.0, -1.0, -1.5]).unwrap();
        // 0.5 m/s over 20 ms.
        assert!((acceleration_after_separation(&v, 0.01).value.unwrap() - 25.0).abs() < 1e-10);
        assert_eq!(acceleration_after_separation(&v, 0.02).value, None);
    }

    #[test]
    fn two_bodies_part_at_a_share_of_their_closing_speed() {
        assert_eq!(restitution_of_two_bodies([10.0, 0.0], [4.0, 6.0]).value, Some(0.2));
        assert_eq!(restitution_of_two_bodies([1.0, 1.0], [0.0, 2.0]).value, None);
    }
}
