//! Both nonlinear models of a single mass fitted to its displacement, from starts by the momentum.

use crumple_lumped::{Model, Nonlinear1, Nonlinear2, Parameter, ParameterKind};
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, descend};
use crumple_numerics::linalg::{dot, nonnegative_least_squares};
use crumple_signal::{Displacement, Signal};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::candidate::Fit;
use crate::coordinates::Coordinates;
use crate::error::SolveError;
use crate::fit::problem::{AtCrush, Problem, SLOW, SingleMassFitOptions};
use crate::fit::search::{best_of_starts, bounds};
use crate::parameters::{FitParameter, Map};
use crate::record::observation::{Observation, ObservedWave};

/// Bounds of the knots, as shares of the last one.
pub(crate) const KNOTS: (f64, f64) = (0.005, 0.995);

/// The coordinates of a model of which the parameters at these indices are free: springs and dampers not negative,
/// knots inside the range of the record.
pub(crate) fn coordinates(template: Model, free: &[(usize, Map)]) -> Coordinates {
    let parameters = template.kind().parameters();
    let number = |&(index, map): &(usize, Map)| {
        let Parameter { name, kind, .. } = parameters[index];
        let is_knot = matches!(kind, ParameterKind::Length | ParameterKind::Rate);
        let bounds = if is_knot { KNOTS } else { (0.0, 1e3) };
        FitParameter::of_search((index, name.into(), kind), map, bounds, bounds)
    };
    Coordinates::new(template, free.iter().map(number).collect())
}

/// The record of a fit to the displacement that ended here, with the sum of squares of the record alone, in squared
/// units of the crush. Parameters on a bound stand in the order of the model.
pub(crate) fn record_of_fit(
    coordinates: &Coordinates,
    observed: &Observation,
    best: &Optimum,
    evaluations: u64,
    options: &SingleMassFitOptions,
) -> Fit {
    let rmse = (best.cost / observed.rows() as f64).sqrt() * options.crush_m;
    let on_bound = coordinates.free.iter().zip(&best.on_bound).filter(|(_, on_bound)| **on_bound);
    let mut indices: Vec<usize> = on_bound.map(|(number, _)| number.index).collect();
    indices.sort_unstable();
    let names = coordinates.template.kind().parameter_names();
    let active_bounds = indices.into_iter().map(|index| names[index].to_owned()).collect();
    Fit::of_waves(observed, &[rmse], Vec::new(), (best.iterations, evaluations, best.stop), active_bounds)
}

// Starting values of the nonlinear models from the momentum balance, which is linear in their coefficients.
//
// Integrating `m a = -k(x) x - c(v) v` once gives `m (v0 - v(t)) = sum_j p_j q_j(t)`: `p_j` the value of spring or
// damper at knot `j` and `q_j` the integral of its hat function times `x` or `v` along the record. For given knots
// the best values are a linear least squares problem with `p_j >= 0`. No acceleration is needed, only one difference
// of the displacement.

/// Places of the knots of the damper, shares of the impact speed: quadratic, since most of the motion near rest is
/// slow.
pub(crate) const DAMPER_KNOTS: [f64; 9] = [0.012, 0.05, 0.11, 0.2, 0.31, 0.44, 0.6, 0.75, 0.9];

/// Starts that are descended from, best first.
pub(crate) const REFINED: usize = 8;

/// Of their ends, those that are followed to convergence.
pub(crate) const FOLLOWED: usize = 2;

/// Knots of spring and damper, the values there, and the squared error of the momentum.
#[derive(Debug, Clone)]
pub(crate) struct Start {
    /// Inner knots: that of the spring over the crush, if it has one, then those of the damper over the impact speed.
    pub knots: Vec<f64>,
    /// Values at all knots, springs first, in the units of [`Momentum::solve`].
    pub values: Vec<f64>,
    /// Sum over the samples of the squared error of the momentum over `m v0`.
    pub cost: f64,
}

/// A record as the momentum balance needs it: displacement over the crush, speed and lost speed over the impact
/// speed.
pub(crate) struct Momentum {
    /// Sampling interval, s.
    dt_s: f64,
    /// Displacement and speed over their scales.
    pub x: Vec<f64>,
    /// Speed over the impact speed.
    pub v: Vec<f64>,
    /// `v0 - v` over `v0`.
    lost: Vec<f64>,
}

