//! Exact-to-rounding motion of one mass on a secant spring and a damper with piecewise-linear coefficients.
//!
//! The force is `k(|x|) x + c(|v|) v` with both coefficients linear between knots. On one piece of each it is a
//! polynomial of degree two in `x` and `v`, and the Taylor series of the motion follows term by term. The axis of `x`
//! and that of `v` are cut into pieces by the knots and by zero, where `|x|` has its kink; [`SecantMotion::walk`] goes
//! from one cut to the next.
//!
//! What a step costs: some 20² products for the series, an estimate of how far it holds, and, only where the motion can
//! reach a cut within the step at all, a search for the instant. A pulse of 250 ms takes some tens of steps, whatever
//! the sampling interval: samples are read off the series.
//!
//! Three things a step has to get right:
//! - *On a cut* the rate decides which piece is entered; where the rate vanishes too, both are tried on the series
//!   itself a little later ([`INSIDE`]).
//! - *Out and back within a step*: the distance to each cut is looked at on eight points of the step.
//! - *At rest for good* (velocity and acceleration below [`REST`] of the start): the rest of the record is one step.

use pulp::Arch;

use crate::exact::falling_zero::falling_zero;
use crate::secant::curve::{BEYOND, Curve, Piece};
use crate::secant::step::{Fill, LANES, Law, ORDER, REST, Step, longest};
use crate::{CrushEvents, LumpedError, ModelKind, Motion};

/// Steps after which the search for an event or the motion gives up.
const MAX_STEPS: usize = 20_000;
/// Share of a step after which a motion that starts on a knot must lie inside its piece.
const INSIDE: f64 = 1.0 / 16.0;

/// `m x'' = -k(|x|) x - c(|v|) v`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SecantMotion {
    /// The model it is of, for errors.
    pub kind: ModelKind,
    pub mass_kg: f64,
    pub spring: Curve,
    pub damper: Curve,
}

impl SecantMotion {
    /// Walks from contact to `end_s`, step by step; `visit` returns whether to go on.
    ///
    /// Inside one piece of both coefficients the equation is a polynomial of degree two, so its Taylor coefficients
    /// follow by recurrence and a step of order 20 is as long as its rest allows. A step ends where `|x|` or `|v|`
    /// meets a knot or `v` or `x` changes sign, found by Newton's method on the series; so no step contains a kink.
    ///
    /// Errors: a state that is not finite, or more than 20,000 steps, both as [`LumpedError::Diverges`] with the time
    /// reached.
    pub fn walk(
        &self,
        impact_speed_m_per_s: f64,
        end_s: f64,
        mut visit: impl FnMut(&Step) -> bool,
    ) -> Result<(), LumpedError> {
        let (mut t, mut x, mut v) = (0.0, 0.0, impact_speed_m_per_s);
        let mut a = self.acceleration(x, v);
        for _ in 0..MAX_STEPS {
            if t >= end_s {
                return Ok(());
            }
            if v.abs() <= REST * impact_speed_m_per_s && a.abs() * (end_s - t) <= REST * impact_speed_m_per_s {
                // At rest for good.
                let series = std::array::from_fn(|k| if k == 0 { x } else { 0.0 });
                let law = Law { k0: 0.0, k1: 0.0, c0: 0.0, c1: 0.0 };
                visit(&Step {
                    start_s: t,
                    length_s: end_s - t,
                    x: series,
                    v: [0.0; ORDER + 1],
                    law,
                    spring_piece: BEYOND,
                    damper_piece: BEYOND,
                    sign_x: 0.0,
                    sign_v: 0.0,
                });
                return Ok(());
            }
            let (mut step, smooth, spring, damper, sx, sv) = self.piecewise(t, x, v, a, end_s);
            step.length_s = border(&step, smooth, &spring, &damper, sx, sv);
            if !visit(&step) {
                return Ok(());
            }
            let next = step.at(step.length_s);
            t += step.length_s;
            let snap = |value: f64, piece: &Piece, sign: f64, size: f64| {
                // On a knot exactly, so that the next step starts on the right piece.
                for knot in [piece.from, piece.to] {
                    if knot.is_finite() && (value * sign - knot).abs() <= 1e-13 * (knot + size) {
                        return sign * knot;
                    }
                }
                value
            };
            let crossed = step.length_s < smooth;
            (x, v) = (next.displacement_m, next.velocity_m_per_s);
            if crossed {
                let reach = impact_speed_m_per_s * step.length_s;
                x = snap(x, &spring, sx, 1e-3 * reach);
                v = snap(v, &damper, sv, 1e-3 * impact_speed_m_per_s);
            }
            a = self.acceleration(x, v);
            if !(x.is_finite() && v.is_finite() && a.is_finite()) {
                return Err(LumpedError::Diverges { model: self.kind, time_s: t });
            }
        }
        Err(LumpedError::Diverges { model: self.kind, time_s: t })
    }

