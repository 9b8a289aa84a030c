//! Acceleration from the change of velocity that an event data recorder keeps.

use crumple_signal::{Notes, STANDARD_GRAVITY_M_PER_S2, Sampled, SignalError};

/// Acceleration from the change of velocity that an event data recorder keeps, on the same grid.
///
/// Central differences `a[k] = (v[k+1] - v[k-1]) / (2 dt)`, one-sided ones at both ends. Exact for a velocity that is a
/// parabola, but for the ends. The trapezoid of the result is the velocity smoothed by (1, 2, 1)/4, and the velocity
/// itself at both ends: the change over the whole event is kept. A peak that is shorter than some samples is lost.
/// Fewer than two samples give zeros. Gain of the difference against the true derivative:
/// `sin(2π·f·dt)/(2π·f·dt)`, -3 dB at 0.22 of the sampling rate and zero at half of it.
pub fn acceleration_of_velocity_change(change: &Sampled) -> Result<Sampled, SignalError> {
    let (v, dt_s) = (change.samples(), change.dt_s());
    let last = v.len().saturating_sub(1);
    let slope = |k: usize| {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(last));
        if to > from { (v[to] - v[from]) / ((to - from) as f64 * dt_s) } else { 0.0 }
    };
    Sampled::new(change.t0_s(), dt_s, (0..v.len()).map(slope).collect())
}

/// Units in which recorders print a velocity: km/h, mph, m/s.
const PRINTED_UNITS_M_PER_S: [f64; 3] = [1.0 / 3.6, 0.44704, 1.0];

/// The step in which a change of velocity is printed, m/s: the largest of 1, 0.5, 0.1, 0.05, 0.01 and 0.001 km/h, mph
/// or m/s of which all its values are multiples; else the smallest difference between two of them that is no rounding.
/// `None` for a constant.
pub fn printed_step_m_per_s(change: &Sampled) -> Option<f64> {
    let mut values = change.samples().to_vec();
    values.sort_unstable_by(f64::total_cmp);
    let range = values.last()? - values.first()?;
    // 1e-9 of the range: products with a unit differ in the last bits only.
    let differences = values.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 1e-9 * range);
    let smallest = differences.reduce(f64::min)?;
    let is_multiple = |value: f64, step: f64| (value / step - (value / step).round()).abs() < 1e-6;
    [1.0, 0.5, 0.1, 0.05, 0.01, 0.001]
        .into_iter()
        .flat_map(|part| PRINTED_UNITS_M_PER_S.map(|unit| part * unit))
        .filter(|step| values.iter().all(|value| is_multiple(*value, *step)))
        .reduce(f64::max)
        .or(Some(smallest))
}

/// What an acceleration derived from a change of velocity can be used for, as a warning among `notes`.
///
/// A printed step s leaves each velocity wrong by up to s/2, so a central difference by up to `s/(2·dt)`: 1.4 g for
/// whole km/h every 10 ms. `of` is the id of the channel it was derived from.
pub fn derivative_note(change: &Sampled, of: &str, notes: &mut Notes) {
    let dt_s = change.dt_s();
    let step = printed_step_m_per_s(change).map_or_else(String::new, |step| {
        format!(
            "; its values come in steps of {step:.3} m/s, so that a sample may be {:.2} g wrong by rounding alone",
            step / (2.0 * dt_s) / STANDARD_GRAVITY_M_PER_S2
        )
    });
    notes.warning(format!(
        "derived from the velocity change of channel {of} by central differences over {:.1} ms, not measured{step}; \
         {:.0} samples a second, and the filter of the recorder is not known: no class is applied, peaks, force and \
         what happens within {:.0} ms cannot be taken from it",
        2e3 * dt_s,
        change.rate_hz(),
        4e3 * dt_s
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(samples: &[f64]) -> Sampled {
        Sampled::new(0.0, 0.5, samples.to_vec()).unwrap()
    }

    #[test]
    fn the_derivative_of_a_parabola_is_exact_inside() {
        // v = -t², a = -2 t; at the ends the slope half an interval inside.
        let a = acceleration_of_velocity_change(&sampled(&[0.0, -0.25, -1.0, -2.25, -4.0])).unwrap();
        assert_eq!(a.samples(), [-0.5, -1.0, -2.0, -3.0, -3.5]);
        assert_eq!(acceleration_of_velocity_change(&sampled(&[3.0])).unwrap().samples(), [0.0]);
        assert!(acceleration_of_velocity_change(&sampled(&[])).unwrap().is_empty());
    }

    #[test]
    fn its_trapezoid_is_the_smoothed_velocity_and_keeps_the_whole_change() {
        let v = [0.0, -1.0, -4.0, -6.0, -6.5, -6.25];
        let a = acceleration_of_velocity_change(&sampled(&v)).unwrap();
        let mut sum = 0.0;
        for (k, pair) in a.samples().windows(2).enumerate() {
            sum += 0.25 * (pair[0] + pair[1]);
            let expected = match v.get(k + 2) {
                Some(next) => (v[k] + 2.0 * v[k + 1] + next) / 4.0,
                None => v[k + 1],
            };
            // Quarters of binary fractions: exact.
            assert_eq!(sum, expected, "{k}");
        }
    }

    #[test]
    fn the_step_of_the_print_is_found_in_si() {
        let km_per_h: Vec<f64> = [0, -3, -9, -14, -14, -13].iter().map(|v| f64::from(*v) / 3.6).collect();
        // 1 km/h; rounding of the differences.
        assert!((printed_step_m_per_s(&sampled(&km_per_h)).unwrap() - 1.0 / 3.6).abs() < 1e-12);
        assert_eq!(printed_step_m_per_s(&sampled(&[2.0, 2.0])), None);
        // Tenths of a km/h whose neighbours are never one tenth apart.
        let tenths: Vec<f64> = [0, -14, -47, -93, -121].iter().map(|v| f64::from(*v) / 36.0).collect();
        assert!((printed_step_m_per_s(&sampled(&tenths)).unwrap() - 1.0 / 36.0).abs() < 1e-12);
        // Of no printed step: the smallest difference.
        let odd = [0.0, -1.0 / 7.0, -std::f64::consts::PI];
        assert!((printed_step_m_per_s(&sampled(&odd)).unwrap() - 1.0 / 7.0).abs() < 1e-12);
        let mut notes = Notes::new();
        derivative_note(&Sampled::new(0.0, 0.01, km_per_h).unwrap(), "dv", &mut notes);
        let text = notes.to_texts().join("");
        assert!(text.contains("steps of 0.278 m/s") && text.contains("1.42 g wrong"), "{text}");
    }
}
