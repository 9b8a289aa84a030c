//! Coefficients that are linear between knots, and their derivatives by values and places of the knots.
//!
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
//! 40 km/h and asked at 64 (`docs/methods/prediction.md`).

use crate::LumpedError;
use crate::error::finite;

/// A coefficient that is linear between knots and constant outside, over the size of a displacement or speed: even, so
/// that a spring is as stiff in tension as in compression.
#[derive(Debug, Clone, PartialEq)]
pub struct PiecewiseLinear {
    /// `(knot, value)` as stated; knots rising, the first zero.
    points: Vec<(f64, f64)>,
}

/// Where one straight line holds: the coefficient is `constant + slope q` for `low <= q <= high`, `q` with its sign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Line {
    pub constant: f64,
    pub slope: f64,
    pub low: f64,
    pub high: f64,
}

impl PiecewiseLinear {
    /// The same everywhere.
    pub fn constant(value: f64) -> Self {
        Self { points: vec![(0.0, value)] }
    }

    /// `(knot, value)` with knots that rise from zero or more. A first knot above zero holds down to zero. Errors: none
    /// at all, knots that do not rise, what is not finite.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, LumpedError> {
        let Some(&(first, start)) = points.first() else {
            return Err(LumpedError::Value { name: "number of knots", value: 0.0, expected: "one or more" });
        };
        for (knot, value) in points {
            finite("knot", *knot)?;
            finite("value at a knot", *value)?;
        }
        if first < 0.0 {
            return Err(LumpedError::Value { name: "knot", value: first, expected: "zero or more" });
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
            return Err(LumpedError::Value { name: "knot", value: pair[1].0, expected: "above the knot before it" });
        }
        let zero = (first > 0.0).then_some((0.0, start));
        Ok(Self { points: zero.into_iter().chain(points.iter().copied()).collect() })
    }

    /// Number of knots, that at zero among them.
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    /// The coefficient at a displacement or speed.
    pub fn at(&self, q: f64) -> f64 {
        let line = self.outwards(self.points.partition_point(|(knot, _)| *knot <= q.abs()) - 1);
        line.constant + line.slope * q.abs()
    }

    /// Energy in a secant spring with this stiffness, `integral from 0 to |q| of k(s) s ds`.
    ///
    /// In closed form on every piece, as products of sums and differences: nothing cancels on a short one.
    pub fn energy(&self, q: f64) -> f64 {
        let mut total = 0.0;
        for i in 0..self.points.len() {
            let line = self.outwards(i);
            if line.low >= q.abs() {
                break;
            }
            let (from, to) = (line.low, line.high.min(q.abs()));
            let (sum, gap) = (to + from, to - from);
            total += gap * (0.5 * line.constant * sum + line.slope / 3.0 * (sum * sum - to * from));
        }
        total
    }

    /// Its value if it is the same everywhere, with however many knots it was stated.
    pub fn as_constant(&self) -> Option<f64> {
        let first = self.points[0].1;
        self.points.iter().all(|(_, value)| *value == first).then_some(first)
    }

    /// Knots and values as stated, the first knot zero: those of the same value too, so that a name always finds its
    /// knot.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.points.iter().copied()
    }

    /// Whether every value is positive or zero.
    pub fn is_passive(&self) -> bool {
        self.points.iter().all(|(_, value)| *value >= 0.0)
    }

    /// The line from knot `i` outwards.
    fn outwards(&self, i: usize) -> Line {
        let (low, value) = self.points[i];
        let Some((high, next)) = self.points.get(i + 1) else {
            return Line { constant: value, slope: 0.0, low, high: f64::INFINITY };
        };
        let slope = (next - value) / (high - low);
        Line { constant: value - slope * low, slope, low, high: *high }
    }

    /// The knot that line `number` starts from outwards, and on which side of zero it lies.
    ///
    /// Lines are counted from minus to plus infinity: with `n` knots the first `n` are the mirror images of the last
    /// `n`. With one knot there is one line.
    fn place(&self, number: usize) -> (usize, f64) {
        let n = self.points.len();
        if number < n && n > 1 { (n - 1 - number, -1.0) } else { (number.saturating_sub(n), 1.0) }
    }

    /// The line of this number.
    pub(crate) fn line(&self, number: usize) -> Line {
        if self.points.len() == 1 {
            return Line { low: f64::NEG_INFINITY, ..self.outwards(0) };
        }
        match self.place(number) {
            (i, 1.0) => self.outwards(i),
            (i, _) => {
                let line = self.outwards(i);
                Line { slope: -line.slope, low: -line.high, high: -line.low, ..line }
            }
        }
    }

    /// The number of the line at `q`, on the side of `towards` where `q` is zero.
    pub(crate) fn line_at(&self, q: f64, towards: f64) -> usize {
        let n = self.points.len();
        let i = self.points.partition_point(|(knot, _)| *knot < q.abs()).saturating_sub(1);
        match n {
            1 => 0,
            _ if q < 0.0 || (q == 0.0 && towards < 0.0) => n - 1 - i,
            _ => n + i,
        }
    }

    /// Derivative of constant and slope of a line by a parameter: twice the number of a knot for its value, one more
    /// for its place.
    ///
    /// A value at a knot tilts the two lines that meet there, the place of a knot moves the meeting point along them;
    /// all other lines stay.
    pub(crate) fn line_by(&self, number: usize, parameter: usize) -> (f64, f64) {
        let ((low, side), (knot, by_place)) = (self.place(number), (parameter / 2, parameter % 2 == 1));
        let Some(pair) = self.points.get(low..low + 2) else {
            return (if knot == low && !by_place { 1.0 } else { 0.0 }, 0.0);
        };
        let (from, length) = (pair[0].0, pair[1].0 - pair[0].0);
        let slope = (pair[1].1 - pair[0].1) / length;
        // constant = value - slope * from at the lower knot.
        let (by_value, steepening) = match (knot, by_place) {
            (k, false) if k == low => (1.0, -length.recip()),
            (k, false) if k == low + 1 => (0.0, length.recip()),
            (k, true) if k == low => (-slope, slope / length),
            (k, true) if k == low + 1 => (0.0, -slope / length),
            _ => return (0.0, 0.0),
        };
        (by_value - steepening * from, side * steepening)
    }
}

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
pub(crate) fn beyond(knots: &[(f64, f64)], steepest_n_per_m: f64) -> (Vec<(f64, f64)>, f64) {
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

    #[test]
    fn lines_meet_and_the_energy_is_their_integral() {
        let curve = PiecewiseLinear::new(&[(0.0, 2.0), (0.5, 6.0), (1.5, 1.0)]).unwrap();
        for number in 0..6 {
            let line = curve.line(number);
            let inside = if number == 0 {
                line.high - 1.0
            } else if number == 5 {
                line.low + 1.0
            } else {
                0.5 * (line.low + line.high)
            };
            assert!((line.constant + line.slope * inside - curve.at(inside)).abs() < 1e-15);
            assert_eq!(curve.line_at(inside, 0.0), number);
            if number > 0 {
                assert_eq!(curve.line(number - 1).high, line.low);
            }
        }
        assert_eq!((curve.line_at(0.0, 1.0), curve.line_at(0.0, -1.0)), (3, 2));
        // Of 2 s + 8 s² up to 0.5, of 8.5 s - 5 s² up to 1, by hand.
        let wanted = 0.25 + 8.0 / 24.0 + 4.25 * 0.75 - 5.0 / 3.0 * 0.875;
        assert!((curve.energy(-1.0) - wanted).abs() < 1e-15);
        assert_eq!(PiecewiseLinear::constant(3.0).line(0).low, f64::NEG_INFINITY);
    }

    #[test]
    fn derivatives_of_lines_are_central_differences() {
        let values = [(0.0, 2.0), (0.5, 6.0), (1.5, 1.0)];
        let curve = PiecewiseLinear::new(&values).unwrap();
        let h = 1e-6;
        // The place of the first knot is zero for good.
        for parameter in [0, 2, 3, 4, 5] {
            let moved = |by: f64| {
                let mut points = values;
                let point = &mut points[parameter / 2];
                if parameter % 2 == 0 {
                    point.1 += by;
                } else {
                    point.0 += by;
                }
                PiecewiseLinear::new(&points).unwrap()
            };
            for number in 0..6 {
                let (up, down) = (moved(h).line(number), moved(-h).line(number));
                let (constant, slope) = curve.line_by(number, parameter);
                // h² of the third derivative, some 1e-10 with rounding.
                assert!((constant - (up.constant - down.constant) / (2.0 * h)).abs() < 1e-8, "{parameter} {number}");
                assert!((slope - (up.slope - down.slope) / (2.0 * h)).abs() < 1e-8, "{parameter} {number}");
            }
        }
    }

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
