//! Linear chains of masses: poles, motion, forces and energy, events, derivatives.
//!
//! `M x'' + C x' + K x = f` with tridiagonal `C` and `K`: element i couples mass i to the one in front of it. State
//! `(x, v, y, y', u, u')`: positions, velocities, position and velocity of the barrier, the input and its slope.

use crumple_lti::{Complex, matrix_exponential, polynomial_roots};
use nalgebra::{DMatrix, DVector};

use crate::error::{finite, row_of_masses};
use crate::exact::driven::{Driven, Instant};
use crate::exact::linear_motion::chain;
use crate::{ChainResponse, CrushEvents, Drive, Energy, Instants, LumpedError, ModelKind, Motion, Sensitivity, State};

/// Any number of masses in a row: barrier - (k1, c1) - m1 - (k2, c2) - m2 - ... - mN, the compartment last.
///
/// Element `i` is a spring and a damper in parallel in front of mass `i`; its force is
/// `k_i (x_i - x_(i-1)) + c_i (v_i - v_(i-1))`, positive in compression, where index 0 is the barrier.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    masses_kg: Vec<f64>,
    springs_n_per_m: Vec<f64>,
    dampers_n_s_per_m: Vec<f64>,
}

impl Chain {
    /// A chain. Errors: lists of unequal length or none, masses that are not positive, values that are not finite.
    pub fn new(masses_kg: &[f64], springs_n_per_m: &[f64], dampers_n_s_per_m: &[f64]) -> Result<Self, LumpedError> {
        row_of_masses(masses_kg, springs_n_per_m.len(), dampers_n_s_per_m.len())?;
        for (k, c) in springs_n_per_m.iter().zip(dampers_n_s_per_m) {
            finite("stiffness_n_per_m", *k)?;
            finite("damping_n_s_per_m", *c)?;
        }
        Ok(Self {
            masses_kg: masses_kg.to_vec(),
            springs_n_per_m: springs_n_per_m.to_vec(),
            dampers_n_s_per_m: dampers_n_s_per_m.to_vec(),
        })
    }

    /// Masses, kg, from the barrier on.
    pub fn masses_kg(&self) -> &[f64] {
        &self.masses_kg
    }

    /// Masses, springs and dampers.
    pub(crate) fn values(&self) -> (&[f64], &[f64], &[f64]) {
        (&self.masses_kg, &self.springs_n_per_m, &self.dampers_n_s_per_m)
    }

    /// Characteristic polynomial, monic, highest power first.
    ///
    /// Built from the compartment forwards as a dynamic stiffness `N/D`: an element in series makes `q N/(N + q D)` of
    /// it, a mass adds `m s²`. Sums of positive terms only, so every coefficient is right to a few roundings.
    pub fn characteristic_polynomial(&self) -> Vec<f64> {
        // Lowest power first.
        let times = |p: &[f64], q: &[f64]| {
            let mut product = vec![0.0; p.len() + q.len() - 1];
            for (i, a) in p.iter().enumerate() {
                for (j, b) in q.iter().enumerate() {
                    product[i + j] += a * b;
                }
            }
            product
        };
        let plus = |p: &[f64], q: &[f64]| -> Vec<f64> {
            let at = |v: &[f64], i: usize| v.get(i).copied().unwrap_or(0.0);
            (0..p.len().max(q.len())).map(|i| at(p, i) + at(q, i)).collect()
        };
        let (mut top, mut bottom) = (vec![0.0], vec![1.0]);
        for i in (0..self.masses_kg.len()).rev() {
            top = plus(&top, &times(&[0.0, 0.0, self.masses_kg[i]], &bottom));
            let q = [self.springs_n_per_m[i], self.dampers_n_s_per_m[i]];
            let closed = plus(&top, &times(&q, &bottom));
            top = times(&q, &top);
            bottom = closed;
        }
        let order = 2 * self.masses_kg.len();
        let leading = bottom[order];
        (0..=order).rev().map(|k| bottom[k] / leading).collect()
    }

