//! Motion of a chain of masses whose springs and dampers have piecewise-linear secant coefficients, by Taylor series.
//!
//! Element i carries `k_i(|u|) u + c_i(|w|) w`, `u` its compression and `w` the rate of it. With N masses there are 2 N
//! coordinates, each on one piece of its coefficient; together they fix a polynomial of degree two in the state, hence
//! a Taylor series of order [`ORDER`] by convolution. A step ends at the first knot that any coordinate meets, and at
//! every sample of a drive, whose slope changes there.
//!
//! Which pieces hold from a knot on is asked of the series: a coordinate on a knot must lie inside its piece a
//! sixteenth of the step later, or its neighbour is taken and the series made again. A coordinate closer to a knot than
//! [`ON_A_KNOT`] of the motion counts as on it, because a difference of two displacements is no better known.
//!
//! Stiff dampers shorten the steps to their time constant; after [`MAX_STEPS`] the motion is given up.

use crate::exact::falling_zero::falling_zero;
use crate::secant::piecewise_linear::{PiecewiseLinear, Region};
use crate::secant::step::{ORDER, REST};
use crate::{Drive, LumpedError};

/// Steps after which the motion is given up.
const MAX_STEPS: usize = 200_000;
/// Share of a step after which a coordinate that starts on a knot must lie inside its piece.
const INSIDE: f64 = 1.0 / 16.0;
/// A coordinate is on a knot if it is nearer than this, relative to the motion: rounding of a difference of
/// displacements.
const ON_A_KNOT: f64 = 1e-13;
/// Below this many metres nothing moves.
const NOTHING_M: f64 = 1e-12;

/// Taylor coefficients about the start of a step, lowest order first, SI units per `s^k`.
pub(crate) type Series = [f64; ORDER + 1];

/// Masses with the pieces of each spring (over its compression) and damper (over its rate).
pub(crate) struct ChainMotion<'a> {
    pub masses_kg: &'a [f64],
    pub springs: &'a [PiecewiseLinear],
    pub dampers: &'a [PiecewiseLinear],
}

/// One step: series about its start, valid for `length_s`.
pub(crate) struct ChainStep {
    pub start_s: f64,
    pub length_s: f64,
    /// Displacement of every mass, then of the base.
    pub x: Vec<Series>,
    /// Power of the dampers and of the drive, W.
    pub heat: Series,
    pub work: Series,
}

/// Input of one step: value and slope at its start.
#[derive(Clone, Copy, Default)]
struct Input {
    force: Option<usize>,
    value: f64,
    slope: f64,
}

/// Series of one step: displacements and velocities of the masses and the base, and what follows from them.
struct Expansion {
    x: Vec<Series>,
    v: Vec<Series>,
    /// Compression and rate of every element: the coordinates of its spring and damper.
    coordinates: Vec<Series>,
    /// Force in every element.
    force: Vec<Series>,
}

/// Value and derivative of a polynomial.
pub(crate) fn horner(series: &Series, tau: f64) -> (f64, f64) {
    let (mut value, mut rate) = (0.0, 0.0);
    for k in (0..=ORDER).rev() {
        rate = rate * tau + value;
        value = value * tau + series[k];
    }
    (value, rate)
}

/// `integral from 0 to tau`.
pub(crate) fn integral(series: &Series, tau: f64) -> f64 {
    (0..=ORDER).rev().fold(0.0, |sum, k| sum * tau + series[k] / (k + 1) as f64) * tau
}

/// Coefficient `k` of the product of two series.
fn product(a: &Series, b: &Series, k: usize) -> f64 {
    (0..=k).map(|i| a[i] * b[k - i]).sum()
}

