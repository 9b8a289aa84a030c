//! A force over deflection, linear between knots, with its integral and its derivatives by the knots.

use crate::LumpedError;
use crate::error::{finite, positive};

/// How a curve goes on beyond its last knot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Extrapolation {
    /// With the slope of the last piece, but not below zero.
    #[default]
    Slope,
    /// With the force of the last knot.
    Constant,
    /// With a stiffness of its own, N/m, zero or more: bottoming.
    Stiffness(f64),
}

/// A straight piece of the curve, `force + slope (d - low)` for `low <= d <= high`, not above the limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    pub low: f64,
    pub high: f64,
    pub force: f64,
    pub slope: f64,
    /// Whether the limit holds on all of it; force and slope are then those of the limit.
    pub is_limited: bool,
    /// Number of the knot it comes after.
    pub knot: usize,
    /// Whether it starts at that knot, and not where the curve crosses the limit.
    pub starts_at_knot: bool,
    /// Integral of the force up to its start, J.
    pub energy_j: f64,
}

impl Piece {
    /// Force at a deflection, N.
    pub fn force_at(&self, d: f64) -> f64 {
        self.force + self.slope * (d - self.low)
    }

    /// Integral of the force from zero to a deflection on this piece, J.
    pub fn energy_at(&self, d: f64) -> f64 {
        let along = d - self.low;
        self.energy_j + (self.force + 0.5 * self.slope * along) * along
    }
}

/// A force over deflection: knots `(deflection, force)` from `(0, 0)` on, linear between, not above a limit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CrushCurve {
    pub knots: Vec<(f64, f64)>,
    pub beyond: Extrapolation,
    pub limit_n: f64,
    pub pieces: Vec<Piece>,
}

impl CrushCurve {
    /// Errors: fewer than two knots, a first one that is not `(0, 0)`, deflections that do not rise, negative forces, a
    /// negative stiffness beyond, a limit that is not positive; infinity is none.
    pub fn new(knots: Vec<(f64, f64)>, beyond: Extrapolation, limit_n: f64) -> Result<Self, LumpedError> {
        let refuse = |name, value, expected| Err(LumpedError::Value { name, value, expected });
        for (d, force) in &knots {
            finite("deflection at a knot", *d)?;
            finite("force at a knot", *force)?;
        }
        if knots.len() < 2 {
            return refuse("number of knots of a force-deflection curve", knots.len() as f64, "two or more");
        }
        if knots[0].0 != 0.0 {
            return refuse("deflection at the first knot", knots[0].0, "zero: a gap is a number of its own");
        }
        if knots[0].1 != 0.0 {
            return refuse("force at zero deflection", knots[0].1, "zero: a plateau starts with a steep ramp");
        }
        if let Some((_, force)) = knots.iter().find(|(_, force)| *force < 0.0) {
            return refuse("force at a knot", *force, "zero or more: the element cannot pull");
        }
        if let Some(pair) = knots.windows(2).find(|pair| pair[1].0 <= pair[0].0) {
            return refuse("deflection at a knot", pair[1].0, "above that of the knot before it");
        }
        if let Extrapolation::Stiffness(stiffness) = beyond {
            finite("stiffness beyond the last knot", stiffness)?;
            if stiffness < 0.0 {
                return refuse("stiffness beyond the last knot", stiffness, "zero or more");
            }
        }
        if limit_n != f64::INFINITY {
            positive("force limit", limit_n)?;
        }
        let mut curve = Self { knots, beyond, limit_n, pieces: Vec::new() };
        curve.cut();
        Ok(curve)
    }

    /// Cuts the curve at its knots and where it crosses the limit.
    fn cut(&mut self) {
        let mut energy_j = 0.0;
        for knot in 0..self.knots.len() {
            let ((from, force), slope) = (self.knots[knot], self.slope_after(knot));
            let to = self.knots.get(knot + 1).map_or(f64::INFINITY, |next| next.0);
            let crossing = from + (self.limit_n - force) / slope;
            let cut = (crossing > from && crossing < to).then_some(crossing);
            for (low, high) in [(from, cut.unwrap_or(to)), (cut.unwrap_or(to), to)].into_iter().filter(|(a, b)| a < b) {
                // Of its end that is not the crossing.
                let outer = if Some(low) != cut { force } else { force + slope * (high.min(low + 1.0) - from) };
                let is_limited = outer >= self.limit_n && (outer > self.limit_n || slope >= 0.0);
                let (at_low, slope) = match (is_limited, Some(low) == cut) {
                    (true, _) => (self.limit_n, 0.0),
                    (false, true) => (self.limit_n, slope),
                    (false, false) => (force, slope),
                };
                let starts_at_knot = low == from;
                let piece = Piece { low, high, force: at_low, slope, is_limited, knot, starts_at_knot, energy_j };
                energy_j = piece.energy_at(high);
                self.pieces.push(piece);
            }
        }
    }

    /// Slope from a knot on, N/m.
    fn slope_after(&self, knot: usize) -> f64 {
        let between = |i: usize| {
            let ((from, force), (to, next)) = (self.knots[i], self.knots[i + 1]);
            (next - force) / (to - from)
        };
        match self.beyond {
            _ if knot + 1 < self.knots.len() => between(knot),
            Extrapolation::Slope => between(knot - 1).max(0.0),
            Extrapolation::Constant => 0.0,
            Extrapolation::Stiffness(stiffness) => stiffness,
        }
    }

    /// Steepest slope, N/m.
    pub fn steepest(&self) -> f64 {
        (0..self.knots.len()).map(|knot| self.slope_after(knot)).fold(0.0, f64::max)
    }

    /// Number of the piece at a deflection; at a knot the one after it.
    pub fn piece_at(&self, d: f64) -> usize {
        self.pieces.partition_point(|piece| piece.high <= d).min(self.pieces.len() - 1)
    }

    /// Constant and slope, over the deflection, of the derivative by the force of a knot of a piece that is not
    /// limited: the hat of that knot.
    pub fn by_force(&self, piece: &Piece, knot: usize) -> (f64, f64) {
        let last = self.knots.len() - 1;
        let lower = match self.beyond {
            // The last two hats go on, unless the slope ends at zero.
            Extrapolation::Slope if piece.knot == last && self.slope_after(last - 1) > 0.0 => last - 1,
            _ if piece.knot == last => return (if knot == last { 1.0 } else { 0.0 }, 0.0),
            _ => piece.knot,
        };
        let (from, length) = (self.knots[lower].0, self.knots[lower + 1].0 - self.knots[lower].0);
        match knot {
            _ if knot == lower => (1.0 + from / length, -length.recip()),
            _ if knot == lower + 1 => (-from / length, length.recip()),
            _ => (0.0, 0.0),
        }
    }

    /// The same by the place of a knot: minus the slope of the piece times its hat.
    pub fn by_deflection(&self, piece: &Piece, knot: usize) -> (f64, f64) {
        let (constant, slope) = self.by_force(piece, knot);
        (-piece.slope * constant, -piece.slope * slope)
    }
}
