//! The Kelvin model, in closed form.

use crate::exact::second_order::{Roots, SecondOrder};
use crate::families::chain::constants;
use crate::families::values::{check_values, values};
use crate::structure::connected_masses::Structure;
use crate::{CrushEvents, LumpedError, ModelKind, State};

/// One mass on a spring and a damper in parallel: `m x'' = -k x - c x'`.
///
/// The first model of the single-mass paper (section 3.1 there). Any damping: undamped, underdamped, critical,
/// overdamped. With damping the acceleration starts at `-c v0/m`, a jump that a real structure does not show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kelvin {
    /// Mass, kg, positive.
    pub mass_kg: f64,
    /// Spring, N/m.
    pub stiffness_n_per_m: f64,
    /// Damper, N·s/m.
    pub damping_n_s_per_m: f64,
}

values!(Kelvin { mass_kg, stiffness_n_per_m, damping_n_s_per_m });

impl Kelvin {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Kelvin, &self.values())?;
        constants(&[self.mass_kg], &[self.stiffness_n_per_m], &[self.damping_n_s_per_m])
    }

    /// `x'' + (c/m) x' + (k/m) x = 0`.
    fn equation(&self) -> SecondOrder {
        SecondOrder {
            half_damping: 0.5 * self.damping_n_s_per_m / self.mass_kg,
            stiffness: self.stiffness_n_per_m / self.mass_kg,
        }
    }

    /// Natural frequency `sqrt(k/m)`, rad/s; `None` without a positive stiffness.
    pub fn natural_frequency_rad_per_s(&self) -> Option<f64> {
        (self.stiffness_n_per_m > 0.0).then(|| (self.stiffness_n_per_m / self.mass_kg).sqrt())
    }

    /// Damping ratio `c/(2 sqrt(k m))`; `None` without a positive stiffness.
    pub fn damping_ratio(&self) -> Option<f64> {
        self.natural_frequency_rad_per_s().map(|w| 0.5 * self.damping_n_s_per_m / (self.mass_kg * w))
    }

    /// The exact state at `t_s >= 0`.
    pub fn state(&self, impact_speed_m_per_s: f64, t_s: f64) -> State {
        let equation = self.equation();
        let x = impact_speed_m_per_s * equation.kernel(t_s).1;
        let v = impact_speed_m_per_s * equation.step_rate(t_s);
        State {
            displacement_m: x,
            velocity_m_per_s: v,
            acceleration_m_per_s2: -(equation.stiffness * x + 2.0 * equation.half_damping * v),
        }
    }

    /// Dynamic crush and rebound, closed form: `t_m = acos(ζ)/(ω sqrt(1-ζ²))`, `C = v0/ω·e^(-ζ ω t_m)`, rebound at
    /// `2 t_m` (single-mass paper, equations 2 and 3, continued to ζ >= 1). None without a positive stiffness, or
    /// with so negative a damping that the motion only grows.
    pub fn events(&self, impact_speed_m_per_s: f64) -> CrushEvents {
        let equation = self.equation();
        let (a, b) = (equation.half_damping, equation.stiffness);
        if b <= 0.0 {
            return CrushEvents::default();
        }
        let t = match equation.roots() {
            Roots::Complex { w } => w.atan2(a) / w,
            Roots::Real { .. } if a < 0.0 => return CrushEvents::default(),
            Roots::Real { s: 0.0, .. } => 1.0 / a,
            // ln((a+s)/(a-s))/(2s), written so that neither a - s nor s -> 0 costs digits.
            Roots::Real { s, .. } => ((a - b.sqrt() + s) / b.sqrt()).ln_1p() / s,
        };
        CrushEvents {
            time_of_dynamic_crush_s: Some(t),
            dynamic_crush_m: Some(impact_speed_m_per_s / b.sqrt() * (-a * t).exp()),
            time_of_rebound_s: Some(2.0 * t),
            rebound_velocity_m_per_s: Some(self.state(impact_speed_m_per_s, 2.0 * t).velocity_m_per_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kelvin(ratio: f64) -> Kelvin {
        let (m, k) = (1000.0, 4e5);
        Kelvin { mass_kg: m, stiffness_n_per_m: k, damping_n_s_per_m: 2.0 * ratio * f64::sqrt(k * m) }
    }

    #[test]
    fn velocity_vanishes_at_the_crush_time_for_every_damping() {
        for ratio in [0.0, 1e-9, 0.2, 0.999_999_9, 1.0, 1.000_000_1, 1.5, 20.0, 1e4] {
            let model = kelvin(ratio);
            let events = model.events(15.0);
            let (t, c) = (events.time_of_dynamic_crush_s.unwrap(), events.dynamic_crush_m.unwrap());
            let state = model.state(15.0, t);
            // The two expressions for C agree to rounding; velocity at t_m is rounding of the deceleration times t_m.
            assert!(
                (state.displacement_m - c).abs() < 4e-15 * (1.0 + ratio) * c,
                "ratio {ratio}: {} {c}",
                state.displacement_m
            );
            assert!(state.velocity_m_per_s.abs() < 2e-13, "ratio {ratio}: {}", state.velocity_m_per_s);
            let rebound = model.state(15.0, events.time_of_rebound_s.unwrap());
            assert!(rebound.acceleration_m_per_s2.abs() < 1e-9, "ratio {ratio}: {}", rebound.acceleration_m_per_s2);
        }
    }

    #[test]
    fn passes_through_critical_damping_without_a_step() {
        let at = |ratio: f64| kelvin(ratio).state(15.0, 0.1);
        // dx/dratio is of order 0.3 m: 2e-9 apart in ratio is 1e-9 m apart at most.
        let (below, on, above) = (at(1.0 - 1e-9), at(1.0), at(1.0 + 1e-9));
        assert!((below.displacement_m - on.displacement_m).abs() < 1e-9);
        assert!((above.displacement_m - on.displacement_m).abs() < 1e-9);
        assert!((below.velocity_m_per_s - above.velocity_m_per_s).abs() < 1e-7);
        assert!(below.displacement_m > on.displacement_m && on.displacement_m > above.displacement_m);
    }

    #[test]
    fn a_mass_without_a_spring_never_stops() {
        let coasting = Kelvin { mass_kg: 1000.0, stiffness_n_per_m: 0.0, damping_n_s_per_m: 5000.0 };
        assert_eq!(coasting.events(10.0), CrushEvents::default());
        // x = m v0/c (1 - e^(-c t/m))
        let state = coasting.state(10.0, 0.2);
        assert!((state.displacement_m - 2.0 * (1.0 - f64::exp(-1.0))).abs() < 1e-15);
        let free = Kelvin { damping_n_s_per_m: 0.0, ..coasting }.state(10.0, 0.2);
        assert_eq!((free.displacement_m, free.velocity_m_per_s), (2.0, 10.0));
    }
}
