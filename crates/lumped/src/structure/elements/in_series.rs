//! Two force-deflection elements in series with no mass between: one element, for the fronts of two vehicles.
//!
//! At equal force deflections add, and so do compliances of unloading: `1/k_u = 1/k_u1 + 1/k_u2`. Partial unloading and
//! return is exact too, for both sides go along their lines to the same force. Where a curve falls, or a rate factor
//! holds, the massless point between is no function of the whole: give it a mass.

use crate::LumpedError;
use crate::structure::elements::crush_curve::{Extrapolation, Piece};
use crate::structure::elements::force_deflection::ForceDeflection;

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
