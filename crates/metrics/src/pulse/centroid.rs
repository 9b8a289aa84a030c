use crumple_signal::{Acceleration, Signal};

/// Centroid time t_c = C/v0 of the loading pulse, s.
///
/// Exact where velocity and displacement are consistent: `∫ t·a dt / ∫ a dt` over 0..t_m, by parts with v(t_m) = 0.
/// Huang, *Vehicle Crash Mechanics* (2002).
pub fn centroid_time_from_crush(dynamic_crush_m: f64, impact_speed_m_per_s: f64) -> f64 {
    dynamic_crush_m / impact_speed_m_per_s
}

/// Centroid time as the first moment of the pulse, `∫ t·a dt / ∫ a dt` from the first sample to `until_s`, s.
///
/// Times count from `time_zero_s`, `until_s` too. Trapezoid with a interpolated at `until_s`, error O(T²). With a t_m from the
/// same acceleration it equals [`centroid_time_from_crush`] by parts whatever the impact speed is: a gap above 0.1 %
/// says that the sampling or the rule is too crude for the pulse, or that C and t_m are from elsewhere.
/// `None` if the pulse has no area or `until_s` lies outside the record.
pub fn centroid_time_by_moment(acceleration: &Signal<Acceleration>, time_zero_s: f64, until_s: f64) -> Option<f64> {
    let a_end = acceleration.at(time_zero_s + until_s)?;
    let (mut area, mut moment) = (0.0, 0.0);
    let mut previous: Option<(f64, f64)> = None;
    let before_end = acceleration.samples().iter().enumerate().map(|(k, &a)| (acceleration.time_s(k) - time_zero_s, a));
    for (t, a) in before_end.take_while(|(t, _)| *t < until_s).chain(std::iter::once((until_s, a_end))) {
        if let Some((t_before, a_before)) = previous {
            area += (t - t_before) * (a_before + a) / 2.0;
            moment += (t - t_before) * (t_before * a_before + t * a) / 2.0;
        }
        previous = Some((t, a));
    }
    let centroid = moment / area;
    centroid.is_finite().then_some(centroid)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_pulse_has_its_centroid_in_the_middle() {
        let a = Signal::new(-1.0, 0.5, vec![-4.0; 9]).unwrap();
        assert_eq!(centroid_time_by_moment(&a, -1.0, 3.0), Some(1.5));
        assert_eq!(centroid_time_by_moment(&a, -1.0, 9.0), None);
    }

    #[test]
    fn a_signal_of_zeros_has_no_centroid() {
        assert_eq!(centroid_time_by_moment(&Signal::new(0.0, 0.5, vec![0.0; 9]).unwrap(), 0.0, 3.0), None);
    }
}