    /// The step from a state, on the pieces the motion enters. On a knot the rate says which; where it vanishes or
    /// deceives, the series itself: a sixteenth of the step on, the state must lie inside.
    ///
    /// Returns the step with the length over which its series holds, the same length, the pieces of spring and damper,
    /// and the signs of displacement and velocity on them.
    fn piecewise(&self, t: f64, x: f64, v: f64, a: f64, end_s: f64) -> (Step, f64, Piece, Piece, f64, f64) {
        let sx = if x == 0.0 { v.signum() } else { x.signum() };
        let sv = if v == 0.0 { a.signum() } else { v.signum() };
        let (outwards, faster) = (x == 0.0 || x * v > 0.0, v == 0.0 || v * a > 0.0);
        let per_mass = 1.0 / self.mass_kg;
        let attempt = |outwards: bool, faster: bool| {
            let spring = self.spring.piece(x.abs(), outwards);
            let damper = self.damper.piece(v.abs(), faster);
            let law = Law {
                k0: per_mass * spring.constant,
                k1: per_mass * spring.slope * sx,
                c0: per_mass * damper.constant,
                c1: per_mass * damper.slope * sv,
            };
            let (of_x, of_v) = law.series(x, v);
            let smooth = longest(&of_x).min(end_s - t);
            let step = Step {
                start_s: t,
                length_s: smooth,
                x: of_x,
                v: of_v,
                law,
                spring_piece: spring.index,
                damper_piece: damper.index,
                sign_x: sx,
                sign_v: sv,
            };
            (step, smooth, spring, damper, sx, sv)
        };
        let inside = |tried: &(Step, f64, Piece, Piece, f64, f64)| {
            let soon = tried.0.at(tried.1 * INSIDE);
            let (x, v) = (soon.displacement_m * sx, soon.velocity_m_per_s * sv);
            let within = |value: f64, now: f64, piece: &Piece| {
                (now != piece.from || value >= piece.from) && (now != piece.to || value <= piece.to)
            };
            (within(x, tried.4 * tried.0.x[0], &tried.2), within(v, tried.5 * tried.0.x[1], &tried.3))
        };
        let first = attempt(outwards, faster);
        let on_knot = |now: f64, piece: &Piece| now == piece.from || now == piece.to;
        if !on_knot(x * sx, &first.2) && !on_knot(v * sv, &first.3) {
            return first;
        }
        match inside(&first) {
            (true, true) => first,
            (spring, damper) => attempt(outwards == spring, faster == damper),
        }
    }

    /// `-(k(|x|) x + c(|v|) v)/m`, m/s².
    fn acceleration(&self, x: f64, v: f64) -> f64 {
        -(self.spring.value(x.abs()) * x + self.damper.value(v.abs()) * v) / self.mass_kg
    }

