//! The double model: two masses, two springs, two dampers.

use crumple_numerics::lti::{Complex, polynomial_roots};
use nalgebra::Matrix4;

use crate::families::chain::constants;
use crate::families::values::{check_values, values};
use crate::structure::connected_masses::Structure;
use crate::{CrushEvents, LumpedError, ModelKind};

/// Two masses in a row: barrier - (k1, c1) - chassis m1 - (k2, c2) - passenger compartment m2.
///
/// `m1 x1'' = -k1 x1 - c1 x1' + k2 (x2 - x1) + c2 (x2' - x1')`, `m2 x2'' = -k2 (x2 - x1) - c2 (x2' - x1')`, both
/// masses at `v0` at contact. Index 1 is next to the barrier, as in both two-mass papers.
///
/// **What the compartment cannot tell.** With `mu = (m1 + m2)/m2`, the model [`dual`](Self::dual)
/// `(mu k2, k1/mu, mu c2, c1/mu)` has exactly the same compartment motion; only the chassis moves differently.
/// An accelerometer in the compartment therefore never decides between the two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DoubleSpringMassDamper {
    /// Mass of the chassis, kg, positive.
    pub m1_kg: f64,
    /// Mass of the compartment, kg, positive.
    pub m2_kg: f64,
    /// Spring between barrier and chassis, N/m.
    pub k1_n_per_m: f64,
    /// Spring between chassis and compartment, N/m.
    pub k2_n_per_m: f64,
    /// Damper between barrier and chassis, N·s/m.
    pub c1_n_s_per_m: f64,
    /// Damper between chassis and compartment, N·s/m.
    pub c2_n_s_per_m: f64,
}

values!(DoubleSpringMassDamper { m1_kg, m2_kg, k1_n_per_m, k2_n_per_m, c1_n_s_per_m, c2_n_s_per_m });

impl DoubleSpringMassDamper {
    /// The structure it is. Errors: parameters without meaning.
    pub fn structure(&self) -> Result<Structure, LumpedError> {
        check_values(ModelKind::DoubleSpringMassDamper, &self.values())?;
        let (springs, dampers) = ([self.k1_n_per_m, self.k2_n_per_m], [self.c1_n_s_per_m, self.c2_n_s_per_m]);
        constants(&[self.m1_kg, self.m2_kg], &springs, &dampers)
    }

    /// The other parameter set with the same masses and the same compartment record.
    ///
    /// Why: the compartment's response depends on the characteristic polynomial and on `c1 c2` only, and the map
    /// exchanges `(m2 c1, m2 k1)` with `((m1+m2) c2, (m1+m2) k2)`, in which all of these are symmetric. Applying
    /// it twice returns to the start; positive parameters stay positive.
    pub fn dual(&self) -> Self {
        let mu = (self.m1_kg + self.m2_kg) / self.m2_kg;
        Self {
            k1_n_per_m: mu * self.k2_n_per_m,
            k2_n_per_m: self.k1_n_per_m / mu,
            c1_n_s_per_m: mu * self.c2_n_s_per_m,
            c2_n_s_per_m: self.c1_n_s_per_m / mu,
            ..*self
        }
    }

    /// `A` of `z' = A z`, state `(x1, x2, x1', x2')`, SI.
    pub fn state_matrix(&self) -> Matrix4<f64> {
        let (m1, m2) = (self.m1_kg, self.m2_kg);
        let (k1, k2, c1, c2) = (self.k1_n_per_m, self.k2_n_per_m, self.c1_n_s_per_m, self.c2_n_s_per_m);
        #[rustfmt::skip]
        let a = Matrix4::new(
            0.0,             0.0,      1.0,             0.0,
            0.0,             0.0,      0.0,             1.0,
            -(k1 + k2) / m1, k2 / m1,  -(c1 + c2) / m1, c2 / m1,
            k2 / m2,         -k2 / m2, c2 / m2,         -c2 / m2,
        );
        a
    }

    /// Characteristic polynomial `s^4 + t s^3 + u s^2 + v s + w`, highest power first.
    pub fn characteristic_polynomial(&self) -> [f64; 5] {
        let (m1, m2) = (self.m1_kg, self.m2_kg);
        let (k1, k2, c1, c2) = (self.k1_n_per_m, self.k2_n_per_m, self.c1_n_s_per_m, self.c2_n_s_per_m);
        let product = m1 * m2;
        [
            1.0,
            (m1 * c2 + m2 * (c1 + c2)) / product,
            (m1 * k2 + m2 * (k1 + k2) + c1 * c2) / product,
            (c1 * k2 + c2 * k1) / product,
            k1 * k2 / product,
        ]
    }

    /// The four poles, 1/s, sorted by `|Im|`, then `Re`, the positive imaginary part first. Errors: parameters so
    /// extreme that the roots of the characteristic polynomial are not found.
    pub fn poles(&self) -> Result<Vec<Complex>, LumpedError> {
        Ok(polynomial_roots(&self.characteristic_polynomial())?)
    }

    /// Dynamic crush and rebound of chassis and compartment, by root finding on the exact solution.
    pub fn events(&self, impact_speed_m_per_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        self.structure()?.events(impact_speed_m_per_s, f64::INFINITY)
    }
}
