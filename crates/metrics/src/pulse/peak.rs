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
    let mut index = 0;
    let a = acceleration.samples();
    for (k, value) in a.iter().enumerate() {
        if value.abs() > a[index].abs() {
            index = k;
        }
    }
    Some(Peak { acceleration_m_per_s2: *a.get(index)?, time_s: acceleration.time_s(index) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_the_larger_magnitude_and_the_earlier_of_equals() {
        let signal = Signal::new(0.0, 1.0, vec![3.0, -5.0, 5.0, -5.0]).unwrap();
        assert_eq!(peak(&signal), Some(Peak { acceleration_m_per_s2: -5.0, time_s: 1.0 }));
        assert_eq!(peak(&Signal::new(0.0, 1.0, vec![]).unwrap()), None);
    }
}
