//! The conditions of the single-mass paper at dynamic crush: `x(t_m) = C`, `v(t_m) = 0`.

use crumple_lumped::{Instants, Model, Motion, Nonlinear1, Place, Structure};

use crate::fit::options::SingleMassFitOptions;

/// The conditions with what they count in an augmented Lagrangian.
///
/// In a fit they are rows `sqrt(w) (c_j + y_j/w)`: `c` the two conditions, `w` the weight and `y` the multipliers.
/// Their square is the Lagrangian up to a constant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AtCrush {
    /// Time of dynamic crush, s.
    time_s: f64,
    /// Crush, m, and impact speed, m/s: the units of both.
    units: [f64; 2],
    /// Weight.
    pub weight: f64,
    /// Multipliers.
    pub multipliers: [f64; 2],
}

impl AtCrush {
    /// Those of a test, with weight one.
    pub fn new(options: &SingleMassFitOptions) -> Self {
        let units = [options.crush_m, options.impact_speed_m_per_s];
        Self { time_s: options.time_of_dynamic_crush_s, units, weight: 1.0, multipliers: [0.0; 2] }
    }

    /// `x(t_m)/C - 1` and `v(t_m)/v0` of the last mass, and the derivatives of both by the parameters at `places`.
    /// `None` without a response.
    pub fn conditions(&self, structure: &Structure, places: &[Place]) -> Option<([f64; 2], Vec<[f64; 2]>)> {
        let at = Instants { first_s: self.time_s, dt_s: self.time_s, samples: 1 };
        let response = structure.sensitivity(self.units[1], &at, places).ok()?;
        let in_units = |motions: &Vec<Motion>| {
            let motion = motions.last()?;
            Some([motion.displacement_m[0] / self.units[0], motion.velocity_m_per_s[0] / self.units[1]])
        };
        let [crush, speed] = in_units(&response.motions)?;
        Some(([crush - 1.0, speed], response.derivatives.iter().map(in_units).collect::<Option<_>>()?))
    }

    /// The rows of a fit, and their derivatives by the parameters at `places`.
    pub fn rows(&self, structure: &Structure, places: &[Place]) -> Option<([f64; 2], Vec<[f64; 2]>)> {
        let (conditions, derivatives) = self.conditions(structure, places)?;
        let root = self.weight.sqrt();
        let row = |j: usize| root * (conditions[j] + self.multipliers[j] / self.weight);
        Some(([row(0), row(1)], derivatives.iter().map(|by| by.map(|by| root * by)).collect()))
    }
}

/// `x(t_m)/C - 1` and `v(t_m)/v0` of a model at the time of dynamic crush of the options: zero where the side
/// conditions are met. `None` without a response.
pub fn conditions_at_crush(model: &Nonlinear1, options: &SingleMassFitOptions) -> Option<[f64; 2]> {
    let structure = Model::Nonlinear1(*model).structure().ok()?;
    Some(AtCrush::new(options).conditions(&structure, &[])?.0)
}
