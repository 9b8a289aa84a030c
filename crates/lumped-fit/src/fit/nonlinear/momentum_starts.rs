//! Starting values of the nonlinear models: the momentum that spring and damper take, linear in their coefficients.

use nalgebra::{DMatrix, DVector};

use crate::fit::options::SingleMassFitOptions;
use crate::record::window::Window;
use crumple_linalg::nonnegative_least_squares;

/// Places of the knots of the damper, shares of the impact speed: quadratic, since most of the motion near rest is
/// slow.
pub(crate) const DAMPER_KNOTS: [f64; 9] = [0.012, 0.05, 0.11, 0.2, 0.31, 0.44, 0.6, 0.75, 0.9];
/// Starts that are refined, and those followed to the end.
pub(crate) const REFINED: usize = 8;
pub(crate) const FOLLOWED: usize = 2;

/// A knot vector of both coefficients and the values there.
#[derive(Debug, Clone)]
pub(crate) struct Start {
    pub knots: Vec<f64>,
    pub values: Vec<f64>,
    pub cost: f64,
}

/// The record as the integral form sees it.
pub(crate) struct Momentum {
    dt_s: f64,
    /// Displacement and speed over their scales.
    pub x: Vec<f64>,
    pub v: Vec<f64>,
    /// `v0 - v` over `v0`.
    lost: Vec<f64>,
}

impl Momentum {
    /// Speed from central differences of the displacement: only starting values depend on it.
    pub fn of(window: &Window, options: &SingleMassFitOptions) -> Self {
        let (crush, v0) = (options.crush_m, options.impact_speed_m_per_s);
        let n = window.samples.len();
        let s = &window.samples;
        let speed = |k: usize| match k {
            0 => (s[1] - s[0]) / window.dt_s,
            k if k + 1 == n => (s[k] - s[k - 1]) / window.dt_s,
            k => (s[k + 1] - s[k - 1]) / (2.0 * window.dt_s),
        };
        let v: Vec<f64> = (0..n).map(|k| speed(k) / v0).collect();
        let first = v[0];
        Self {
            dt_s: window.dt_s,
            x: s.iter().map(|x| x / crush).collect(),
            lost: v.iter().map(|v| first - v).collect(),
            v,
        }
    }

    /// Integrals of `hat_j(|y|) y` for the hats of these knots.
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

    /// The best values at given knots: non-negative least squares of `lost = sum of value_j column_j`.
    pub fn solve(&self, spring: &[Vec<f64>], damper: &[Vec<f64>]) -> (Vec<f64>, f64) {
        let columns: Vec<&Vec<f64>> = spring.iter().chain(damper).collect();
        let n = columns.len();
        let dot = |a: &[f64], b: &[f64]| crumple_linalg::dot(a, b);
        let norms: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt().max(f64::MIN_POSITIVE)).collect();
        let gram = DMatrix::from_fn(n, n, |i, j| dot(columns[i], columns[j]) / (norms[i] * norms[j]));
        let b = DVector::from_fn(n, |i, _| dot(columns[i], &self.lost) / norms[i]);
        let x = nonnegative_least_squares(&gram, &b);
        let cost = (&gram * &x).dot(&x) - 2.0 * b.dot(&x) + dot(&self.lost, &self.lost);
        ((0..n).map(|i| x[i] / norms[i]).collect(), cost)
    }
}
