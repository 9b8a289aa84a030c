//! What a record says by itself of slower impacts: a plastic structure takes the same energy to the same crush.

/// Slower impacts, over the tested speed: 34 to 53 km/h after 56.
const SHARES: std::ops::RangeInclusive<u32> = 60..=95;
/// Between two of them, percent.
const STEP: usize = 5;

/// The largest relative error of the crush at 0.60 to 0.95 of the tested speed, of a model beside its record, both
/// displacements from contact to dynamic crush, m, `dt_s` apart; `None` where one of them does not slow down that far.
///
/// One mass on a plastic structure without rate effect obeys `v² = v0² - 2 E(x)/m`, whatever its curve: an impact at
/// `s v0` ends where the velocity of the tested one has fallen to `v0 sqrt(1 - s²)`. So the record holds its own crush
/// at every lower speed, and a curve that misses these predicts them wrongly. A rate effect moves model and record
/// alike.
pub fn crush_error_at_lower_speeds(record_m: &[f64], model_m: &[f64], dt_s: f64, impact_speed: f64) -> Option<f64> {
    let mut largest = 0.0_f64;
    for percent in SHARES.step_by(STEP) {
        let velocity = impact_speed * (1.0 - (f64::from(percent) / 100.0).powi(2)).sqrt();
        let of_record = place_of_velocity(record_m, dt_s, velocity)?;
        largest = largest.max((place_of_velocity(model_m, dt_s, velocity)? / of_record - 1.0).abs());
    }
    largest.is_finite().then_some(largest)
}

/// Where a motion has slowed down to a velocity, m, straight between samples; velocities by central differences.
fn place_of_velocity(displacement_m: &[f64], dt_s: f64, velocity: f64) -> Option<f64> {
    let mut before: Option<(f64, f64)> = None;
    for three in displacement_m.windows(3) {
        let now = ((three[2] - three[0]) / (2.0 * dt_s), three[1]);
        if now.0 <= velocity {
            let (faster, at) = before?;
            return Some(at + (now.1 - at) * (faster - velocity) / (faster - now.0));
        }
        before = Some(now);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 1e-4;

    /// Crush of a linear spring goes as the speed: at `s v0` it is `s C`.
    fn linear(omega: f64) -> Vec<f64> {
        let samples = (0.5 * std::f64::consts::PI / omega / DT_S) as u32;
        (0..=samples).map(|k| 15.0 / omega * (omega * f64::from(k) * DT_S).sin()).collect()
    }

    #[test]
    fn the_record_of_a_linear_spring_holds_its_crush_at_lower_speeds() {
        for percent in SHARES.step_by(STEP) {
            let share = f64::from(percent) / 100.0;
            let place = place_of_velocity(&linear(25.0), DT_S, 15.0 * (1.0 - share * share).sqrt()).unwrap();
            // Central differences and straight lines between samples: both of the order of (25 DT)².
            assert!((place - share * 15.0 / 25.0).abs() < 1e-5, "{place}");
        }
    }

    #[test]
    fn a_softer_spring_errs_by_the_root_of_the_ratio_and_a_motion_that_goes_on_is_not_compared() {
        let error = crush_error_at_lower_speeds(&linear(25.0), &linear(20.0), DT_S, 15.0).unwrap();
        assert!((error - 0.25).abs() < 1e-4, "{error}");
        let steady: Vec<f64> = (0..700).map(|k| 15.0 * f64::from(k) * DT_S).collect();
        assert_eq!(crush_error_at_lower_speeds(&linear(25.0), &steady, DT_S, 15.0), None);
        assert_eq!(crush_error_at_lower_speeds(&linear(25.0)[..2], &linear(25.0), DT_S, 15.0), None);
    }
}
