//! Linear motions of any structure with their derivatives by the parameters.
//!
//! Every motion here is `z' = A z` from a start, marched by `phi = exp(A dt)` from sample to sample. A derivative by a
//! parameter p, `s = dz/dp`, obeys `s' = A s + (dA/dp) z`, so it is marched by the same step and the derivative of it:
//! `s(t + dt) = phi s(t) + (dphi/dp) z(t)`. Both `phi` and `dphi/dp` come from one pass of scaling, Taylor series and
//! squaring, each operation differentiated by the product rule: no finite differences, and no step error that depends
//! on the sampling interval.
//!
//! Error: that of the exponential, about `1e-16 2^s` with `s = log2(2 |A| dt)` squarings, and one rounding a sample.
//! Cost of a sample with P parameters and N states: `(2 P + 1) N²` products for the step and as many for the rates.

use nalgebra::allocator::Allocator;
use nalgebra::{Const, DefaultAllocator, Dim, Dyn, OMatrix, OVector, U1};

use crate::exact::linear_system::LinearSystem;
use crate::motion::mass_motion::Waves;
use crate::structure::connected_masses::Place;
use crate::{Instants, Motion, Sensitivity, Start};

/// Taylor terms after scaling to a norm of 1/2: the rest of the series is below `0.5^17/17! = 3e-20`, and of its
/// derivative below `0.5^16/16! = 8e-19`.
const TERMS: usize = 16;

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
    /// Its derivatives by the parameters asked for.
    da: Vec<Square<D>>,
    /// The state at the start.
    pub start: OVector<f64, D>,
    /// Its derivatives by the parameters asked for.
    start_by: Vec<OVector<f64, D>>,
}

/// The motion at these instants after an impact, with its derivatives by the parameters at `places`.
pub(crate) fn sensitivity(system: &LinearSystem, start: &Start, at: &Instants, places: &[Place]) -> Sensitivity {
    match system.states {
        2 => LinearMotion::new(Const::<2>, system, places, start).sensitivity(at),
        3 => LinearMotion::new(Const::<3>, system, places, start).sensitivity(at),
        4 => LinearMotion::new(Const::<4>, system, places, start).sensitivity(at),
        6 => LinearMotion::new(Const::<6>, system, places, start).sensitivity(at),
        n => LinearMotion::new(Dyn(n), system, places, start).sensitivity(at),
    }
}

