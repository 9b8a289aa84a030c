//! Natural frequency and damping of a pole.

use std::f64::consts::TAU;

use crate::Complex;

/// One pole in continuous time, as an engineer reads it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Continuous pole: real part 1/s, imaginary part rad/s.
    pub pole: Complex,
    /// Modulus of the pole, rad/s. Not to be multiplied by 2 pi.
    pub natural_frequency_rad_per_s: f64,
    /// `-Re/|s|`: 1 for a real decaying pole, negative for a growing one; `None` for a pole at zero.
    pub damping_ratio: Option<f64>,
}

impl Mode {
    /// The mode of a continuous pole.
    pub fn continuous(pole: Complex) -> Self {
        let modulus = pole.norm();
        Self { pole, natural_frequency_rad_per_s: modulus, damping_ratio: (modulus > 0.0).then(|| -pole.re / modulus) }
    }

    /// The mode of a discrete pole, `s = ln(z)/dt` on the principal branch, so `|Im s| <= pi/dt`.
    ///
    /// `None` for `z = 0`, a pure delay. A negative real `z` lands on `Im s = pi/dt` without a partner: an artefact of
    /// sampling or of too high an order, for the caller to name.
    pub fn discrete(z: Complex, dt_s: f64) -> Option<Self> {
        let squared = z.norm_sqr();
        if squared == 0.0 || !squared.is_finite() {
            return None;
        }
        // Near the unit circle ln|z| cancels; its square minus one does not.
        let log_modulus = if (0.5..2.0).contains(&squared) {
            0.5 * ((z.re - 1.0) * (z.re + 1.0) + z.im * z.im).ln_1p()
        } else {
            z.norm().ln()
        };
        Some(Self::continuous(Complex::new(log_modulus / dt_s, z.arg() / dt_s)))
    }

    /// Natural frequency, Hz.
    pub fn natural_frequency_hz(&self) -> f64 {
        self.natural_frequency_rad_per_s / TAU
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn discrete_pole_returns_the_continuous_one() {
        let dt = 1e-4;
        for pole in [Complex::new(-18.04, 533.15), Complex::new(-274.9, 501.4), Complex::new(3.0, -40.0)] {
            let back = Mode::discrete((pole * dt).exp(), dt).unwrap();
            // One rounding of z is 1e-16/dt = 1e-12 in s.
            assert!((back.pole - pole).norm() < 4e-12, "{}", back.pole);
        }
    }

    #[test]
    fn damping_tells_decay_from_growth_and_is_undefined_at_zero() {
        assert_eq!(Mode::continuous(Complex::new(-3.0, 4.0)).damping_ratio, Some(0.6));
        assert_eq!(Mode::continuous(Complex::new(2.0, 0.0)).damping_ratio, Some(-1.0));
        assert_eq!(Mode::continuous(Complex::new(0.0, 0.0)).damping_ratio, None);
        assert!(Mode::discrete(Complex::new(0.0, 0.0), 1e-3).is_none());
    }
}
