//! The elastoplastic model after an impact, in closed form.
//!
//! One loading and one unloading, each a piece of a cosine: starts of fits and checks of the simulated motion. What
//! happens when a force continues or a barrier moves is the law of [`PlasticSpring`].

use std::f64::consts::FRAC_PI_2;

use crate::families::values::{check_values, values};
use crate::structure::connected_masses::Structure;
use crate::structure::elements::plastic_spring::PlasticSpring;
use crate::{CrushEvents, LumpedError, ModelKind};

/// One mass on a spring that unloads stiffer than it loads.
///
/// Loads along `k_E` until the velocity is zero at `(t_m, C)`, then moves on `k_P` about the permanent set
/// `C - d_e`, `d_e = C k_E/k_P`: the force is continuous at `C`. Single-mass paper, section 3.2, equations 9 to 15.
/// The paper keeps the mass attached, so it oscillates about the set for ever; with `release` the contact opens
/// when the force is zero and the mass leaves with `-v0 sqrt(k_E/k_P)`. Piecewise closed form, no step error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastoplastic {
    /// Mass, kg, positive.
    pub mass_kg: f64,
    /// Stiffness while loading `k_E`, N/m, positive.
    pub loading_stiffness_n_per_m: f64,
    /// Stiffness after dynamic crush `k_P`, N/m, positive; a structure has `k_P >= k_E`.
    pub unloading_stiffness_n_per_m: f64,
    /// Whether the contact opens at zero force.
    pub release: bool,
}

values!(Elastoplastic { mass_kg, loading_stiffness_n_per_m, unloading_stiffness_n_per_m | release: true });

impl Elastoplastic {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Elastoplastic, &self.values())?;
        let spring = PlasticSpring {
            loading_stiffness_n_per_m: self.loading_stiffness_n_per_m,
            unloading_stiffness_n_per_m: self.unloading_stiffness_n_per_m,
            release: self.release,
        };
        Structure::row(&[self.mass_kg], [vec![spring.into()]])
    }

    /// Angular frequencies of loading and unloading, `sqrt(k_E/m)` and `sqrt(k_P/m)`, rad/s.
    fn frequencies(&self) -> (f64, f64) {
        (
            (self.loading_stiffness_n_per_m / self.mass_kg).sqrt(),
            (self.unloading_stiffness_n_per_m / self.mass_kg).sqrt(),
        )
    }

    /// Coefficient of restitution `e = sqrt(k_E/k_P)`; the energy returned is `e²` of the energy absorbed.
    pub fn coefficient_of_restitution(&self) -> f64 {
        (self.loading_stiffness_n_per_m / self.unloading_stiffness_n_per_m).sqrt()
    }

    /// Permanent set `C - d_e`, m: where the force is zero after unloading.
    pub fn permanent_set_m(&self, impact_speed_m_per_s: f64) -> f64 {
        let crush = impact_speed_m_per_s / self.frequencies().0;
        crush * (1.0 - self.loading_stiffness_n_per_m / self.unloading_stiffness_n_per_m)
    }

    /// Dynamic crush and rebound, closed form.
    pub fn events(&self, impact_speed_m_per_s: f64) -> CrushEvents {
        let (loading, unloading) = self.frequencies();
        let t_m = FRAC_PI_2 / loading;
        CrushEvents {
            time_of_dynamic_crush_s: Some(t_m),
            dynamic_crush_m: Some(impact_speed_m_per_s / loading),
            time_of_rebound_s: Some(t_m + FRAC_PI_2 / unloading),
            rebound_velocity_m_per_s: Some(-impact_speed_m_per_s * self.coefficient_of_restitution()),
        }
    }
}
