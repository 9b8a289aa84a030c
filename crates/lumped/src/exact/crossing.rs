//! First zeros of velocities and accelerations of a linear motion, from the exact solution.
//!
//! Several exponentials of different speeds stand in one quantity; no closed form gives the first zero of their sum.
//! The search is by exact steps, so that only the bracketing can miss anything, never the motion.
//!
//! Where a distance that is positive first meets zero.
//!
//! Events (a knot, a change of sign, the end of contact) are zeros of a distance along a motion whose value and rate
//! are both known in closed form or as a series. Newton's method needs a few evaluations there; the bracket keeps it
//! from leaving the step.

use crumple_numerics::lti::{Complex, eigenvalues};
use nalgebra::allocator::Allocator;
use nalgebra::{Const, DMatrix, DefaultAllocator, Dim, Dyn, OMatrix, OVector, U1};

use crate::exact::linear_motion::{LinearMotion, LinearSystem};
use crate::{CrushEvents, LumpedError, Start};

/// Steps after which the search gives up; at 20 ns each this is 40 ms.
const MAX_STEPS: usize = 2_000_000;
/// Time constants after which a mode is dead. Much longer, and rounding would be taken for a crossing of what dies out
/// without one; a slow mode that overtakes the others does so earlier.
const LIFETIME: f64 = 25.0;
/// Steps between two looks at which modes are still alive.
const STAGE: usize = 64;

/// Dynamic crush and rebound of every mass: the first zero of its velocity, and of its acceleration after it.
///
/// The search ends at `horizon_s`, or earlier, when nothing moves any more. Errors: parameters so extreme that the
/// poles are not found.
pub(crate) fn events(system: &LinearSystem, v0: f64, horizon_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
    let start = &Start::Impact(v0);
    match system.states {
        2 => LinearMotion::new(Const::<2>, system, start).events(horizon_s),
        3 => LinearMotion::new(Const::<3>, system, start).events(horizon_s),
        4 => LinearMotion::new(Const::<4>, system, start).events(horizon_s),
        6 => LinearMotion::new(Const::<6>, system, start).events(horizon_s),
        n => LinearMotion::new(Dyn(n), system, start).events(horizon_s),
    }
}

/// The time that a mode lasts: bounded by 20 periods where it is nearly undamped or grows; a decaying one lives at
/// least as long as it lasts.
fn lifetime(pole: &Complex) -> f64 {
    let decay = if pole.re < 0.0 { -LIFETIME / pole.re } else { f64::INFINITY };
    let periods = 20.0 * std::f64::consts::TAU / pole.norm();
    if pole.re < 0.0 && pole.re.abs() > 1e-3 * pole.norm() { decay } else { periods.min(decay) }
}

/// A motion, and its events by rows of its state.
impl<D: Dim> LinearMotion<D>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D> + Allocator<U1, D>,
{
    fn events(&self, horizon_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        let (n, size) = (self.masses, self.a.nrows());
        let poles = eigenvalues(&DMatrix::from_fn(size, size, |i, j| self.a[(i, j)]))?;
        let poles: Vec<Complex> = poles.into_iter().map(|pole| pole / self.tau_s).collect();
        let event = |mass: usize| {
            let mut velocity = OMatrix::<f64, U1, D>::zeros_generic(U1, self.a.shape_generic().0);
            velocity[n + mass] = 1.0;
            let Some((t, z)) = self.first_crossing(&poles, &velocity, &self.start, horizon_s) else {
                return CrushEvents::default();
            };
            let rebound = self.first_crossing(&poles, &(&velocity * &self.a), &z, horizon_s - t);
            CrushEvents {
                time_of_dynamic_crush_s: Some(t),
                dynamic_crush_m: Some(z[mass]),
                time_of_rebound_s: rebound.as_ref().map(|(after, _)| t + after),
                rebound_velocity_m_per_s: rebound.map(|(_, z)| z[n + mass] / self.tau_s),
            }
        };
        Ok((0..n).map(event).collect())
    }

