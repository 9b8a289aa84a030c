//! Kelvin, elastoplastic and Maxwell model from crash events or exponents, by formula.

use std::f64::consts::FRAC_2_PI;

use crumple_lumped::{Elastoplastic, Kelvin, Maxwell};

use crate::error::{SolveError, positive};

/// The elastoplastic model with the crush, speed and restitution of the record: `k_E = m v0²/C²`, `k_P = k_E/e²`.
///
/// Energy balance of loading and unloading, single-mass paper, equations 9 to 15; `e` is a ratio of velocities, so
/// the energy returned is `e²`. Keeps `C`, `v0` and the rebound velocity; its time of dynamic crush is `π/2·C/v0`
/// whatever was measured. Relative error: twice that of `C` for `k_E`, and twice that of `e` in addition for `k_P`.
/// Errors: values that are not positive (without rebound `k_P` is infinite), or restitution above 1.
pub fn elastoplastic_from_events(
    mass_kg: f64,
    impact_speed_m_per_s: f64,
    dynamic_crush_m: f64,
    coefficient_of_restitution: f64,
) -> Result<Elastoplastic, SolveError> {
    let m = positive("mass_kg", mass_kg)?;
    let v0 = positive("impact_speed_m_per_s", impact_speed_m_per_s)?;
    let crush = positive("dynamic_crush_m", dynamic_crush_m)?;
    let e = positive("coefficient_of_restitution", coefficient_of_restitution)?;
    if e > 1.0 {
        return Err(SolveError::Value {
            name: "coefficient_of_restitution",
            value: e,
            expected: "at most 1 (more energy came back than went in)",
        });
    }
    let omega = v0 / crush;
    let loading = m * omega * omega;
    Ok(Elastoplastic {
        mass_kg: m,
        loading_stiffness_n_per_m: loading,
        unloading_stiffness_n_per_m: loading / (e * e),
        release: true,
    })
}

/// Coefficient of restitution below which the unloading is rigid within the accuracy of a record. It lasts for
/// `π/2·e·C/v0`, 2 ms of a crush of 0.6 m at 14 m/s: a quarter of a swing of 125 Hz, where CFC 60 leaves half (SAE
/// J211-1). A zero level 0.1 g off makes a third of such a rebound of nothing within 100 ms at 10 m/s.
pub(crate) const RIGID_RESTITUTION: f64 = 0.03;

/// As [`elastoplastic_from_events`], with an unloading stiffness of at most `k_E/0.03²`, and whether it stands there: a
/// smaller restitution, zero or none is no number but a rigid line, and any stiffness above gives the same record.
pub(crate) fn elastoplastic_of_record(
    mass_kg: f64,
    impact_speed_m_per_s: f64,
    dynamic_crush_m: f64,
    coefficient_of_restitution: f64,
) -> Result<(Elastoplastic, bool), SolveError> {
    let rigid = coefficient_of_restitution <= RIGID_RESTITUTION;
    let restitution = if rigid { RIGID_RESTITUTION } else { coefficient_of_restitution };
    Ok((elastoplastic_from_events(mass_kg, impact_speed_m_per_s, dynamic_crush_m, restitution)?, rigid))
}

/// Whether the unloading stiffness of a closed form is the one that stands for a rigid line.
pub(crate) fn unloads_rigidly(model: &Elastoplastic) -> bool {
    model.coefficient_of_restitution() <= RIGID_RESTITUTION * (1.0 + 1e-9)
}

// The Kelvin model, spring and damper in parallel, from the time of dynamic crush, the crush and the impact speed.
//
// With `t_c = C/v0` the ratio `t_c/t_m` depends on the damping ratio alone; inverting that relation gives `ζ`, then
// the time gives `ω`, and `k = m ω²`, `c = 2 ζ ω m`. Single-mass paper, section 3.1; M. Huang, *Vehicle Crash
// Mechanics*, 2002.

