//! A linear spring and a linear damper in series, as in the Maxwell model.
//!
//! One force in both; the inner state is the compression of the spring, `z' = w - (k/c) z`.

use crate::structure::form::{Form, Strain};
use crate::structure::law::{Branch, Law};

/// Spring and damper in series. Parameters: stiffness, coefficient of the damper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesSpringDamper {
    /// Spring, N/m, positive.
    pub stiffness_n_per_m: f64,
    /// Damper, N·s/m, positive.
    pub damping_n_s_per_m: f64,
}

impl Law for SeriesSpringDamper {
    fn parameters(&self) -> usize {
        2
    }

    fn has_branches(&self) -> bool {
        false
    }

    fn force(&self, _: &Branch) -> Form {
        Form { z: self.stiffness_n_per_m, ..Form::ZERO }
    }

    fn inner_rate(&self) -> Option<Form> {
        Some(Form { w: 1.0, z: -self.stiffness_n_per_m / self.damping_n_s_per_m, ..Form::ZERO })
    }

    fn force_by(&self, _: &Branch, parameter: usize) -> Form {
        Form { z: if parameter == 0 { 1.0 } else { 0.0 }, ..Form::ZERO }
    }

    fn inner_rate_by(&self, parameter: usize) -> Form {
        let (k, c) = (self.stiffness_n_per_m, self.damping_n_s_per_m);
        Form { z: if parameter == 0 { -1.0 / c } else { k / (c * c) }, ..Form::ZERO }
    }

    fn energies(&self, _: &Branch, strain: &Strain) -> [f64; 2] {
        [0.5 * self.stiffness_n_per_m * strain.z * strain.z, 0.0]
    }

    fn damping(&self, branch: &Branch) -> Form {
        self.force(branch)
    }

    fn symbols(&self) -> &'static str {
        "kc"
    }

    fn compression(&self, part: usize, strain: &Strain) -> f64 {
        if part == 0 { strain.z } else { strain.u - strain.z }
    }
}
