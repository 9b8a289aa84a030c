//! The pulse of a run as a small line.

use crate::drawing::sparkline;
use crumple_signal::Sampled;

/// Time that is shown after time zero: the same for all runs, so that lines compare.
pub const SHOWN_S: f64 = 0.15;

/// An acceleration over the first 150 ms after time zero, upwards as the vehicle slows down, each run to its own peak;
/// empty where there is nothing to draw.
pub fn pulse_line(acceleration: &Sampled, time_zero_s: f64) -> String {
    let samples = acceleration.samples().iter().enumerate();
    let points: Vec<[f64; 2]> = samples.map(|(k, a)| [acceleration.time_s(k) - time_zero_s, -a]).collect();
    sparkline(&points, [0.0, SHOWN_S]).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pulse_is_drawn_upwards_from_time_zero() {
        let samples: Vec<f64> = (0..400).map(|k| if (100..200).contains(&k) { -50.0 } else { 0.0 }).collect();
        let acceleration = Sampled::new(-0.05, 1e-3, samples).unwrap();
        // Contact is 50 ms after the record's own zero: at the left edge.
        let line = pulse_line(&acceleration, 0.05);
        assert!(line.contains("d=\"M0 1l") && line.contains(" 18"), "{line}");
        assert_eq!(pulse_line(&acceleration, 1.0), "");
    }
}
