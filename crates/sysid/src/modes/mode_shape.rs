//! Measures of mode shapes: assurance criterion and phase collinearity.

use crumple_lti::Complex;

/// Modal assurance criterion `|p* q|² / (p* p  q* q)` of two shapes: 1 for the same up to a factor, 0 for orthogonal
/// ones. `None` for shapes of different lengths, or one that is zero.
///
/// Two shapes of two sensors are easily alike: it says little with fewer than four sensors. Allemang & Brown, IMAC
/// 1982.
pub fn modal_assurance(p: &[Complex], q: &[Complex]) -> Option<f64> {
    let inner: Complex = p.iter().zip(q).map(|(p, q)| p.conj() * q).sum();
    let square = |shape: &[Complex]| shape.iter().map(Complex::norm_sqr).sum::<f64>();
    let mac = inner.norm_sqr() / (square(p) * square(q));
    // Rounding may carry it past 1.
    (p.len() == q.len() && mac.is_finite()).then_some(mac.min(1.0))
}

/// Modal phase collinearity `((Sxx - Syy)² + 4 Sxy²) / (Sxx + Syy)²` with `Sxx`, `Syy`, `Sxy` the sums of squares and
/// products of real and imaginary parts: 1 if all sensors move in phase or against it, as in a lightly damped
/// structure, 0 for phases spread all round, as noise has them. `None` for a shape of zeros.
///
/// Not centred, for a shape through rest has no mean. One sensor alone always has 1. Pappa, Elliott & Schenk, J.
/// Guidance 16(5), 1993.
pub fn phase_collinearity(shape: &[Complex]) -> Option<f64> {
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for z in shape {
        xx += z.re * z.re;
        yy += z.im * z.im;
        xy += z.re * z.im;
    }
    let mpc = ((xx - yy).powi(2) + 4.0 * xy * xy) / (xx + yy).powi(2);
    mpc.is_finite().then_some(mpc.min(1.0))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    const I: Complex = Complex::new(0.0, 1.0);

    #[test]
    fn a_turned_and_scaled_shape_is_the_same() {
        let p = [Complex::from(1.0), Complex::from(-0.5), Complex::from(0.25)];
        let q: Vec<Complex> = p.iter().map(|x| x * Complex::new(0.3, -2.0)).collect();
        // Rounding.
        assert!((modal_assurance(&p, &q).unwrap() - 1.0).abs() < 1e-15);
        assert!((phase_collinearity(&q).unwrap() - 1.0).abs() < 1e-15);
        assert!(modal_assurance(&p[..2], &[Complex::from(1.0), Complex::from(2.0)]).unwrap() < 1e-30);
        assert_eq!(modal_assurance(&p, &p[..2]), None);
    }

    #[test]
    fn phases_all_round_are_not_collinear() {
        assert_eq!(phase_collinearity(&[Complex::from(1.0), I, Complex::from(-1.0), -I]), Some(0.0));
        assert_eq!(phase_collinearity(&[Complex::from(0.0)]), None);
    }
}
