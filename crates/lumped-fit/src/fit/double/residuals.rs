//! Displacement of the double model's compartment minus the record, with exact sensitivities.
//!
//! The motion is marched with the exact step `z(t + dt) = e^(A dt) z(t)` of the state `z = (x1, x2, v1, v2)`, so
//! samples may be any distance apart.

use crumple_lumped::{DoubleSpringMassDamper, exact_step, exact_step_with_derivatives};
use nalgebra::{DMatrix, Matrix4, Vector4};

use crate::record::window::Window;
use crumple_estimation::minimise::levenberg_marquardt::Response;

/// The fit in logarithms: `theta = ln(k1, k2, c1, c2)` over their scales, so that every trial is positive.
///
/// Residuals are in units of `impact speed · window length`.
pub(crate) struct DoubleResiduals<'a> {
    /// Mass next to the barrier, kg.
    pub m1_kg: f64,
    /// Mass of the compartment, kg.
    pub m2_kg: f64,
    /// Speed of both masses at contact, m/s.
    pub impact_speed_m_per_s: f64,
    /// Displacement of the compartment, m.
    pub window: &'a Window,
    /// Scales of `k1, k2, c1, c2`.
    pub scale: [f64; 4],
    /// Metres of one unit of residual.
    pub unit_m: f64,
}

impl DoubleResiduals<'_> {
    /// The model at `theta`.
    pub fn model(&self, theta: &[f64]) -> DoubleSpringMassDamper {
        let p = [0, 1, 2, 3].map(|i| self.scale[i] * theta[i].exp());
        DoubleSpringMassDamper {
            m1_kg: self.m1_kg,
            m2_kg: self.m2_kg,
            k1_n_per_m: p[0],
            k2_n_per_m: p[1],
            c1_n_s_per_m: p[2],
            c2_n_s_per_m: p[3],
        }
    }

    /// The state at contact: no displacement, both masses at the impact speed.
    fn start(&self) -> Vector4<f64> {
        Vector4::new(0.0, 0.0, self.impact_speed_m_per_s, self.impact_speed_m_per_s)
    }

    /// Derivatives of the state matrix by each of theta. It is linear in every parameter, so each is the state
    /// matrix of that parameter alone, without the two rows that say `x' = v`.
    fn state_matrix_derivatives(&self, model: &DoubleSpringMassDamper) -> [Matrix4<f64>; 4] {
        let none =
            DoubleSpringMassDamper { k1_n_per_m: 0.0, k2_n_per_m: 0.0, c1_n_s_per_m: 0.0, c2_n_s_per_m: 0.0, ..*model };
        let base = none.state_matrix();
        [
            DoubleSpringMassDamper { k1_n_per_m: model.k1_n_per_m, ..none },
            DoubleSpringMassDamper { k2_n_per_m: model.k2_n_per_m, ..none },
            DoubleSpringMassDamper { c1_n_s_per_m: model.c1_n_s_per_m, ..none },
            DoubleSpringMassDamper { c2_n_s_per_m: model.c2_n_s_per_m, ..none },
        ]
        .map(|one| one.state_matrix() - base)
    }
}

impl Response for DoubleResiduals<'_> {
    /// One residual for each sample of the window.
    fn rows(&self) -> usize {
        self.window.samples.len()
    }

    /// `(x2(t_k) - s_k)/unit`; `false` where one is not finite.
    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let a = self.model(theta).state_matrix();
        let phi = exact_step(&a, self.window.dt_s);
        let mut z = exact_step(&a, self.window.first_s) * self.start();
        for (r, x) in out.iter_mut().zip(&self.window.samples) {
            *r = (z[1] - x) / self.unit_m;
            z = phi * z;
        }
        out.iter().all(|r| r.is_finite())
    }

    /// The sensitivity `s = dz/dtheta` marches with the state: `s(t+dt) = phi s + dphi z`.
    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> Option<bool> {
        let model = self.model(theta);
        let a = model.state_matrix();
        let da = self.state_matrix_derivatives(&model);
        let step = exact_step_with_derivatives(&a, &da, self.window.dt_s);
        let (mut z, mut s) = (self.start(), [Vector4::zeros(); 4]);
        if self.window.first_s > 0.0 {
            let first = exact_step_with_derivatives(&a, &da, self.window.first_s);
            (z, s) = (first.phi * z, first.derivatives.map(|d| d * z));
        }
        for k in 0..self.rows() {
            for (j, s) in s.iter().enumerate() {
                out[(k, j)] = s[1] / self.unit_m;
            }
            for (s, d) in s.iter_mut().zip(&step.derivatives) {
                *s = step.phi * *s + d * z;
            }
            z = step.phi * z;
        }
        Some(out.iter().all(|x| x.is_finite()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_estimation::minimise::levenberg_marquardt::{Bounds, central_differences};

    #[test]
    fn sensitivities_agree_with_central_differences() {
        let window = Window { first_s: 0.003, dt_s: 1e-3, samples: vec![0.1; 60] };
        let problem = DoubleResiduals {
            m1_kg: 300.0,
            m2_kg: 900.0,
            impact_speed_m_per_s: 12.0,
            window: &window,
            scale: [4e5, 5e5, 6e3, 7e3],
            unit_m: 0.5,
        };
        let theta = [0.1, -0.2, 0.3, 0.05];
        let bounds = Bounds { lower: vec![-1.0; 4], upper: vec![1.0; 4], max_iterations: 0, cost_tolerance: 0.0 };
        let mut analytic = DMatrix::zeros(60, 4);
        assert_eq!(problem.sensitivities(&theta, &mut analytic), Some(true));
        let by_differences = central_differences(&problem, &theta, &bounds).unwrap();
        for (analytic, difference) in analytic.column_iter().zip(by_differences.column_iter()) {
            let error = (analytic - difference).amax() / analytic.amax();
            // h² of the third derivative, which is some ten times the first: 1e-9; rounding 1e-16/1e-5 of residuals
            // near 1 over sensitivities near 0.1: 1e-10.
            assert!(error < 1e-8, "{error:e}");
        }
    }
}
