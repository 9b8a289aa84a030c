//! First zero of one quantity of a linear system, from the exact solution.
//!
//! The double model has four exponentials of different speeds in one quantity; no closed form gives the first zero of
//! their sum. The search is by exact steps, so that only the bracketing can miss anything, never the motion.

use crumple_lti::Complex;
use nalgebra::{Matrix4, RowVector4, Vector4};

use crate::exact::exact_step::exact_step;

/// Steps after which the search gives up; at 20 ns each this is 40 ms.
const MAX_STEPS: usize = 2_000_000;
/// Time constants after which a mode is dead. Much longer, and rounding would be taken for a crossing of what dies out
/// without one; a slow mode that overtakes the others does so earlier.
const LIFETIME: f64 = 25.0;
/// Steps between two looks at which modes are still alive.
const STAGE: usize = 64;

/// The state at the first sign change of `row·z` after `start`, and the time it takes from there.
///
/// Marches by exact steps that are short against every mode still alive (1/16 of `1/|pole|`; a mode is dead after
/// 25 time constants, when `1e-11` of it is left), then closes in on the crossing by bracketed Newton steps on the
/// exact solution. `None` when the horizon passes without a crossing: 25 time constants of the slowest decaying
/// mode, or 20 periods of an undamped one. Two crossings inside one step would be missed; so short a step makes
/// that a tangency to rounding.
pub(crate) fn first_crossing(
    a: &Matrix4<f64>,
    poles: &[Complex],
    row: &RowVector4<f64>,
    start: &Vector4<f64>,
) -> Option<(f64, Vector4<f64>)> {
    let lifetime = |pole: &Complex| {
        let decay = if pole.re < 0.0 { -LIFETIME / pole.re } else { f64::INFINITY };
        let periods = 20.0 * std::f64::consts::TAU / pole.norm();
        // Nearly undamped or growing modes: bounded by periods; decaying ones live at least as long as they last.
        if pole.re < 0.0 && pole.re.abs() > 1e-3 * pole.norm() { decay } else { periods.min(decay) }
    };
    let fastest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
    // Poles at zero stand for a mass that no spring holds: they bring no crossing.
    let moving = || poles.iter().filter(|p| p.norm() > 1e-7 * fastest);
    let horizon = moving().map(lifetime).fold(0.0, f64::max);
    let value = |z: &Vector4<f64>| (row * z)[0];

    let (mut t, mut z) = (0.0, *start);
    let mut sign = value(&z);
    let mut steps = 0;
    while t < horizon && steps < MAX_STEPS {
        let alive = moving().filter(|p| lifetime(p) > t).map(|p| p.norm()).fold(0.0, f64::max);
        let h = 1.0 / (16.0 * alive);
        let phi = exact_step(a, h);
        for _ in 0..STAGE {
            let next = phi * z;
            let f = value(&next);
            if !f.is_finite() {
                return None;
            }
            if sign == 0.0 {
                sign = f;
            } else if f == 0.0 || (f > 0.0) != (sign > 0.0) {
                let (dt, at) = refine(a, row, &z, h, sign);
                return Some((t + dt, at));
            }
            t += h;
            z = next;
            steps += 1;
        }
    }
    None
}

/// Zero of `row·exp(A τ) z` in `(0, h]`, by Newton's method kept inside the bracket.
fn refine(a: &Matrix4<f64>, row: &RowVector4<f64>, z: &Vector4<f64>, h: f64, sign: f64) -> (f64, Vector4<f64>) {
    let (mut low, mut high) = (0.0, h);
    let slope_row = row * a;
    let mut tau = 0.5 * h;
    let mut at = *z;
    for _ in 0..60 {
        at = exact_step(a, tau) * z;
        let f = (row * at)[0];
        if f == 0.0 {
            break;
        }
        if (f > 0.0) == (sign > 0.0) {
            low = tau;
        } else {
            high = tau;
        }
        let newton = tau - f / (slope_row * at)[0];
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - tau).abs() <= f64::EPSILON * tau {
            break;
        }
        tau = next;
    }
    (tau, at)
}
