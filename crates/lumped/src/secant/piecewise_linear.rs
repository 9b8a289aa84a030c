//! A coefficient as a person states it: values at knots.
//!
//! What a pipeline file states and a fit of a chain varies: any number of knots, unlike [`Curve`](super::curve::Curve),
//! which has four at most and no memory of its own.

use crate::LumpedError;
use crate::error::finite;
use crate::secant::curve::{piece, work};

/// A coefficient that is linear between knots and constant outside, over the size of a displacement or speed: even, so
/// that a spring is as stiff in tension as in compression.
#[derive(Debug, Clone, PartialEq)]
pub struct PiecewiseLinear {
    /// As stated; rising, the first zero.
    knots: Vec<f64>,
    values: Vec<f64>,
    /// Knots from the first on that the curve needs: one that has, with all after it, the value of the one before says
    /// nothing.
    needed: usize,
}

impl PiecewiseLinear {
    /// The same everywhere.
    pub fn constant(value: f64) -> Self {
        Self { knots: vec![0.0], values: vec![value], needed: 1 }
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
        let (mut knots, mut values) = (Vec::new(), Vec::new());
        if first > 0.0 {
            knots.push(0.0);
            values.push(start);
        }
        knots.extend(points.iter().map(|p| p.0));
        values.extend(points.iter().map(|p| p.1));
        let last = values.last().copied().unwrap_or(start);
        let needed = values.iter().rposition(|value| *value != last).map_or(1, |before| before + 2);
        Ok(Self { knots, values, needed })
    }

    /// The knots that the curve needs and their values.
    fn shape(&self) -> (&[f64], &[f64]) {
        (&self.knots[..self.needed], &self.values[..self.needed])
    }

    /// The coefficient at a displacement or speed.
    pub fn at(&self, q: f64) -> f64 {
        let (knots, values) = self.shape();
        let piece = piece(knots, values, q.abs(), true);
        piece.constant + piece.slope * q.abs()
    }

    /// Energy in a secant spring with this stiffness, `integral from 0 to |q| of k(s) s ds`.
    pub fn energy(&self, q: f64) -> f64 {
        let (knots, values) = self.shape();
        work(knots, values, q.abs())
    }

    /// Its value if it is the same everywhere, with however many knots it was stated.
    pub fn as_constant(&self) -> Option<f64> {
        (self.needed == 1).then_some(self.values[0])
    }

    /// Knots and values as stated, the first knot zero: those of the same value too, so that a name always finds its
    /// knot.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.knots.iter().copied().zip(self.values.iter().copied())
    }

    /// Whether every value is positive or zero.
    pub fn is_passive(&self) -> bool {
        self.values.iter().all(|value| *value >= 0.0)
    }

    /// The pieces over the whole axis, from minus to plus infinity: `coefficient = constant + slope q`.
    pub(crate) fn regions(&self) -> Vec<Region> {
        let (knots, values) = self.shape();
        let right: Vec<Region> = knots
            .iter()
            .map(|knot| {
                let p = piece(knots, values, *knot, true);
                Region { constant: p.constant, slope: p.slope, low: p.from, high: p.to }
            })
            .collect();
        let mirrored = |r: &Region| Region { slope: -r.slope, low: -r.high, high: -r.low, ..*r };
        let mut all: Vec<Region> = right.iter().rev().map(mirrored).collect();
        let mut rest = right.as_slice();
        if right[0].slope == 0.0 {
            // Nothing happens at zero: one piece across it.
            all.pop();
            all.push(Region { low: -right[0].high, ..right[0] });
            rest = &right[1..];
        }
        all.extend_from_slice(rest);
        all
    }
}

/// Where one straight line holds.
///
/// The coefficient is `constant + slope q` for `low <= q <= high`, `q` with its sign: the regions of one coefficient
/// tile the axis from minus to plus infinity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Region {
    pub constant: f64,
    pub slope: f64,
    pub low: f64,
    pub high: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_tile_the_axis_and_give_the_coefficient() {
        let curve = PiecewiseLinear::new(&[(0.1, 3.0), (0.2, 5.0), (0.4, 1.0), (0.5, 1.0)]).unwrap();
        let regions = curve.regions();
        // Minus infinity to -0.4, -0.2, -0.1, across zero to 0.1, 0.2, 0.4, infinity.
        assert_eq!(regions.len(), 7);
        assert_eq!((regions[0].low, regions[6].high), (f64::NEG_INFINITY, f64::INFINITY));
        for pair in regions.windows(2) {
            assert_eq!(pair[0].high, pair[1].low);
        }
        for q in [-0.7, -0.3, -0.15, 0.0, 0.05, 0.13, 0.39, 2.0] {
            let region = regions.iter().find(|r| r.low <= q && q <= r.high).unwrap();
            // Two roundings of numbers near 5.
            assert!((region.constant + region.slope * q - curve.at(q)).abs() < 1e-14, "{q}");
        }
        assert_eq!(PiecewiseLinear::constant(2.0).regions().len(), 1);
        // By hand: 3 * 0.1^2/2 up to the knot, then k = 1 + 20 s: s^2/2 + 20 s^3/3 from 0.1 to 0.2.
        let by_hand = 0.015 + 0.5 * (0.04 - 0.01) + 20.0 / 3.0 * (0.008 - 0.001);
        assert!((curve.energy(-0.2) - by_hand).abs() < 1e-16);
    }

    #[test]
    fn knots_must_rise_and_equal_values_are_a_constant() {
        assert!(PiecewiseLinear::new(&[]).is_err());
        assert!(PiecewiseLinear::new(&[(-0.1, 1.0)]).is_err());
        assert!(PiecewiseLinear::new(&[(0.0, 1.0), (0.0, 2.0)]).is_err());
        assert!(PiecewiseLinear::new(&[(0.0, f64::NAN)]).is_err());
        let flat = PiecewiseLinear::new(&[(0.0, 7.0), (0.2, 7.0), (0.4, 7.0)]).unwrap();
        assert_eq!(flat.as_constant(), Some(7.0));
        assert_eq!((flat.points().count(), flat.regions().len()), (3, 1));
        assert_eq!(PiecewiseLinear::new(&[(0.3, 7.0)]).unwrap().as_constant(), Some(7.0));
        let step = PiecewiseLinear::new(&[(0.0, 7.0), (0.2, 5.0), (0.4, 5.0)]).unwrap();
        assert_eq!((step.as_constant(), step.points().last()), (None, Some((0.4, 5.0))));
        assert_eq!((step.at(0.3), step.regions().len()), (5.0, 4));
    }
}
