//! A chain of masses with piecewise-linear springs and dampers.
//!
//! The interface of these chains: building, responding, events. How the motion is followed from knot to knot is in
//! `secant/chain.rs`; a chain whose coefficients are all constant is handed to the linear one, which has no steps.

use crate::error::{finite, positive, row_of_masses};
use crate::secant::chain::{ChainMotion, ChainStep, Series, horner, integral};
use crate::secant::step::ORDER;
use crate::{
    Chain, ChainResponse, CrushEvents, Drive, Dynamics, Energy, Instants, LumpedError, Motion, PiecewiseLinear, State,
};

/// Any number of masses in a row as [`Chain`], with secant coefficients that are piecewise linear: the force of element
/// `i` is `k_i(|u|) u + c_i(|w|) w`, `u` its compression and `w` the rate of it.
///
/// One mass is [`Nonlinear2`](crate::Nonlinear2) with any number of knots; coefficients that are constant make a
/// [`Chain`], and are computed as one. The secant reading is that of the single-mass paper, carried to elements between
/// masses; contact stays closed, and an element is as stiff in tension as in compression.
#[derive(Debug, Clone, PartialEq)]
pub struct SecantChain {
    masses_kg: Vec<f64>,
    springs: Vec<PiecewiseLinear>,
    dampers: Vec<PiecewiseLinear>,
}

/// Parts of a step on which a change of sign is looked for.
const PARTS: u32 = 8;

impl SecantChain {
    /// Masses in kg, springs in N/m over m and dampers in N·s/m over m/s in front of them, from the barrier on. Errors:
    /// lists of unequal length or none, masses that are not positive.
    pub fn new(
        masses_kg: &[f64],
        springs: &[PiecewiseLinear],
        dampers: &[PiecewiseLinear],
    ) -> Result<Self, LumpedError> {
        row_of_masses(masses_kg, springs.len(), dampers.len())?;
        Ok(Self { masses_kg: masses_kg.to_vec(), springs: springs.to_vec(), dampers: dampers.to_vec() })
    }

    /// Masses, kg, from the barrier on.
    pub fn masses_kg(&self) -> &[f64] {
        &self.masses_kg
    }

    /// Springs in front of the masses, N/m over the compression in m.
    pub fn springs(&self) -> &[PiecewiseLinear] {
        &self.springs
    }

    /// Dampers in front of the masses, N·s/m over the rate of the compression in m/s.
    pub fn dampers(&self) -> &[PiecewiseLinear] {
        &self.dampers
    }

    /// Whether no spring or damper is negative anywhere.
    pub fn is_passive(&self) -> bool {
        self.springs.iter().chain(&self.dampers).all(PiecewiseLinear::is_passive)
    }

    /// The linear chain it is, if every coefficient is constant.
    pub fn linear(&self) -> Option<Chain> {
        let constants =
            |laws: &[PiecewiseLinear]| -> Option<Vec<f64>> { laws.iter().map(PiecewiseLinear::as_constant).collect() };
        Chain::new(&self.masses_kg, &constants(&self.springs)?, &constants(&self.dampers)?).ok()
    }

