//! From a sampled model to the continuous one whose samples it gives, with the negative real poles handled.

use crate::linalg::jacobi_svd;
use nalgebra::{DMatrix, DVector};

use crate::lti::matrix::checks::check_finite;
use crate::lti::{LtiError, StateSpace, matrix_exponential, matrix_logarithm};

/// Poles nearer to zero than this are delays: there is no continuous counterpart of any order.
const DELAY: f64 = 1e-6;

/// Cosine between a left and a right eigenvector below which the pole counts as multiple: rounding parts a double pole
/// by `sqrt(f64::EPSILON)`, 1.5e-8 of its size, and leaves a cosine of that order.
const DEFECTIVE: f64 = 1e-6;

/// What an input does between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputHold {
    /// It keeps the value of the last sample.
    Zero,
    /// It goes straight to the next sample.
    First,
}

/// A continuous model and what had to be done to get it.
#[derive(Debug, Clone, PartialEq)]
pub struct Continuous {
    /// The model. Its state is that of the sampled one only without `conjugated` poles and for a zero-order hold.
    pub model: StateSpace,
    /// Negative real poles `z` that got a conjugate at the Nyquist frequency, one more state each.
    pub conjugated: Vec<f64>,
}

/// The continuous model of which the sampled one is the discretisation with the given hold; `|Im s| <= pi/dt`.
///
/// `A = ln(Ad)/dt`. With `phi(X) = (e^X - I)/X` a zero-order hold has `Bd = phi(A dt) B dt`, a first-order hold, in the
/// form without the next sample, `Bd = phi(A dt)^2 B dt` and `Dd = D + C (phi(A dt) - I)/(A dt) B dt`. `phi` is regular
/// for every pole that a principal logarithm can give, a rigid body (`z = 1`) among them.
///
/// A negative real pole has no real logarithm. As MATLAB's `d2c` does, it gets a conjugate, `s = ln|z|/dt +- i pi/dt`:
/// the outputs at the samples stay the same, the order grows by one, the pole is listed in `conjugated`. Such a pole is
/// an artefact of sampling or of too high an order; nothing in the continuous world is known of it.
///
/// Errors: a pole within 1e-6 of zero (a delay), a multiple negative pole.
pub fn to_continuous(model: &StateSpace, hold: InputHold) -> Result<Continuous, LtiError> {
    let dt_s = model.require_discrete()?;
    let (m, q) = (model.b.ncols(), model.c.nrows());
    let mut rest = model.clone();
    // Modes taken out: pole, row of inputs, column of outputs.
    let mut alone: Vec<(f64, DMatrix<f64>, DMatrix<f64>)> = Vec::new();
    while let Some(z) = rest.poles()?.into_iter().find(|z| z.im == 0.0 && z.re <= DELAY) {
        if z.re.abs() <= DELAY {
            return Err(LtiError::Delay { re: z.re });
        }
        let (remaining, b, c) = split_off(&rest, z.re)?;
        rest = remaining;
        alone.push((z.re, b, c));
    }
    let kept = rest.order();
    let n = kept + 2 * alone.len();
    // A dt, Bd and C with two states for every mode taken out.
    let mut generator = DMatrix::zeros(n, n);
    generator.view_mut((0, 0), (kept, kept)).copy_from(&matrix_logarithm(&rest.a)?);
    let mut b = DMatrix::zeros(n, m);
    b.rows_mut(0, kept).copy_from(&rest.b);
    let mut c = DMatrix::zeros(q, n);
    c.columns_mut(0, kept).copy_from(&rest.c);
    for (index, (z, row, column)) in alone.iter().enumerate() {
        let at = kept + 2 * index;
        let (rate, turn) = (z.abs().ln(), std::f64::consts::PI);
        generator.view_mut((at, at), (2, 2)).copy_from_slice(&[rate, -turn, turn, rate]);
        b.row_mut(at).copy_from(row);
        c.column_mut(at).copy_from(column);
    }
    let (phi, phi_next) = phi_functions(&generator)?;
    let solved = |right: &DMatrix<f64>| {
        phi.clone().lu().solve(right).ok_or(LtiError::Singular { what: "the integral of the matrix exponential" })
    };
    let (b, d) = match hold {
        InputHold::Zero => (solved(&b)?, model.d.clone()),
        InputHold::First => {
            let b = solved(&solved(&b)?)?;
            let d = &model.d - &c * (phi_next * &b);
            (b, d)
        }
    };
    let conjugated = alone.into_iter().map(|(z, ..)| z).collect();
    Ok(Continuous { model: StateSpace::new(generator / dt_s, b / dt_s, c, d, None)?, conjugated })
}

/// `(e^X - I)/X` and `(e^X - I - X)/X²`, from one exponential; no inverse of `X`.
fn phi_functions(x: &DMatrix<f64>) -> Result<(DMatrix<f64>, DMatrix<f64>), LtiError> {
    let n = x.nrows();
    let mut big = DMatrix::zeros(3 * n, 3 * n);
    big.view_mut((0, 0), (n, n)).copy_from(x);
    big.view_mut((0, n), (n, n)).fill_with_identity();
    big.view_mut((n, 2 * n), (n, n)).fill_with_identity();
    let e = matrix_exponential(&big)?;
    Ok((e.view((0, n), (n, n)).into_owned(), e.view((0, 2 * n), (n, n)).into_owned()))
}