impl ChainMotion<'_> {
    /// Walks from the start to `end_s`; `visit` returns whether to go on.
    ///
    /// Between knots every force is a polynomial of degree two in the state, so the Taylor coefficients follow by
    /// recurrence. A step of order 16 is as long as its rest allows and ends where a compression or a rate meets a knot
    /// (Newton's method on the series) and at every sample of the drive; so no step contains a kink. Forces are
    /// continuous at a knot: which side a coordinate enters is asked of the series itself.
    pub fn walk(
        &self,
        drive: &Drive,
        dt_s: f64,
        end_s: f64,
        mut visit: impl FnMut(&ChainStep) -> bool,
    ) -> Result<(), LumpedError> {
        let n = self.masses_kg.len();
        let laws: Vec<Vec<Region>> =
            self.springs.iter().zip(self.dampers).flat_map(|(k, c)| [k.regions(), c.regions()]).collect();
        let source = drive.source();
        let at = |k: usize| source.get(k).copied().unwrap_or(0.0);
        let (mut x, mut v) = (vec![0.0; n + 1], vec![drive.speed_m_per_s(); n + 1]);
        v[n] = 0.0;
        let mut places: Vec<usize> = coordinates(&x, &v)
            .zip(&laws)
            .map(|(q, law)| law.partition_point(|region| region.high < q).min(law.len() - 1))
            .collect();
        let (mut t, mut segment) = (0.0, 0);
        for _ in 0..MAX_STEPS {
            if t >= end_s {
                return Ok(());
            }
            let driven = segment < source.len();
            let until = if driven { end_s.min((segment + 1) as f64 * dt_s) } else { end_s };
            let slope = (at(segment + 1) - at(segment)) / dt_s;
            let since = t - segment as f64 * dt_s;
            let force = drive.force().map(|(mass, _)| mass);
            let input =
                if driven { Input { force, value: at(segment) + slope * since, slope } } else { Input::default() };

            let size = largest(&x).max(1e-3 * largest(&v)).max(NOTHING_M);
            let mut tries = 0;
            let (expansion, reach, near) = loop {
                let expansion = self.expand(&x, &v, &laws, &places, input);
                let reach = longest(&expansion.x, size).min(until - t);
                let near = tolerances(&x, &v, reach);
                let wrong = (0..2 * n).find_map(|c| {
                    let region = laws[c][places[c]];
                    let (now, soon) =
                        (expansion.coordinates[c][0], horner(&expansion.coordinates[c], reach * INSIDE).0);
                    if now <= region.low + near[c % 2] && soon < region.low - near[c % 2] {
                        Some((c, places[c].checked_sub(1)?))
                    } else if now >= region.high - near[c % 2] && soon > region.high + near[c % 2] {
                        Some((c, places[c] + 1)).filter(|(c, place)| *place < laws[*c].len())
                    } else {
                        None
                    }
                });
                tries += 1;
                match wrong {
                    // Each piece can move the motion onto another; more changes than there are coordinates decide
                    // nothing.
                    Some((c, place)) if tries <= 4 * n + 4 => places[c] = place,
                    _ => break (expansion, reach, near),
                }
            };
            if !expansion.x.iter().chain(&expansion.force).all(|s| s.iter().all(|q| q.is_finite())) {
                return Err(LumpedError::ChainDiverges { time_s: t });
            }
            let exit = first_exit(&expansion.coordinates, &laws, &places, reach, near);
            let length_s = exit.map_or(reach, |(tau, ..)| tau);
            let step = self.step(expansion, t, length_s, &laws, &places, input);
            if !visit(&step) {
                return Ok(());
            }
            if let Some((_, c, place)) = exit {
                places[c] = place;
            }
            for (i, series) in step.x.iter().enumerate() {
                (x[i], v[i]) = horner(series, length_s);
            }
            if exit.is_none() && t + length_s >= until * (1.0 - f64::EPSILON) {
                t = until;
            } else {
                t += length_s;
            }
            if driven && t >= (segment + 1) as f64 * dt_s {
                segment += 1;
            }
        }
        Err(LumpedError::ChainDiverges { time_s: t })
    }

    /// The Taylor coefficients: `x[k+1] = v[k]/(k+1)`, `v[k+1] = a[k]/(k+1)`, products by convolution.
    ///
    /// `x0, v0`: state of the masses and, last, of the base; `places`: the piece each coordinate is on. Some
    /// `(2 N) ORDER²` products.
    fn expand(&self, x0: &[f64], v0: &[f64], laws: &[Vec<Region>], places: &[usize], input: Input) -> Expansion {
        let n = self.masses_kg.len();
        let mut e = Expansion {
            x: vec![[0.0; ORDER + 1]; n + 1],
            v: vec![[0.0; ORDER + 1]; n + 1],
            coordinates: vec![[0.0; ORDER + 1]; 2 * n],
            force: vec![[0.0; ORDER + 1]; n],
        };
        for i in 0..=n {
            (e.x[i][0], e.v[i][0]) = (x0[i], v0[i]);
        }
        for k in 0..=ORDER {
            for i in 0..n {
                let front = if i == 0 { n } else { i - 1 };
                e.coordinates[2 * i][k] = e.x[i][k] - e.x[front][k];
                e.coordinates[2 * i + 1][k] = e.v[i][k] - e.v[front][k];
                e.force[i][k] = [2 * i, 2 * i + 1]
                    .map(|c| {
                        let (q, law) = (&e.coordinates[c], laws[c][places[c]]);
                        let square = if law.slope == 0.0 { 0.0 } else { law.slope * product(q, q, k) };
                        law.constant * q[k] + square
                    })
                    .iter()
                    .sum();
            }
            if k == ORDER {
                break;
            }
            let drive = [input.value, input.slope].get(k).copied().unwrap_or(0.0);
            let factor = 1.0 / (k + 1) as f64;
            for i in 0..=n {
                let acceleration = if i == n {
                    if input.force.is_none() { drive } else { 0.0 }
                } else {
                    let behind = e.force.get(i + 1).map_or(0.0, |force| force[k]);
                    let pushed = if input.force == Some(i) { drive } else { 0.0 };
                    (behind - e.force[i][k] + pushed) / self.masses_kg[i]
                };
                e.x[i][k + 1] = e.v[i][k] * factor;
                e.v[i][k + 1] = acceleration * factor;
            }
        }
        e
    }

    /// The step with its powers: `c(w) w²` of every damper, and force times velocity where the drive acts.
    fn step(
        &self,
        expansion: Expansion,
        start_s: f64,
        length_s: f64,
        laws: &[Vec<Region>],
        places: &[usize],
        input: Input,
    ) -> ChainStep {
        let n = self.masses_kg.len();
        let mut heat = [0.0; ORDER + 1];
        for i in 0..n {
            let (w, law) = (&expansion.coordinates[2 * i + 1], laws[2 * i + 1][places[2 * i + 1]]);
            let square: Series = std::array::from_fn(|k| product(w, w, k));
            for (k, power) in heat.iter_mut().enumerate() {
                *power += law.constant * square[k] + law.slope * product(w, &square, k);
            }
        }
        let work = std::array::from_fn(|k| match input.force {
            Some(mass) => {
                input.value * expansion.v[mass][k] + if k == 0 { 0.0 } else { input.slope * expansion.v[mass][k - 1] }
            }
            // The barrier pushes with the force of the first element.
            None => -product(&expansion.force[0], &expansion.v[n], k),
        });
        ChainStep { start_s, length_s, x: expansion.x, heat, work }
    }
}