    /// Motion, forces and energies at `k dt`, k = 0 .. `samples`.
    ///
    /// A linear chain by one matrix exponential, any other by Taylor series of order 20 from knot to knot, about
    /// `1e-15` of the largest motion a step; heat and work term by term on the same series. Errors: a force on a mass
    /// that is not there, a step or drive that is not finite, a motion that leaves the range of numbers or needs more
    /// than 200,000 steps.
    pub fn respond(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<ChainResponse, LumpedError> {
        if let Some(chain) = self.linear() {
            return chain.respond(drive, dt_s, samples).map_err(|error| match error {
                LumpedError::Diverges { time_s, .. } => LumpedError::ChainDiverges { time_s },
                other => other,
            });
        }
        self.by_series(drive, dt_s, samples)
    }

    /// As [`respond`](Self::respond), in the words of every model.
    pub fn dynamics(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<Dynamics, LumpedError> {
        Ok(self.respond(drive, dt_s, samples)?.into_dynamics(&self.masses_kg))
    }

    fn motion(&self) -> ChainMotion<'_> {
        ChainMotion { masses_kg: &self.masses_kg, springs: &self.springs, dampers: &self.dampers }
    }

    /// Forces are read off the coefficients at each sample, not off the series: a sum that closes exactly with the
    /// motion of the masses. Heat and work are summed over whole steps, plus the part of the step up to the sample.
    fn by_series(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<ChainResponse, LumpedError> {
        let n = self.masses_kg.len();
        positive("dt_s", dt_s)?;
        finite("impact_speed_m_per_s", drive.speed_m_per_s())?;
        if let Some((mass, _)) = drive.force()
            && mass >= n
        {
            return Err(LumpedError::Value {
                name: "mass",
                value: mass as f64,
                expected: "the index of a mass of the chain",
            });
        }
        let mut response = ChainResponse {
            dt_s,
            motions: vec![Motion::with_capacity(samples); n],
            base_m: Vec::with_capacity(samples),
            spring_force_n: vec![Vec::with_capacity(samples); n],
            damper_force_n: vec![Vec::with_capacity(samples); n],
            energy: Vec::with_capacity(samples),
        };
        let impact = 0.5 * self.masses_kg.iter().sum::<f64>() * drive.speed_m_per_s().powi(2);
        let (mut heat, mut work) = (0.0, impact);
        self.motion().walk(drive, dt_s, dt_s * samples as f64, |step| {
            let stop = step.start_s + step.length_s;
            while response.base_m.len() < samples && response.base_m.len() as f64 * dt_s <= stop {
                let k = response.base_m.len();
                let tau = k as f64 * dt_s - step.start_s;
                let energy = Energy {
                    dissipated_j: heat + integral(&step.heat, tau),
                    input_j: work + integral(&step.work, tau),
                    ..Energy::default()
                };
                self.sample(step, tau, drive, k, energy, &mut response);
            }
            heat += integral(&step.heat, step.length_s);
            work += integral(&step.work, step.length_s);
            response.base_m.len() < samples
        })?;
        Ok(response)
    }

    /// The motion of every mass at these instants after an impact: the series of [`respond`](Self::respond), without
    /// forces and energies. Errors: as there.
    pub fn motions_at(&self, impact_speed_m_per_s: f64, at: &Instants) -> Result<Vec<Motion>, LumpedError> {
        finite("impact_speed_m_per_s", impact_speed_m_per_s)?;
        positive("dt_s", at.dt_s)?;
        let n = self.masses_kg.len();
        let time = |k: usize| at.first_s + k as f64 * at.dt_s;
        let mut motions = vec![Motion::with_capacity(at.samples); n];
        let mut next = 0;
        let drive = Drive::Impact(impact_speed_m_per_s);
        let mut states = vec![(0.0, 0.0); n + 1];
        let mut front_force = vec![0.0; n + 1];
        self.motion().walk(&drive, at.dt_s, time(at.samples), |step| {
            while next < at.samples && time(next) <= step.start_s + step.length_s {
                for (state, series) in states.iter_mut().zip(&step.x) {
                    *state = horner(series, time(next) - step.start_s);
                }
                for i in 0..n {
                    let front = if i == 0 { n } else { i - 1 };
                    let (u, w) = (states[i].0 - states[front].0, states[i].1 - states[front].1);
                    front_force[i] = self.springs[i].at(u) * u + self.dampers[i].at(w) * w;
                }
                for (i, motion) in motions.iter_mut().enumerate() {
                    motion.push(State {
                        displacement_m: states[i].0,
                        velocity_m_per_s: states[i].1,
                        acceleration_m_per_s2: (front_force[i + 1] - front_force[i]) / self.masses_kg[i],
                    });
                }
                next += 1;
            }
            next < at.samples
        })?;
        Ok(motions)
    }

    /// Adds sample `k` of the drive, `tau` after the start of the step.
    ///
    /// `energy` comes with heat and work; kinetic and stored energy are added. The drive is taken at the sample itself,
    /// so that an acceleration has the force of its own instant.
    fn sample(
        &self,
        step: &ChainStep,
        tau: f64,
        drive: &Drive,
        k: usize,
        energy: Energy,
        response: &mut ChainResponse,
    ) {
        let n = self.masses_kg.len();
        let states: Vec<(f64, f64)> = step.x.iter().map(|series| horner(series, tau)).collect();
        let mut energy = energy;
        // Force of the elements in front of each mass.
        let mut front_force = vec![0.0; n + 1];
        for i in 0..n {
            let front = if i == 0 { n } else { i - 1 };
            let (u, w) = (states[i].0 - states[front].0, states[i].1 - states[front].1);
            let (spring, damper) = (self.springs[i].at(u) * u, self.dampers[i].at(w) * w);
            response.spring_force_n[i].push(spring);
            response.damper_force_n[i].push(damper);
            front_force[i] = spring + damper;
            energy.stored_j += self.springs[i].energy(u);
            energy.kinetic_j += 0.5 * self.masses_kg[i] * states[i].1.powi(2);
        }
        for i in 0..n {
            let pushed = match drive.force() {
                Some((mass, samples)) if mass == i => samples.get(k).copied().unwrap_or(0.0),
                _ => 0.0,
            };
            response.motions[i].push(State {
                displacement_m: states[i].0,
                velocity_m_per_s: states[i].1,
                acceleration_m_per_s2: (front_force[i + 1] - front_force[i] + pushed) / self.masses_kg[i],
            });
        }
        response.base_m.push(states[n].0);
        response.energy.push(energy);
    }

    /// First zero of the velocity of every mass after an impact, within `horizon_s`, and of its acceleration after it,
    /// on the exact solution of a linear chain and on the series of any other. What does not happen until the horizon
    /// is none.
    pub fn events(&self, impact_speed_m_per_s: f64, horizon_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        if let Some(chain) = self.linear() {
            return chain.events(impact_speed_m_per_s, horizon_s);
        }
        positive("horizon_s", horizon_s)?;
        let n = self.masses_kg.len();
        let mut events = vec![CrushEvents::default(); n];
        if impact_speed_m_per_s == 0.0 {
            return Ok(events);
        }
        let direction = impact_speed_m_per_s.signum();
        self.motion().walk(&Drive::Impact(impact_speed_m_per_s), horizon_s, horizon_s, |step| {
            for (event, x) in events.iter_mut().zip(&step.x[..n]) {
                let v = derivative(x);
                let mut from = 0.0;
                if event.time_of_dynamic_crush_s.is_none() {
                    let Some(tau) = zero(&v, direction, from, step.length_s) else { continue };
                    event.time_of_dynamic_crush_s = Some(step.start_s + tau);
                    event.dynamic_crush_m = Some(horner(x, tau).0);
                    from = tau;
                }
                if event.time_of_rebound_s.is_none()
                    && let Some(tau) = zero(&derivative(&v), -direction, from, step.length_s)
                {
                    event.time_of_rebound_s = Some(step.start_s + tau);
                    event.rebound_velocity_m_per_s = Some(horner(x, tau).1);
                }
            }
            events.iter().any(|event| event.time_of_rebound_s.is_none())
        })?;
        Ok(events)
    }
}

/// Series of the derivative; its highest coefficient is not known and taken as zero.
fn derivative(series: &Series) -> Series {
    std::array::from_fn(|k| if k < ORDER { (k + 1) as f64 * series[k + 1] } else { 0.0 })
}

/// The first instant of `from <= tau <= to` at which the sign is no more that of `sign`, by bisection. The sign is
/// given: where a step begins on a zero, the value there is rounding.
fn zero(series: &Series, sign: f64, from: f64, to: f64) -> Option<f64> {
    let holds = |tau: f64| horner(series, tau).0 * sign > 0.0;
    let mut low = from;
    for part in 1..=PARTS {
        let mut high = from + (to - from) * f64::from(part) / f64::from(PARTS);
        if holds(high) {
            low = high;
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if holds(middle) { low = middle } else { high = middle }
        }
        return Some(high);
    }
    None
}
