//! Eigenvalues and eigenvectors of small real matrices, roots of polynomials.

use nalgebra::linalg::Schur;
use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{DMatrix, DVector};

use crate::lti::LtiError;

/// A complex number, as nalgebra uses it.
pub type Complex = nalgebra::Complex<f64>;

/// Errors unless every entry is finite.
pub(crate) fn check_finite(what: &'static str, matrix: &DMatrix<f64>) -> Result<(), LtiError> {
    if matrix.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(LtiError::NotFinite { what }) }
}

/// Errors unless the matrix is square and finite.
pub(crate) fn check_square(what: &'static str, matrix: &DMatrix<f64>) -> Result<(), LtiError> {
    let (rows, columns) = matrix.shape();
    if rows != columns {
        return Err(LtiError::Shape { what, rows, columns, expected: "a square matrix".to_owned() });
    }
    check_finite(what, matrix)
}

/// QR steps per state before a matrix counts as stuck; three or four are usual.
const STEPS_PER_STATE: usize = 60;

/// Eigenvalues of a real matrix, exactly conjugate in pairs, by `|Im|`, then `Re`, the positive imaginary part
/// first.
///
/// Mean removed, balanced, then the real Schur form. Absolute error about the rounding unit times the norm of the
/// matrix so treated, for well-separated eigenvalues; one of multiplicity m is known only to the m-th root of that.
/// Errors: not square, not finite, [`LtiError::NotConverged`].
pub fn eigenvalues(a: &DMatrix<f64>) -> Result<Vec<Complex>, LtiError> {
    check_square("the matrix of an eigenvalue problem", a)?;
    let n = a.nrows();
    if n == 0 {
        return Ok(Vec::new());
    }
    // Without its mean the matrix keeps only what tells the eigenvalues apart. A sampled model is the identity plus a
    // small part: the absolute error then goes with the small part, and nalgebra's QR, whose test for convergence
    // looks at the diagonal, does not stall on it.
    let mean = a.diagonal().iter().map(|x| x / n as f64).sum::<f64>();
    let mut balanced = a - DMatrix::<f64>::identity(n, n) * mean;
    let largest = balanced.amax();
    if largest == 0.0 {
        return Ok(vec![Complex::new(mean, 0.0); n]);
    }
    // A power of two rounds nothing; entries near 1 keep the squares inside the balancing from overflowing.
    let scale = largest.log2().round().exp2().clamp(f64::MIN_POSITIVE, f64::MAX / 2.0);
    balanced /= scale;
    balance_parlett_reinsch(&mut balanced);
    // That QR has no exceptional shifts and can cycle on matrices with rotational symmetry (companion matrices of z^n
    // - 1), and it stalls where a cluster of eigenvalues sits on a diagonal near zero. A shifted matrix has neither;
    // its eigenvalues differ by the shift, and a looser test costs a few rounding units of the norm.
    for (shift, looseness) in [(0.0, 1.0), (0.328_125, 4.0), (-0.703_125, 32.0)] {
        let shifted = &balanced + DMatrix::<f64>::identity(n, n) * shift;
        let schur = Schur::try_new(shifted, f64::EPSILON * looseness, STEPS_PER_STATE * n);
        if let Some(schur) = schur {
            let values = schur.complex_eigenvalues();
            return Ok(sort_poles(values.iter().map(|z| (z - shift) * scale + mean).collect()));
        }
    }
    Err(LtiError::NotConverged { what: "the eigenvalue iteration", iterations: STEPS_PER_STATE * n })
}

/// Sorts the roots of a real polynomial or matrix by `|Im|`, then `Re`, the positive imaginary part first, and makes
/// conjugate pairs exact by averaging the two.
///
/// A complex value without partner (which rounding cannot produce from real data) is made real.
fn sort_poles(poles: Vec<Complex>) -> Vec<Complex> {
    let (mut upper, rest): (Vec<_>, Vec<_>) = poles.into_iter().partition(|z| z.im > 0.0);
    let (mut lower, mut result): (Vec<_>, Vec<_>) = rest.into_iter().partition(|z| z.im < 0.0);
    upper.sort_by(|a, b| a.im.total_cmp(&b.im).then(a.re.total_cmp(&b.re)));
    for z in upper {
        let distance = |w: &Complex| (w.conj() - z).norm();
        match (0..lower.len()).min_by(|&i, &j| distance(&lower[i]).total_cmp(&distance(&lower[j]))) {
            Some(nearest) => {
                let mean = (z + lower.swap_remove(nearest).conj()) * 0.5;
                result.extend([mean, mean.conj()]);
            }
            None => result.push(Complex::new(z.re, 0.0)),
        }
    }
    result.extend(lower.into_iter().map(|z| Complex::new(z.re, 0.0)));
    // A negative zero would print as such.
    for z in &mut result {
        *z = Complex::new(z.re + 0.0, if z.im == 0.0 { 0.0 } else { z.im });
    }
    result.sort_by(|a, b| a.im.abs().total_cmp(&b.im.abs()).then(a.re.total_cmp(&b.re)).then(b.im.total_cmp(&a.im)));
    result
}

