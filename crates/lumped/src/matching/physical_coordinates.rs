//! The masses' own motions in an identified state space: the transformation to physical coordinates.

use crumple_numerics::linalg::jacobi_svd;
use nalgebra::{DMatrix, Matrix2, Matrix4, RowVector4, Vector4};

use crate::error::{finite, positive};
use crate::{DoubleSpringMassDamper, LumpedError};

/// A continuous model of four states whose output is the motion of the compartment, and where there is a second sensor,
/// that of the chassis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RealisedModel {
    /// State matrix.
    pub a: Matrix4<f64>,
    /// Output row of the compartment.
    pub compartment: RowVector4<f64>,
    /// Output row of the chassis, the same quantity.
    pub chassis: Option<RowVector4<f64>>,
    /// What the outputs are: 0 displacement, 1 velocity, 2 acceleration.
    pub derivative: usize,
    /// State at contact, for a model of a free motion.
    pub start: Option<Vector4<f64>>,
}

/// An identified state space in the coordinates `(x1, x2, v1, v2)` of two masses: `M x'' + L x' + K x = 0`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhysicalCoordinates {
    /// `M`, kg.
    pub mass_kg: Matrix2<f64>,
    /// `L`, N·s/m.
    pub damping_n_s_per_m: Matrix2<f64>,
    /// `K`, N/m.
    pub stiffness_n_per_m: Matrix2<f64>,
    /// `T` of `(x1, x2, v1, v2) = T z`.
    pub transformation: Matrix4<f64>,
    /// Condition number of `T` with velocities over the mean natural frequency: digits lost on the way.
    pub condition: f64,
    /// `|T A - Ap T|/|Ap T|` in the same scale, `Ap` of the two masses: rounding times condition where the poles agree.
    pub residual: f64,
    /// Difference of the chassis row of `T` from that of the sensor there, relative to the latter: near 0 for the right
    /// solution. `None` without such a sensor.
    pub chassis_mismatch: Option<f64>,
    /// `(x1, x2, v1, v2)` at the start; a crash from contact has `(0, 0, v0, v0)`.
    pub start: Option<[f64; 4]>,
}

/// `A`, the row of the compartment's displacement and that of the chassis, in time units of the mean natural frequency.
struct Scaled {
    rate: f64,
    a: Matrix4<f64>,
    compartment: RowVector4<f64>,
    chassis: Option<RowVector4<f64>>,
}

impl RealisedModel {
    /// `rate` is the geometric mean of the four moduli of the poles, `|det A|^(1/4)`: in its units all of `A` is of one
    /// size. Errors: entries that are not finite, a pole at zero.
    fn scaled(&self) -> Result<Scaled, LumpedError> {
        for x in self.a.iter().chain(self.compartment.iter()).chain(self.chassis.iter().flat_map(|c| c.iter())) {
            finite("entry of the state space", *x)?;
        }
        let rate = self.a.determinant().abs().powf(0.25);
        positive("mean natural frequency of the state space, rad/s", rate)?;
        let a = self.a / rate;
        let inverse = a.try_inverse().ok_or(LumpedError::Value {
            name: "determinant of the state matrix",
            value: 0.0,
            expected: "other than 0: a pole at zero has no displacement",
        })?;
        // The displacement row of an output that is its d-th derivative: C A^-d.
        let integrated = |row: &RowVector4<f64>| (0..self.derivative).fold(*row, |row, _| row * inverse / rate);
        Ok(Scaled {
            rate,
            a,
            compartment: integrated(&self.compartment),
            chassis: self.chassis.as_ref().map(integrated),
        })
    }

    /// The transformation to the coordinates of a model with the same poles, a solution of coefficient matching.
    ///
    /// The compartment's rows of `T` follow from the output alone: `x2 = C A^-d`, `v2 = x2 A`. The chassis's follow
    /// from the compartment's equation of motion, `x1 (c2 A + k2) = x2 (m2 A² + c2 A + k2)`; with the poles right, the
    /// chassis's own equation then holds by Cayley and Hamilton. So **every** solution of the matching has its
    /// transformation, with the same compartment output: poles and one sensor leave the choice open. What decides is a
    /// row of the chassis (`chassis_mismatch`), or, between solutions with different `c1 c2`, the state at contact.
    ///
    /// Errors: values that are not finite, a pole at zero, `-k2/c2` on a pole.
    pub fn coordinates(&self, model: &DoubleSpringMassDamper) -> Result<PhysicalCoordinates, LumpedError> {
        model.check()?;
        let Scaled { rate, a, compartment: x2, chassis } = self.scaled()?;
        let (m2, c2, k2) = (model.m2_kg, model.c2_n_s_per_m, model.k2_n_per_m);
        let coupling = a * (c2 * rate) + Matrix4::identity() * k2;
        let Some(inverse) = coupling.try_inverse() else {
            return Err(LumpedError::Value {
                name: "determinant of c2 A + k2",
                value: 0.0,
                expected: "other than 0: the two masses are not coupled at one of the poles",
            });
        };
        // x2 (m2 A² + q) q^-1 = x2 + m2 x2 A² q^-1.
        let x1 = x2 + x2 * a * a * inverse * (m2 * rate * rate);
        let t = Matrix4::from_rows(&[x1, x2, x1 * a, x2 * a]);
        let physical = scaled_state_matrix(model, rate);
        let chassis_mismatch = chassis.map(|row| (x1 - row).norm() / row.norm());
        let mut plain = t;
        plain.row_mut(2).scale_mut(rate);
        plain.row_mut(3).scale_mut(rate);
        let (c1, k1) = (model.c1_n_s_per_m, model.k1_n_per_m);
        Ok(PhysicalCoordinates {
            mass_kg: Matrix2::from_diagonal(&nalgebra::Vector2::new(model.m1_kg, m2)),
            damping_n_s_per_m: Matrix2::new(c1 + c2, -c2, -c2, c2),
            stiffness_n_per_m: Matrix2::new(k1 + k2, -k2, -k2, k2),
            transformation: plain,
            condition: condition(&t)?,
            residual: (t * a - physical * t).norm() / (physical * t).norm(),
            chassis_mismatch: chassis_mismatch.filter(|x| x.is_finite()),
            start: self.start.map(|z| (plain * z).into()),
        })
    }

