//! The two nonlinear models of the single-mass paper.

use crate::families::values::{check_values, values};
use crate::structure::connected_masses::Structure;
use crate::structure::elements::piecewise_linear::PiecewiseLinear;
use crate::structure::elements::secant::{Damper, Spring};
use crate::{CrushEvents, LumpedError, ModelKind};

/// One mass on a stiffening spring and a damper that weakens with speed: the first nonlinear model of the single-mass
/// paper (section 4).
///
/// `m x'' = -k(|x|) x - c(|v|) v`: a secant stiffness that multiplies the displacement, not a tangent one that is
/// integrated (only this reading reproduces the paper). `k` is linear from `k1` at 0 to `k2` at the crush `C`, `c` from
/// `c1` at rest over `c2` at `v_thresh` to `c3` at the impact speed `v0`; constant beyond.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nonlinear1 {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Secant stiffness at contact, N/m.
    pub k1_n_per_m: f64,
    /// Secant stiffness at `crush_m`, N/m.
    pub k2_n_per_m: f64,
    /// Damping at rest, N·s/m.
    pub c1_n_s_per_m: f64,
    /// Damping at `v_thresh_m_per_s`, N·s/m.
    pub c2_n_s_per_m: f64,
    /// Damping at `v0_m_per_s`, N·s/m.
    pub c3_n_s_per_m: f64,
    /// Speed of the knee of the damper, m/s.
    pub v_thresh_m_per_s: f64,
    /// Displacement of the last knot of the spring, m: the dynamic crush of the test it was fitted to.
    pub crush_m: f64,
    /// Speed of the last knot of the damper, m/s: the impact speed of that test.
    pub v0_m_per_s: f64,
}

/// The second nonlinear model of the single-mass paper (section 5): ten parameters.
///
/// As [`Nonlinear1`], with `k` through `(0, k1), (x1, k2), (C, k3)` and `c` through
/// `(0, c1), (v1, c2), (v2, c3), (v0, c4)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nonlinear2 {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Secant stiffness at contact, N/m.
    pub k1_n_per_m: f64,
    /// Secant stiffness at `x1_m`, N/m.
    pub k2_n_per_m: f64,
    /// Secant stiffness at `crush_m`, N/m.
    pub k3_n_per_m: f64,
    /// Displacement of the middle knot, m, below `crush_m`.
    pub x1_m: f64,
    /// Damping at rest, N·s/m.
    pub c1_n_s_per_m: f64,
    /// Damping at `v1_m_per_s`, N·s/m.
    pub c2_n_s_per_m: f64,
    /// Damping at `v2_m_per_s`, N·s/m.
    pub c3_n_s_per_m: f64,
    /// Damping at `v0_m_per_s`, N·s/m.
    pub c4_n_s_per_m: f64,
    /// First knee of the damper, m/s.
    pub v1_m_per_s: f64,
    /// Second knee, m/s, above the first and below `v0_m_per_s`.
    pub v2_m_per_s: f64,
    /// Displacement of the last knot of the spring, m.
    pub crush_m: f64,
    /// Speed of the last knot of the damper, m/s.
    pub v0_m_per_s: f64,
}

values!(Nonlinear1 {
    mass_kg,
    k1_n_per_m,
    k2_n_per_m,
    c1_n_s_per_m,
    c2_n_s_per_m,
    c3_n_s_per_m,
    v_thresh_m_per_s,
    crush_m,
    v0_m_per_s
});
values!(Nonlinear2 {
    mass_kg,
    k1_n_per_m,
    k2_n_per_m,
    k3_n_per_m,
    x1_m,
    c1_n_s_per_m,
    c2_n_s_per_m,
    c3_n_s_per_m,
    c4_n_s_per_m,
    v1_m_per_s,
    v2_m_per_s,
    crush_m,
    v0_m_per_s
});

/// One mass on a spring and a damper through these knots.
fn one_mass(mass_kg: f64, spring: &[(f64, f64)], damper: &[(f64, f64)]) -> Result<Structure, LumpedError> {
    let (spring, damper) = (Spring(PiecewiseLinear::new(spring)?), Damper(PiecewiseLinear::new(damper)?));
    Structure::row(&[mass_kg], [vec![spring.into(), damper.into()]])
}

macro_rules! responses {
    ($model:ty) => {
        impl $model {
            /// Dynamic crush and rebound within two seconds, on the series themselves.
            pub fn events(&self, impact_speed_m_per_s: f64) -> Result<CrushEvents, LumpedError> {
                Ok(self.structure()?.events(impact_speed_m_per_s, 2.0)?[0])
            }
        }
    };
}

responses!(Nonlinear1);
responses!(Nonlinear2);

/// Spring through two knots, damper through three.
impl Nonlinear1 {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Nonlinear1, &self.values())?;
        let spring = [(0.0, self.k1_n_per_m), (self.crush_m, self.k2_n_per_m)];
        let damper = [
            (0.0, self.c1_n_s_per_m),
            (self.v_thresh_m_per_s, self.c2_n_s_per_m),
            (self.v0_m_per_s, self.c3_n_s_per_m),
        ];
        one_mass(self.mass_kg, &spring, &damper)
    }
}

impl Nonlinear2 {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::Nonlinear2, &self.values())?;
        let spring = [(0.0, self.k1_n_per_m), (self.x1_m, self.k2_n_per_m), (self.crush_m, self.k3_n_per_m)];
        let damper = [
            (0.0, self.c1_n_s_per_m),
            (self.v1_m_per_s, self.c2_n_s_per_m),
            (self.v2_m_per_s, self.c3_n_s_per_m),
            (self.v0_m_per_s, self.c4_n_s_per_m),
        ];
        one_mass(self.mass_kg, &spring, &damper)
    }
}