/// Columns of springs or of dampers, with their inner products.
pub(crate) struct Columns {
    columns: Vec<Vec<f64>>,
    /// With each other.
    gram: DMatrix<f64>,
    /// With the lost speed.
    lost: Vec<f64>,
}

impl Momentum {
    /// Reads a displacement. The speed is a central difference of it, off by `O(dt²)` and by the noise over `dt`: only
    /// starting values depend on it.
    pub fn of(wave: &ObservedWave, options: &SingleMassFitOptions) -> Self {
        let (crush, v0) = (options.crush_m, options.impact_speed_m_per_s);
        let (s, dt_s) = (&wave.samples, wave.instants().dt_s);
        let n = s.len();
        let speed = |k: usize| match k {
            0 => (s[1] - s[0]) / dt_s,
            k if k + 1 == n => (s[k] - s[k - 1]) / dt_s,
            k => (s[k + 1] - s[k - 1]) / (2.0 * dt_s),
        };
        let v: Vec<f64> = (0..n).map(|k| speed(k) / v0).collect();
        let first = v[0];
        Self { dt_s, x: s.iter().map(|x| x / crush).collect(), lost: v.iter().map(|v| first - v).collect(), v }
    }

    /// One column for each knot: the integrals of `hat_j(|y|) y` by trapezoids over the window, with `y` the
    /// displacement or the speed. Hat functions are piecewise linear, one at their own knot and zero at the others;
    /// the last one stays one beyond.
    pub fn columns(&self, y: &[f64], knots: &[f64]) -> Vec<Vec<f64>> {
        (0..knots.len())
            .map(|j| {
                let hat = |y: f64| {
                    let at = y.abs();
                    let rising =
                        if j == 0 { 1.0 } else { ((at - knots[j - 1]) / (knots[j] - knots[j - 1])).clamp(0.0, 1.0) };
                    let falling = if j + 1 == knots.len() {
                        1.0
                    } else {
                        ((knots[j + 1] - at) / (knots[j + 1] - knots[j])).clamp(0.0, 1.0)
                    };
                    rising.min(falling) * y
                };
                let mut sum = 0.0;
                let mut before = hat(y[0]);
                y.iter()
                    .map(|&y| {
                        let now = hat(y);
                        sum += 0.5 * self.dt_s * (before + now);
                        before = now;
                        sum
                    })
                    .collect()
            })
            .collect()
    }

    /// Columns with their inner products.
    pub fn with_products(&self, columns: Vec<Vec<f64>>) -> Columns {
        let n = columns.len();
        let gram = DMatrix::from_fn(n, n, |i, j| dot(&columns[i], &columns[j]));
        let lost = columns.iter().map(|column| dot(column, &self.lost)).collect();
        Columns { columns, gram, lost }
    }

    /// The values at given knots that meet the lost speed best, not negative, and the squared error they leave.
    ///
    /// Values of springs come first, in units of `m v0/C` a second; then those of dampers, in units of `m` a second.
    /// Columns are scaled to one length before the Gram matrix is formed.
    pub fn solve(&self, spring: &Columns, damper: &Columns) -> (Vec<f64>, f64) {
        let (springs, n) = (spring.columns.len(), spring.columns.len() + damper.columns.len());
        let mut gram = DMatrix::zeros(n, n);
        gram.view_mut((0, 0), (springs, springs)).copy_from(&spring.gram);
        gram.view_mut((springs, springs), (n - springs, n - springs)).copy_from(&damper.gram);
        for (i, of_spring) in spring.columns.iter().enumerate() {
            for (j, of_damper) in damper.columns.iter().enumerate() {
                let product = dot(of_spring, of_damper);
                (gram[(i, springs + j)], gram[(springs + j, i)]) = (product, product);
            }
        }
        let norms: Vec<f64> = (0..n).map(|i| gram[(i, i)].sqrt().max(f64::MIN_POSITIVE)).collect();
        let gram = DMatrix::from_fn(n, n, |i, j| gram[(i, j)] / (norms[i] * norms[j]));
        let b = DVector::from_iterator(n, spring.lost.iter().chain(&damper.lost).zip(&norms).map(|(b, norm)| b / norm));
        // The factor has the same inner products as the columns, in n rows.
        let factor = (&gram + DMatrix::identity(n, n) * 1e-13).cholesky().map(nalgebra::Cholesky::unpack);
        let reduced = factor.and_then(|l| Some((l.transpose(), l.solve_lower_triangular(&b)?)));
        let Some((columns, lost)) = reduced else { return (vec![0.0; n], dot(&self.lost, &self.lost)) };
        let (x, _) = nonnegative_least_squares(&columns, &lost);
        let cost = (&gram * &x).dot(&x) - 2.0 * b.dot(&x) + dot(&self.lost, &self.lost);
        ((0..n).map(|i| x[i] / norms[i]).collect(), cost)
    }
}

