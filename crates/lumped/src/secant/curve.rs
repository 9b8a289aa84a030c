//! Coefficients that are linear between at most four knots, for one mass, without allocation.
//!
//! A coefficient is `constant + slope x` on each piece between two knots, and constant beyond the last one. The first
//! knot is zero; arguments are moduli of a displacement or a speed, so never negative.

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

    /// Its knots with their values.
    pub fn points(&self) -> Vec<(f64, f64)> {
        self.knots.iter().copied().zip(self.values.iter().copied()).take(self.len).collect()
    }

    /// The coefficient at `x >= 0`.
    pub fn value(&self, x: f64) -> f64 {
        let piece = self.piece(x, true);
        piece.constant + piece.slope * x
    }

    /// See [`work`].
    pub fn work(&self, x: f64) -> f64 {
        work(&self.knots[..self.len], &self.values[..self.len], x)
    }

    /// See [`piece`].
    pub fn piece(&self, x: f64, outwards: bool) -> Piece {
        piece(&self.knots[..self.len], &self.values[..self.len], x, outwards)
    }

    /// Number of knots.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Derivative of constant and slope of a piece, given by its index, by a value or the place of a knot.
    ///
    /// `index` is [`Piece::index`]. A value at a knot tilts the two pieces that meet there, the place of a knot moves
    /// the meeting point along them; all other pieces stay, with derivative zero.
    pub fn change_of_piece(&self, index: usize, by: Knot) -> (f64, f64) {
        if index >= self.len {
            return (if index == self.len && by == Knot::Value(self.len - 1) { 1.0 } else { 0.0 }, 0.0);
        }
        let (low, high) = (index - 1, index);
        let (from, length) = (self.knots[low], self.knots[high] - self.knots[low]);
        let slope = (self.values[high] - self.values[low]) / length;
        let steepening = match by {
            Knot::Value(k) if k == high => length.recip(),
            Knot::Value(k) if k == low => -length.recip(),
            Knot::Place(k) if k == high => -slope / length,
            Knot::Place(k) if k == low => slope / length,
            _ => return (0.0, 0.0),
        };
        // constant = value - slope * from at the lower knot.
        let change_of_value = match by {
            Knot::Value(k) if k == low => 1.0,
            Knot::Place(k) if k == low => -slope,
            _ => 0.0,
        };
        (change_of_value - steepening * from, steepening)
    }
}

/// What a curve is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Knot {
    /// Value at this knot.
    Value(usize),
    /// Place of this knot.
    Place(usize),
}

/// Index of no piece: nothing changes it.
pub(crate) const BEYOND: usize = usize::MAX;

/// `constant + slope x` for `from <= x <= to`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    /// Index of its upper knot; the number of knots beyond the last.
    pub index: usize,
    pub constant: f64,
    pub slope: f64,
    pub from: f64,
    pub to: f64,
}

/// `integral from 0 to x of k(s) s ds` for `x >= 0`: the work on a secant spring with this coefficient, in closed form
/// on every piece. The first knot is zero.
pub(crate) fn work(knots: &[f64], values: &[f64], x: f64) -> f64 {
    let mut total = 0.0;
    let mut from = 0.0;
    loop {
        let piece = piece(knots, values, from, true);
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

/// The piece that holds at `x >= 0`, where moving outwards counts the piece beyond a knot. The first knot is zero.
pub(crate) fn piece(knots: &[f64], values: &[f64], x: f64, outwards: bool) -> Piece {
    let above = if outwards { knots.partition_point(|k| *k <= x) } else { knots.partition_point(|k| *k < x) };
    let last = knots.len() - 1;
    if above == knots.len() {
        return Piece { index: above, constant: values[last], slope: 0.0, from: knots[last], to: f64::INFINITY };
    }
    // The first knot is zero: below it there is nothing.
    let i = above.max(1);
    if i > last {
        return Piece { index: i, constant: values[last], slope: 0.0, from: knots[last], to: f64::INFINITY };
    }
    let slope = (values[i] - values[i - 1]) / (knots[i] - knots[i - 1]);
    Piece { index: i, constant: values[i - 1] - slope * knots[i - 1], slope, from: knots[i - 1], to: knots[i] }
}
