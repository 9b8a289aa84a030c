//! Linear motions of any structure with their derivatives by the parameters.
//!
//! Every motion here is `z' = A z` from a start, marched by `phi = exp(A dt)` from sample to sample. A derivative by a
//! parameter p, `s = dz/dp`, obeys `s' = A s + (dA/dp) z`, so it is marched by the same step and the derivative of it:
//! `s(t + dt) = phi s(t) + (dphi/dp) z(t)` ([`derivatives`](crate::exact::derivatives)).
//!
//! Error: that of the exponential, about `1e-16 2^s` with `s = log2(2 |A| dt)` squarings, and one rounding a sample.
//! Cost of a sample with P parameters and N states: `(2 P + 1) N²` products for the step and half as many for
//! accelerations.

use nalgebra::allocator::Allocator;
use nalgebra::{Const, DefaultAllocator, Dim, Dyn, OMatrix, OVector, U1};
use pulp::Arch;

use crate::exact::derivatives::{ABREAST, DerivativesAbreast};
use crate::exact::linear_system::LinearSystem;
use crate::exact::scaling::{TERMS, squarings_of};
use crate::motion::mass_motion::Waves;
use crate::structure::connected_masses::Place;
use crate::{Instants, Motion, Sensitivity, Start};

type Square<D> = OMatrix<f64, D, D>;

/// `z' = A z` in a time unit in which the fastest swing is of size one: state `(x, tau v, z)`, time in `tau`.
///
/// Unbalanced, the exponential of a car (stiffness over mass near 1e3/s²) loses three digits. Sizes of the usual
/// models are known to the compiler: a fit marches millions of steps of a few products.
pub(crate) struct LinearMotion<D: Dim>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    pub masses: usize,
    pub tau_s: f64,
    /// The matrix in the time unit.
    pub a: Square<D>,
    /// The state at the start.
    pub start: OVector<f64, D>,
}

/// The motion at these instants after an impact, with its derivatives by the parameters at `places`. Waves that are not
/// asked for may stay empty.
pub(crate) fn sensitivity(
    system: &LinearSystem,
    start: &Start,
    at: &Instants,
    waves: Waves,
    places: &[Place],
) -> Sensitivity {
    if places.is_empty() {
        let motions = match system.states {
            2 => LinearMotion::new(Const::<2>, system, start).march(at),
            3 => LinearMotion::new(Const::<3>, system, start).march(at),
            4 => LinearMotion::new(Const::<4>, system, start).march(at),
            6 => LinearMotion::new(Const::<6>, system, start).march(at),
            n => LinearMotion::new(Dyn(n), system, start).march(at),
        };
        return Sensitivity { motions, derivatives: Vec::new() };
    }
    let (n, tau_s, arch) = (system.states, system.time_unit_s(), Arch::new());
    let motion = LinearMotion::new(Dyn(n), system, start);
    let a = motion.a.transpose();
    let mut sensitivity = Sensitivity { motions: Vec::new(), derivatives: Vec::with_capacity(places.len()) };
    for places in places.chunks(ABREAST) {
        let (mut da, mut start_by) = (vec![[0.0; ABREAST]; n * n], vec![[0.0; ABREAST]; n]);
        for (lane, place) in places.iter().enumerate() {
            system.entries_by(*place, tau_s, &mut |row, column, value| {
                if column < n {
                    da[row * n + column][lane] += value;
                }
            });
            let state = state_of(system, tau_s, &|mass| place.of_start(mass));
            start_by.iter_mut().zip(state).for_each(|(lanes, value)| lanes[lane] = value);
        }
        let (a, start) = (a.as_slice(), motion.start.as_slice());
        let (masses, filled, da, start_by) = (system.masses, places.len(), &*da, &*start_by);
        let abreast = DerivativesAbreast { masses, tau_s, a, da, start, start_by, filled, at, waves };
        let (motions, derivatives) = arch.dispatch(abreast);
        sensitivity.motions = motions;
        sensitivity.derivatives.extend(derivatives);
    }
    sensitivity
}

/// The state of masses that are at `[x, v]`.
fn state_of(system: &LinearSystem, tau_s: f64, of_mass: &dyn Fn(usize) -> [f64; 2]) -> Vec<f64> {
    let mut state = vec![0.0; system.states];
    for mass in 0..system.masses {
        let [x, v] = of_mass(mass);
        (state[mass], state[system.masses + mass]) = (x, v * tau_s);
    }
    state
}

impl<D: Dim> LinearMotion<D>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    /// `size`: number of states of the system.
    pub fn new(size: D, system: &LinearSystem, start: &Start) -> Self {
        let (masses, tau_s) = (system.masses, system.time_unit_s());
        let mut a = Square::<D>::zeros_generic(size, size);
        // What the barrier does would stand in the columns beyond: it rests.
        system.entries(tau_s, &mut |row, column, value| {
            if column < system.states {
                a[(row, column)] += value;
            }
        });
        let start =
            OVector::<f64, D>::from_iterator_generic(size, U1, state_of(system, tau_s, &|mass| start.of_mass(mass)));
        Self { masses, tau_s, a, start }
    }

    /// `exp(A t)`, `t` in s: scaling, Taylor series, squaring.
    pub fn exponential(&self, t_s: f64) -> Square<D> {
        let (size, _) = self.a.shape_generic();
        let t = t_s / self.tau_s;
        let squarings = squarings_of(self.a.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max) * t.abs());
        let x = &self.a * (t * 0.5_f64.powi(squarings));
        let mut phi = Square::<D>::identity_generic(size, size) + &x;
        let mut term = x.clone();
        for k in 2..=TERMS {
            term = &term * &x * (1.0 / k as f64);
            phi += &term;
        }
        for _ in 0..squarings {
            phi = &phi * &phi;
        }
        phi
    }

    /// The motion alone. Even and odd instants by steps of twice the interval, side by side: one row of products that
    /// each wait for the one before leaves the processor idle.
    fn march(&self, at: &Instants) -> Vec<Motion> {
        let mut motions = vec![Motion::zeros(at.samples, Waves::All); self.masses];
        let (n, per_tau) = (self.masses, self.tau_s.recip());
        let start = if at.first_s > 0.0 { self.exponential(at.first_s) * &self.start } else { self.start.clone() };
        let phi = self.exponential(at.dt_s);
        let twice = &phi * &phi;
        let mut states = [start.clone(), &phi * start];
        for k in (0..at.samples).step_by(2) {
            for (odd, z) in states.iter_mut().enumerate().take(at.samples - k) {
                let rate = &self.a * &*z;
                for (i, motion) in motions.iter_mut().enumerate() {
                    motion.displacement_m[k + odd] = z[i];
                    motion.velocity_m_per_s[k + odd] = z[n + i] * per_tau;
                    motion.acceleration_m_per_s2[k + odd] = rate[n + i] * per_tau * per_tau;
                }
                *z = &twice * &*z;
            }
        }
        motions
    }
}