impl<D: Dim> LinearMotion<D>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    /// `size`: number of states of the system.
    pub fn new(size: D, system: &LinearSystem, places: &[Place], start: &Start) -> Self {
        let (masses, tau_s) = (system.masses, system.time_unit_s());
        let zeros = || Square::<D>::zeros_generic(size, size);
        let mut a = zeros();
        // What the barrier does would stand in the columns beyond: it rests.
        system.entries(tau_s, &mut |row, column, value| {
            if column < system.states {
                a[(row, column)] += value;
            }
        });
        let derivative_by = |place: &Place| {
            let mut derivative = zeros();
            system.entries_by(*place, tau_s, &mut |row, column, value| {
                if column < system.states {
                    derivative[(row, column)] += value;
                }
            });
            derivative
        };
        let da = places.iter().map(derivative_by).collect();
        let state = |of_mass: &dyn Fn(usize) -> [f64; 2]| {
            let mut state = OVector::<f64, D>::zeros_generic(size, U1);
            for mass in 0..masses {
                let [x, v] = of_mass(mass);
                (state[mass], state[masses + mass]) = (x, v * tau_s);
            }
            state
        };
        let start_by = places.iter().map(|place| state(&|mass| place.of_start(mass))).collect();
        Self { masses, tau_s, a, da, start: state(&|mass| start.of_mass(mass)), start_by }
    }

    /// `exp(A t)` and its derivatives, `t` in s: scaling, Taylor series, squaring, each step differentiated.
    pub fn exponential(&self, t_s: f64) -> (Square<D>, Vec<Square<D>>) {
        let (size, _) = self.a.shape_generic();
        let t = t_s / self.tau_s;
        let norm = self.a.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max) * t.abs();
        // Beyond 2^60 the result is zero or infinite anyway.
        let squarings = if norm > 0.5 { ((2.0 * norm).log2().ceil() as i32).clamp(0, 60) } else { 0 };
        let h = t * 0.5_f64.powi(squarings);
        let x = &self.a * h;
        let dx: Vec<_> = self.da.iter().map(|d| d * h).collect();
        let mut phi = Square::<D>::identity_generic(size, size) + &x;
        let mut derivatives = dx.clone();
        let (mut term, mut dterm) = (x.clone(), dx.clone());
        for k in 2..=TERMS {
            let factor = 1.0 / k as f64;
            for (dt, d) in dterm.iter_mut().zip(&dx) {
                *dt = (&*dt * &x + &term * d) * factor;
            }
            term = &term * &x * factor;
            phi += &term;
            for (sum, dt) in derivatives.iter_mut().zip(&dterm) {
                *sum += dt;
            }
        }
        for _ in 0..squarings {
            for d in &mut derivatives {
                *d = &phi * &*d + &*d * &phi;
            }
            phi = &phi * &phi;
        }
        (phi, derivatives)
    }

    /// Marches over the instants; a sensitivity goes `s(t+dt) = phi s + dphi z`.
    ///
    /// The first instant is reached by one step of its own; rates come from `A z` and `A s + dA z`, not from
    /// differences.
    pub fn sensitivity(&self, at: &Instants) -> Sensitivity {
        let parameters = self.da.len();
        if parameters == 0 {
            return Sensitivity { motions: self.march(at), derivatives: Vec::new() };
        }
        let zero_state = || OVector::<f64, D>::zeros_generic(self.a.shape_generic().0, U1);
        let (mut z, mut s) = (self.start.clone(), self.start_by.clone());
        if at.first_s > 0.0 {
            let (phi, derivatives) = self.exponential(at.first_s);
            s = derivatives.iter().zip(&s).map(|(d, s)| &phi * s + d * &z).collect();
            z = phi * z;
        }
        let (phi, derivatives) = self.exponential(at.dt_s);
        let empty = || vec![Motion::zeros(at.samples, Waves::All); self.masses];
        let mut sensitivity = Sensitivity { motions: empty(), derivatives: (0..parameters).map(|_| empty()).collect() };
        let (n, per_tau) = (self.masses, self.tau_s.recip());
        let fill = |motions: &mut [Motion], k: usize, z: &OVector<f64, D>, rate: &OVector<f64, D>| {
            for (i, motion) in motions.iter_mut().enumerate() {
                motion.displacement_m[k] = z[i];
                motion.velocity_m_per_s[k] = z[n + i] * per_tau;
                motion.acceleration_m_per_s2[k] = rate[n + i] * per_tau * per_tau;
            }
        };
        let (mut rate, mut moved) = (zero_state(), zero_state());
        for k in 0..at.samples {
            rate.gemv(1.0, &self.a, &z, 0.0);
            fill(&mut sensitivity.motions, k, &z, &rate);
            for j in 0..parameters {
                rate.gemv(1.0, &self.a, &s[j], 0.0);
                rate.gemv(1.0, &self.da[j], &z, 1.0);
                fill(&mut sensitivity.derivatives[j], k, &s[j], &rate);
                moved.gemv(1.0, &phi, &s[j], 0.0);
                moved.gemv(1.0, &derivatives[j], &z, 1.0);
                s[j].copy_from(&moved);
            }
            moved.gemv(1.0, &phi, &z, 0.0);
            z.copy_from(&moved);
        }
        sensitivity
    }

    /// The motion alone. Even and odd instants by steps of twice the interval, side by side: one row of products that
    /// each wait for the one before leaves the processor idle.
    fn march(&self, at: &Instants) -> Vec<Motion> {
        let mut motions = vec![Motion::zeros(at.samples, Waves::All); self.masses];
        let (n, per_tau) = (self.masses, self.tau_s.recip());
        let start = if at.first_s > 0.0 { self.exponential(at.first_s).0 * &self.start } else { self.start.clone() };
        let (phi, _) = self.exponential(at.dt_s);
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
