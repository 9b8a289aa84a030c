//! Starting values of the nonlinear models from the momentum balance, which is linear in their coefficients.
//!
//! Integrating `m a = -k(x) x - c(v) v` once gives `m (v0 - v(t)) = sum_j p_j q_j(t)`: `p_j` the value of spring or
//! damper at knot `j` and `q_j` the integral of its hat function times `x` or `v` along the record. For given knots
//! the best values are a linear least squares problem with `p_j >= 0`. No acceleration is needed, only one difference
//! of the displacement.

use nalgebra::{DMatrix, DVector};

use crate::fit::options::SingleMassFitOptions;
use crate::record::observation::ObservedWave;
use crumple_numerics::linalg::nonnegative_least_squares;

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

    /// The values at given knots that meet the lost speed best, not negative, and the squared error they leave.
    ///
    /// Values of springs come first, in units of `m v0/C` a second; then those of dampers, in units of `m` a second.
    /// Columns are scaled to one length before the Gram matrix is formed.
    pub fn solve(&self, spring: &[Vec<f64>], damper: &[Vec<f64>]) -> (Vec<f64>, f64) {
        let columns: Vec<&Vec<f64>> = spring.iter().chain(damper).collect();
        let n = columns.len();
        let dot = |a: &[f64], b: &[f64]| crumple_numerics::linalg::dot(a, b);
        let norms: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt().max(f64::MIN_POSITIVE)).collect();
        let gram = DMatrix::from_fn(n, n, |i, j| dot(columns[i], columns[j]) / (norms[i] * norms[j]));
        let b = DVector::from_fn(n, |i, _| dot(columns[i], &self.lost) / norms[i]);
        // The factor has the same inner products as the columns, in n rows.
        let factor = (&gram + DMatrix::identity(n, n) * 1e-13).cholesky().map(nalgebra::Cholesky::unpack);
        let reduced = factor.and_then(|l| Some((l.transpose(), l.solve_lower_triangular(&b)?)));
        let Some((columns, lost)) = reduced else { return (vec![0.0; n], dot(&self.lost, &self.lost)) };
        let (x, _) = nonnegative_least_squares(&columns, &lost);
        let cost = (&gram * &x).dot(&x) - 2.0 * b.dot(&x) + dot(&self.lost, &self.lost);
        ((0..n).map(|i| x[i] / norms[i]).collect(), cost)
    }
}
