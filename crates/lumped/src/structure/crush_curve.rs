//! Crush curves, and two elements of them in series.
//!
//! Two force-deflection elements in series with no mass between: one element, for the fronts of two vehicles.
//!
//! At equal force deflections add, and so do compliances of unloading: `1/k_u = 1/k_u1 + 1/k_u2`. Partial unloading and
//! return is exact too, for both sides go along their lines to the same force. Where a curve falls, or a rate factor
//! holds, the massless point between is no function of the whole: give it a mass.

use crate::LumpedError;
use crate::error::{finite, positive};
use crate::structure::force_deflection::ForceDeflection;

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

/// Forces nearer to each other than this, relative, are the same level.
const SAME: f64 = 1e-12;

/// Two elements in series as one, and how its deflection is shared.
#[derive(Debug, Clone, PartialEq)]
pub struct InSeries {
    /// The one element.
    pub element: ForceDeflection,
    /// Deflections of both at every knot of the one, m.
    path: Vec<[f64; 2]>,
    /// What each adds to a deflection beyond the last knot, together one.
    shares_beyond: [f64; 2],
}

/// One side, as far as it is compressed.
struct Side<'a> {
    pieces: &'a [Piece],
    number: usize,
    d: f64,
}

impl Side<'_> {
    fn piece(&self) -> &Piece {
        &self.pieces[self.number]
    }

    /// Whether its force stays for a while.
    fn is_flat(&self) -> bool {
        self.piece().slope == 0.0
    }

    /// Force at the end of the piece, N.
    fn end_n(&self) -> f64 {
        let piece = self.piece();
        if piece.high < f64::INFINITY { piece.force_at(piece.high) } else { f64::INFINITY }
    }

    /// Goes on to a force on a rising piece, not beyond its end.
    fn rise_to(&mut self, force_n: f64) {
        if self.end_n() <= force_n * (1.0 + SAME) {
            self.pass();
        } else {
            let piece = self.piece();
            self.d = piece.low + (force_n - piece.force) / piece.slope;
        }
    }

    /// Goes on to the next piece.
    fn pass(&mut self) {
        self.d = self.piece().high;
        self.number += 1;
    }
}

impl ForceDeflection {
    /// This element and another in series, with no mass between. Gaps add.
    ///
    /// Errors: a curve that falls, a rate factor.
    pub fn in_series(&self, other: &Self) -> Result<InSeries, LumpedError> {
        for element in [self, other] {
            let expected = "zero for elements in series: else give the point between a mass";
            if element.rate_s_per_m() > 0.0 {
                return Err(LumpedError::Value { name: "rate factor", value: element.rate_s_per_m(), expected });
            }
            if let Some(piece) = element.pieces().iter().find(|piece| piece.slope < 0.0) {
                let expected = "not negative for elements in series: else give the point between a mass";
                return Err(LumpedError::Value { name: "slope of the curve", value: piece.slope, expected });
            }
        }
        let mut sides = [self, other].map(|element| Side { pieces: element.pieces(), number: 0, d: 0.0 });
        let (mut force_n, mut path, mut knots) = (0.0, vec![[0.0; 2]], vec![(0.0, 0.0)]);
        let (shares_beyond, beyond) = loop {
            let flat = sides.each_ref().map(Side::is_flat);
            let ends = sides.each_ref().map(Side::end_n);
            if flat.contains(&true) {
                let endless: Vec<usize> = (0..2).filter(|i| flat[*i] && ends[*i] == f64::INFINITY).collect();
                if !endless.is_empty() {
                    let share = (endless.len() as f64).recip();
                    break ([0, 1].map(|i| if endless.contains(&i) { share } else { 0.0 }), Extrapolation::Constant);
                }
                // Where both are flat, they share the way in proportion.
                sides.iter_mut().zip(flat).filter(|(_, flat)| *flat).for_each(|(side, _)| side.pass());
            } else if ends == [f64::INFINITY; 2] {
                let compliance = sides.each_ref().map(|side| side.piece().slope.recip());
                let sum = compliance[0] + compliance[1];
                break (compliance.map(|c| c / sum), Extrapolation::Stiffness(sum.recip()));
            } else {
                force_n = ends[0].min(ends[1]);
                sides.iter_mut().for_each(|side| side.rise_to(force_n));
            }
            path.push(sides.each_ref().map(|side| side.d));
            knots.push((sides[0].d + sides[1].d, force_n));
        };
        let [a, b] = [self, other].map(Self::unloading_n_per_m);
        let element =
            Self::new(&knots, a * b / (a + b))?.with_extrapolation(beyond)?.with_gap(self.gap_m() + other.gap_m())?;
        Ok(InSeries { element, path, shares_beyond })
    }
}

impl InSeries {
    /// The segment a deflection lies on: number of its lower knot.
    fn segment(&self, deflection_m: f64) -> usize {
        self.element.knots().partition_point(|(d, _)| *d <= deflection_m).clamp(1, self.path.len()) - 1
    }

    /// How a deflection on the curve, m, is shared between the two.
    pub fn shared(&self, deflection_m: f64) -> [f64; 2] {
        let (lower, knots) = (self.segment(deflection_m), self.element.knots());
        let (from, along) = (self.path[lower], deflection_m - knots[lower].0);
        let shares = match self.path.get(lower + 1) {
            Some(to) => [0, 1].map(|i| (to[i] - from[i]) / (knots[lower + 1].0 - knots[lower].0)),
            None => self.shares_beyond,
        };
        [0, 1].map(|i| from[i] + shares[i] * along)
    }

    /// Whether that share is open: both are on a plateau of the same force, where it is taken in proportion.
    pub fn is_share_open(&self, deflection_m: f64) -> bool {
        let (lower, knots) = (self.segment(deflection_m), self.element.knots());
        match self.path.get(lower + 1) {
            Some(to) => {
                let from = self.path[lower];
                knots[lower + 1].1 == knots[lower].1 && from[0] < to[0] && from[1] < to[1]
            }
            None => self.element.extrapolation() == Extrapolation::Constant && !self.shares_beyond.contains(&0.0),
        }
    }
}
