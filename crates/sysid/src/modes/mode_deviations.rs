//! Standard deviations of roots, modes and frequency responses from those of coefficients.
//!
//! First-order (delta method) propagation: with gradient `g` of a quantity by the coefficients and their covariance
//! `P`, its variance is `g' P g`. Right where the coefficients' errors are small against the curvature of the
//! quantity; near a multiple root it is not, and nothing is returned there.

use crumple_lti::{Complex, TransferFunction};
use nalgebra::{DMatrix, DVector};

/// Standard deviations of real and imaginary parts of the roots of a polynomial, coefficients highest power first with
/// `covariance`, at first order: `dz/dp_j = -z^(n-j)/P'(z)`. `None` at a multiple root, which moves with the root of
/// a change, and where the covariance is not finite.
pub(crate) fn root_deviations(
    polynomial: &[f64],
    covariance: &DMatrix<f64>,
    roots: &[Complex],
) -> Vec<Option<(f64, f64)>> {
    roots
        .iter()
        .map(|z| {
            let gradient = root_gradient(polynomial, *z)?;
            let deviation = |part: &dyn Fn(&Complex) -> f64| {
                let g = DVector::from_iterator(gradient.len(), gradient.iter().map(part));
                finite(g.dot(&(covariance * &g)).max(0.0).sqrt())
            };
            Some((deviation(&|g| g.re)?, deviation(&|g| g.im)?))
        })
        .collect()
}

/// `dz/dp_j = -z^(n-j)/P'(z)` for `j = 0 ..= n`, the coefficients highest power first; `None` where the derivative
/// `P'` vanishes to ten digits, at a multiple root.
fn root_gradient(polynomial: &[f64], z: Complex) -> Option<Vec<Complex>> {
    let n = polynomial.len().checked_sub(1)?;
    // Terms j z^(j-1) p of the derivative, and the sum of their sizes against which it may vanish.
    let mut slope = Complex::new(0.0, 0.0);
    let mut size = 0.0;
    for (index, p) in polynomial[..n].iter().enumerate() {
        let power = n - index;
        let term = z.powu(u32::try_from(power - 1).ok()?) * (power as f64 * p);
        slope += term;
        size += term.norm();
    }
    if slope.norm() <= 1e-10 * size {
        return None;
    }
    (0..=n).map(|index| Some(-z.powu(u32::try_from(n - index).ok()?) / slope)).collect()
}

/// Standard deviations of natural frequency (rad/s) and damping ratio of the continuous counterparts of the roots of
/// `z^n + a_1 z^(n-1) + ... + a_n`, with the covariance of `a`; `None` as above and for a root at zero.
pub(crate) fn discrete_mode_deviations(
    a: &[f64],
    covariance: &DMatrix<f64>,
    roots: &[Complex],
    dt_s: f64,
) -> Vec<Option<(f64, f64)>> {
    let polynomial: Vec<f64> = std::iter::once(1.0).chain(a.iter().copied()).collect();
    roots
        .iter()
        .map(|z| {
            if z.norm() == 0.0 {
                return None;
            }
            let s = z.ln() / dt_s;
            let modulus = s.norm();
            let gradient = root_gradient(&polynomial, *z)?;
            // ds = dz/(z dt); d|s| = Re(conj(s) ds)/|s|; dzeta = -(Re ds)/|s| + Re(s) d|s|/|s|².
            let change: Vec<Complex> = gradient[1..].iter().map(|dz| dz / (z * dt_s)).collect();
            let frequency: Vec<f64> = change.iter().map(|ds| (s.conj() * ds).re / modulus).collect();
            let damping: Vec<f64> = change
                .iter()
                .zip(&frequency)
                .map(|(ds, dw)| -ds.re / modulus + s.re * dw / (modulus * modulus))
                .collect();
            let deviation = |g: Vec<f64>| {
                let g = DVector::from_vec(g);
                finite(g.dot(&(covariance * &g)).max(0.0).sqrt())
            };
            Some((deviation(frequency)?, deviation(damping)?))
        })
        .collect()
}