/// Compression and rate of every element.
fn coordinates<'a>(x: &'a [f64], v: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    let n = x.len() - 1;
    (0..n).flat_map(move |i| {
        let front = if i == 0 { n } else { i - 1 };
        [x[i] - x[front], v[i] - v[front]]
    })
}

/// How near a compression and a rate are to a knot to be on it.
fn tolerances(x: &[f64], v: &[f64], step_s: f64) -> [f64; 2] {
    let (x, v) = (largest(x), largest(v));
    [ON_A_KNOT * (x + v * step_s), ON_A_KNOT * (v + NOTHING_M / step_s)]
}

/// Largest modulus.
fn largest(q: &[f64]) -> f64 {
    q.iter().fold(0.0, |m, q| m.max(q.abs()))
}

/// The step after which the last terms of the series are `REST` of the motion.
fn longest(x: &[Series], size: f64) -> f64 {
    let bound = |k: usize| {
        let term = x.iter().fold(f64::MIN_POSITIVE, |m, series| m.max(series[k].abs()));
        (size * REST / term).powf(1.0 / k as f64)
    };
    bound(ORDER).min(bound(ORDER - 1)).max(1e-12)
}

/// Where a coordinate first leaves its piece: the time, the coordinate and the piece it enters.
///
/// `None` if every coordinate stays on its piece for `length` seconds. `near` are the tolerances of compressions and
/// rates.
fn first_exit(
    coordinates: &[Series],
    laws: &[Vec<Region>],
    places: &[usize],
    length: f64,
    near: [f64; 2],
) -> Option<(f64, usize, usize)> {
    let mut exit = None;
    let mut first = length;
    for (c, series) in coordinates.iter().enumerate() {
        let region = laws[c][places[c]];
        // Farthest it can go in the step: most steps meet no knot, and this tells at once.
        let reach = series[1..].iter().rev().fold(0.0, |sum, q| (sum + q.abs()) * length);
        for (knot, side, next) in
            [(region.low, 1.0, places[c].wrapping_sub(1)), (region.high, -1.0, places[c].wrapping_add(1))]
        {
            if !knot.is_finite() {
                continue;
            }
            // Distance inside the piece, and its rate.
            let distance = |tau: f64| {
                let (q, rate) = horner(series, tau);
                (side * (q - knot), side * rate)
            };
            let now = side * (series[0] - knot);
            if now > reach {
                continue;
            }
            // Looked for on eight points, so that one out and back within the step is seen. On a knot the motion was
            // found to go inwards.
            let mut low = if now > near[c % 2] { 0.0 } else { length * INSIDE };
            let mut high = None;
            for part in 1..=8 {
                let tau = first * f64::from(part) / 8.0;
                if tau <= low {
                    continue;
                }
                if distance(tau).0 < 0.0 {
                    high = Some(tau);
                    break;
                }
                low = tau;
            }
            let Some(high) = high else { continue };
            let tau = falling_zero(low, high, distance);
            (first, exit) = (tau, Some((tau, c, next)));
        }
    }
    exit
}
