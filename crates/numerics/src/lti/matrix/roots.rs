//! Roots of real polynomials.

use nalgebra::DMatrix;

use crate::lti::matrix::eigen::sort_poles;
use crate::lti::{Complex, LtiError, eigenvalues};

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
    use super::*;
    use proptest::prelude::*;

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