    /// The motion at `k dt`, k = 0 .. `samples`.
    ///
    /// Every sample is a value of the series of the step it lies in: about `1e-15` of the largest motion a step.
    /// Errors: as [`walk`](Self::walk).
    pub fn motion(&self, impact_speed_m_per_s: f64, dt_s: f64, samples: usize) -> Result<Motion, LumpedError> {
        let mut motion = Motion::zeros(samples);
        let arch = Arch::new();
        let mut next = 0;
        let end_s = dt_s * samples as f64;
        self.walk(impact_speed_m_per_s, end_s, |step| {
            let stop = step.start_s + step.length_s;
            // Instants up to the end of the step: a division finds them but for rounding.
            let mut end = ((stop / dt_s) as usize).clamp(next, samples);
            while end > next && (end - 1) as f64 * dt_s > stop {
                end -= 1;
            }
            while end < samples && end as f64 * dt_s <= stop {
                end += 1;
            }
            let Motion { displacement_m, velocity_m_per_s, acceleration_m_per_s2 } = &mut motion;
            let waves = [displacement_m, velocity_m_per_s, acceleration_m_per_s2].map(|wave| &mut wave[next..end]);
            arch.dispatch(Fill { step, first_s: 0.0, dt_s, first: next, waves });
            next = end;
            next < samples
        })?;
        Ok(motion)
    }

    /// The displacement at `first_s + k dt_s`, for a fit.
    ///
    /// Half the work of [`motion`](Self::motion) a sample, and no allocation. `out` is filled from its start; where the
    /// motion cannot be followed to its end, an error says up to when.
    pub fn displacement(
        &self,
        impact_speed_m_per_s: f64,
        first_s: f64,
        dt_s: f64,
        out: &mut [f64],
    ) -> Result<(), LumpedError> {
        let mut next = 0;
        let end_s = first_s + dt_s * out.len() as f64;
        self.walk(impact_speed_m_per_s, end_s, |step| {
            let stop = step.start_s + step.length_s;
            let time = |k: usize| first_s + k as f64 * dt_s;
            while next < out.len() && time(next) <= stop {
                let tau: [f64; LANES] = std::array::from_fn(|lane| time(next + lane) - step.start_s);
                let [displacements, ..] = step.waves(&tau);
                // Lanes beyond the step or the end are not used.
                for x in displacements {
                    if next < out.len() && time(next) <= stop {
                        out[next] = x;
                        next += 1;
                    }
                }
            }
            next < out.len()
        })
    }

    /// Heat of the damper up to `k dt`, J, k = 0 .. `samples`: `c(|v|) v²` integrated term by term on the series of
    /// every step, to about `1e-14` of the energy.
    pub fn dissipated(&self, impact_speed_m_per_s: f64, dt_s: f64, samples: usize) -> Result<Vec<f64>, LumpedError> {
        let mut heat = vec![0.0; samples];
        let (mut next, mut before) = (0, 0.0);
        self.walk(impact_speed_m_per_s, dt_s * samples as f64, |step| {
            let series = step.power();
            let since = |tau: f64| -> f64 {
                let sum = (0..=ORDER).rev().fold(0.0, |sum, k| sum * tau + series[k] / (k + 1) as f64);
                self.mass_kg * sum * tau
            };
            let stop = step.start_s + step.length_s;
            while next < samples && next as f64 * dt_s <= stop {
                heat[next] = before + since(next as f64 * dt_s - step.start_s);
                next += 1;
            }
            before += since(step.length_s);
            next < samples
        })?;
        Ok(heat)
    }

