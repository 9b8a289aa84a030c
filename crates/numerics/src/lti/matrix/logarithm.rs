//! The matrix logarithm.

use nalgebra::DMatrix;

use crate::lti::matrix::checks::check_square;
use crate::lti::matrix::exponential::one_norm;
use crate::lti::{LtiError, eigenvalues, matrix_exponential};

/// Nodes of 8-point Gauss-Legendre quadrature on [-1, 1], the positive half, with their weights.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];

/// Distance from the identity, in the 1-norm, at which the quadrature is exact to rounding.
const NEAR_IDENTITY: f64 = 0.25;

/// Square roots taken at most: 2^64 covers every finite norm of interest.
const MAX_ROOTS: usize = 64;

/// Steps of one square root. It converges quadratically once it has left the neighbourhood of the negative axis,
/// which takes about one step per binary digit of the distance.
const MAX_STEPS: usize = 100;

/// Largest relative residual of `exp(ln a) - a` that is passed on.
const MAX_RESIDUAL: f64 = 1e-8;

/// The principal logarithm of a real matrix.
///
/// Square roots until `a` is near the identity, then `ln a = ∫₀¹ (I + tX)⁻¹ X dt`, `X = a - I`, by 8-point
/// Gauss-Legendre quadrature, which is the [8/8] Padé approximant. No Schur form and no eigenvectors, so a defective
/// matrix (Jordan block, rigid body) is an ordinary case. Relative error about 1e-15 times the condition of the
/// logarithm; the result is checked by its exponential.
///
/// Errors: an eigenvalue on the closed negative real axis has no real logarithm
/// ([`LtiError::NegativeRealEigenvalue`]); eigenvalues that nearly do may give [`LtiError::NotConverged`] or
/// [`LtiError::Inaccurate`].
///
/// Denman & Beavers, "The matrix sign function and computations in systems", Appl. Math. Comput. 2, 1976; Higham,
/// *Functions of Matrices*, SIAM 2008, ch. 11.
pub fn matrix_logarithm(a: &DMatrix<f64>) -> Result<DMatrix<f64>, LtiError> {
    check_square("the matrix of a logarithm", a)?;
    if let Some(z) = eigenvalues(a)?.into_iter().find(|z| z.im == 0.0 && z.re <= 0.0) {
        return Err(LtiError::NegativeRealEigenvalue { re: z.re });
    }
    let n = a.nrows();
    let identity = DMatrix::<f64>::identity(n, n);
    let mut root = a.clone();
    let mut roots = 0;
    while one_norm(&(&root - &identity)) > NEAR_IDENTITY {
        if roots == MAX_ROOTS {
            return Err(LtiError::NotConverged { what: "the matrix logarithm", iterations: MAX_ROOTS });
        }
        root = square_root(root)?;
        roots += 1;
    }
    let x = root - &identity;
    let mut sum = DMatrix::zeros(n, n);
    for (node, weight) in GAUSS {
        for t in [(1.0 - node) / 2.0, (1.0 + node) / 2.0] {
            let term =
                (&identity + &x * t).lu().solve(&x).ok_or(LtiError::NotFinite { what: "the matrix logarithm" })?;
            sum += term * (weight / 2.0);
        }
    }
    let logarithm = sum * 2.0_f64.powi(i32::try_from(roots).unwrap_or(i32::MAX));

    let residual = one_norm(&(matrix_exponential(&logarithm)? - a)) / one_norm(a).max(f64::MIN_POSITIVE);
    if residual > MAX_RESIDUAL {
        return Err(LtiError::Inaccurate { what: "the matrix logarithm", relative_error: residual });
    }
    Ok(logarithm)
}

/// Principal square root by the Denman-Beavers iteration.
fn square_root(a: DMatrix<f64>) -> Result<DMatrix<f64>, LtiError> {
    let failed = LtiError::NotConverged { what: "a matrix square root", iterations: MAX_STEPS };
    let n = a.nrows();
    let mut y = a;
    let mut z = DMatrix::<f64>::identity(n, n);
    let mut last_change = f64::INFINITY;
    for _ in 0..MAX_STEPS {
        let (y_inverse, z_inverse) = match (y.clone().try_inverse(), z.clone().try_inverse()) {
            (Some(y), Some(z)) => (y, z),
            _ => return Err(failed),
        };
        let next = (&y + z_inverse) * 0.5;
        z = (z + y_inverse) * 0.5;
        let change = one_norm(&(&next - &y)) / one_norm(&next);
        y = next;
        if !change.is_finite() {
            return Err(failed);
        }
        // Quadratic convergence: after a change of 1e-9 the next iterate is exact to rounding; once changes no longer
        // shrink, rounding is all that is left of them.
        if change < 1e-15 || (change < 1e-12 && change >= last_change) {
            return Ok(y);
        }
        last_change = change;
    }
    Err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    #[test]
    fn jordan_block_gives_its_nilpotent_part_exactly() {
        // ln([[1, h], [0, 1]]) = [[0, h], [0, 0]]: where an eigenvector formula returns noise.
        for h in [1.0, 1e-6, 0.2, 50.0] {
            let log = matrix_logarithm(&dmatrix![1.0, h; 0.0, 1.0]).unwrap();
            // 1e-14: a few roundings per square root.
            assert!((&log - dmatrix![0.0, h; 0.0, 0.0]).norm() <= 1e-14 * h, "{log}");
        }
    }

    #[test]
    fn rotation_gives_its_angle_up_to_nearly_half_a_turn() {
        for angle in [1e-8_f64, 0.5, 3.0, std::f64::consts::PI - 6e-4] {
            let log = matrix_logarithm(&dmatrix![angle.cos(), -angle.sin(); angle.sin(), angle.cos()]).unwrap();
            // The logarithm's condition grows like 1/(pi - angle), 1700 for the last angle.
            assert!((&log - dmatrix![0.0, -angle; angle, 0.0]).norm() <= 1e-12, "{log}");
        }
    }

    #[test]
    fn negative_and_zero_eigenvalues_are_refused_by_name() {
        let error = matrix_logarithm(&dmatrix![-0.5, 0.0; 0.0, 2.0]).unwrap_err();
        assert_eq!(error, LtiError::NegativeRealEigenvalue { re: -0.5 });
        assert!(matches!(
            matrix_logarithm(&dmatrix![0.0, 1.0; 0.0, 0.0]).unwrap_err(),
            LtiError::NegativeRealEigenvalue { .. }
        ));
    }

    proptest! {
        #[test]
        fn exponential_undoes_it(entries in prop::collection::vec(-1.0..1.0_f64, 16)) {
            // Start from a generator whose eigenvalues lie inside the strip |Im| < pi, so its exponential has it as
            // principal logarithm.
            let a = DMatrix::from_vec(4, 4, entries) * 0.7;
            let e = matrix_exponential(&a).unwrap();
            let log = matrix_logarithm(&e).unwrap();
            // exp is well conditioned here (|a|_1 < 2.8): 1e-12 leaves two digits over the 6e-15 of typical matrices.
            let back = matrix_exponential(&log).unwrap();
            prop_assert!((&back - &e).norm() <= 1e-12 * e.norm(), "{}", (&back - &e).norm());
            prop_assert!((&log - &a).norm() <= 1e-11, "{}", (&log - &a).norm());
        }
    }
}
