//! The Maxwell model, in closed form.

use std::f64::consts::PI;

use crate::exact::second_order::{Roots, SecondOrder};
use crate::families::values::{check_values, values};
use crate::structure::connected_masses::Structure;
use crate::structure::elements::series_spring_damper::SeriesSpringDamper;
use crate::{CrushEvents, LumpedError, ModelKind, State};

/// One mass on a spring and a damper in series: `m x'' = -F`, `F' = k x' - (k/c) F`, `F(0) = 0`.
///
/// The velocity solves `v'' + (k/c) v' + (k/m) v = 0` with `v(0) = v0`, `v'(0) = 0`; the mass comes to rest at
/// `m v0/c`. Single-mass paper, section 3.3. With real roots the velocity never reaches zero: no dynamic crush.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Maxwell {
    /// Mass, kg, positive.
    pub mass_kg: f64,
    /// Spring, N/m, positive.
    pub stiffness_n_per_m: f64,
    /// Damper, N·s/m, positive.
    pub damping_n_s_per_m: f64,
}

values!(Maxwell { mass_kg, stiffness_n_per_m, damping_n_s_per_m });

impl Maxwell {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Maxwell, &self.values())?;
        let Self { stiffness_n_per_m, damping_n_s_per_m, .. } = *self;
        Structure::row(&[self.mass_kg], [vec![SeriesSpringDamper { stiffness_n_per_m, damping_n_s_per_m }.into()]])
    }

    /// `v'' + (k/c) v' + (k/m) v = 0`.
    fn equation(&self) -> SecondOrder {
        SecondOrder {
            half_damping: 0.5 * self.stiffness_n_per_m / self.damping_n_s_per_m,
            stiffness: self.stiffness_n_per_m / self.mass_kg,
        }
    }

    /// The exact state at `t_s >= 0`. The displacement is the difference of two terms of size `m v0/c` or less, so
    /// near contact its absolute error is about `1e-16·(m v0/c)`.
    pub fn state(&self, impact_speed_m_per_s: f64, t_s: f64) -> State {
        let equation = self.equation();
        let a = equation.half_damping;
        let (cosine, sine) = equation.kernel(t_s);
        let v = impact_speed_m_per_s * (cosine + a * sine);
        let acceleration = -impact_speed_m_per_s * equation.stiffness * sine;
        // Integral of the equation of motion: v' + 2a (v - v0) + b x = 0.
        let x = (2.0 * a * (impact_speed_m_per_s - v) - acceleration) / equation.stiffness;
        State { displacement_m: x, velocity_m_per_s: v, acceleration_m_per_s2: acceleration }
    }

    /// Dynamic crush at `(π - atan2(w, a))/w` and rebound at `π/w`, for complex roots `-a ± i w` only.
    pub fn events(&self, impact_speed_m_per_s: f64) -> CrushEvents {
        let equation = self.equation();
        let Roots::Complex { w } = equation.roots() else {
            return CrushEvents::default();
        };
        let t = (PI - w.atan2(equation.half_damping)) / w;
        CrushEvents {
            time_of_dynamic_crush_s: Some(t),
            dynamic_crush_m: Some(self.state(impact_speed_m_per_s, t).displacement_m),
            time_of_rebound_s: Some(PI / w),
            rebound_velocity_m_per_s: Some(self.state(impact_speed_m_per_s, PI / w).velocity_m_per_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn creeps_to_its_final_place_without_stopping_when_overdamped() {
        let soft = Maxwell { mass_kg: 900.0, stiffness_n_per_m: 1e6, damping_n_s_per_m: 5e3 };
        assert_eq!(soft.events(10.0), CrushEvents::default());
        let end = soft.state(10.0, 5.0);
        // e^(-5.7 · 5) of 1.8 m is left.
        assert!((end.displacement_m - 900.0 * 10.0 / 5e3).abs() < 1e-11, "{}", end.displacement_m);
    }
}