// The first nonlinear model fitted to the compartment's displacement, under the side constraints of its paper.

/// Rounds of the augmented Lagrangian.
const ROUNDS: usize = 12;

impl SingleMassFitOptions {
    /// Fits the first nonlinear model under the side constraints of its paper: `k1 <= k2`, `c1 >= c2 >= c3`, and at the
    /// time of dynamic crush `x = C` and `v = 0`.
    ///
    /// The coefficients are sums of parts that are not negative, which keeps their order: `k2 = k1 + d`, `c1 = c2 + e`,
    /// `c2 = c3 + f`. Bounded Levenberg-Marquardt in these parts and the knot, from nine knots whose parts follow from
    /// the momentum balance. The two equations are met by an augmented Lagrangian around that, to 1e-9 of crush and
    /// speed where they can be met at all; see [`conditions_at_crush`](Self::conditions_at_crush) for what is left.
    /// `constrained` false leaves them out, for a record that never stops.
    ///
    /// The error in the record of the fit is that of the displacement alone. No standard deviations: at the constraints
    /// they have no linear form. Single-mass paper, section 4.1. Errors: values that are not positive, a window outside
    /// the record, no start with a finite response.
    pub fn fit_nonlinear1(
        &self,
        displacement: &Signal<Displacement>,
        constrained: bool,
    ) -> Result<(Nonlinear1, Fit), SolveError> {
        self.check()?;
        let observed = self.observed(displacement)?;
        let momentum = Momentum::of(&observed.waves[0], self);
        let springs = momentum.columns(&momentum.x, &[0.0, 1.0]);
        let sum = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a + b).collect() };
        // k = k1 + (k2 - k1) ramp; c = c3 + (c2 - c3) [first two hats] + (c1 - c2) [first hat].
        let spring_parts = momentum.with_products(vec![sum(&springs[0], &springs[1]), springs[1].clone()]);
        let mut starts: Vec<Start> = DAMPER_KNOTS
            .iter()
            .map(|knee| {
                let c = momentum.columns(&momentum.v, &[0.0, *knee, 1.0]);
                let two = sum(&c[0], &c[1]);
                let parts = momentum.with_products(vec![c[0].clone(), two.clone(), sum(&two, &c[2])]);
                let (values, cost) = momentum.solve(&spring_parts, &parts);
                Start { knots: vec![*knee], values, cost }
            })
            .collect();
        starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        starts.truncate(REFINED);
        let rate = self.impact_speed_m_per_s / self.crush_m;
        // Of the dampers the smallest first, on which the others stand.
        let point = |s: &Start| [0, 1, 4, 3, 2].map(|i| s.values[i] / rate).into_iter().chain([s.knots[0]]).collect();
        let coordinates = parts(self);
        let problem = Problem { unit: self.crush_m, ..Problem::new(&coordinates, &observed, 0.0) };
        let points = starts.iter().map(point).collect();
        let [sorting, to_the_end] = [(30, 1e-4), (120, 1e-10)].map(|(steps, worth)| bounds(&coordinates, steps, worth));
        let (best, mut evaluations) = best_of_starts(&problem, points, [&sorting, &to_the_end], FOLLOWED);
        let mut best = best.ok_or(SolveError::NoFit { starts: REFINED })?;
        if constrained {
            if let Some((end, spent, _)) = descend_to_conditions(&problem, self, &best.theta, (1e-10, 1e-9)) {
                evaluations += spent;
                best = end;
            }
            // The cost of the record alone.
            let mut residuals = vec![0.0; problem.rows()];
            if problem.residuals(&best.theta, &mut residuals) {
                best.cost = residuals.iter().map(|x| x * x).sum();
            }
        }
        // A part on its bound makes two coefficients equal.
        let fit = record_of_fit(&coordinates, &observed, &best, evaluations, self);
        match coordinates.model(&best.theta) {
            Some(Model::Nonlinear1(model)) => Ok((model, fit)),
            _ => Err(SolveError::NoFit { starts: REFINED }),
        }
    }
}