/// Right eigenvectors of `a`, one column per eigenvalue, of norm 1, by two steps of inverse iteration.
///
/// `eigenvalues` are those of [`eigenvalues`]. The columns of a multiple eigenvalue coincide: the matrix is then
/// singular, which the caller must expect. `None` if a column cannot be computed.
pub fn eigenvectors(a: &DMatrix<f64>, eigenvalues: &[Complex]) -> Option<DMatrix<Complex>> {
    let n = a.nrows();
    let complex = a.map(|x| Complex::new(x, 0.0));
    // Just off the eigenvalue, so that the matrix can be factorised and the wanted direction is blown up.
    let nudge = (a.amax() * f64::EPSILON * 4.0).max(f64::MIN_POSITIVE);
    let mut result = DMatrix::<Complex>::zeros(n, eigenvalues.len());
    for (i, &z) in eigenvalues.iter().enumerate() {
        if z.im < 0.0 && i > 0 && eigenvalues[i - 1] == z.conj() {
            let conjugate = result.column(i - 1).map(|x| x.conj());
            result.set_column(i, &conjugate);
            continue;
        }
        let shifted = &complex - DMatrix::<Complex>::identity(n, n) * (z + nudge);
        let lu = shifted.lu();
        // An arbitrary start without symmetry.
        let mut x = DVector::from_fn(n, |k, _| Complex::new(1.0 + 0.1 * k as f64, 0.3));
        for _ in 0..2 {
            x = lu.solve(&x)?;
            let norm = x.norm();
            if !(norm.is_finite() && norm > 0.0) {
                return None;
            }
            x.unscale_mut(norm);
        }
        result.set_column(i, &x);
    }
    Some(result)
}

/// Newton steps on each root; quadratic convergence needs two from an eigenvalue's accuracy.
const POLISH_STEPS: usize = 4;

/// Roots of a real polynomial, coefficients with the highest power first, in the order of [`eigenvalues`].
///
/// Variable scaled so that the product of the roots is 1, eigenvalues of the balanced companion matrix, then Newton
/// steps that are kept only while they lower `|p|`. Simple roots come to a few rounding units of their condition; a
/// root of multiplicity m is known only to the m-th root of the rounding unit. Leading zeros are dropped, roots at
/// zero are exact.
///
/// Errors: no non-zero coefficient, not finite, [`LtiError::NotConverged`].
pub fn polynomial_roots(coefficients: &[f64]) -> Result<Vec<Complex>, LtiError> {
    if coefficients.iter().any(|c| !c.is_finite()) {
        return Err(LtiError::NotFinite { what: "a polynomial" });
    }
    let first =
        coefficients.iter().position(|&c| c != 0.0).ok_or(LtiError::NoLeadingCoefficient { what: "a polynomial" })?;
    let last = coefficients.iter().rposition(|&c| c != 0.0).unwrap_or(first);
    let zeros = coefficients.len() - 1 - last;
    let degree = last - first;
    let mut roots = vec![Complex::new(0.0, 0.0); zeros];
    if degree > 0 {
        // s = radius t: the scaled polynomial has leading and constant coefficients of equal magnitude.
        let log_ratio = coefficients[last].abs().log2() - coefficients[first].abs().log2();
        let radius = (log_ratio / degree as f64).round().exp2();
        // Divided step by step: a power of the radius may overflow where the quotient does not.
        let monic: Vec<f64> = (0..=degree)
            .map(|k| (0..k).fold(coefficients[first + k] / coefficients[first], |c, _| c / radius))
            .collect();
        if monic.iter().any(|c| !c.is_finite()) || !radius.is_finite() {
            return Err(LtiError::NotFinite { what: "a polynomial scaled to monic form" });
        }
        let mut companion = DMatrix::zeros(degree, degree);
        for k in 0..degree {
            companion[(0, k)] = -monic[k + 1];
            if k > 0 {
                companion[(k, k - 1)] = 1.0;
            }
        }
        roots.extend(eigenvalues(&companion)?.into_iter().map(|z| polish(&monic, z) * radius));
    }
    Ok(sort_poles(roots))
}

