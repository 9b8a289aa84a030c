use crumple_signal::{Signal, Velocity};

/// Mean deceleration over `from_s ..= to_s`, m/s², positive when braking: `(v(from) - v(to))/(to - from)` ("x-mean").
///
/// From the velocity with linear interpolation, never a mean of samples: that one depends on where the samples
/// fall. Times are on the signal's own axis; `None` if they are out of order or outside the record.
pub fn mean_deceleration(velocity: &Signal<Velocity>, from_s: f64, to_s: f64) -> Option<f64> {
    if from_s >= to_s {
        return None;
    }
    Some((velocity.at(from_s)? - velocity.at(to_s)?) / (to_s - from_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_the_velocity_at_both_ends() {
        let v = Signal::new(0.0, 1.0, vec![10.0, 8.0, 2.0]).unwrap();
        assert_eq!(mean_deceleration(&v, 0.5, 1.5), Some(4.0));
        assert_eq!(mean_deceleration(&v, 0.5, 2.5), None);
        assert_eq!(mean_deceleration(&v, 1.0, 1.0), None);
    }
}