    /// Poles, 1/s, as `polynomial_roots` sorts them.
    ///
    /// Two for each mass. Errors: parameters so extreme that the roots of the characteristic polynomial are not found.
    pub fn poles(&self) -> Result<Vec<Complex>, LumpedError> {
        Ok(polynomial_roots(&self.characteristic_polynomial())?)
    }

    /// `A` over `(x, v, y, y', u, u')`: masses, base and the drive, which is linear within a step.
    ///
    /// `2 N + 4` rows for N masses, SI units. The input enters the row of the driven mass, over its mass, or the
    /// acceleration of the barrier; after an impact its four states stay zero.
    fn matrix(&self, drive: &Drive) -> DMatrix<f64> {
        let n = self.masses_kg.len();
        let (base, input) = (2 * n, 2 * n + 2);
        let mut a = DMatrix::zeros(2 * n + 4, 2 * n + 4);
        for i in 0..n {
            a[(i, n + i)] = 1.0;
            let (k, c) = (self.springs_n_per_m[i], self.dampers_n_s_per_m[i]);
            let front = if i == 0 { (base, base + 1) } else { (i - 1, n + i - 1) };
            for (row, sign) in [(Some(i), -1.0), (i.checked_sub(1), 1.0)] {
                let Some(row) = row else { continue };
                let per_mass = sign / self.masses_kg[row];
                a[(n + row, i)] += per_mass * k;
                a[(n + row, front.0)] -= per_mass * k;
                a[(n + row, n + i)] += per_mass * c;
                a[(n + row, front.1)] -= per_mass * c;
            }
        }
        a[(base, base + 1)] = 1.0;
        a[(input, input + 1)] = 1.0;
        if let Some((mass, _)) = drive.force()
            && mass < n
        {
            a[(n + mass, input)] = 1.0 / self.masses_kg[mass];
        } else if drive.base().is_some() {
            a[(base + 1, input)] = 1.0;
        }
        a
    }

