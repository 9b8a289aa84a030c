//! How the curve of a structure is likely to go on beyond the crush that it was read from.
//!
//! The last piece of a structure that folds lies somewhere on a wave and says little of what comes. What goes on is the
//! trend of the whole curve: its projection on a constant, a slope and a bend (the first three Legendre polynomials,
//! which are the least squares of a parabola) from a fifth of the deepest deflection `C` on, behind the first bend. A
//! few waves say little of the slope: it counts together with that of a force that rises by half of its mean from the
//! middle of the range to its end, between a constant force and one in proportion to the crush (CRASH3). A structure
//! gets stiffer behind what was crushed, so of a bend that rises most counts, and none that falls.
//!
//! From a trough the curve comes back to its trend within 3 % of `C`; from a crest it goes on as steeply as the trend,
//! for nothing says that what is highest at the end was a wave: an engine that is reached and a bottoming look alike.
//!
//! The shares were chosen by cars of two and three masses, of foam and such that bottom out, tested at 56 or at 56 and
//! 40 km/h and asked at 64 (`docs/prediction.md`).

/// Deflection from which on the curve counts, over the deepest.
const FROM: f64 = 0.2;
/// Rise of the force from the middle to the end of the range over its mean, before anything is known, and its share
/// beside what the curve says.
const USUAL_RISE: f64 = 0.5;
const USUAL_COUNTS: f64 = 0.4;
/// Share of a bend that rises.
const BEND_COUNTS: f64 = 0.8;
/// Ends of the pieces beyond, over the deepest deflection; the first is where a trough has come back to the trend.
const ENDS: [f64; 5] = [1.03, 1.1, 1.2, 1.3, 1.45];

/// A parabola over the deflection, as coefficients of Legendre polynomials on a range.
struct Trend {
    /// Middle and half length of the range, m.
    range_m: (f64, f64),
    /// Constant, slope and bend, N.
    coefficients_n: [f64; 3],
}

impl Trend {
    /// Of a curve that is linear between knots, from [`FROM`] times its last deflection on.
    fn of(knots: &[(f64, f64)], last_m: f64) -> Self {
        let (middle, half) = (0.5 * (1.0 + FROM) * last_m, 0.5 * (1.0 - FROM) * last_m);
        let mut integrals = [0.0; 3];
        for pair in knots.windows(2) {
            let ((low, force), (high, next)) = (pair[0], pair[1]);
            let start = low.max(FROM * last_m);
            if start >= high {
                continue;
            }
            let at = |d: f64| force + (next - force) * (d - low) / (high - low);
            // Simpson's rule, exact for a line times a parabola.
            for (d, weight) in [(start, 1.0), (0.5 * (start + high), 4.0), (high, 1.0)] {
                let share = weight / 6.0 * (high - start) / (2.0 * half) * at(d);
                for (sum, polynomial) in integrals.iter_mut().zip(legendre((d - middle) / half)) {
                    *sum += share * polynomial;
                }
            }
        }
        let [mean, slope, bend] = [integrals[0], 3.0 * integrals[1], 5.0 * integrals[2]];
        let slope = (1.0 - USUAL_COUNTS) * slope + USUAL_COUNTS * USUAL_RISE * mean;
        Self { range_m: (middle, half), coefficients_n: [mean, slope, BEND_COUNTS * bend.max(0.0)] }
    }

    /// Force, N, at a deflection, m.
    fn at(&self, d: f64) -> f64 {
        let (middle, half) = self.range_m;
        legendre((d - middle) / half).iter().zip(self.coefficients_n).map(|(polynomial, n)| polynomial * n).sum()
    }
}

/// The first three Legendre polynomials.
fn legendre(u: f64) -> [f64; 3] {
    [1.0, u, 1.5 * u * u - 0.5]
}

