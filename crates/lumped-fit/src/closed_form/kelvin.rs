//! The Kelvin model, spring and damper in parallel, from the time of dynamic crush, the crush and the impact speed.
//!
//! With `t_c = C/v0` the ratio `t_c/t_m` depends on the damping ratio alone; inverting that relation gives `ζ`, then
//! the time gives `ω`, and `k = m ω²`, `c = 2 ζ ω m`. Single-mass paper, section 3.1; M. Huang, *Vehicle Crash
//! Mechanics*, 2002.

use std::f64::consts::FRAC_2_PI;

use crumple_lumped::Kelvin;

use crate::SolveError;
use crate::error::positive;

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
