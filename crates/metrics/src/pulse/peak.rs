//! The peak of an acceleration.

use crumple_signal::{Acceleration, Signal};

/// The sample of largest magnitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Its acceleration with its sign, m/s².
    pub acceleration_m_per_s2: f64,
    /// Its time on the signal's own axis, s.
    pub time_s: f64,
}

/// The sample of largest |a|, the earliest of equals; `None` without samples.
///
/// Not interpolated: the true peak of a signal between two samples is higher by at most `T²·max|a''|/8`.
/// State the channel frequency class beside it, the peak of an unfiltered channel is mostly ringing.
pub fn peak(acceleration: &Signal<Acceleration>) -> Option<Peak> {
    let a = acceleration.samples();
    let index = index_of_largest(a);
    Some(Peak { acceleration_m_per_s2: *a.get(index)?, time_s: acceleration.time_s(index) })
}

/// Index of the sample of largest magnitude, the earliest of equals; 0 without samples.
pub(crate) fn index_of_largest(samples: &[f64]) -> usize {
    // The maximum alone is found in several lanes at once; where it is, in a second pass up to there.
    let mut lanes = [0.0_f64; 8];
    let chunks = samples.chunks_exact(lanes.len());
    let rest = chunks.remainder();
    for chunk in chunks {
        for (lane, value) in lanes.iter_mut().zip(chunk) {
            let size = value.abs();
            *lane = if size > *lane { size } else { *lane };
        }
    }
    let largest = rest.iter().map(|value| value.abs()).chain(lanes).fold(0.0, f64::max);
    samples.iter().position(|value| value.abs() == largest).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_the_larger_magnitude_and_the_earlier_of_equals() {
        let signal = Signal::new(0.0, 1.0, vec![3.0, -5.0, 5.0, -5.0]).unwrap();
        assert_eq!(peak(&signal), Some(Peak { acceleration_m_per_s2: -5.0, time_s: 1.0 }));
        assert_eq!(peak(&Signal::new(0.0, 1.0, vec![]).unwrap()), None);
        for at in [0, 7, 8, 40, 41] {
            let mut samples: Vec<f64> = (0..42).map(|k| (f64::from(k)).sin()).collect();
            samples[at] = -2.0;
            assert_eq!(index_of_largest(&samples), at);
        }
    }
}