/// Knots `(deflection, force)`, m and N, with which a curve goes on, and the stiffness beyond them, N/m; nowhere
/// falling and nowhere steeper than `steepest_n_per_m`. None for a curve without a deflection.
pub(super) fn beyond(knots: &[(f64, f64)], steepest_n_per_m: f64) -> (Vec<(f64, f64)>, f64) {
    let Some(&(last_m, force_n)) = knots.last().filter(|(last, _)| *last > 0.0) else { return (Vec::new(), 0.0) };
    let trend = Trend::of(knots, last_m);
    let above = (force_n - trend.at(last_m)).max(0.0);
    let (mut at, mut stiffness) = ((last_m, force_n), 0.0);
    let mut new = Vec::new();
    for end in ENDS {
        let length = end * last_m - at.0;
        stiffness = ((trend.at(end * last_m) + above - at.1) / length).clamp(0.0, steepest_n_per_m);
        at = (end * last_m, at.1 + stiffness * length);
        new.push(at);
    }
    (new, stiffness)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 120 kN plus 400 kN/m; the force that is usual rises by half of its mean over the same way.
    #[test]
    fn a_straight_curve_goes_on_straight_and_a_bit_towards_what_is_usual() {
        let knots = [(0.0, 0.0), (0.1, 160e3), (0.4, 280e3), (1.0, 520e3)];
        // From 0.2 m on a line: 360 kN at 0.6 m, which rises by 160 kN to the end; usual are 180 kN.
        let slope = (0.6 * 160e3 + 0.4 * 180e3) / 0.4;
        let (new, stiffness) = beyond(&knots, 4e7);
        assert!((stiffness / slope - 1.0).abs() < 1e-9, "{stiffness} {slope}");
        // At the last knot the trend is 8 kN above the curve; at the first end it is met.
        assert!((new[0].1 - (360e3 + slope * (1.03 - 0.6))).abs() < 1e-6, "{new:?}");
        assert!(new.iter().all(|(d, force)| (force - 360e3 - slope * (d - 0.6)).abs() < 1e-6));
    }

    #[test]
    fn a_trough_comes_back_and_a_crest_stays() {
        let wave = |end: f64| [(0.0, 0.0), (0.1, 300e3), (0.2, 250e3), (0.3, 350e3), (0.4, 250e3), (0.5, end)];
        let (trough, _) = beyond(&wave(200e3), 4e7);
        let (crest, _) = beyond(&wave(400e3), 4e7);
        // The mean behind the first bend is some 280 kN.
        assert!(trough[0].1 > 270e3, "{trough:?}");
        assert!(crest[0].1 >= 400e3 && crest[1].1 > crest[0].1, "{crest:?}");
        // Not steeper than the unloading: the way back is longer then.
        let (slow, stiffness) = beyond(&wave(200e3), 1.3e6);
        assert!((slow[0].1 - (200e3 + 1.3e6 * 0.015)).abs() < 1e-6, "{slow:?}");
        assert!(stiffness <= 1.3e6);
    }

    /// `F = d²`: the bend of `C²` is `2/3 (0.4 C)²`; of it 0.8 count.
    #[test]
    fn a_foam_that_closes_goes_on_bending() {
        let knots: Vec<(f64, f64)> = (0..=100).map(|k| f64::from(k) / 100.0).map(|d| (d, d * d)).collect();
        let trend = Trend::of(&knots, 1.0);
        // Mean `0.36 + 0.16/3`, slope `2 0.6 0.4`; chords lie above the parabola by at most `h²/4`.
        let mean = 0.36 + 0.16 / 3.0;
        let expected = [mean, 0.6 * 0.48 + 0.4 * 0.5 * mean, 0.8 * 2.0 / 3.0 * 0.16];
        for (found, expected) in trend.coefficients_n.iter().zip(expected) {
            assert!((found - expected).abs() < 2.5e-5 * 5.0, "{found} {expected}");
        }
        let (new, _) = beyond(&knots, 10.0);
        let slopes: Vec<f64> = new.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).collect();
        assert!(slopes.windows(2).all(|pair| pair[1] > pair[0]), "{slopes:?}");
    }

    #[test]
    fn a_curve_that_falls_does_not_go_on_falling() {
        let (new, stiffness) = beyond(&[(0.0, 0.0), (0.1, 500e3), (0.5, 100e3)], 4e7);
        assert!(stiffness >= 0.0 && new.windows(2).all(|pair| pair[1].1 >= pair[0].1), "{new:?}");
        assert_eq!(beyond(&[(0.0, 0.0)], 4e7), (Vec::new(), 0.0));
    }
}
