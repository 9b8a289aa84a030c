//! Profile likelihood: how far one parameter can move while all others are fitted again.

use rayon::prelude::*;

use crate::assessed::Profile;

/// Rise of `2 ln L` that ends a 95 % interval of one parameter: chi-square with one degree of freedom.
pub(crate) const RISE_95: f64 = 3.841_459;
/// Grid points on each side at most.
const POINTS: usize = 24;
/// The first step as a share of the half-width that the linearisation expects.
const FIRST_SHARE: f64 = 0.25;
/// Factor from one step to the next.
const GROWTH: f64 = 1.35;
/// Smallest and largest first step in a coordinate of size one.
const STEPS: (f64, f64) = (1e-6, 0.25);
/// Bisections between the last point inside and the first outside: 1/64 of a grid step.
const BISECTIONS: usize = 6;

/// Fits the other parameters with one fixed: which one, its coordinate, start coordinates of the others. Gives the
/// coordinates of the minimum and its sum of squares.
pub(crate) type Refit<'a> = &'a (dyn Fn(usize, f64, &[f64]) -> Option<(Vec<f64>, f64)> + Sync);

/// A minimum whose parameters can be fixed one at a time.
pub(crate) struct Profiled<'a> {
    /// Names of the parameters, in the order of the coordinates.
    pub names: &'a [String],
    /// Coordinates of the minimum.
    pub at: &'a [f64],
    /// Smallest and largest coordinates.
    pub bounds: &'a [(f64, f64)],
    /// The value of a parameter at a coordinate.
    pub value: &'a (dyn Fn(usize, f64) -> f64 + Sync),
    /// Whether a coordinate of zero is a value of zero, which ends an interval.
    pub ends_at_zero: &'a (dyn Fn(usize) -> bool + Sync),
    /// How the others are fitted again.
    pub refit: Refit<'a>,
    /// The rise of `2 ln L` above the minimum at a sum of squares.
    pub rise: &'a (dyn Fn(f64) -> f64 + Sync),
    /// Half-width of the linear interval of each coordinate, where there is one; it sets the first step.
    pub expected: &'a [Option<f64>],
}

impl Profiled<'_> {
    /// Sets each free parameter to values away from the minimum, fits all others again from the neighbouring value, and
    /// ends the interval where `2 ln L` has fallen by 3.84: chi-square, one degree of freedom, 95 %.
    ///
    /// Up to 24 values on each side with growing steps, then six bisections. A side that does not rise so far, or ends
    /// at a bound of the search, is open: the parameter is not identifiable. Where zero is reached first, zero is the
    /// end.
    pub fn profiles(&self) -> Vec<Profile> {
        (0..self.at.len()).into_par_iter().map(|i| self.profile(i)).collect()
    }

    /// The profile of one parameter.
    pub fn profile(&self, i: usize) -> Profile {
        let side = Side::new(self, i);
        let (low, mut points) = side.walk(-1.0);
        let (high, above) = side.walk(1.0);
        points.reverse();
        points.push(((self.value)(i, self.at[i]), 0.0));
        points.extend(above);
        Profile { parameter: self.names[i].clone(), low, high, points }
    }
}

/// What both sides of the profile of one parameter share.
struct Side<'a> {
    /// The minimum, and which of its parameters is fixed.
    of: &'a Profiled<'a>,
    fixed: usize,
    /// First step of the coordinate.
    first_step: f64,
}

impl<'a> Side<'a> {
    fn new(of: &'a Profiled<'a>, fixed: usize) -> Self {
        let expected = of.expected.get(fixed).copied().flatten();
        let first_step = (FIRST_SHARE * expected.unwrap_or(1.0)).clamp(STEPS.0, STEPS.1);
        Self { of, fixed, first_step }
    }

    /// The rise of `2 ln L` with the parameter at `coordinate`, and the coordinates of the others there.
    fn rise(&self, coordinate: f64, start: &[f64]) -> Option<(Vec<f64>, f64)> {
        let (theta, cost) = (self.of.refit)(self.fixed, coordinate, start)?;
        let rise = (self.of.rise)(cost);
        rise.is_finite().then_some((theta, rise))
    }

    /// One side, `direction` -1 or 1: the end of the interval and the points on the way.
    fn walk(&self, direction: f64) -> (Option<f64>, Vec<(f64, f64)>) {
        let value = |coordinate: f64| (self.of.value)(self.fixed, coordinate);
        let (lower, upper) = self.of.bounds[self.fixed];
        let mut theta: Vec<f64> =
            self.of.at.iter().enumerate().filter(|(i, _)| *i != self.fixed).map(|(_, x)| *x).collect();
        let mut inside = self.of.at[self.fixed];
        let mut step = self.first_step;
        let mut points = Vec::new();
        let zero = |coordinate: f64| {
            (direction < 0.0 && (self.of.ends_at_zero)(self.fixed) && coordinate <= 0.0).then_some(0.0)
        };
        for _ in 0..POINTS {
            let next = (inside + direction * step).clamp(lower, upper);
            if next == inside {
                return (zero(inside), points);
            }
            let Some((refitted, rise)) = self.rise(next, &theta) else { return (None, points) };
            points.push((value(next), rise));
            if rise > RISE_95 {
                let (mut good, mut bad) = (inside, next);
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (good + bad);
                    match self.rise(middle, &theta) {
                        Some((refitted, rise)) if rise <= RISE_95 => {
                            good = middle;
                            theta = refitted;
                        }
                        _ => bad = middle,
                    }
                }
                return (Some(value(0.5 * (good + bad))), points);
            }
            (theta, inside) = (refitted, next);
            step *= GROWTH;
        }
        (None, points)
    }
}
