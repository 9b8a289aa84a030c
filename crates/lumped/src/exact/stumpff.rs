//! The integrals of a cosine, which the exact step of an undamped spring is made of.
//!
//! With `y'' + w² y = a + b t` the step is `y(t) = y0 S_0 + v0 S_1 + a S_2 + b S_3`: a forced oscillator without a
//! division by `w`, so that a spring of no stiffness (an open contact) is no special case. Three more integrals give
//! the integral of `y` and those of it, which the work of a drive needs.

/// `S_n(t)`, n = 0 .. 7: `S_0 = cos w t`, `S_1 = sin(w t)/w`, and each the integral of the one before from 0.
///
/// Stumpff functions, `S_n = t^n c_n(w² t²)` with `c_n(z) = sum of (-z)^k/(n + 2k)!`. Below `z = 4` by the series of
/// the two last and `c_n = 1/n! - z c_{n+2}`, right to rounding and for `w = 0` too; above it by cosine and sine and
/// the same rule upwards, where each two steps cost a rounding of `1/(n! z)`, at most three digits of the highest.
pub(crate) fn cosine_integrals(w2: f64, t: f64) -> [f64; 7] {
    const FACTORIALS: [f64; 7] = [1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0];
    let z = w2 * t * t;
    let mut c = [0.0; 7];
    if z < 4.0 {
        // Fourteen terms: 4^14/34! = 1e-30.
        let series = |n: u32| {
            let first = FACTORIALS[n as usize].recip();
            let (mut term, mut sum) = (first, first);
            for k in 1..=14 {
                term *= -z / f64::from((n + 2 * k) * (n + 2 * k - 1));
                sum += term;
                if term.abs() < 1e-18 * first {
                    break;
                }
            }
            sum
        };
        (c[6], c[5]) = (series(6), series(5));
        for n in (0..5).rev() {
            c[n] = FACTORIALS[n].recip() - z * c[n + 2];
        }
    } else {
        let root = z.sqrt();
        let (sine, cosine) = root.sin_cos();
        (c[0], c[1]) = (cosine, sine / root);
        for n in 2..7 {
            c[n] = (FACTORIALS[n - 2].recip() - c[n - 2]) / z;
        }
    }
    let mut power = 1.0;
    c.map(|value| {
        let scaled = value * power;
        power *= t;
        scaled
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_form_meet_and_without_a_spring_powers_remain() {
        let free = cosine_integrals(0.0, 0.5);
        assert_eq!((free[0], free[1], free[2]), (1.0, 0.5, 0.125));
        assert!((free[6] - 0.5_f64.powi(6) / 720.0).abs() < 1e-19);
        let (below, above) = (cosine_integrals(4.0 * (1.0 - 1e-13), 1.0), cosine_integrals(4.0, 1.0));
        for n in 0..7 {
            // The argument differs by 1e-13, and the upper rule loses three digits at the most.
            assert!((below[n] - above[n]).abs() < 4e-13, "{n}: {} {}", below[n], above[n]);
        }
        let (w, t) = (3.0_f64, 0.4);
        let integrals = cosine_integrals(w * w, t);
        assert!((integrals[0] - (w * t).cos()).abs() < 4e-16 && (integrals[1] - (w * t).sin() / w).abs() < 2e-16);
        assert!((integrals[2] - (1.0 - (w * t).cos()) / (w * w)).abs() < 2e-16);
    }
}
