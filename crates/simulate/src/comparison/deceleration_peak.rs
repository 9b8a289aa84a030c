//! The peak of a model's deceleration as a laboratory reads it.

use crumple_metrics::through_class;

/// Zero acceleration before contact, as a laboratory records it: the filter looks ahead.
const BEFORE_CONTACT_S: f64 = 0.04;
/// Channel frequency class of vehicle structures, Hz.
const CLASS_HZ: f64 = 60.0;

/// Largest deceleration through CFC 60, m/s², negative, of an acceleration from contact on. `None` where the interval
/// is too coarse for the class, or nothing slows down.
pub fn deceleration_peak(acceleration_m_per_s2: &[f64], dt_s: f64) -> Option<f64> {
    let before = (BEFORE_CONTACT_S / dt_s).round().min(1e6) as usize;
    let mut samples = vec![0.0; before];
    samples.extend_from_slice(acceleration_m_per_s2);
    let filtered = through_class(&samples, dt_s, CLASS_HZ)?;
    filtered.into_iter().skip(before).reduce(f64::min).filter(|peak| *peak < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_half_sine_keeps_its_peak_and_a_speed_up_has_none() {
        let sine = |scale: f64| -> Vec<f64> {
            (0..1000).map(|k| scale * (std::f64::consts::PI * f64::from(k) / 1000.0).sin()).collect()
        };
        // A half sine of 100 ms is 5 Hz: 1 - |H| of both passes at 125 Hz design is 2.6e-6.
        let peak = deceleration_peak(&sine(-200.0), 1e-4).unwrap();
        assert!((peak + 200.0).abs() < 0.01, "{peak}");
        assert_eq!(deceleration_peak(&sine(-200.0), 0.01), None);
    }
}