/// Springs and dampers as sums of parts that are not negative, over their units, and the knot over the impact speed.
pub(crate) fn parts(options: &SingleMassFitOptions) -> Coordinates {
    let ((k, c), v0) = (options.units(), options.impact_speed_m_per_s);
    let template = Model::Nonlinear1(Nonlinear1 {
        mass_kg: options.mass_kg,
        k1_n_per_m: k,
        k2_n_per_m: k,
        c1_n_s_per_m: c,
        c2_n_s_per_m: c,
        c3_n_s_per_m: c,
        v_thresh_m_per_s: 0.5 * v0,
        crush_m: options.crush_m,
        v0_m_per_s: v0,
    });
    // k1, k2 - k1, c3, c2 - c3, c1 - c2 and the knot.
    let springs = [(1, Map::Share(k)), (2, Map::Above(1, k))];
    let dampers = [(5, Map::Share(c)), (4, Map::Above(5, c)), (3, Map::Above(4, c)), (6, Map::Share(v0))];
    coordinates(template, &[&springs[..], &dampers].concat())
}

/// Descends from `start` under the two conditions at dynamic crush, by an augmented Lagrangian, until they are met to
/// `met` of crush and speed or twelve rounds are over. The end, the evaluations spent, and whether they are met; `None`
/// without a finite response.
pub(crate) fn descend_to_conditions(
    problem: &Problem<'_>,
    options: &SingleMassFitOptions,
    start: &[f64],
    (cost_tolerance, met): (f64, f64),
) -> Option<(Optimum, u64, bool)> {
    // Residuals are of size one times the number of samples.
    let mut at_crush = AtCrush::new(options);
    at_crush.weight = problem.observed.rows() as f64;
    let bounds = bounds(problem.coordinates, 120, cost_tolerance);
    let (mut end, mut evaluations): (Option<Optimum>, u64) = (None, 0);
    for _ in 0..ROUNDS {
        let problem = Problem { at_crush: Some(at_crush), ..problem.clone() };
        let from = end.as_ref().map_or(start, |end| &end.theta);
        let Some(next) = descend(&problem, from, &bounds) else { break };
        evaluations += next.evaluations;
        let structure = problem.coordinates.structure(&next.theta);
        let left = structure.and_then(|structure| at_crush.conditions(&structure, &[]));
        end = Some(next);
        let Some((left, _)) = left else { break };
        if left.iter().all(|condition| condition.abs() <= met) {
            return Some((end?, evaluations, true));
        }
        for (multiplier, condition) in at_crush.multipliers.iter_mut().zip(left) {
            *multiplier += at_crush.weight * condition;
        }
        at_crush.weight = (at_crush.weight * 4.0).min(1e8);
    }
    Some((end?, evaluations, false))
}

// The search for the second nonlinear model in the compartment's displacement.

/// Places of the middle knot of the spring that are tried, shares of the crush.
const SPRING_KNOTS: [f64; 9] = [0.1, 0.25, 0.4, 0.55, 0.7, 0.8, 0.87, 0.93, 0.97];

/// Steps that sort the starts into hopeful and hopeless.
const SORTING_STEPS: u32 = 10;

