//! Coefficients that are linear between knots, and their derivatives by values and places of the knots.

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
}