/// Which branch of the relation the record lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum KelvinBranch {
    /// `1/e < t_c/t_m < 2/π`, damping ratio below 1.
    Underdamped,
    /// `t_c/t_m <= 1/e`, damping ratio 1 and above.
    Overdamped,
    /// `t_c/t_m >= 2/π`: no damping ratio exists; the undamped model with the same crush and speed instead.
    UndampedReduction {
        /// The time of dynamic crush of that model, `π/2·t_c`, s: later than the measured one.
        model_time_of_dynamic_crush_s: f64,
    },
}

/// A Kelvin model and how it follows from the events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KelvinSolution {
    /// The model.
    pub model: Kelvin,
    /// Natural frequency, rad/s.
    pub natural_frequency_rad_per_s: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Centroid time over time of dynamic crush, `C/(v0 t_m)`.
    pub time_ratio: f64,
    /// Branch it lies on.
    pub branch: KelvinBranch,
}

/// `ω t_m` of a Kelvin model with damping ratio `zeta >= 0`: `acos(ζ)/sqrt(1-ζ²)`, continued by
/// `ln(ζ + sqrt(ζ²-1))/sqrt(ζ²-1)`; 1 at ζ = 1.
fn tau_m(zeta: f64) -> f64 {
    let below = (1.0 - zeta) * (1.0 + zeta);
    if below > 0.0 {
        let s = below.sqrt();
        s.atan2(zeta) / s
    } else if below < 0.0 {
        let s = (-below).sqrt();
        // ln(ζ + s) with ζ = 1 + (ζ - 1): exact near critical damping.
        ((zeta - 1.0) + s).ln_1p() / s
    } else {
        1.0
    }
}

/// `t_c/t_m = e^(-ζ ω t_m)/(ω t_m)` of a Kelvin model with damping ratio `zeta >= 0`.
///
/// Falls strictly, from `2/π` at 0 (slope -0.5947) through `1/e` at 1 towards 0, about `1/(2 ln 2ζ)`. Single-mass
/// paper, equations 2 to 4, where `arctan(sqrt(1-ζ²)/ζ)` is `acos ζ`.
pub fn centroid_to_crush_time_ratio(zeta: f64) -> f64 {
    let tau = tau_m(zeta);
    (-zeta * tau).exp() / tau
}

/// Solves for stiffness and damping of the Kelvin model that stops after `t_m` at `C` from `v0`.
///
/// Unique: one damping ratio for each `t_c/t_m` below `2/π`, by bisection to the last bit; then
/// `ω = (ω t_m)/t_m`, `k = m ω²`, `c = 2 ζ ω m` (equations 5, 7, 8). At and above `2/π` the model is reduced to the
/// undamped one, `ω = 1/t_c`, which keeps `C` and `v0` and misses `t_m` (equation 6). With exact events the
/// parameters are exact to about `1e-15`; an error of `t_m` or `C` enters the stiffness twice, and the damping ratio
/// with a factor 1/0.59, so that `c` is much the weaker of the two. Errors: events that are not positive; a ratio
/// below 0.024 (damping ratio above 1e9).
pub fn kelvin_from_events(
    mass_kg: f64,
    impact_speed_m_per_s: f64,
    time_of_dynamic_crush_s: f64,
    dynamic_crush_m: f64,
) -> Result<KelvinSolution, SolveError> {
    let m = positive("mass_kg", mass_kg)?;
    let v0 = positive("impact_speed_m_per_s", impact_speed_m_per_s)?;
    let t_m = positive("time_of_dynamic_crush_s", time_of_dynamic_crush_s)?;
    let crush = positive("dynamic_crush_m", dynamic_crush_m)?;
    let t_c = crush / v0;
    let ratio = t_c / t_m;
    let (zeta, omega, branch) = if ratio >= FRAC_2_PI {
        let model_time_of_dynamic_crush_s = std::f64::consts::FRAC_PI_2 * t_c;
        (0.0, t_c.recip(), KelvinBranch::UndampedReduction { model_time_of_dynamic_crush_s })
    } else {
        let zeta = invert(ratio).ok_or(SolveError::RatioTooSmall { ratio })?;
        let branch = if zeta < 1.0 { KelvinBranch::Underdamped } else { KelvinBranch::Overdamped };
        (zeta, tau_m(zeta) / t_m, branch)
    };
    let model = Kelvin { mass_kg: m, stiffness_n_per_m: m * omega * omega, damping_n_s_per_m: 2.0 * zeta * omega * m };
    Ok(KelvinSolution { model, natural_frequency_rad_per_s: omega, damping_ratio: zeta, time_ratio: ratio, branch })
}

