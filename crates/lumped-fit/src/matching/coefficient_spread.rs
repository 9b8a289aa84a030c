//! Standard deviations of matched springs and dampers from those of the identified coefficients.
//!
//! `C_p = J C J'` with `J = dp/d(t, u, v, w)` by implicit differentiation of the four matching equations.

use std::collections::BTreeMap;

use crumple_lumped::{DoubleSpringMassDamper, matching_sensitivity};
use nalgebra::Matrix4;

use crate::Uncertainty;

/// Covariance of the coefficients `t, u, v, w` of an identified denominator, in their units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoefficientSpread {
    /// Rows and columns `t, u, v, w`.
    covariance: Matrix4<f64>,
    /// Whether correlations were unknown and taken as zero.
    independent: bool,
}

impl CoefficientSpread {
    /// From their covariance, rows and columns from `t` to `w`. `None` for another shape, numbers that are not
    /// finite, or variances that are not positive.
    pub fn of_covariance(rows: &[Vec<f64>]) -> Option<Self> {
        if rows.len() != 4 || rows.iter().any(|row| row.len() != 4) {
            return None;
        }
        let covariance = Matrix4::from_fn(|i, j| rows[i][j]);
        let sound = covariance.iter().all(|x| x.is_finite()) && covariance.diagonal().iter().all(|x| *x > 0.0);
        sound.then_some(Self { covariance, independent: false })
    }

    /// From their standard deviations alone, as if independent. Coefficients of one fit are correlated, so the result
    /// can be wrong by a factor of a few either way.
    pub fn of_deviations(deviations: &[f64]) -> Option<Self> {
        let deviations = <[f64; 4]>::try_from(deviations).ok()?;
        let sound = deviations.iter().all(|d| d.is_finite() && *d > 0.0);
        let covariance = Matrix4::from_diagonal(&deviations.map(|d| d * d).into());
        sound.then_some(Self { covariance, independent: true })
    }

    /// Standard deviations of `k1, k2, c1, c2` of one solution: `J cov J'` with `J` by implicit differentiation of the
    /// four equations, for known masses.
    ///
    /// First order: good while the deviations are small beside the distance to the next solution, without bound towards
    /// a multiple one. `None` there, and where a coefficient or a damper is zero.
    pub fn of_match(&self, model: &DoubleSpringMassDamper) -> Option<Uncertainty> {
        let relative = matching_sensitivity(model)?;
        let p = [model.k1_n_per_m, model.k2_n_per_m, model.c1_n_s_per_m, model.c2_n_s_per_m];
        let coefficients = model.characteristic_polynomial();
        let jacobian = Matrix4::from_fn(|i, j| relative[(i, j)] * p[i] / coefficients[j + 1]);
        let covariance = jacobian * self.covariance * jacobian.transpose();
        let names = ["k1_n_per_m", "k2_n_per_m", "c1_n_s_per_m", "c2_n_s_per_m"];
        let standard_deviation: BTreeMap<&'static str, f64> =
            names.into_iter().zip(covariance.diagonal().iter().map(|x| x.max(0.0).sqrt())).collect();
        // With columns of one length.
        let mut scaled = relative;
        for mut column in scaled.column_iter_mut() {
            let length = column.norm();
            column.unscale_mut(length);
        }
        let values = scaled.singular_values();
        let condition = values.max() / values.min();
        let finite = condition.is_finite() && standard_deviation.values().all(|d| d.is_finite());
        finite.then_some(Uncertainty {
            method: if self.independent {
                "J cov J' from the deviations of the identified coefficients, taken as independent"
            } else {
                "J cov J' from the covariance of the identified coefficients"
            },
            standard_deviation,
            condition,
            residual_autocorrelation: None,
        })
    }
}
