//! The matrix exponential.

use nalgebra::DMatrix;

use crate::lti::LtiError;
use crate::lti::matrix::checks::check_square;

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

#[cfg(test)]
mod tests {
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
}
