//! Exponential and logarithm of small real matrices.

use nalgebra::DMatrix;

use crate::lti::eigenvalues::check_square;
use crate::lti::{LtiError, eigenvalues};

/// Coefficients of the [13/13] Padé approximant of `exp`, lowest power first.
const PADE: [f64; 14] = [
    64_764_752_532_480_000.0,
    32_382_376_266_240_000.0,
    7_771_770_303_897_600.0,
    1_187_353_796_428_800.0,
    129_060_195_264_000.0,
    10_559_470_521_600.0,
    670_442_572_800.0,
    33_522_128_640.0,
    1_323_241_920.0,
    40_840_800.0,
    960_960.0,
    16_380.0,
    182.0,
    1.0,
];

/// Largest 1-norm at which the approximant is accurate to the last bit (Higham 2005, table 2.3).
const THETA: f64 = 5.371_920_351_148_152;

/// `exp(a)` by scaling and squaring with the [13/13] Padé approximant.
///
/// Backward error near the rounding unit; each of the `log2(|a|/5.4)` squarings may double the forward error. Unlike
/// nalgebra's `exp` it answers a matrix whose exponential overflows with an error instead of a panic.
/// Errors: not square, not finite, or overflow ([`LtiError::NotFinite`]).
///
/// Higham, "The scaling and squaring method for the matrix exponential revisited", SIAM J. Matrix Anal. 26(4), 2005.
pub fn matrix_exponential(a: &DMatrix<f64>) -> Result<DMatrix<f64>, LtiError> {
    check_square("the matrix of an exponential", a)?;
    let n = a.nrows();
    let overflow = LtiError::NotFinite { what: "the matrix exponential" };
    let norm = one_norm(a);
    // exp(|a|) bounds every entry; past 1e5 only a matrix with hugely negative eigenvalues could be represented.
    if !norm.is_finite() || norm > 1e5 {
        return Err(overflow);
    }
    let squarings = if norm > THETA { (norm / THETA).log2().ceil() as i32 } else { 0 };
    let a = a * 0.5_f64.powi(squarings);

    let identity = DMatrix::<f64>::identity(n, n);
    let a2 = &a * &a;
    let a4 = &a2 * &a2;
    let a6 = &a4 * &a2;
    let odd = &a6 * (&a6 * PADE[13] + &a4 * PADE[11] + &a2 * PADE[9])
        + &a6 * PADE[7]
        + &a4 * PADE[5]
        + &a2 * PADE[3]
        + &identity * PADE[1];
    let u = &a * odd;
    let v = &a6 * (&a6 * PADE[12] + &a4 * PADE[10] + &a2 * PADE[8])
        + &a6 * PADE[6]
        + &a4 * PADE[4]
        + &a2 * PADE[2]
        + &identity * PADE[0];

    let mut result = (&v - &u).lu().solve(&(&v + &u)).ok_or_else(|| overflow.clone())?;
    for _ in 0..squarings {
        result = &result * &result;
    }
    if result.iter().all(|x| x.is_finite()) { Ok(result) } else { Err(overflow) }
}

/// Largest column sum of magnitudes; 0 for an empty matrix.
pub(crate) fn one_norm(a: &DMatrix<f64>) -> f64 {
    a.column_iter().map(|column| column.iter().map(|x| x.abs()).sum()).fold(0.0, f64::max)
}

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
    use proptest::prelude::*;

    use super::*;
    use nalgebra::dmatrix;

    fn close(a: &DMatrix<f64>, b: &DMatrix<f64>, relative: f64) {
        assert!((a - b).norm() <= relative * b.norm(), "{a} against {b}");
    }

    #[test]
    fn rotates_by_an_angle() {
        // exp of the generator of rotations; 40 rad takes three squarings, so a few ulp times 2^3.
        for angle in [0.0_f64, 1e-9, 0.3, 2.0, 40.0] {
            let exact = dmatrix![angle.cos(), -angle.sin(); angle.sin(), angle.cos()];
            close(&matrix_exponential(&dmatrix![0.0, -angle; angle, 0.0]).unwrap(), &exact, 1e-14);
        }
    }

    #[test]
    fn keeps_a_jordan_block() {
        // exp([[l,1],[0,l]]) = e^l [[1,1],[0,1]], exact up to rounding.
        let e = (-3.0_f64).exp();
        close(&matrix_exponential(&dmatrix![-3.0, 1.0; 0.0, -3.0]).unwrap(), &dmatrix![e, e; 0.0, e], 1e-15 * 4.0);
    }

    #[test]
    fn stiff_diagonal_keeps_its_small_entry_and_overflow_is_an_error() {
        let e = matrix_exponential(&dmatrix![-700.0, 0.0; 0.0, -1.0]).unwrap();
        // Eight squarings: the relative error of the small entry is 2^8 rounding units at most.
        assert!((e[(0, 0)] / (-700.0_f64).exp() - 1.0).abs() < 1e-12);
        assert!((e[(1, 1)] / (-1.0_f64).exp() - 1.0).abs() < 1e-12);
        assert!(matrix_exponential(&dmatrix![800.0]).is_err());
        assert!(matrix_exponential(&dmatrix![1e300]).is_err());
    }

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