/// Takes the mode of a simple real pole out of a model: what is left (one state less), and the mode's input row and
/// output column. The remaining states are orthonormal coordinates of the left eigenvector's complement.
fn split_off(model: &StateSpace, z: f64) -> Result<(StateSpace, DMatrix<f64>, DMatrix<f64>), LtiError> {
    let n = model.order();
    let shifted = &model.a - DMatrix::<f64>::identity(n, n) * z;
    let svd =
        jacobi_svd(&shifted).ok_or(LtiError::NotConverged { what: "the mode of a negative pole", iterations: 60 })?;
    let right: DVector<f64> = svd.right.column(n - 1).into_owned();
    // The left vector of a zero singular value is not given; the right one of the transpose is.
    let svd = jacobi_svd(&shifted.transpose())
        .ok_or(LtiError::NotConverged { what: "the mode of a negative pole", iterations: 60 })?;
    let left: DVector<f64> = svd.right.column(n - 1).into_owned();
    let cosine = left.dot(&right);
    if cosine.abs() < DEFECTIVE {
        return Err(LtiError::NegativeRealEigenvalue { re: z });
    }
    let b = left.transpose() * &model.b;
    let c = &model.c * &right / cosine;
    // Householder reflection that takes the left vector to the first axis; the other axes span its complement.
    let mut normal = left.clone();
    normal[0] += if left[0] >= 0.0 { 1.0 } else { -1.0 };
    let normal = normal.normalize();
    let reflection = DMatrix::<f64>::identity(n, n) - &normal * normal.transpose() * 2.0;
    let basis = reflection.columns(1, n - 1).into_owned();
    let rest_b = &model.b - &right * &b / cosine;
    check_finite("a mode", &rest_b)?;
    let rest = StateSpace::new(
        basis.tr_mul(&(&model.a * &basis)),
        basis.tr_mul(&rest_b),
        &model.c * &basis,
        model.d.clone(),
        model.sample_time_s,
    )?;
    Ok((
        rest,
        DMatrix::from_row_slice(1, b.ncols(), b.as_slice()),
        DMatrix::from_column_slice(c.nrows(), 1, c.as_slice()),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lti::{discretize_first_order_hold, discretize_zero_order_hold, impulse_response, undo_zero_order_hold};
    use nalgebra::dmatrix;

    fn sampled(a: DMatrix<f64>) -> StateSpace {
        let n = a.nrows();
        let b = DMatrix::from_fn(n, 1, |i, _| 1.0 - 0.3 * i as f64);
        let c = DMatrix::from_fn(1, n, |_, i| 0.5 + 0.4 * i as f64);
        StateSpace::new(a, b, c, dmatrix![0.2], Some(0.01)).unwrap()
    }

    #[test]
    fn without_negative_poles_it_is_the_logarithm_of_the_whole() {
        let model = sampled(dmatrix![0.9, 0.3, 0.0; -0.3, 0.9, 0.1; 0.0, 0.0, 1.0]);
        let continuous = to_continuous(&model, InputHold::Zero).unwrap();
        let whole = undo_zero_order_hold(&model).unwrap();
        assert!(continuous.conjugated.is_empty());
        // Two ways to the same: rounding of the logarithm over dt.
        assert!((&continuous.model.a - &whole.a).norm() < 1e-12 * whole.a.norm());
        assert!((&continuous.model.b - &whole.b).norm() < 1e-12 * whole.b.norm());
    }

    #[test]
    fn negative_poles_get_a_conjugate_and_the_samples_stay() {
        let a = dmatrix![0.9, 0.3, 0.0, 0.2; -0.3, 0.9, 0.1, 0.0; 0.1, 0.0, -0.5, 0.3; 0.0, 0.0, 0.0, -0.2];
        let model = sampled(a);
        let expected = impulse_response(&model, 40).unwrap();
        let continuous = to_continuous(&model, InputHold::Zero).unwrap();
        assert_eq!((continuous.model.order(), continuous.conjugated.len()), (6, 2));
        let again = impulse_response(&discretize_zero_order_hold(&continuous.model, 0.01).unwrap(), 40).unwrap();
        for (x, y) in expected.iter().zip(&again) {
            // Rounding of a logarithm and an exponential of norm 4.
            assert!((x - y).abs() < 1e-12, "{x} {y}");
        }
        let nyquist = std::f64::consts::PI / 0.01;
        let poles = continuous.model.poles().unwrap();
        assert_eq!(poles.iter().filter(|s| (s.im.abs() - nyquist).abs() < 1e-9 * nyquist).count(), 4);
        let held = to_continuous(&model, InputHold::First).unwrap();
        let again = discretize_first_order_hold(&held.model, 0.01).unwrap().state_space().unwrap();
        for (x, y) in expected.iter().zip(&impulse_response(&again, 40).unwrap()) {
            assert!((x - y).abs() < 1e-12, "{x} {y}");
        }
    }

    #[test]
    fn a_delay_and_a_double_negative_pole_are_refused() {
        let delay = sampled(dmatrix![0.0, 1.0; 0.0, 0.0]);
        assert!(matches!(to_continuous(&delay, InputHold::Zero), Err(LtiError::Delay { .. })));
        // As a triangle, where its eigenvalues are exact, and in other coordinates, where rounding parts them.
        let double = dmatrix![-0.5, 1.0; 0.0, -0.5];
        let to = dmatrix![1.3, 0.4; -0.7, 0.9];
        let turned = &to * &double * to.clone().try_inverse().unwrap();
        for a in [double, turned] {
            let continuous = to_continuous(&sampled(a), InputHold::Zero);
            assert!(matches!(continuous, Err(LtiError::NegativeRealEigenvalue { .. })), "{continuous:?}");
        }
    }
}