/// Relative standard deviation of the modulus and standard deviation of the phase (rad) of a transfer function at
/// frequencies in rad/s, with the covariance of its coefficients: numerator as long as `numerator_length` says, then
/// the denominator without its 1, both highest power first. `None` where the response vanishes.
///
/// By `d ln H = dB/B - dA/A`: its real part is the relative change of the modulus, its imaginary part that of the
/// phase.
pub fn response_deviations(
    tf: &TransferFunction,
    numerator_length: usize,
    covariance: &DMatrix<f64>,
    rad_per_s: &[f64],
) -> Vec<Option<(f64, f64)>> {
    let n = tf.denominator().len() - 1;
    let value = |p: &[f64], s: Complex| p.iter().fold(Complex::new(0.0, 0.0), |sum, c| sum * s + *c);
    rad_per_s
        .iter()
        .map(|w| {
            let s = Complex::new(0.0, *w);
            let (b, a) = (value(tf.numerator(), s), value(tf.denominator(), s));
            // d ln H = db/B - da/A.
            let power = |k: usize| s.powu(u32::try_from(k).unwrap_or(u32::MAX));
            let mut gradient: Vec<Complex> = (0..numerator_length).rev().map(|k| power(k) / b).collect();
            gradient.extend((0..n).rev().map(|k| -power(k) / a));
            let deviation = |part: &dyn Fn(&Complex) -> f64| {
                let g = DVector::from_iterator(gradient.len(), gradient.iter().map(part));
                finite(g.dot(&(covariance * &g)).max(0.0).sqrt())
            };
            Some((deviation(&|g| g.re)?, deviation(&|g| g.im)?))
        })
        .collect()
}

/// `None` for what is not a finite number.
fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_lti::{Mode, polynomial_roots};

    #[test]
    fn deviations_of_roots_and_modes_are_those_of_finite_differences() {
        let a = [-1.6, 0.9, -0.1];
        let covariance = nalgebra::dmatrix![4e-6, 1e-6, 0.0; 1e-6, 9e-6, -2e-6; 0.0, -2e-6, 1e-6];
        let roots = polynomial_roots(&[1.0, a[0], a[1], a[2]]).unwrap();
        let estimated = discrete_mode_deviations(&a, &covariance, &roots, 1e-3);
        let mut full = DMatrix::zeros(4, 4);
        full.view_mut((1, 1), (3, 3)).copy_from(&covariance);
        let parts = root_deviations(&[1.0, a[0], a[1], a[2]], &full, &roots);
        for (k, z) in roots.iter().enumerate() {
            let mut gradients = DMatrix::zeros(4, 3);
            for i in 0..3 {
                let h = 1e-6;
                let at = |sign: f64| {
                    let mut p = [1.0, a[0], a[1], a[2]];
                    p[i + 1] += sign * h;
                    let roots = polynomial_roots(&p).unwrap();
                    let near = *roots.iter().min_by(|x, y| (*x - z).norm().total_cmp(&(*y - z).norm())).unwrap();
                    let mode = Mode::discrete(near, 1e-3).unwrap();
                    [near.re, near.im, mode.natural_frequency_rad_per_s, mode.damping_ratio.unwrap()]
                };
                let (up, down) = (at(1.0), at(-1.0));
                for j in 0..4 {
                    gradients[(j, i)] = (up[j] - down[j]) / (2.0 * h);
                }
            }
            let exact = &gradients * &covariance * gradients.transpose();
            let (re, im) = parts[k].unwrap();
            let (w, zeta) = estimated[k].unwrap();
            for (estimated, exact) in
                [(re, exact[(0, 0)]), (im, exact[(1, 1)]), (w, exact[(2, 2)]), (zeta, exact[(3, 3)])]
            {
                // Central differences of roots known to 1e-15 with a step of 1e-6: 1e-9, over a gradient of order one.
                let exact = exact.sqrt();
                assert!((estimated - exact).abs() < 1e-6 * exact + 1e-9, "{z}: {estimated} {exact}");
            }
        }
        // A double root has no first-order deviation.
        let double = root_deviations(&[1.0, -2.0, 1.0], &DMatrix::identity(3, 3), &[Complex::new(1.0, 0.0)]);
        assert_eq!(double, [None]);
    }

    #[test]
    fn deviation_of_a_response_by_hand() {
        // H = b/(s + a): d ln|H| = db/b - a da/(a² + w²), d arg H = w da/(a² + w²).
        let tf = TransferFunction::new(&[3.0], &[1.0, 4.0]).unwrap();
        let covariance = nalgebra::dmatrix![0.09, 0.0; 0.0, 0.25];
        let (magnitude, phase) = response_deviations(&tf, 1, &covariance, &[3.0])[0].unwrap();
        assert!((magnitude - (0.01_f64 + (4.0 * 0.5 / 25.0_f64).powi(2)).sqrt()).abs() < 1e-14, "{magnitude}");
        assert!((phase - 3.0 * 0.5 / 25.0).abs() < 1e-14, "{phase}");
    }
}
