//! The bilinear (Tustin) transformation, both ways.

use nalgebra::DMatrix;

use crate::model::check_sample_time;
use crate::{LtiError, StateSpace};

/// Reciprocal condition, by the 1-norm, below which a matrix counts as singular.
const SINGULAR: f64 = 1e-14;

/// The sampled model with `s = 2/dt (z - 1)/(z + 1)`: the trapezoidal rule applied to the state equation.
///
/// Every stable model stays stable, and frequencies are bent: `w` answers as `2/dt tan(w dt/2)` did, 1 % off at
/// `w dt = 0.35`. For an exact model of a record use the holds. Errors: a pole at `2/dt`, which has no image.
///
/// Source: Franklin, Powell, Workman, *Digital Control of Dynamic Systems*, 1998, ch. 6.
pub fn discretize_tustin(model: &StateSpace, dt_s: f64) -> Result<StateSpace, LtiError> {
    model.require_continuous()?;
    check_sample_time(dt_s)?;
    let n = model.order();
    let identity = DMatrix::<f64>::identity(n, n);
    let half = &model.a * (dt_s / 2.0);
    let inverse = inverted(&identity - &half, "I - A dt/2 (a pole at 2/dt)")?;
    let d = &model.d + &model.c * &inverse * &model.b * (dt_s / 2.0);
    StateSpace::new(&inverse * (&identity + &half), &inverse * &model.b * dt_s, &model.c * &inverse, d, Some(dt_s))
}

/// The continuous model with `z = (1 + s dt/2)/(1 - s dt/2)`. It exists for negative real poles too; only a pole at
/// `z = -1` has no image.
pub fn undo_tustin(model: &StateSpace) -> Result<StateSpace, LtiError> {
    let dt_s = model.require_discrete()?;
    let n = model.order();
    let identity = DMatrix::<f64>::identity(n, n);
    let inverse = inverted(&identity + &model.a, "I + Ad (a pole at -1)")?;
    let d = &model.d - &model.c * &inverse * &model.b;
    StateSpace::new(
        &inverse * (&model.a - &identity) * (2.0 / dt_s),
        &inverse * &model.b * (2.0 / dt_s),
        &model.c * &inverse * 2.0,
        d,
        None,
    )
}

fn inverted(matrix: DMatrix<f64>, what: &'static str) -> Result<DMatrix<f64>, LtiError> {
    let norm = crate::matrix::exponential::one_norm(&matrix);
    match matrix.try_inverse() {
        Some(inverse) if crate::matrix::exponential::one_norm(&inverse) * norm < 1.0 / SINGULAR => Ok(inverse),
        _ => Err(LtiError::Singular { what }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Complex;
    use nalgebra::dmatrix;

    #[test]
    fn a_lag_gives_its_textbook_coefficients() {
        // 1/(s + 2) at dt = 1: (z + 1)/(4 z).
        let unit = dmatrix![1.0];
        let lag = StateSpace::new(dmatrix![-2.0], unit.clone(), unit, dmatrix![0.0], None).unwrap();
        let d = discretize_tustin(&lag, 1.0).unwrap();
        assert_eq!((d.a[0], d.d[0]), (0.0, 0.25));
        // Value at z = 2: 3/8.
        assert_eq!(d.d[0] + d.c[0] * d.b[0] / (2.0 - d.a[0]), 0.375);
    }

    #[test]
    fn frequencies_are_bent_as_the_tangent_says() {
        let (w, dt) = (300.0, 1e-3);
        let a = dmatrix![0.0, 1.0; -w * w, 0.0];
        let model = StateSpace::new(a, dmatrix![0.0; 1.0], dmatrix![1.0, 0.0], dmatrix![0.0], None).unwrap();
        let z = discretize_tustin(&model, dt).unwrap().poles().unwrap()[0];
        let bent = (Complex::new(z.re, z.im).ln() / dt).im.abs();
        // Rounding of the eigenvalue, 1e-16 over w dt.
        assert!(((bent * dt / 2.0).tan() * 2.0 / dt - w).abs() < 1e-9 * w, "{bent}");
    }

    #[test]
    fn a_pole_without_image_is_refused() {
        let unit = dmatrix![1.0];
        let fast = StateSpace::new(dmatrix![2.0], unit.clone(), unit.clone(), dmatrix![0.0], None).unwrap();
        assert!(matches!(discretize_tustin(&fast, 1.0), Err(LtiError::Singular { .. })));
        let alternating = StateSpace::new(dmatrix![-1.0], unit.clone(), unit, dmatrix![0.0], Some(1.0)).unwrap();
        assert!(matches!(undo_tustin(&alternating), Err(LtiError::Singular { .. })));
    }
}