    /// First zero of velocity, and of acceleration after it.
    ///
    /// A step ends where the velocity changes its sign, so dynamic crush is the end of a step; rebound is found by
    /// bisection inside one, to rounding. Nothing after two seconds is looked for.
    pub fn events(&self, impact_speed_m_per_s: f64) -> Result<CrushEvents, LumpedError> {
        let mut events = CrushEvents::default();
        let mut rate = 1.0;
        // A crash is over in a second or never.
        self.walk(impact_speed_m_per_s, 2.0, |step| {
            let end = step.at(step.length_s);
            if events.time_of_dynamic_crush_s.is_none() {
                // Steps end where the velocity changes its sign.
                if end.velocity_m_per_s.abs() <= 1e-12 * impact_speed_m_per_s {
                    events.time_of_dynamic_crush_s = Some(step.start_s + step.length_s);
                    events.dynamic_crush_m = Some(end.displacement_m);
                    rate = end.acceleration_m_per_s2;
                }
                return true;
            }
            if end.acceleration_m_per_s2 * rate > 0.0 && rate != 0.0 {
                return true;
            }
            let (mut low, mut high) = (0.0, step.length_s);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if step.at(middle).acceleration_m_per_s2 * rate > 0.0 { low = middle } else { high = middle }
            }
            events.time_of_rebound_s = Some(step.start_s + high);
            events.rebound_velocity_m_per_s = Some(step.at(high).velocity_m_per_s);
            false
        })?;
        Ok(events)
    }
}

/// Where the step first meets a border of its pieces: a knot of either coefficient, or a change of sign.
///
/// Most steps end the check at the first comparison: the sum of the moduli of the series bounds how far displacement
/// and velocity can go. Otherwise the distance to each end of a piece is positive inside and falls through zero at the
/// border, where [`falling_zero`] closes in on it.
fn border(step: &Step, length: f64, spring: &Piece, damper: &Piece, sx: f64, sv: f64) -> f64 {
    let mut first = length;
    // Farthest that displacement and velocity can go in the step: most steps meet no border, and this tells at once.
    let mut reach = (0.0, 0.0);
    let mut power = 1.0;
    for k in 1..=ORDER {
        let size = step.x[k].abs();
        if k > 1 {
            reach.1 += k as f64 * size * power;
        }
        power *= length;
        reach.0 += size * power;
    }
    // Points of the step, found once if any end is near.
    let parts: [f64; LANES] = std::array::from_fn(|part| length * (part + 1) as f64 / LANES as f64);
    let mut looked = None;
    // Distance inside the piece from each of its ends, positive inside, and its rate.
    for (end, side, is_velocity) in
        [(spring.from, 1.0, false), (spring.to, -1.0, false), (damper.from, 1.0, true), (damper.to, -1.0, true)]
    {
        if !end.is_finite() {
            continue;
        }
        let distance = |tau: f64| {
            let s = step.at(tau);
            if is_velocity {
                (side * (sv * s.velocity_m_per_s - end), side * sv * s.acceleration_m_per_s2)
            } else {
                (side * (sx * s.displacement_m - end), side * sx * s.velocity_m_per_s)
            }
        };
        let distance_now = side * (if is_velocity { sv * step.x[1] } else { sx * step.x[0] } - end);
        if distance_now > if is_velocity { reach.1 } else { reach.0 } {
            continue;
        }
        // Looked for on eight points, so that one out and back within the step is seen. From a border the motion was
        // found to go inwards.
        let mut low = if distance_now > 0.0 { 0.0 } else { length * INSIDE };
        let mut high = None;
        let (x, v) = looked.get_or_insert_with(|| {
            let [x, v, _] = step.waves(&parts);
            (x, v)
        });
        for part in 0..LANES {
            let tau = parts[part].min(first);
            if tau > low {
                let beyond = if tau < parts[part] {
                    distance(tau).0 < 0.0
                } else {
                    side * (if is_velocity { sv * v[part] } else { sx * x[part] } - end) < 0.0
                };
                if beyond {
                    high = Some(tau);
                    break;
                }
                low = tau;
            }
            if tau >= first {
                break;
            }
        }
        let Some(high) = high else { continue };
        first = falling_zero(low, high, distance).min(first);
    }
    first.max(1e-15)
}
