//! The elastoplastic model under a force or on a moving barrier, event by event.
//!
//! A small machine of three branches ([`Branch`]) and two numbers, the permanent set and the depth of the unloading
//! line. On a branch the motion is that of a forced oscillator, in closed form ([`cosine_integrals`]); the machine only
//! has to find the instants at which the branch changes.

use crate::error::{finite, positive};
use crate::exact::falling_zero::falling_zero;
use crate::exact::stumpff::cosine_integrals;
use crate::{Drive, Dynamics, Elastoplastic, ElementForce, Energy, LumpedError, ModelKind, Motion, Response, State};

/// Pieces after which the motion is given up, beside one a sample.
const MAX_PIECES: usize = 200_000;
/// Part of a sampling interval below which a zero of the acceleration is the start itself.
const AT_ONCE: f64 = 1e-12;

/// Which line of the force the mass is on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Branch {
    /// Farther in than ever, along `k_E`.
    Loading,
    /// Out and in again along `k_P`, up to the largest crush so far.
    Unloading,
    /// Off the structure, without force.
    Open,
}

/// The mass and the structure at one instant.
#[derive(Debug, Clone, Copy)]
struct Contact {
    branch: Branch,
    /// Crush beyond the place without force: zero while loading, the permanent set otherwise.
    y: f64,
    /// Its rate.
    v: f64,
    set: f64,
    /// `d_e`, the depth of the unloading line: from the permanent set to the largest crush.
    depth: f64,
}

/// What moves the mass against the barrier in one interval, per unit of mass: value and slope.
#[derive(Debug, Clone, Copy)]
struct Push {
    value: f64,
    slope: f64,
}

/// `y` after `tau`, and its rate: `y'' + w² y = push`.
///
/// `s` are the integrals of the cosine for `w²` and `tau`, see [`cosine_integrals`]; `push` per unit of mass.
fn moved(y: f64, v: f64, w2: f64, push: Push, s: &[f64; 7]) -> (f64, f64) {
    (
        y * s[0] + v * s[1] + push.value * s[2] + push.slope * s[3],
        v * s[0] - w2 * y * s[1] + push.value * s[1] + push.slope * s[2],
    )
}

