//! The response of a class filter against the limits of SAE J211-1 and ISO 6487 (figure 1 of both).

use crate::{Cfc, Coefficients};

/// F_L, Hz: from here on the response is looked at.
const F_L_HZ: f64 = 0.1;
/// Frequencies looked at, in units of F_N; those below half the sampling rate.
const OF_F_N: [f64; 13] = [0.075, 0.15, 0.3, 0.45, 0.6, 0.75, 1.0, 1.25, 1.5, 2.0, 3.0, 5.0, 10.0];

/// The gain of a filter at one frequency, and the limits of its class there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorridorPoint {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Gain of both passes at the sampling rate of the record, dB.
    pub gain_db: f64,
    /// Upper limit, dB.
    pub upper_db: f64,
    /// Lower limit, dB; `None` above F_N.
    pub lower_db: Option<f64>,
}

impl CorridorPoint {
    /// Whether the gain lies between the limits.
    pub fn is_inside(&self) -> bool {
        self.gain_db <= self.upper_db && self.lower_db.is_none_or(|lower| self.gain_db >= lower)
    }
}

/// Upper and lower limit of the response of a class at a frequency, dB (SAE J211-1 Figure 1, ISO 6487 Figure 1).
///
/// With F_H the class and F_N = F_H/0.6 (1650 Hz at CFC 1000): +0.5 dB up to F_N; -0.5 dB up to F_H/2, -1 dB at F_H,
/// -4 dB at F_N, straight lines over the logarithm of frequency between them. Above F_N the upper limit falls by 9 dB
/// an octave to a floor of -30 dB (CFC 60, 180) or -40 dB (CFC 600, 1000), and there is no lower limit. Where the
/// sloping line begins is not confirmed; a slope of 24 dB an octave from F_N, as other descriptions have it, is
/// passed by no filter of four poles, the one of the standards included.
pub fn limits_db(cfc: Cfc, frequency_hz: f64) -> (f64, Option<f64>) {
    let (f_h, f_n) = (cfc.frequency_hz(), corner_hz(cfc));
    if frequency_hz > f_n * (1.0 + 1e-12) {
        let floor_db = if cfc <= Cfc::Cfc180 { -30.0 } else { -40.0 };
        return ((0.5 - 9.0 * (frequency_hz / f_n).log2()).max(floor_db), None);
    }
    let between = |(f0, db0): (f64, f64), (f1, db1): (f64, f64)| {
        db0 + (db1 - db0) * (frequency_hz / f0).log2() / (f1 / f0).log2()
    };
    let lower = if frequency_hz <= f_h / 2.0 {
        -0.5
    } else if frequency_hz <= f_h {
        between((f_h / 2.0, -0.5), (f_h, -1.0))
    } else {
        between((f_h, -1.0), (f_n, -4.0))
    };
    (0.5, Some(lower))
}

/// F_N, Hz: CFC/0.6 (100, 300, 1000 Hz), and 1650 Hz at CFC 1000.
fn corner_hz(cfc: Cfc) -> f64 {
    if cfc == Cfc::Cfc1000 { 1650.0 } else { cfc.frequency_hz() / 0.6 }
}

/// Compares the filter that is used, at the sampling rate it is used at, with the limits of a class.
///
/// Points in ascending frequency: 0.1 Hz (F_L), then 0.075 to 10 times F_N, as far as they lie below half the sampling
/// rate; up to 14 of them. Gains are the closed form, not measured on a signal. The filters of both standards are
/// inside from 10 samples per period of the class on; a filter designed for one pass, or of another class, is not.
pub fn corridor(cfc: Cfc, coefficients: &Coefficients) -> Vec<CorridorPoint> {
    let highest_hz = 0.5 / coefficients.dt_s();
    std::iter::once(F_L_HZ)
        .chain(OF_F_N.map(|ratio| ratio * corner_hz(cfc)))
        .filter(|f| *f < highest_hz)
        .map(|frequency_hz| {
            let (upper_db, lower_db) = limits_db(cfc, frequency_hz);
            CorridorPoint { frequency_hz, gain_db: coefficients.two_pass_gain_db(frequency_hz), upper_db, lower_db }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mode;

    #[test]
    fn the_filters_of_both_standards_keep_their_corridor_from_the_lowest_rate_on() {
        for cfc in Cfc::ALL {
            for mode in [Mode::Iso6487, Mode::SaeReflect] {
                for factor in [10.0, 20.0, 1000.0] {
                    let rate_hz = factor * cfc.frequency_hz();
                    for point in corridor(cfc, &Coefficients::new(cfc, mode, 1.0 / rate_hz)) {
                        assert!(point.is_inside(), "{cfc} {mode:?} {rate_hz} Hz: {point:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_filter_of_another_class_is_outside() {
        // Two common mistakes: the class as the -3 dB point of one pass (-6 dB at F_H), and a class too high.
        let lower = Coefficients::new(Cfc::Cfc60, Mode::Iso6487, 1e-5);
        assert!(corridor(Cfc::Cfc180, &lower).iter().any(|point| !point.is_inside()));
        let higher = Coefficients::new(Cfc::Cfc180, Mode::Iso6487, 1e-5);
        assert!(corridor(Cfc::Cfc60, &higher).iter().any(|point| !point.is_inside()));
    }

    #[test]
    fn the_limits_meet_at_the_corners() {
        assert_eq!(limits_db(Cfc::Cfc60, 30.0), (0.5, Some(-0.5)));
        assert_eq!(limits_db(Cfc::Cfc60, 60.0), (0.5, Some(-1.0)));
        assert_eq!(limits_db(Cfc::Cfc60, 100.0), (0.5, Some(-4.0)));
        assert_eq!(limits_db(Cfc::Cfc60, 200.0), (-8.5, None));
        assert_eq!((limits_db(Cfc::Cfc60, 5e3).0, limits_db(Cfc::Cfc600, 5e4).0), (-30.0, -40.0));
    }
}
