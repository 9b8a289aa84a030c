//! Linear motions of any number of masses with their derivatives by the parameters.
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

use crate::{Instants, Motion, Sensitivity};

/// Taylor terms after scaling to a norm of 1/2, as in `exact_step`.
const TERMS: usize = 16;

type Square<D> = OMatrix<f64, D, D>;

/// `z' = A z` in a time unit in which the fastest swing is of size one: state `(x, tau v, ...)`, time in `tau`.
///
/// Unbalanced, the exponential of a car (stiffness over mass near 1e3/s²) loses three digits. Sizes of the usual models
/// are known to the compiler: a fit marches millions of steps of a few products.
///
/// `tau_s` is the time unit, `a` the matrix in it, `da` its derivatives by the parameters asked for, `start` the state
/// at contact. Positions of the masses come first, then their velocities times `tau_s`.
struct LinearMotion<D: Dim>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    masses: usize,
    tau_s: f64,
    a: Square<D>,
    da: Vec<Square<D>>,
    start: OVector<f64, D>,
}

/// Masses in a row that meet the barrier at `v0`; parameters are the places in `masses, springs, dampers`.
///
/// Places count masses, then springs, then dampers, each from the barrier on. Chains of one, two and three masses have
/// their size as a constant; longer ones run the same code with a size known at run time.
pub(crate) fn chain(
    [masses_kg, springs, dampers]: [&[f64]; 3],
    parameters: &[usize],
    v0: f64,
    at: &Instants,
) -> Sensitivity {
    let values = [masses_kg, springs, dampers];
    match masses_kg.len() {
        1 => LinearMotion::chain(Const::<2>, values, parameters, v0).sensitivity(at),
        2 => LinearMotion::chain(Const::<4>, values, parameters, v0).sensitivity(at),
        3 => LinearMotion::chain(Const::<6>, values, parameters, v0).sensitivity(at),
        n => LinearMotion::chain(Dyn(2 * n), values, parameters, v0).sensitivity(at),
    }
}

/// One mass on spring and damper in series that meets the barrier at `v0`; parameters are the places in
/// `mass, spring, damper`.
pub(crate) fn maxwell(values: [f64; 3], parameters: &[usize], v0: f64, at: &Instants) -> Sensitivity {
    LinearMotion::maxwell(values, parameters, v0).sensitivity(at)
}

/// Time unit of these rates, 1/s².
///
/// The square root of the largest ratio of stiffness to mass is the fastest natural frequency to within a factor of
/// two; its reciprocal brings positions and scaled velocities to one size. One second where nothing is stiff.
fn time_unit(rates: impl Iterator<Item = f64>) -> f64 {
    let fastest = rates.map(f64::abs).fold(0.0, f64::max);
    if fastest > 0.0 && fastest.is_finite() { fastest.sqrt().recip() } else { 1.0 }
}

impl LinearMotion<Const<3>> {
    /// State `(x, tau v, tau² F/m)`.
    fn maxwell([mass_kg, spring, damper]: [f64; 3], parameters: &[usize], v0: f64) -> Self {
        let tau_s = time_unit([spring / mass_kg, (spring / damper).powi(2)].into_iter());
        let stiffness = spring * tau_s * tau_s / mass_kg;
        let decay = spring * tau_s / damper;
        let mut a = Square::<Const<3>>::zeros();
        a[(0, 1)] = 1.0;
        a[(1, 2)] = -1.0;
        a[(2, 1)] = stiffness;
        a[(2, 2)] = -decay;
        let derivative_by = |place: &usize| {
            let mut d = Square::<Const<3>>::zeros();
            (d[(2, 1)], d[(2, 2)]) = match place {
                0 => (-stiffness / mass_kg, 0.0),
                1 => (stiffness / spring, -decay / spring),
                _ => (0.0, decay / damper),
            };
            d
        };
        let da = parameters.iter().map(derivative_by).collect();
        Self { masses: 1, tau_s, a, da, start: [0.0, v0 * tau_s, 0.0].into() }
    }
}

impl<D: Dim> LinearMotion<D>
where
    DefaultAllocator: Allocator<D, D> + Allocator<D>,
{
    /// `size`: twice the number of masses.
    fn chain(size: D, [masses_kg, springs, dampers]: [&[f64]; 3], parameters: &[usize], v0: f64) -> Self {
        let n = masses_kg.len();
        let zeros = || Square::<D>::zeros_generic(size, size);
        let next = |of: &[f64], i: usize| of.get(i + 1).copied().unwrap_or(0.0);
        let tau_s = time_unit((0..n).map(|i| (springs[i] + next(springs, i)) / masses_kg[i]));
        let build = |springs: &[f64], dampers: &[f64], rows: bool| {
            let mut a = zeros();
            for i in 0..n {
                if rows {
                    a[(i, n + i)] = 1.0;
                }
                let (k, c) = (springs[i] * tau_s * tau_s, dampers[i] * tau_s);
                for (row, sign) in [(Some(i), -1.0), (i.checked_sub(1), 1.0)] {
                    let Some(row) = row else { continue };
                    let per_mass = sign / masses_kg[row];
                    a[(n + row, i)] += per_mass * k;
                    a[(n + row, n + i)] += per_mass * c;
                    if i > 0 {
                        a[(n + row, i - 1)] -= per_mass * k;
                        a[(n + row, n + i - 1)] -= per_mass * c;
                    }
                }
            }
            a
        };
        let a = build(springs, dampers, true);
        let unit_vector = |i: usize| -> Vec<f64> { (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect() };
        let zero_vector = vec![0.0; n];
        // A is linear in springs and dampers, and its rows are over the masses.
        let derivative_by = |&place: &usize| match place / n {
            0 => {
                let mut d = zeros();
                for column in 0..2 * n {
                    d[(n + place, column)] = a[(n + place, column)] / -masses_kg[place];
                }
                d
            }
            1 => build(&unit_vector(place - n), &zero_vector, false),
            _ => build(&zero_vector, &unit_vector(place - 2 * n), false),
        };
        let da = parameters.iter().map(derivative_by).collect();
        let mut start = OVector::<f64, D>::zeros_generic(size, U1);
        start.rows_mut(n, n).fill(v0 * tau_s);
        Self { masses: n, tau_s, a, da, start }
    }

    /// `exp(A t)` and its derivatives, `t` in s: scaling, Taylor series, squaring, each step differentiated.
    fn exponential(&self, t_s: f64) -> (Square<D>, Vec<Square<D>>) {
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
    fn sensitivity(&self, at: &Instants) -> Sensitivity {
        let parameters = self.da.len();
        let zero_state = || OVector::<f64, D>::zeros_generic(self.a.shape_generic().0, U1);
        let (mut z, mut s) = (self.start.clone(), vec![zero_state(); parameters]);
        if at.first_s > 0.0 {
            let (phi, derivatives) = self.exponential(at.first_s);
            s = derivatives.iter().map(|d| d * &z).collect();
            z = phi * z;
        }
        let (phi, derivatives) = self.exponential(at.dt_s);
        let empty = || vec![Motion::zeros(at.samples); self.masses];
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
}