/// The damping ratio of a time ratio below `2/π`, by bisection to the last bit: in `ζ` up to 1, in `ln ζ` above.
/// `None` for a ratio whose damping ratio is above 1e9.
fn invert(ratio: f64) -> Option<f64> {
    let bisect = |mut low: f64, mut high: f64, f: &dyn Fn(f64) -> f64| {
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if centroid_to_crush_time_ratio(f(middle)) > ratio { low = middle } else { high = middle }
        }
    };
    if ratio >= (-1.0_f64).exp() {
        return Some(bisect(0.0, 1.0, &|zeta| zeta));
    }
    let limit = 1e9_f64;
    (centroid_to_crush_time_ratio(limit) < ratio).then(|| bisect(0.0, limit.ln(), &f64::exp).exp())
}

// The Maxwell model from the exponents of a displacement: `r² + (k/c) r + k/m = 0` beside a constant.

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

impl MaxwellExponents {
    /// Spring and damper `(k, c)` by the formulas `k = m (a² ± b²)`, `c = -k/(2a)`, whatever the signs that come out.
    ///
    /// From `r² + (k/c) r + k/m = 0`; single-mass paper, equations 18 to 25. For reproduction of printed tables;
    /// [`MaxwellExponents::model`] refuses what is no Maxwell model.
    pub fn constants(self, mass_kg: f64) -> (f64, f64) {
        let (a, stiffness) = match self {
            Self::Complex { a_per_s: a, b_rad_per_s: b } => (a, mass_kg * (a * a + b * b)),
            Self::Real { a_per_s: a, b_per_s: b } => (a, mass_kg * (a - b) * (a + b)),
        };
        (stiffness, -stiffness / (2.0 * a))
    }

    /// The Maxwell model with these exponents. Errors: a mass that is not positive, and exponents of which one does not
    /// decay: `a` not negative, or `|b|` not below `|a|` for real ones; such a fit describes a motion that grows
    /// without end, and its spring or damper would be negative.
    pub fn model(self, mass_kg: f64) -> Result<Maxwell, SolveError> {
        let mass_kg = positive("mass_kg", mass_kg)?;
        let slowest = match self {
            Self::Complex { a_per_s, b_rad_per_s } if b_rad_per_s.is_finite() => a_per_s,
            Self::Real { a_per_s, b_per_s } => a_per_s + b_per_s.abs(),
            Self::Complex { b_rad_per_s, .. } => b_rad_per_s,
        };
        if !(slowest.is_finite() && slowest < 0.0) {
            return Err(SolveError::Value {
                name: "slowest exponent of the fit",
                value: slowest,
                expected: "negative: both parts must decay (|b| below |a| for real roots)",
            });
        }
        let (stiffness_n_per_m, damping_n_s_per_m) = self.constants(mass_kg);
        Ok(Maxwell { mass_kg, stiffness_n_per_m, damping_n_s_per_m })
    }
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn a_growing_exponent_is_refused_with_its_value() {
        let printed = MaxwellExponents::Real { a_per_s: -14.5, b_per_s: -14.6 };
        let error = printed.model(873.0).unwrap_err();
        assert!(error.to_string().starts_with("slowest exponent of the fit is 0.0999"), "{error}");
        assert!(MaxwellExponents::Complex { a_per_s: 1.0, b_rad_per_s: 3.0 }.model(873.0).is_err());
    }

    #[test]
    fn exponents_come_back_from_the_model() {
        let model = MaxwellExponents::Real { a_per_s: -14.5, b_per_s: 14.4 }.model(873.0).unwrap();
        let (k, c) = (model.stiffness_n_per_m, model.damping_n_s_per_m);
        let half = 0.5 * k / c;
        // One cancellation of a² - b² in the formula's inverse, a factor of 70.
        assert!((half - 14.5).abs() < 1e-13 && ((half * half - k / 873.0).sqrt() - 14.4).abs() < 1e-12);
    }
}
