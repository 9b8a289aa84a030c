//! The matrix exponential of a two-mass system.
//!
//! Fixed size and without allocation: about 1 µs. Larger matrices belong to `crumple-lti`.
//!
//! [`exact_step`] works for any `A = [0 I; -K -C]` with 2 x 2 blocks, so for the double model whatever its masses.

use nalgebra::{Matrix2, Matrix4};

/// Taylor terms after scaling to a norm of 1/2: the rest of the series is below `0.5^17/17! = 3e-20`.
const TERMS: usize = 16;

/// `exp(A dt)` for `A = [0 I; -K -C]`, state `(x1, x2, v1, v2)`.
///
/// Scaling, Taylor series, squaring. Displacement and velocity are brought to one scale first, `(x, v/sqrt|K|)`:
/// unbalanced, the exponential of a car (K near 1e3/s²) loses three digits. Relative error about `1e-16·2^s`, with
/// `s = log2(2 |A| dt)` squarings.
pub fn exact_step(a: &Matrix4<f64>, dt_s: f64) -> Matrix4<f64> {
    let stiffness = a.fixed_view::<2, 2>(2, 0).into_owned().amax();
    let tau = if stiffness > 0.0 { stiffness.sqrt().recip() } else { dt_s.abs().max(f64::MIN_POSITIVE) };
    let balance = |m: &Matrix4<f64>, factor: f64| {
        let mut scaled = m * factor;
        let upper: Matrix2<f64> = scaled.fixed_view::<2, 2>(0, 2) / tau;
        let lower: Matrix2<f64> = scaled.fixed_view::<2, 2>(2, 0) * tau;
        scaled.fixed_view_mut::<2, 2>(0, 2).copy_from(&upper);
        scaled.fixed_view_mut::<2, 2>(2, 0).copy_from(&lower);
        scaled
    };
    let norm = balance(a, dt_s).column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max);
    // Beyond 2^60 the result is zero or infinite anyway.
    let squarings = if norm > 0.5 { ((2.0 * norm).log2().ceil() as i32).clamp(0, 60) } else { 0 };
    let h = dt_s * 0.5_f64.powi(squarings);
    let x = balance(a, h);

    let mut phi = Matrix4::identity() + x;
    let mut term = x;
    for k in 2..=TERMS {
        term = term * x * (1.0 / k as f64);
        phi += term;
    }
    for _ in 0..squarings {
        phi *= phi;
    }
    let upper: Matrix2<f64> = phi.fixed_view::<2, 2>(0, 2) * tau;
    let lower: Matrix2<f64> = phi.fixed_view::<2, 2>(2, 0) / tau;
    phi.fixed_view_mut::<2, 2>(0, 2).copy_from(&upper);
    phi.fixed_view_mut::<2, 2>(2, 0).copy_from(&lower);
    phi
}

#[cfg(test)]
mod tests {
    use super::*;

    fn system(k: f64, c: f64) -> Matrix4<f64> {
        // Two equal uncoupled oscillators: every entry has a closed form.
        let mut a = Matrix4::zeros();
        a[(0, 2)] = 1.0;
        a[(1, 3)] = 1.0;
        a[(2, 0)] = -k;
        a[(3, 1)] = -k;
        a[(2, 2)] = -c;
        a[(3, 3)] = -c;
        a
    }

    #[test]
    fn is_the_closed_form_of_an_oscillator() {
        let (w, t) = (20.0_f64, 0.1);
        let phi = exact_step(&system(w * w, 0.0), t);
        // Three squarings of entries below 1: a few 1e-16.
        assert!((phi[(0, 0)] - (w * t).cos()).abs() < 2e-15);
        assert!((phi[(0, 2)] - (w * t).sin() / w).abs() < 2e-16);
        assert!((phi[(3, 1)] + (w * t).sin() * w).abs() < 4e-14);
        assert_eq!(phi[(0, 1)], 0.0);
    }

    #[test]
    fn agrees_with_the_pade_approximant() {
        let model = crate::DoubleSpringMassDamper {
            m1_kg: 291.0,
            m2_kg: 582.0,
            k1_n_per_m: 45929.0,
            k2_n_per_m: 40731.0,
            c1_n_s_per_m: 13687.0,
            c2_n_s_per_m: 9952.0,
        };
        for t in [1e-4, 1e-2, 0.3] {
            let a = model.state_matrix();
            let scaled = nalgebra::DMatrix::from_fn(4, 4, |i, j| a[(i, j)] * t);
            let wanted = crumple_lti::matrix_exponential(&scaled).unwrap();
            let phi = exact_step(&a, t);
            for i in 0..16 {
                // Entries up to |A| dt e^..: both lose 2^s roundings of the largest, with at most 7 squarings.
                assert!((phi[i] - wanted[i]).abs() < 1e-13 * wanted.amax(), "{t} {i}: {} {}", phi[i], wanted[i]);
            }
        }
    }

    #[test]
    fn drifts_without_stiffness() {
        let phi = exact_step(&system(0.0, 0.0), 0.25);
        assert_eq!((phi[(0, 0)], phi[(0, 2)], phi[(2, 2)]), (1.0, 0.25, 1.0));
    }
}
