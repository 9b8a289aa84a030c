//! Where a step leaves the branches it was made on.
//!
//! Which branches hold from an event on is asked of the series: a guard that is zero at the start must become positive
//! first, or its branch ends there and the series is made again. A guard closer to zero than [`ON_A_GUARD`] of the
//! motion counts as zero, because a difference of two displacements is no better known.

use crate::exact::falling_zero::falling_zero;
use crate::series::step::{LinkSeries, NOTHING_M, ORDER, Series, Step, horner, largest, value, values};
use crate::series::zeros::{PARTS, turns};
use crate::structure::form::{Form, Strain};
use crate::structure::law::Guard;

/// Share of a step within which a guard that is zero at its start must become positive.
const INSIDE: f64 = 1.0 / 16.0;
/// That share is looked at from its four-thousandth on, each time four times as far: what comes back within it counts.
const LOOKS: i32 = 6;
/// A guard is zero if it is nearer than this, relative to the motion: rounding of a difference of displacements.
const ON_A_GUARD: f64 = 1e-13;

/// A guard with the element it belongs to.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LinkGuard {
    pub link: usize,
    pub guard: Guard,
}

/// How near to zero a compression and a rate are nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tolerance {
    u: f64,
    w: f64,
}

impl Tolerance {
    /// That of a step of this length.
    pub fn of_step(step: &Step, length_s: f64) -> Self {
        let (x, v) =
            (largest(step.nodes.iter().map(|node| node.x[0])), largest(step.nodes.iter().map(|node| node.v[0])));
        Self { u: ON_A_GUARD * (x + v * length_s), w: ON_A_GUARD * (v + NOTHING_M / length_s) }
    }

    /// That of a form.
    fn of_form(&self, form: &Form, link: &LinkSeries) -> f64 {
        let (u, w) = (link.u[0].abs(), link.w[0].abs());
        (form.u.abs() + 2.0 * form.uu.abs() * u + form.uw.abs() * w) * self.u
            + (form.w.abs() + 2.0 * form.ww.abs() * w + form.uw.abs() * u) * self.w
    }
}

/// Farthest that a series gets from its start, with the powers of the length of the step from the first on. In four
/// sums that need not wait for each other.
fn reach(series: &Series, powers: &[f64; ORDER]) -> f64 {
    let mut sums = [0.0; 4];
    for (terms, powers) in series[1..].chunks_exact(4).zip(powers.chunks_exact(4)) {
        for lane in 0..4 {
            sums[lane] += terms[lane].abs() * powers[lane];
        }
    }
    sums.iter().sum()
}

/// What an element feels at the start of a step.
fn now(link: &LinkSeries) -> Strain {
    Strain { u: link.u[0], w: link.w[0], z: link.z[0] }
}

/// The first guard that is zero at the start and falls below.
pub(crate) fn ends_at_once(step: &Step, guards: &[LinkGuard], reach_s: f64, near: Tolerance) -> Option<LinkGuard> {
    let falls = |guard: &&LinkGuard| {
        let (form, link) = (&guard.guard.form, &step.links[guard.link]);
        let near = near.of_form(form, link);
        form.at(now(link)) <= near && leaves_zero(form, link, reach_s, near).1 < -near
    };
    guards.iter().find(falls).copied()
}

/// Where a form that is zero at the start is something first, and what.
fn leaves_zero(form: &Form, link: &LinkSeries, reach_s: f64, near: f64) -> (f64, f64) {
    let look = |k: i32| {
        let tau = reach_s * INSIDE * 0.25_f64.powi(k);
        (tau, form.at(link.strain(tau)))
    };
    (1..=LOOKS).rev().map(look).find(|(_, value)| value.abs() > near).unwrap_or_else(|| look(0))
}

/// Where a guard first falls through zero within `length` seconds: the instant and the guard. `None` if all stay
/// positive.
pub(crate) fn first_exit(step: &Step, guards: &[LinkGuard], length: f64, near: Tolerance) -> Option<(f64, LinkGuard)> {
    let mut exit = None;
    let mut first = length;
    let mut power = 1.0;
    let powers: [f64; ORDER] = std::array::from_fn(|_| {
        power *= length;
        power
    });
    let mut farthest = (usize::MAX, (0.0, 0.0));
    for guard in guards {
        let (form, link) = (&guard.guard.form, &step.links[guard.link]);
        // Farthest the element can go in the step: most steps meet no guard, and this tells at once.
        if farthest.0 != guard.link {
            farthest = (guard.link, (reach(&link.u, &powers), reach(&link.w, &powers)));
        }
        let (u, w) = farthest.1;
        let (start, is_straight) =
            (form.at(now(link)), form.z == 0.0 && form.uu == 0.0 && form.ww == 0.0 && form.uw == 0.0);
        if is_straight && start > form.u.abs() * u + form.w.abs() * w {
            continue;
        }
        let series = link.series(form);
        // On a guard the motion was found to go inwards; it may be back soon.
        let near = near.of_form(form, link);
        let from = match length * INSIDE {
            _ if start > near => 0.0,
            inside if value(&series, inside) > 0.0 => inside,
            _ => leaves_zero(form, link, length, near).0,
        };
        let parts: [f64; PARTS] = std::array::from_fn(|part| first * (part + 1) as f64 / PARTS as f64);
        let is_beyond = values(&series, &parts).map(|distance| distance < 0.0);
        let part = (0..PARTS).find(|part| parts[*part] > from && is_beyond[*part]);
        let beyond = part.map(|part| (parts[..part].last().copied().unwrap_or(0.0).max(from), parts[part]));
        // Out and back between two looks.
        let mut dip = None;
        turns(&series, from, &parts, part.unwrap_or(PARTS), |low, bottom, is_lowest| {
            if is_lowest && dip.is_none() && value(&series, bottom) < -near {
                dip = Some((low, bottom));
            }
        });
        let Some((low, high)) = dip.or(beyond) else { continue };
        first = falling_zero(low, high, |tau| horner(&series, tau));
        exit = Some((first, *guard));
    }
    exit
}