impl Elastoplastic {
    /// Motion, force and energy at `k dt` under any drive.
    ///
    /// The crush `q` is that against the barrier. Beyond the largest crush so far the force is `k_E q`; from there the
    /// mass goes out, and in again, along `k_P` about the permanent set `q_max (1 - k_E/k_P)` until it passes that
    /// crush. With `release` nothing holds it below the permanent set, and it meets the structure there again; without,
    /// the line goes on into tension. This is what the paper's law for one loading and one unloading says when a force
    /// continues it: no hardening but by crush, no softening by repetition.
    ///
    /// A force or acceleration linear between samples leaves cosines on each line. Its acceleration is one sine wave,
    /// whose zeros are known; between them the velocity has one sign change at most, and between those the crush passes
    /// each limit once at most: so no reversal, release or contact inside a sample is missed. Instants by Newton's
    /// method to rounding; the motion to about `1e-16` of its largest a piece. Work of the drive by the exact integral
    /// of force times velocity.
    ///
    /// Errors: a step or drive that is not finite, a mass that is not there, a motion that cannot be followed.
    pub(crate) fn driven(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<Dynamics, LumpedError> {
        positive("dt_s", dt_s)?;
        let speed = finite("impact_speed_m_per_s", drive.speed_m_per_s()).map(|()| drive.speed_m_per_s())?;
        if let Some((index, _)) = drive.force().filter(|(index, _)| *index > 0) {
            return Err(LumpedError::Value { name: "mass", value: index as f64, expected: "0: there is one mass" });
        }
        let (mass, of_base) = (self.mass_kg, drive.base().is_some());
        let source = drive.source();
        let at = |k: usize| source.get(k).copied().unwrap_or(0.0);
        let mut contact = Contact { branch: Branch::Unloading, y: 0.0, v: speed, set: 0.0, depth: 0.0 };
        let mut base_rate = 0.0;
        // Seen from the ground; by the force alone, so that a mass that nothing touches stays at rest to the last
        // digit.
        let (mut from_ground, mut velocity) = (0.0, speed);
        let (mut work, mut pieces) = (0.0, 0);
        let mut motion = Motion::with_capacity(samples);
        let (mut force_n, mut deflection_m) = (Vec::with_capacity(samples), Vec::with_capacity(samples));
        let mut energy = Vec::with_capacity(samples);
        for k in 0..samples {
            let (now, slope) = (at(k), (at(k + 1) - at(k)) / dt_s);
            let per_mass = if of_base { -1.0 } else { 1.0 / mass };
            let mut push = Push { value: now * per_mass, slope: slope * per_mass };
            contact.settle(self, push);

            let force = self.stiffness(contact.branch) * contact.y;
            if !of_base {
                (from_ground, velocity) = (contact.set + contact.y, contact.v);
            }
            let state = State {
                displacement_m: from_ground,
                velocity_m_per_s: velocity,
                acceleration_m_per_s2: (if of_base { 0.0 } else { now } - force) / mass,
            };
            let crushed = if contact.branch == Branch::Loading { contact.y } else { contact.set + contact.depth };
            let (soft, stiff) = (self.loading_stiffness_n_per_m, self.unloading_stiffness_n_per_m);
            let instant = Energy {
                kinetic_j: 0.5 * mass * velocity * velocity,
                stored_j: 0.5 * force * force / stiff,
                dissipated_j: 0.5 * soft * crushed * crushed * (1.0 - soft / stiff),
                input_j: 0.5 * mass * speed * speed + work,
            };
            if !(state.displacement_m.is_finite()
                && state.acceleration_m_per_s2.is_finite()
                && instant.input_j.is_finite())
            {
                return Err(self.lost(k as f64 * dt_s));
            }
            motion.push(state);
            force_n.push(force);
            deflection_m.push(contact.set + contact.y);
            energy.push(instant);

            let mut left = dt_s;
            while left > 0.0 {
                pieces += 1;
                if pieces > MAX_PIECES + samples {
                    return Err(self.lost((k + 1) as f64 * dt_s - left));
                }
                let before = contact;
                let stiffness = self.stiffness(before.branch);
                let h = contact.advance(self, push, left, dt_s);
                let s = cosine_integrals(stiffness / mass, h);
                // Integral of y, and those of it.
                let [once, twice, thrice]: [f64; 3] = std::array::from_fn(|i| {
                    before.y * s[i + 1] + before.v * s[i + 2] + push.value * s[i + 3] + push.slope * s[i + 4]
                });
                let since = dt_s - left;
                if of_base {
                    // The barrier gives minus the force times its velocity, which is quadratic in time.
                    let a0 = now + slope * since;
                    let moments = [once, h * once - twice, h * (h * once - 2.0 * twice) + 2.0 * thrice];
                    work -= stiffness * (base_rate * moments[0] + a0 * moments[1] + 0.5 * slope * moments[2]);
                    base_rate += h * (a0 + 0.5 * h * slope);
                    from_ground += h * velocity - stiffness / mass * twice;
                    velocity -= stiffness / mass * once;
                } else {
                    let end = moved(before.y, before.v, stiffness / mass, push, &s).0;
                    work += (now + slope * since) * (end - before.y) + slope * (h * end - once);
                }
                push.value += push.slope * h;
                left -= h;
                contact.settle(self, push);
            }
        }
        let forces = vec![ElementForce { name: "k".to_owned(), force_n, deflection_m }];
        Ok(Dynamics { response: Response { dt_s, masses_kg: vec![mass], motions: vec![motion] }, forces, energy })
    }

    /// N/m; zero where nothing touches.
    fn stiffness(&self, branch: Branch) -> f64 {
        match branch {
            Branch::Loading => self.loading_stiffness_n_per_m,
            Branch::Unloading => self.unloading_stiffness_n_per_m,
            Branch::Open => 0.0,
        }
    }

    /// The error of a motion that cannot be followed beyond this time.
    fn lost(&self, time_s: f64) -> LumpedError {
        LumpedError::Diverges { model: ModelKind::Elastoplastic, time_s }
    }
}

impl Contact {
    /// The line the mass goes on along, where it stands on the border of two.
    fn settle(&mut self, model: &Elastoplastic, push: Push) {
        let a = push.value - model.stiffness(self.branch) / model.mass_kg * self.y;
        // The force is continuous, so the acceleration is the same on both lines.
        let rises = self.v > 0.0 || (self.v == 0.0 && (a > 0.0 || (a == 0.0 && push.slope > 0.0)));
        if self.branch == Branch::Loading {
            if !rises {
                let crush = self.y;
                self.depth = crush * (model.loading_stiffness_n_per_m / model.unloading_stiffness_n_per_m);
                (self.branch, self.set, self.y) = (Branch::Unloading, crush - self.depth, self.depth);
            }
            return;
        }
        if rises && self.y == self.depth {
            (self.branch, self.y, self.set) = (Branch::Loading, self.set + self.depth, 0.0);
        } else if self.y == 0.0 && model.release {
            self.branch = if rises { Branch::Unloading } else { Branch::Open };
        }
    }