/// Newton's method from `z`, stopped as soon as a step no longer lowers `|p|`.
fn polish(monic: &[f64], mut z: Complex) -> Complex {
    let (mut p, mut slope) = value_and_slope(monic, z);
    for _ in 0..POLISH_STEPS {
        let step = p / slope;
        if !(step.re.is_finite() && step.im.is_finite()) {
            break;
        }
        let candidate = z - step;
        let (next, next_slope) = value_and_slope(monic, candidate);
        if next.norm() >= p.norm() {
            break;
        }
        (z, p, slope) = (candidate, next, next_slope);
    }
    z
}

/// `p(z)` and `p'(z)` by Horner's rule.
fn value_and_slope(coefficients: &[f64], z: Complex) -> (Complex, Complex) {
    let zero = Complex::new(0.0, 0.0);
    coefficients.iter().fold((zero, zero), |(p, slope), &c| (p * z + c, slope * z + p))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use nalgebra::dmatrix;

    #[test]
    fn companion_matrix_of_the_roots_of_unity_does_not_hang() {
        for n in [3, 4, 5, 8, 12] {
            let mut a = DMatrix::zeros(n, n);
            for k in 0..n {
                a[(k, (k + 1) % n)] = 1.0;
            }
            let values = eigenvalues(&a).unwrap();
            for z in &values {
                // Well-separated eigenvalues of an orthogonal matrix: a few roundings.
                assert!((z.norm() - 1.0).abs() < 1e-13 && (z.powu(n as u32) - 1.0).norm() < 1e-12, "{z}");
            }
        }
    }

    #[test]
    fn near_identity_matrices_do_not_stall() {
        // Sampled models with hardly any motion between samples, I + small; nalgebra's QR alone fails on half of them.
        for seed in 0..200 {
            let n = 3 + seed % 6;
            let small =
                DMatrix::from_fn(n, n, |i, j| (((seed * 37 + i * 13 + j * 7) as f64).sin() * 1e4).fract() * 1e-8);
            let values = eigenvalues(&(DMatrix::identity(n, n) + &small)).unwrap();
            let sum: Complex = values.iter().sum();
            // The trace: rounding of 1 + 1e-8 at each diagonal entry.
            assert!((sum - (n as f64 + small.trace())).norm() < 1e-14, "{sum}");

            let two_clusters = DMatrix::from_fn(n, n, |i, j| {
                if i != j {
                    0.0
                } else if i % 2 == 0 {
                    1.0
                } else {
                    0.5
                }
            });
            let sum: Complex = eigenvalues(&(&two_clusters + &small)).unwrap().iter().sum();
            // The same with the looser test of the retries, 32 rounding units an eigenvalue.
            assert!((sum - (two_clusters.trace() + small.trace())).norm() < 1e-13, "{sum}");
        }
    }

    #[test]
    fn sorts_by_height_and_pairs_exactly() {
        let c = Complex::new;
        let sorted = sort_poles(vec![c(-1.0, -5.0), c(3.0, 0.0), c(-1.0 - 2e-16, 5.0), c(-9.0, 0.0), c(0.5, 0.0)]);
        assert_eq!(sorted.iter().map(|z| z.re.round() as i32).collect::<Vec<_>>(), [-9, 1, 3, -1, -1]);
        assert_eq!(sorted[3], sorted[4].conj());
        assert!(sorted[3].im > 0.0);
    }

    #[test]
    fn graded_matrix_keeps_its_slow_pole() {
        // A stiff chassis and a slow occupant in physical coordinates: entries from 1 to 1e7.
        let a = dmatrix![
            0.0, 1.0, 0.0, 0.0;
            -2.25e6, -900.0, 0.0, 0.0;
            0.0, 0.0, 0.0, 1.0;
            0.0, 0.0, -2.0, -3.0
        ];
        let values = eigenvalues(&a).unwrap();
        // (s + 1)(s + 2) and s^2 + 900 s + 2.25e6; balanced, so relative to each block.
        assert!((values[0] - Complex::new(-2.0, 0.0)).norm() < 1e-12);
        assert!((values[1] - Complex::new(-1.0, 0.0)).norm() < 1e-12);
        assert!((values[2] - Complex::new(-450.0, (2.25e6_f64 - 202_500.0).sqrt())).norm() < 1e-9);
    }

    #[test]
    fn eigenvectors_satisfy_their_equation() {
        let a = dmatrix![-22.5, -526.3, 56.2, 141.5; 526.3, -243.8, 631.5, 279.9;
                         56.2, -631.5, -171.2, -1363.2; -141.5, 279.9, 1363.2, -445.9];
        let values = eigenvalues(&a).unwrap();
        let vectors = eigenvectors(&a, &values).unwrap();
        let complex = a.map(|x| Complex::new(x, 0.0));
        for (i, &z) in values.iter().enumerate() {
            let residual = (&complex * vectors.column(i) - vectors.column(i) * z).norm();
            // Rounding unit times the norm of a, about 2e3, times a small factor.
            assert!(residual < 1e-11, "{residual:e}");
        }
    }

    #[test]
    fn finds_the_poles_of_the_printed_fourth_order_model() {
        // Denominator s^4 + 35.71 s^3 + 6024 s^2 + 1.85e5 s + 4.146e5 of the transfer-function paper; roots from
        // 50-digit arithmetic.
        let roots = polynomial_roots(&[1.0, 35.71, 6024.0, 185_000.0, 414_600.0]).unwrap();
        let expected = [
            Complex::new(-29.275_017_509_12, 0.0),
            Complex::new(-2.430_918_696_070, 0.0),
            Complex::new(-2.002_031_897_403, 76.301_206_344_67),
            Complex::new(-2.002_031_897_403, -76.301_206_344_67),
        ];
        for (root, exact) in roots.iter().zip(expected) {
            // The expected values are given to 13 digits.
            assert!((root - exact).norm() < 1e-11, "{root} against {exact}");
        }
    }

    #[test]
    fn leading_and_trailing_zeros_are_what_they_say() {
        let roots = polynomial_roots(&[0.0, 2.0, -6.0, 0.0, 0.0]).unwrap();
        assert_eq!(roots, [Complex::new(0.0, 0.0), Complex::new(0.0, 0.0), Complex::new(3.0, 0.0)]);
        assert!(polynomial_roots(&[5.0]).unwrap().is_empty());
        assert!(polynomial_roots(&[0.0, 0.0]).is_err());
        assert!(polynomial_roots(&[1.0, f64::INFINITY]).is_err());
    }

    #[test]
    fn wildly_scaled_coefficients_do_not_overflow() {
        let roots = polynomial_roots(&[1.0, 0.0, 1e300]).unwrap();
        // ±i 1e150. Scaled to a monic polynomial near s² + 1: an eigenvalue of a companion matrix of two rows, a few
        // roundings.
        assert!(
            (roots[0].im / 1e150 - 1.0).abs() < 8.0 * f64::EPSILON && roots[0].re.abs() < 8.0 * f64::EPSILON * 1e150
        );
    }

    proptest! {
        #[test]
        fn roots_multiply_back_to_the_coefficients(entries in prop::collection::vec(-10.0..10.0_f64, 1..8)) {
            let mut coefficients = vec![1.0];
            coefficients.extend(&entries);
            let roots = polynomial_roots(&coefficients).unwrap();
            let mut product = vec![Complex::new(1.0, 0.0)];
            for root in roots {
                product.push(Complex::new(0.0, 0.0));
                for k in (1..product.len()).rev() {
                    let previous = product[k - 1];
                    product[k] -= previous * root;
                }
            }
            // Backward stability: the eigenvalues are those of a companion matrix off by roundings of its norm, up to
            // 70 for seven coefficients below 10. Multiplying the roots (all below 11) out again sums up to 2^7
            // products: 1e4 roundings of the largest coefficient, 2e-12. A factor of fifty is left for products larger
            // than their sum.
            let size = coefficients.iter().fold(1.0_f64, |m, c| m.max(c.abs()));
            for (c, p) in coefficients.iter().zip(&product) {
                prop_assert!((p.re - c).abs() < 1e-10 * size && p.im.abs() < 1e-10 * size, "{c} {p}");
            }
        }
    }
}
