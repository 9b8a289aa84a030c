/// A coefficient that is linear between knots and constant outside: up to four knots, the first at zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Curve {
    knots: [f64; 4],
    values: [f64; 4],
    len: usize,
}

impl Curve {
    /// Knots that rise; `N` is 2 to 4.
    pub fn new<const N: usize>(knots: [f64; N], values: [f64; N]) -> Self {
        let mut curve = Self { knots: [0.0; 4], values: [0.0; 4], len: N };
        curve.knots[..N].copy_from_slice(&knots);
        curve.values[..N].copy_from_slice(&values);
        curve
    }

    /// The coefficient at `x >= 0`.
    pub fn value(&self, x: f64) -> f64 {
        let piece = self.piece(x, true);
        piece.constant + piece.slope * x
    }

    /// `integral from 0 to x of k(s) s ds` for `x >= 0`: the work on a secant spring with this coefficient, in closed form on
    /// every piece.
    pub fn work(&self, x: f64) -> f64 {
        let knots = &self.knots[..self.len];
        let mut total = 0.0;
        let mut from = 0.0;
        loop {
            let piece = self.piece(from, true);
            let to = piece.to.min(x);
            // As products of sums and differences: nothing cancels on a short piece.
            let (sum, gap) = (to + from, to - from);
            total += gap * (0.5 * piece.constant * sum + piece.slope / 3.0 * (sum * sum - to * from));
            if piece.to >= x || !knots.contains(&piece.to) {
                return total;
            }
            from = piece.to;
        }
    }

    /// The piece that holds at `x >= 0`, where moving outwards counts the piece beyond a knot: `(start, slope, end)`
    /// of `value = start + slope x`, valid up to `end` (and from `begin`).
    pub fn piece(&self, x: f64, outwards: bool) -> Piece {
        let knots = &self.knots[..self.len];
        let above = if outwards { knots.partition_point(|k| *k <= x) } else { knots.partition_point(|k| *k < x) };
        if above == self.len {
            return Piece {
                constant: self.values[self.len - 1],
                slope: 0.0,
                from: knots[self.len - 1],
                to: f64::INFINITY,
            };
        }
        // The first knot is zero: below it there is nothing.
        let i = above.max(1);
        let slope = (self.values[i] - self.values[i - 1]) / (knots[i] - knots[i - 1]);
        Piece { constant: self.values[i - 1] - slope * knots[i - 1], slope, from: knots[i - 1], to: knots[i] }
    }
}

/// `constant + slope x` for `from <= x <= to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    pub constant: f64,
    pub slope: f64,
    pub from: f64,
    pub to: f64,
}
