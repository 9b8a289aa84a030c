//! The difference equation of a class: SAE J211-1 Appendix C, ISO 6487 Annex A.

use std::f64::consts::{PI, SQRT_2};

use crate::{Cfc, Mode};

/// One pass of a two-pole Butterworth low-pass:
/// `y[i] = a0·x[i] + a1·x[i-1] + a2·x[i-2] + b1·y[i-1] + b2·y[i-2]` (mind the plus signs of b1 and b2).
///
/// SAE J211-1 Appendix C, ISO 6487 Annex A. Run forward and backward it has four poles and no phase.
///
/// The five numbers sum to 1 (gain 1 at 0 Hz, so the area of a pulse and its change of velocity stay). CFC 60 at 10 kHz
/// after ISO 6487: a0 = 0.00146032, b1 = 1.889033, b2 = -0.894874.
///
/// A mistake often made is to design one pass with its -3 dB point at CFC/0.6: both passes then have -6 dB there. The
/// factor κ in the design frequency is what corrects for the second pass, `κ = (√2 - 1)^(-1/4)/0.6` ≈ 2.0775.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// Factor of `x[i]`.
    pub a0: f64,
    /// Factor of `x[i-1]`.
    pub a1: f64,
    /// Factor of `x[i-2]`.
    pub a2: f64,
    /// Factor of `y[i-1]`.
    pub b1: f64,
    /// Factor of `y[i-2]`.
    pub b2: f64,
    /// Prewarped design frequency wa = tan(π·CFC·κ·T).
    warped: f64,
    mode: Mode,
    dt_s: f64,
}

impl Coefficients {
    /// The filter of a class for one sampling interval, by the bilinear transform: `wd = 2π·CFC·κ`, `wa =
    /// tan(wd·T/2)`, `D = 1 + √2·wa + wa²`, `a0 = wa²/D`, `b1 = -2(wa² - 1)/D`, `b2 = (-1 + √2·wa - wa²)/D`.
    ///
    /// The warp of the bilinear transform is exact at -6 dB (CFC·κ); at ten samples per CFC period the -3 dB point has
    /// moved from 1.667·CFC to 1.751·CFC. Below a rate of 4.2 CFC there is no such filter; see
    /// [`Cfc::lowest_rate_hz`] for the limit that the standards set.
    pub fn new(cfc: Cfc, mode: Mode, dt_s: f64) -> Self {
        let design_rad_per_s = 2.0 * PI * cfc.frequency_hz() * mode.frequency_factor();
        let wa = (design_rad_per_s * dt_s / 2.0).tan();
        let d = 1.0 + SQRT_2 * wa + wa * wa;
        let a0 = wa * wa / d;
        Self {
            a0,
            a1: 2.0 * a0,
            a2: a0,
            b1: -2.0 * (wa * wa - 1.0) / d,
            b2: (-1.0 + SQRT_2 * wa - wa * wa) / d,
            warped: wa,
            mode,
            dt_s,
        }
    }

    /// The standard they were made after.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The sampling interval they were made for, s.
    pub fn dt_s(&self) -> f64 {
        self.dt_s
    }

    /// a0, a1, a2, b1, b2, the order in which artifacts and the recursion hold them.
    pub fn to_array(self) -> [f64; 5] {
        [self.a0, self.a1, self.a2, self.b1, self.b2]
    }

    /// Amplitude gain of both passes at a frequency up to half the sampling rate: `1/(1 + (tan(π·f·T)/wa)⁴)`.
    ///
    /// It is the square of the gain of one pass, 1 at 0 Hz, 1/2 at the design frequency CFC·κ and 0 at half the
    /// sampling rate. It holds inside a record; the first and last milliseconds depend on the ends.
    pub fn two_pass_gain(&self, frequency_hz: f64) -> f64 {
        let ratio = (PI * frequency_hz * self.dt_s).tan() / self.warped;
        1.0 / (1.0 + ratio.powi(4))
    }

    /// [`two_pass_gain`](Self::two_pass_gain) in dB, `20·log10(gain)`: -0.45 dB at CFC and -3.01 dB at CFC/0.6 (SAE,
    /// fast sampling).
    pub fn two_pass_gain_db(&self, frequency_hz: f64) -> f64 {
        20.0 * self.two_pass_gain(frequency_hz).log10()
    }

    /// Frequency at which both passes together leave 1/√2 of the amplitude (-3.01 dB), Hz:
    /// `atan(wa·(√2 - 1)^(1/4))/(π·T)`, the inverse of the closed form of the gain.
    pub fn half_power_frequency_hz(&self) -> f64 {
        (self.warped * (SQRT_2 - 1.0).powf(0.25)).atan() / (PI * self.dt_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_passes_unchanged() {
        for cfc in Cfc::ALL {
            for mode in [Mode::Iso6487, Mode::SaeReflect] {
                for rate_hz in [10_000.0, 20_000.0, 100_000.0] {
                    let sum: f64 = Coefficients::new(cfc, mode, 1.0 / rate_hz).to_array().iter().sum();
                    // Five numbers of order one, rounded: a few 1e-16; 1e-12 would be visible as a drifting velocity.
                    assert!((sum - 1.0).abs() < 1e-12, "cfc {cfc} at {rate_hz} Hz: {sum}");
                }
            }
        }
    }

    #[test]
    fn half_power_moves_up_at_low_rates() {
        let at =
            |rate_hz: f64| Coefficients::new(Cfc::Cfc60, Mode::SaeReflect, 1.0 / rate_hz).half_power_frequency_hz();
        // The factors at 10, 20 and many samples per CFC period, known to three digits.
        assert!((at(600.0) / 60.0 - 1.751).abs() < 5e-4);
        assert!((at(1200.0) / 60.0 - 1.688).abs() < 5e-4);
        assert!((at(1e6) - 100.0).abs() < 1e-3);
    }
}