    /// Moves on by `left` seconds or to the next event, whichever is first; returns how far.
    fn advance(&mut self, model: &Elastoplastic, push: Push, left: f64, dt_s: f64) -> f64 {
        let w2 = model.stiffness(self.branch) / model.mass_kg;
        let (y, v) = (self.y, self.v);
        let at = |tau: f64| moved(y, v, w2, push, &cosine_integrals(w2, tau));
        let rate = |tau: f64, y: f64| push.value + push.slope * tau - w2 * y;
        let mut h = left;
        if !(self.branch == Branch::Unloading && self.swings_free(model, push, w2, left)) {
            h = next_rest_of_acceleration(push.value - w2 * y, push.slope - w2 * v, w2, left, AT_ONCE * dt_s);
        }
        let (mut end, mut speed) = at(h);
        // The velocity rises or falls throughout: it changes its sign once at the most.
        if v * speed < 0.0 {
            let side = v.signum();
            h = falling_zero(0.0, h, |tau| {
                let (y, v) = at(tau);
                (side * v, side * rate(tau, y))
            });
            (end, speed) = (at(h).0, 0.0);
        }
        // And the crush goes one way throughout: it passes a limit once at the most.
        let limit = match self.branch {
            Branch::Loading => None,
            Branch::Unloading if end > self.depth && y < self.depth => Some((self.depth, 1.0)),
            Branch::Unloading if end < 0.0 && y > 0.0 && model.release => Some((0.0, -1.0)),
            Branch::Open if end > 0.0 && y < 0.0 => Some((0.0, 1.0)),
            Branch::Unloading | Branch::Open => None,
        };
        if let Some((limit, side)) = limit {
            h = falling_zero(0.0, h, |tau| {
                let (y, v) = at(tau);
                (side * (limit - y), -side * v)
            });
            (end, speed) = (limit, at(h).1);
        }
        (self.y, self.v) = (end, speed);
        h
    }

    /// Whether the swing on the unloading line stays off its ends for the whole interval: a stiff line may go through
    /// many periods.
    fn swings_free(&self, model: &Elastoplastic, push: Push, w2: f64, left: f64) -> bool {
        let swing = (push.value - w2 * self.y).hypot((push.slope - w2 * self.v) / w2.sqrt()) / w2;
        let middle = [push.value / w2, (push.value + push.slope * left) / w2];
        let slack = 1e-12 * (swing + self.depth);
        middle.iter().all(|m| m + swing + slack < self.depth && (!model.release || m - swing - slack > 0.0))
    }
}

/// When the acceleration, now `a` with the rate `j`, is zero next, later than `at_once` and up to `left`:
/// `a cos w t + j sin(w t)/w`.
fn next_rest_of_acceleration(a: f64, j: f64, w2: f64, left: f64, at_once: f64) -> f64 {
    let w = w2.sqrt();
    let zero = if w * left < 1e-8 {
        // A line within the interval.
        let zero = -a / j;
        if zero > at_once { zero } else { left }
    } else {
        let phase = (j / w).atan2(a) + std::f64::consts::FRAC_PI_2;
        let zero = phase.rem_euclid(std::f64::consts::PI) / w;
        if zero > at_once { zero } else { zero + std::f64::consts::PI / w }
    };
    zero.min(left)
}