    /// The model that the rows of both masses determine with the total mass, and how far the state space is from a
    /// chain of two masses: `|T A T^-1 - Ap|/|Ap|`. `None` without a row of the chassis.
    ///
    /// `T` is then known without any model; `Ap = T A T^-1` holds `k2/m2`, `c2/m2`, `k2/m1`, `c2/m1` and the sums with
    /// `k1`, `c1`, so the mass ratio follows too. Where the rows do not agree, in the sense of least squares.
    ///
    /// Errors: as [`coordinates`](Self::coordinates), a total mass that is not positive, sensors that move alike.
    pub fn from_both_masses(&self, total_kg: f64) -> Result<Option<(DoubleSpringMassDamper, f64)>, LumpedError> {
        positive("total mass, kg", total_kg)?;
        let Scaled { rate, a, compartment: x2, chassis } = self.scaled()?;
        let Some(x1) = chassis else { return Ok(None) };
        let t = Matrix4::from_rows(&[x1, x2, x1 * a, x2 * a]);
        let alike = LumpedError::Value {
            name: "difference of the two sensors",
            value: 0.0,
            expected: "two masses that move differently",
        };
        let Some(inverse) = t.try_inverse() else { return Err(alike) };
        let p = t * a * inverse;
        // Per mass: the coupling seen from the compartment (twice) and from the chassis.
        let (k_rear, c_rear) = (0.5 * (p[(3, 0)] - p[(3, 1)]), 0.5 * (p[(3, 2)] - p[(3, 3)]));
        let (k_front, c_front) = (p[(2, 1)], p[(2, 3)]);
        let ratio = (k_front * k_rear + c_front * c_rear) / (k_rear * k_rear + c_rear * c_rear);
        if !(ratio.is_finite() && ratio > 0.0) {
            return Err(LumpedError::Value {
                name: "m2/m1 of the state space",
                value: if ratio.is_finite() { ratio } else { 0.0 },
                expected: "a positive number: the state space is no chain of two masses",
            });
        }
        let (m1, m2) = (total_kg / (1.0 + ratio), total_kg * ratio / (1.0 + ratio));
        let (k2, c2) = (m2 * k_rear * rate * rate, m2 * c_rear * rate);
        let model = DoubleSpringMassDamper {
            m1_kg: m1,
            m2_kg: m2,
            k1_n_per_m: -m1 * p[(2, 0)] * rate * rate - k2,
            k2_n_per_m: k2,
            c1_n_s_per_m: -m1 * p[(2, 2)] * rate - c2,
            c2_n_s_per_m: c2,
        };
        model.check()?;
        let chain = scaled_state_matrix(&model, rate);
        Ok(Some((model, (p - chain).norm() / chain.norm())))
    }

    /// `zeta = c1 c2/(m1 m2)`, 1/s², that the start of a free motion from contact implies, `-x2'''(0)/v2(0)`; it tells
    /// pairs of solutions apart, not the two of a pair. `None` without a start or a motion there.
    pub fn zeta_of_the_start(&self) -> Option<f64> {
        let z = self.start?;
        let Scaled { rate, a, compartment: x2, .. } = self.scaled().ok()?;
        let speed = (x2 * a * z)[0];
        let jerk = (x2 * a * a * a * z)[0];
        let zeta = -jerk / speed * rate * rate;
        zeta.is_finite().then_some(zeta)
    }
}

/// `A` of the double model in time units of `1/rate`, with velocities in those units too.
fn scaled_state_matrix(model: &DoubleSpringMassDamper, rate: f64) -> Matrix4<f64> {
    let mut p = model.state_matrix();
    for i in 2..4 {
        for j in 0..2 {
            p[(i, j)] /= rate * rate;
            p[(i, j + 2)] /= rate;
        }
    }
    p
}

/// Ratio of the largest to the smallest singular value. Errors: a matrix without an inverse.
fn condition(t: &Matrix4<f64>) -> Result<f64, LumpedError> {
    let svd = jacobi_svd(&DMatrix::from_column_slice(4, 4, t.as_slice()));
    let condition = svd.map_or(f64::NAN, |svd| svd.values[0] / svd.values[3]);
    finite("condition of the transformation", condition)?;
    Ok(condition)
}