    /// Motion, forces and energies at `k dt`, k = 0 .. `samples`.
    ///
    /// One matrix exponential for the step, exact for drives linear between samples; heat and work by the exact
    /// integral of the quadratic form over the step (Van Loan 1978), so the balance closes to rounding. Errors: a force
    /// on a mass that is not there, a step or drive that is not finite, a response that leaves the range of numbers.
    pub fn respond(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<ChainResponse, LumpedError> {
        let n = self.masses_kg.len();
        if let Some((mass, _)) = drive.force()
            && mass >= n
        {
            return Err(LumpedError::Value {
                name: "mass",
                value: mass as f64,
                expected: "the index of a mass of the chain",
            });
        }
        let a = self.matrix(drive);
        let (heat, work) = (self.heat_form(), self.work_form(drive, &a));
        let mut start = vec![0.0; 2 * n];
        start[n..].fill(drive.speed_m_per_s());
        let mut response = ChainResponse {
            dt_s,
            motions: vec![Motion::with_capacity(samples); n],
            base_m: Vec::with_capacity(samples),
            spring_force_n: vec![Vec::with_capacity(samples); n],
            damper_force_n: vec![Vec::with_capacity(samples); n],
            energy: Vec::with_capacity(samples),
        };
        let driven = Driven { a, heat, work, model: ModelKind::TripleSpringMassDamper };
        driven.walk(&start, drive, dt_s, samples, |Instant { z, rate, dissipated_j, input_j }| {
            for i in 0..n {
                let (front_x, front_v) = if i == 0 { (z[2 * n], z[2 * n + 1]) } else { (z[i - 1], z[n + i - 1]) };
                response.spring_force_n[i].push(self.springs_n_per_m[i] * (z[i] - front_x));
                response.damper_force_n[i].push(self.dampers_n_s_per_m[i] * (z[n + i] - front_v));
                response.motions[i].push(State {
                    displacement_m: z[i],
                    velocity_m_per_s: z[n + i],
                    acceleration_m_per_s2: rate[n + i],
                });
            }
            response.base_m.push(z[2 * n]);
            let held = self.energy(z);
            let impact = if let Some(first) = response.energy.first() { first.input_j } else { held.kinetic_j };
            response.energy.push(Energy { dissipated_j, input_j: impact + input_j, ..held });
        })?;
        Ok(response)
    }

    /// Kinetic and stored energy of a state, J; heat and work are integrated along the way.
    fn energy(&self, z: &[f64]) -> Energy {
        let n = self.masses_kg.len();
        let front = |i: usize| if i == 0 { z[2 * n] } else { z[i - 1] };
        Energy {
            kinetic_j: (0..n).map(|i| 0.5 * self.masses_kg[i] * z[n + i].powi(2)).sum(),
            stored_j: (0..n).map(|i| 0.5 * self.springs_n_per_m[i] * (z[i] - front(i)).powi(2)).sum(),
            ..Energy::default()
        }
    }

    /// `z' Q z` is the power of the dampers.
    ///
    /// The sum of `c_i (v_i - v_(i-1))²`, W.
    fn heat_form(&self) -> DMatrix<f64> {
        let n = self.masses_kg.len();
        let mut q = DMatrix::zeros(2 * n + 4, 2 * n + 4);
        for i in 0..n {
            let front = if i == 0 { 2 * n + 1 } else { n + i - 1 };
            let c = self.dampers_n_s_per_m[i];
            q[(n + i, n + i)] += c;
            q[(front, front)] += c;
            q[(n + i, front)] -= c;
            q[(front, n + i)] -= c;
        }
        q
    }

    /// `z' Q z` is the power that comes in.
    ///
    /// Force times the velocity of its mass, or the force of the barrier times its velocity, W.
    fn work_form(&self, drive: &Drive, a: &DMatrix<f64>) -> DMatrix<f64> {
        let n = self.masses_kg.len();
        let mut q = DMatrix::zeros(2 * n + 4, 2 * n + 4);
        if let Some((mass, _)) = drive.force() {
            q[(n + mass, 2 * n + 2)] = 1.0;
        } else if drive.base().is_some() {
            // The barrier pushes with the force of the first element: minus the sum of m a.
            for i in 0..n {
                for j in 0..2 * n + 4 {
                    q[(2 * n + 1, j)] += self.masses_kg[i] * a[(n + i, j)];
                }
            }
        }
        (&q + q.transpose()) * 0.5
    }

    /// First zero of the velocity of every mass after an impact, within `horizon_s`, and of its acceleration after it.
    ///
    /// Steps of 1/16 of the fastest time constant, but between 1/4000 and 1/400,000 of the horizon, then bisection on
    /// the exact solution. What does not happen until the horizon is none; an element faster than the shortest step may
    /// swing unseen. Errors: a horizon that is not positive.
    pub fn events(&self, impact_speed_m_per_s: f64, horizon_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        if !(horizon_s.is_finite() && horizon_s > 0.0) {
            return Err(LumpedError::Value { name: "horizon_s", value: horizon_s, expected: "a positive time" });
        }
        let n = self.masses_kg.len();
        let a = self.matrix(&Drive::Impact(impact_speed_m_per_s)).view((0, 0), (2 * n, 2 * n)).into_owned();
        let fastest = self.poles()?.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let h = (horizon_s / 4000.0).min(1.0 / (16.0 * fastest)).max(horizon_s / 400_000.0);
        let phi = matrix_exponential(&(&a * h))?;
        let mut events = vec![CrushEvents::default(); n];
        let mut z = DVector::zeros(2 * n);
        z.rows_mut(n, n).fill(impact_speed_m_per_s);
        let mut rate = &a * &z;
        let mut k = 0;
        while (k as f64) * h < horizon_s && events.iter().any(|e| e.time_of_rebound_s.is_none()) {
            let next = &phi * &z;
            let next_rate = &a * &next;
            if !next.iter().all(|x| x.is_finite()) {
                break;
            }
            for (i, event) in events.iter_mut().enumerate() {
                let row = n + i;
                // Crush and rebound of a stiff element may lie in one step: the rebound is looked for from the crush
                // on.
                let (mut from, mut start): (f64, Option<DVector<f64>>) = (0.0, None);
                while event.time_of_rebound_s.is_none() {
                    let stopped = event.time_of_dynamic_crush_s.is_some();
                    let (before, after) = match (&start, stopped) {
                        (Some(at), _) => (a.row(row).transpose().dot(at), next_rate[row]),
                        (None, true) => (rate[row], next_rate[row]),
                        (None, false) => (z[row], next[row]),
                    };
                    if before == 0.0 || before * after > 0.0 {
                        break;
                    }
                    let (mut low, mut high) = (from, h);
                    let mut at = z.clone();
                    for _ in 0..52 {
                        let middle = 0.5 * (low + high);
                        at = matrix_exponential(&(&a * middle))? * &z;
                        let value = if stopped { (&a * &at)[row] } else { at[row] };
                        if value * before > 0.0 { low = middle } else { high = middle }
                    }
                    let t = k as f64 * h + high;
                    if stopped {
                        event.time_of_rebound_s = Some(t);
                        event.rebound_velocity_m_per_s = Some(at[row]);
                    } else {
                        event.time_of_dynamic_crush_s = Some(t);
                        event.dynamic_crush_m = Some(at[i]);
                        (from, start) = (high, Some(at));
                    }
                }
            }
            (z, rate) = (next, next_rate);
            k += 1;
        }
        Ok(events)
    }

    /// The motion of every mass at these instants after an impact, and its derivatives by the parameters at these
    /// places of masses, springs, dampers, one list after the other; by the derivative of the matrix exponential, right
    /// to rounding. Errors: a place that is none, a motion that leaves the range of numbers.
    pub fn sensitivity(
        &self,
        impact_speed_m_per_s: f64,
        at: &Instants,
        parameters: &[usize],
    ) -> Result<Sensitivity, LumpedError> {
        let (masses, springs, dampers) = self.values();
        if let Some(place) = parameters.iter().find(|p| **p >= 3 * masses.len()) {
            let expected = "the place of a mass, spring or damper of the chain";
            return Err(LumpedError::Value { name: "parameter", value: *place as f64, expected });
        }
        let sensitivity = chain([masses, springs, dampers], parameters, impact_speed_m_per_s, at);
        let motions = || sensitivity.motions.iter().chain(sensitivity.derivatives.iter().flatten());
        match motions().filter_map(Motion::first_not_finite).min() {
            Some(k) => Err(LumpedError::ChainDiverges { time_s: at.first_s + k as f64 * at.dt_s }),
            None => Ok(sensitivity),
        }
    }
}

/// Three masses in a row: engine, suspension and chassis, compartment. See [`Chain`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TripleSpringMassDamper {
    /// Masses from the barrier on, kg.
    pub masses_kg: [f64; 3],
    /// Springs in front of them, N/m.
    pub springs_n_per_m: [f64; 3],
    /// Dampers in front of them, N·s/m.
    pub dampers_n_s_per_m: [f64; 3],
}

impl TripleSpringMassDamper {
    /// The chain it is.
    pub fn chain(&self) -> Result<Chain, LumpedError> {
        Chain::new(&self.masses_kg, &self.springs_n_per_m, &self.dampers_n_s_per_m)
    }

    /// Refuses masses that are not positive and values that are not finite.
    pub fn check(&self) -> Result<(), LumpedError> {
        self.chain().map(|_| ())
    }

    /// Dynamic crush and rebound of the three masses, within two seconds.
    pub fn events(&self, impact_speed_m_per_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        self.chain()?.events(impact_speed_m_per_s, 2.0)
    }
}