    /// The state at the first sign change of `row·z` after `start`, and the time it takes from there, s.
    ///
    /// Marches by exact steps that are short against every mode still alive (1/16 of `1/|pole|`; a mode is dead after
    /// 25 time constants, when `1e-11` of it is left), then closes in on the crossing by bracketed Newton steps on the
    /// exact solution. `None` when the horizon passes without a crossing, or 25 time constants of the slowest decaying
    /// mode, or 20 periods of an undamped one. Where the quantity turns round inside a step, which is so short that it
    /// does so once, its extremum is looked at: two crossings close together are not missed.
    fn first_crossing(
        &self,
        poles: &[Complex],
        row: &OMatrix<f64, U1, D>,
        start: &OVector<f64, D>,
        horizon_s: f64,
    ) -> Option<(f64, OVector<f64, D>)> {
        let fastest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        // Poles at zero stand for a mass that no spring holds: they bring no crossing.
        let moving = || poles.iter().filter(|p| p.norm() > 1e-7 * fastest);
        let horizon = moving().map(lifetime).fold(0.0, f64::max).min(horizon_s);
        let value = |z: &OVector<f64, D>| (row * z)[0];
        let rate = row * &self.a;
        let (mut t, mut z) = (0.0, start.clone());
        let mut sign = value(&z);
        // Positive where the quantity moves away from zero; a start at zero is no turn.
        let mut away = if sign == 0.0 { 0.0 } else { sign.signum() * (&rate * &z)[0] };
        let mut steps = 0;
        while t < horizon && steps < MAX_STEPS {
            let alive = moving().filter(|p| lifetime(p) > t).map(|p| p.norm()).fold(0.0, f64::max);
            let h = 1.0 / (16.0 * alive);
            let phi = self.exponential(h);
            for _ in 0..STAGE {
                let next = &phi * &z;
                let f = value(&next);
                if !f.is_finite() {
                    return None;
                }
                if sign == 0.0 {
                    sign = f;
                }
                let next_away = sign.signum() * (&rate * &next)[0];
                let crosses = |f: f64| f == 0.0 || (f > 0.0) != (sign > 0.0);
                let bracket = if crosses(f) {
                    Some(h)
                } else if away < 0.0 && next_away > 0.0 {
                    let (turn, at) = self.refine(&rate, &z, h, -sign);
                    crosses(value(&at)).then_some(turn)
                } else {
                    None
                };
                if let Some(bracket) = bracket {
                    let (after, at) = self.refine(row, &z, bracket, sign);
                    return (t + after <= horizon_s).then_some((t + after, at));
                }
                away = next_away;
                t += h;
                z = next;
                steps += 1;
            }
        }
        None
    }

    /// Zero of `row·exp(A τ) z` in `(0, h]`, by Newton's method kept inside the bracket.
    fn refine(&self, row: &OMatrix<f64, U1, D>, z: &OVector<f64, D>, h: f64, sign: f64) -> (f64, OVector<f64, D>) {
        let rate = row * &self.a;
        let at = |tau: f64| self.exponential(tau) * z;
        let tau = falling_zero(0.0, h, |tau| {
            let z = at(tau);
            (sign.signum() * (row * &z)[0], sign.signum() * (&rate * &z)[0] / self.tau_s)
        });
        (tau, at(tau))
    }
}

/// Steps below this share of the instant may be rounding.
const STALLED: f64 = 1e-10;

/// Zero of a function that is positive at `low` and not at `high`, by Newton's method kept inside the bracket.
///
/// `distance` gives value and rate. A Newton step that leaves the bracket, or that a rate of zero makes no number, is
/// replaced by the middle; ends when a step is two roundings of the instant, when small steps no longer shrink, which
/// is the rounding of the distance, or after 60.
///
/// `low` and `high` in s; the result lies between them, right to two roundings for a distance known to rounding.
pub(crate) fn falling_zero(mut low: f64, mut high: f64, distance: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut tau = 0.5 * (low + high);
    let mut before = f64::INFINITY;
    for _ in 0..60 {
        let (d, rate) = distance(tau);
        if d > 0.0 {
            low = tau;
        } else {
            high = tau;
        }
        let newton = tau - d / rate;
        let inside = newton > low && newton < high;
        let next = if inside { newton } else { 0.5 * (low + high) };
        let (step, wanted) = ((next - tau).abs(), (newton - tau).abs());
        // Newton's steps shrink by their square.
        let stalled = inside && before <= STALLED * tau && step >= 0.5 * before;
        if step.min(wanted) <= 2.0 * f64::EPSILON * tau || stalled {
            break;
        }
        (tau, before) = (next, if inside { step } else { f64::INFINITY });
    }
    tau
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_is_found_to_rounding_and_a_flat_start_does_not_stop_it() {
        // Two roundings of the answer, as the last step allows.
        let zero = falling_zero(0.0, 2.0, |t| (2.0 - t * t, -2.0 * t));
        assert!((zero - 2.0_f64.sqrt()).abs() <= 2.0 * f64::EPSILON * 1.5, "{zero}");
        // At the middle the rate is zero, and Newton's step no number.
        let zero = falling_zero(-1.0, 1.0, |t| (0.125 - t * t * t, -3.0 * t * t));
        assert!((zero - 0.5).abs() <= 2.0 * f64::EPSILON, "{zero}");
    }
}