impl SingleMassFitOptions {
    /// Searches for the ten parameters of the second nonlinear model on the motion itself.
    ///
    /// For fixed knots the force is linear in the seven coefficients, and the momentum it takes, `m (v0 - v(t)) = sum
    /// of coefficient_j times the integral of hat_j`, needs no acceleration: non-negative least squares on a grid of
    /// 324 knot vectors gives starting values; the best eight go through bounded Levenberg-Marquardt on a part of the
    /// samples of the simulated displacement, the best two to the end, the better of them then on all samples.
    /// Deterministic. From the exact displacement of the paper's own parameters all ten come back. A real record
    /// determines fewer.
    ///
    /// Errors: masses, speed or crush that are not positive, a window outside the record, no finite response.
    pub fn search_nonlinear2(&self, displacement: &Signal<Displacement>) -> Result<(Nonlinear2, Fit), SolveError> {
        self.check()?;
        let observed = self.observed(displacement)?;
        let momentum = Momentum::of(&observed.waves[0], self);
        let spring = |x1: &f64| momentum.with_products(momentum.columns(&momentum.x, &[0.0, *x1, 1.0]));
        let springs: Vec<Columns> = SPRING_KNOTS.iter().map(spring).collect();
        let pairs: Vec<(f64, f64)> = DAMPER_KNOTS
            .iter()
            .enumerate()
            .flat_map(|(i, v1)| DAMPER_KNOTS[i + 1..].iter().map(move |v2| (*v1, *v2)))
            .collect();
        let mut starts: Vec<Start> = pairs
            .par_iter()
            .flat_map_iter(|(v1, v2)| {
                let damper = momentum.with_products(momentum.columns(&momentum.v, &[0.0, *v1, *v2, 1.0]));
                let tried: Vec<Start> = springs
                    .iter()
                    .zip(SPRING_KNOTS)
                    .map(|(spring, x1)| {
                        let (values, cost) = momentum.solve(spring, &damper);
                        Start { knots: vec![x1, *v1, *v2], values, cost }
                    })
                    .collect();
                tried
            })
            .collect();
        starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        starts.truncate(REFINED);

        // Momentum over v0: a spring coefficient is in units of m v0/C a second, a damper one of m a second.
        let to_theta = |start: &Start| -> Vec<f64> {
            let rate = self.impact_speed_m_per_s / self.crush_m;
            let v: Vec<f64> = start.values.iter().map(|x| x / rate).collect();
            vec![v[0], v[1], v[2], start.knots[0], v[3], v[4], v[5], v[6], start.knots[1], start.knots[2]]
        };
        let coordinates = shares(self);
        let problem = Problem { unit: self.crush_m, ..Problem::new(&coordinates, &observed, 0.0) };
        let points = starts.iter().map(to_theta).collect();
        let sorting = bounds(&coordinates, SORTING_STEPS, 1e-4);
        let to_the_end = Bounds { slow: SLOW, ..bounds(&coordinates, 60, 1e-9) };
        let (best, evaluations) = best_of_starts(&problem, points, [&sorting, &to_the_end], FOLLOWED);
        let best = best.ok_or(SolveError::NoFit { starts: REFINED })?;
        // The knots of the damper stand in rising order in the model.
        let mut ordered = best.clone();
        if best.theta[8] > best.theta[9] {
            for (i, j) in [(5, 6), (8, 9)] {
                ordered.theta.swap(i, j);
                ordered.on_bound.swap(i, j);
            }
        }
        let fit = record_of_fit(&coordinates, &observed, &ordered, evaluations, self);
        match coordinates.model(&best.theta) {
            Some(Model::Nonlinear2(model)) => Ok((model, fit)),
            _ => Err(SolveError::NoFit { starts: REFINED }),
        }
    }
}

/// Springs and dampers over their units, knots over the crush and the impact speed; those of the damper in either
/// order.
fn shares(options: &SingleMassFitOptions) -> Coordinates {
    let ((k, c), v0) = (options.units(), options.impact_speed_m_per_s);
    let template = Model::Nonlinear2(Nonlinear2 {
        mass_kg: options.mass_kg,
        k1_n_per_m: k,
        k2_n_per_m: k,
        k3_n_per_m: k,
        x1_m: 0.5 * options.crush_m,
        c1_n_s_per_m: c,
        c2_n_s_per_m: c,
        c3_n_s_per_m: c,
        c4_n_s_per_m: c,
        v1_m_per_s: 0.3 * v0,
        v2_m_per_s: 0.6 * v0,
        crush_m: options.crush_m,
        v0_m_per_s: v0,
    });
    let units = [k, k, k, options.crush_m, c, c, c, c, v0, v0];
    let free: Vec<(usize, Map)> = (1..).zip(units.map(Map::Share)).collect();
    let mut coordinates = coordinates(template, &free);
    coordinates.either_order = Some([[9, 6], [10, 7]]);
    coordinates
}
