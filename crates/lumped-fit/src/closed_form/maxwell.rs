//! The Maxwell model from the exponents of a displacement: `r² + (k/c) r + k/m = 0` beside a constant.

use crumple_lumped::Maxwell;

use crate::SolveError;
use crate::error::positive;

/// The two exponents of `x = C1 + e^(a t) (C2 e^(b t) + C3 e^(-b t))` beside the constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MaxwellExponents {
    /// `a ± i b`, 1/s and rad/s: the mass swings.
    Complex {
        /// Real part, negative.
        a_per_s: f64,
        /// Imaginary part.
        b_rad_per_s: f64,
    },
    /// `a ± b`: the mass creeps.
    Real {
        /// Mean, negative.
        a_per_s: f64,
        /// Half the distance, from zero to below `|a|`.
        b_per_s: f64,
    },
}

/// Spring and damper `(k, c)` by the formulas `k = m (a² ± b²)`, `c = -k/(2a)`, whatever the signs that come out.
///
/// From `r² + (k/c) r + k/m = 0`; single-mass paper, equations 18 to 25. For reproduction of printed tables;
/// [`maxwell_from_exponents`] refuses what is no Maxwell model.
pub fn maxwell_constants(mass_kg: f64, exponents: MaxwellExponents) -> (f64, f64) {
    let (a, stiffness) = match exponents {
        MaxwellExponents::Complex { a_per_s: a, b_rad_per_s: b } => (a, mass_kg * (a * a + b * b)),
        MaxwellExponents::Real { a_per_s: a, b_per_s: b } => (a, mass_kg * (a - b) * (a + b)),
    };
    (stiffness, -stiffness / (2.0 * a))
}

/// The Maxwell model with these exponents. Errors: a mass that is not positive, and exponents of which one does not
/// decay: `a` not negative, or `|b|` not below `|a|` for real ones; such a fit describes a motion that grows without
/// end, and its spring or damper would be negative.
pub fn maxwell_from_exponents(mass_kg: f64, exponents: MaxwellExponents) -> Result<Maxwell, SolveError> {
    let mass_kg = positive("mass_kg", mass_kg)?;
    let slowest = match exponents {
        MaxwellExponents::Complex { a_per_s, b_rad_per_s } if b_rad_per_s.is_finite() => a_per_s,
        MaxwellExponents::Real { a_per_s, b_per_s } => a_per_s + b_per_s.abs(),
        MaxwellExponents::Complex { b_rad_per_s, .. } => b_rad_per_s,
    };
    if !(slowest.is_finite() && slowest < 0.0) {
        return Err(SolveError::Value {
            name: "slowest exponent of the fit",
            value: slowest,
            expected: "negative: both parts must decay (|b| below |a| for real roots)",
        });
    }
    let (stiffness_n_per_m, damping_n_s_per_m) = maxwell_constants(mass_kg, exponents);
    Ok(Maxwell { mass_kg, stiffness_n_per_m, damping_n_s_per_m })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_growing_exponent_is_refused_with_its_value() {
        let printed = MaxwellExponents::Real { a_per_s: -14.5, b_per_s: -14.6 };
        let error = maxwell_from_exponents(873.0, printed).unwrap_err();
        assert!(error.to_string().starts_with("slowest exponent of the fit is 0.0999"), "{error}");
        assert!(maxwell_from_exponents(873.0, MaxwellExponents::Complex { a_per_s: 1.0, b_rad_per_s: 3.0 }).is_err());
    }

    #[test]
    fn exponents_come_back_from_the_model() {
        let model = maxwell_from_exponents(873.0, MaxwellExponents::Real { a_per_s: -14.5, b_per_s: 14.4 }).unwrap();
        let (k, c) = (model.stiffness_n_per_m, model.damping_n_s_per_m);
        let half = 0.5 * k / c;
        // One cancellation of a² - b² in the formula's inverse, a factor of 70.
        assert!((half - 14.5).abs() < 1e-13 && ((half * half - k / 873.0).sqrt() - 14.4).abs() < 1e-12);
    }
}
