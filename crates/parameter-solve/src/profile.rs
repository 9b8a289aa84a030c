//! Profile likelihood: how far one parameter can move when all others follow.

use nalgebra::DVector;
use rayon::prelude::*;

use crate::observed::{FreeParameter, Observed, Problem};
use crate::refine::{Refined, follow};

/// Rise of `2 ln L` that ends a 95 % interval of one parameter: chi-square with one degree of freedom.
pub const RISE_95: f64 = 3.841_459;
/// Grid points on each side, at most.
const POINTS: usize = 24;
/// The first step is this share of the interval that the linearisation expects, growing by `GROWTH`.
const FIRST_SHARE: f64 = 0.25;
const GROWTH: f64 = 1.35;
/// Smallest and largest first step in a coordinate of size one.
const STEPS: (f64, f64) = (1e-6, 0.25);
/// Bisections between the last point inside and the first outside: 1/64 of a grid step.
const BISECTIONS: usize = 6;

/// The profile of one parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Name with unit.
    pub parameter: &'static str,
    /// Lower end of the 95 % interval; `None`: open, the record does not bound it from below.
    pub low: Option<f64>,
    /// Upper end; `None`: open.
    pub high: Option<f64>,
    /// Value and rise of `2 ln L` at every grid point, by rising value.
    pub points: Vec<(f64, f64)>,
}

impl Profile {
    /// Whether the record bounds the parameter on both sides.
    pub fn identifiable(&self) -> bool {
        self.low.is_some() && self.high.is_some()
    }
}

/// Fixes each free parameter on a grid away from the minimum, fits all others again from the neighbour, and ends the
/// interval where `2 ΔlnL = Ne ln(S/S_min)` exceeds 3.84.
///
/// `Ne` is the effective number of samples, at least one more than there are parameters. To both sums of squares comes the
/// resolution of the displacement. Up to 24 points on each side, with growing steps; a side that never rises so far, or ends on
/// a bound of the search, is open: not identifiable. Where zero is reached below the limit, zero is the end.
///
/// `expected`: half-width of the linear interval of each free parameter's coordinate, where there is one; it sets the first step.
pub fn profile(
    refined: &Refined,
    observed: &Observed,
    expected: &[Option<f64>],
    effective_samples: f64,
) -> Vec<Profile> {
    let problem = Problem::new(refined.model, refined.free.clone(), observed);
    let at = problem.start();
    (0..refined.free.len())
        .into_par_iter()
        .map(|i| {
            let judge = Side::new(refined, observed, (expected.get(i).copied().flatten(), effective_samples), i, &at);
            let (low, mut points) = judge.walk(-1.0);
            let (high, above) = judge.walk(1.0);
            points.reverse();
            points.push((refined.free[i].value, 0.0));
            points.extend(above);
            Profile { parameter: refined.free[i].name, low, high, points }
        })
        .collect()
}

/// What both sides of one parameter's profile share.
struct Side<'a> {
    refined: &'a Refined,
    observed: &'a Observed,
    fixed: usize,
    at: &'a [f64],
    effective_samples: f64,
    /// Sum of squares at the minimum with that of the resolution, in squared units of the problem.
    least: f64,
    floor: f64,
    first_step: f64,
}

impl<'a> Side<'a> {
    fn new(
        refined: &'a Refined,
        observed: &'a Observed,
        (expected, effective_samples): (Option<f64>, f64),
        fixed: usize,
        at: &'a [f64],
    ) -> Self {
        let unit = observed.scale_m();
        let floor =
            observed.blocks().iter().map(|(n, resolution)| *n as f64 * (resolution / unit).powi(2)).sum::<f64>();
        let least = refined.misfit_m.iter().map(|r| (r / unit).powi(2)).sum::<f64>() + floor;
        let first_step = (FIRST_SHARE * expected.unwrap_or(1.0)).clamp(STEPS.0, STEPS.1);
        let effective_samples = effective_samples.max(refined.free.len() as f64 + 1.0);
        Self { refined, observed, fixed, at, effective_samples, least, floor, first_step }
    }

    /// The others at their best for a value of the fixed one: their coordinates and the rise.
    fn rise(&self, coordinate: f64, start: &[f64]) -> Option<(Vec<f64>, f64)> {
        let free = &self.refined.free;
        let mut values = self.refined.model.parameters();
        *values.get_mut(free[self.fixed].name)? = free[self.fixed].at(coordinate);
        let template = crate::observed::with_parameters(&self.refined.model, &values)?;
        let others: Vec<FreeParameter> = (0..free.len()).filter(|&i| i != self.fixed).map(|i| free[i]).collect();
        let problem = Problem::new(template, others, self.observed);
        let (theta, cost) = if start.is_empty() {
            (Vec::new(), self.observed.misfit(&template)?.iter().map(|r| (r / problem.unit_m).powi(2)).sum())
        } else {
            let found = follow(&problem, start)?;
            (found.theta, found.cost)
        };
        let rise = self.effective_samples * ((cost + self.floor) / self.least).ln();
        rise.is_finite().then_some((theta, rise))
    }

    /// The end of the interval on one side and the points met on the way.
    fn walk(&self, direction: f64) -> (Option<f64>, Vec<(f64, f64)>) {
        let free = &self.refined.free[self.fixed];
        let (lower, upper) = free.bounds();
        let mut theta: Vec<f64> = DVector::from_column_slice(self.at).remove_row(self.fixed).iter().copied().collect();
        let mut inside = self.at[self.fixed];
        let mut step = self.first_step;
        let mut points = Vec::new();
        let zero = |coordinate: f64| (direction < 0.0 && !free.logarithmic && coordinate <= 0.0).then_some(0.0);
        for _ in 0..POINTS {
            let next = (inside + direction * step).clamp(lower, upper);
            if next == inside {
                return (zero(inside), points);
            }
            let Some((found, rise)) = self.rise(next, &theta) else { return (None, points) };
            points.push((free.at(next), rise));
            if rise > RISE_95 {
                let (mut good, mut bad) = (inside, next);
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (good + bad);
                    match self.rise(middle, &theta) {
                        Some((found, rise)) if rise <= RISE_95 => {
                            good = middle;
                            theta = found;
                        }
                        _ => bad = middle,
                    }
                }
                return (Some(free.at(0.5 * (good + bad))), points);
            }
            (theta, inside) = (found, next);
            step *= GROWTH;
        }
        (None, points)
    }
}
