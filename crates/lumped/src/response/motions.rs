//! Motions of a structure, with forces, energies and events.
//!
//! Motions of a structure after an impact, with their derivatives.
//!
//! Two ways: where every force is linear for good, one matrix exponential (and its derivatives) for the step from
//! instant to instant; otherwise Taylor series from event to event. Both are right to rounding.
//!
//! Everything a structure does under a drive: motions, the force in every element, and where the energy is.
//!
//! The balance of energy is a check of the motion: kinetic + stored + dissipated = brought in. Heat and work are
//! integrated by themselves, never taken as what is left over: linear structures by exact integrals of quadratic forms
//! over a step, all others term by term on the Taylor series.

use crate::error::positive;
use crate::exact::derivatives::{Driven, Instant};
use crate::exact::linear_motion::LinearSystem;
use crate::exact::{crossing, linear_motion};
use crate::motion::collision::{Meeting, MeetingState};
use crate::series::expression_series::heat;
use crate::series::step::{LinkSeries, ORDER, Series, Step, integral, product};
use crate::series::walk::{Reader, walk};
use crate::structure::connected_masses::{Branch, Form, Place, Strain, Structure};
use crate::{
    Asked, CrushEvents, Drive, Dynamics, Element, ElementForce, Energy, Instants, LumpedError, Motion, Response,
    Sensitivity, Start, State, Waves,
};

impl Structure {
    /// The motion of every mass at these instants after the start, and its derivatives by the parameters at `places`,
    /// in their order. A number for a start is an impact speed, m/s.
    ///
    /// Analytic throughout: linear structures by the derivative of the matrix exponential, all others by the
    /// variational equation, solved by Taylor series along with the motion; forces are continuous at an event, so that
    /// nothing jumps there. An acceleration has a kink at an event, where one of the two one-sided derivatives is
    /// given. Errors: a place that is none, instants or a start that are not finite, a motion that leaves the range of
    /// numbers or needs more than 200,000 steps.
    pub fn sensitivity(
        &self,
        start: impl Into<Start>,
        at: &Instants,
        places: &[Place],
    ) -> Result<Sensitivity, LumpedError> {
        self.sensitivity_of(Waves::All, start, at, places)
    }

    /// The same of what is asked for: other waves and masses may stay empty.
    pub fn sensitivity_of(
        &self,
        asked: impl Into<Asked>,
        start: impl Into<Start>,
        at: &Instants,
        places: &[Place],
    ) -> Result<Sensitivity, LumpedError> {
        let (start, asked) = (start.into(), asked.into());
        start.check(self.masses_kg().len())?;
        positive("dt_s", at.dt_s)?;
        self.check_places(places)?;
        let sensitivity = match LinearSystem::new(self).filter(|_| self.is_smooth_in(places)) {
            Some(system) => linear_motion::sensitivity(&system, &start, at, asked, places),
            None => self.by_series(asked, start, at, places)?,
        };
        let motions = || sensitivity.motions.iter().chain(sensitivity.derivatives.iter().flatten());
        match motions().filter_map(Motion::first_not_finite).min() {
            Some(k) => Err(LumpedError::ChainDiverges { time_s: at.first_s + k as f64 * at.dt_s }),
            None => Ok(sensitivity),
        }
    }

    /// The motion of every mass at these instants after the start. Errors: as [`sensitivity`](Self::sensitivity).
    pub fn motions_at(&self, start: impl Into<Start>, at: &Instants) -> Result<Vec<Motion>, LumpedError> {
        Ok(self.sensitivity(start, at, &[])?.motions)
    }

    /// Whether a change of these parameters leaves a linear structure linear: it does not where an element has knots
    /// whose values only happen to be equal.
    fn is_smooth_in(&self, places: &[Place]) -> bool {
        places.iter().all(|place| match place {
            Place::Element { connection, .. } => !self.connections()[*connection].element.law().has_branches(),
            Place::Law(_) => self.connections().iter().all(|connection| !connection.element.law().has_branches()),
            _ => true,
        })
    }

    fn by_series(
        &self,
        asked: Asked,
        start: Start,
        at: &Instants,
        places: &[Place],
    ) -> Result<Sensitivity, LumpedError> {
        let zeros = || asked.zeros(at.samples, self.masses_kg().len());
        let mut motions = zeros();
        let mut derivatives: Vec<Vec<Motion>> = places.iter().map(|_| zeros()).collect();
        let mut reader = Reader::new(at);
        walk(self, &Drive::Start(start), at.dt_s, reader.end_s(), places, |step, changes| {
            let instants = reader.pass(step);
            if !instants.is_empty() {
                reader.fill_motions(step, &instants, &mut motions);
                let mut changed = Vec::with_capacity(3 * places.len());
                for (p, derivative) in derivatives.iter_mut().enumerate() {
                    for (mass, motion) in derivative.iter_mut().enumerate() {
                        let asked = motion.waves_mut().into_iter().enumerate().filter(|(_, wave)| !wave.is_empty());
                        let part =
                            |(k, wave)| (changes.series(mass, p, k), &mut Vec::as_mut_slice(wave)[instants.clone()]);
                        changed.extend(asked.map(part));
                    }
                }
                reader.fill_waves(step, &instants, changed);
            }
            reader.goes_on()
        })?;
        Ok(Sensitivity { motions, derivatives })
    }
}

/// Parts of a step on which a change of sign is looked for.
const PARTS: u32 = 8;

impl Structure {
    /// First zero of the velocity of every mass after an impact, within `horizon_s`, and of its acceleration after it,
    /// on the exact solution of a linear structure and on the series of any other.
    ///
    /// What does not happen until the horizon is none; of a linear structure neither what would happen after all its
    /// modes are dead. Errors: a horizon that is not positive, a motion that cannot be followed.
    pub fn events(&self, impact_speed_m_per_s: f64, horizon_s: f64) -> Result<Vec<CrushEvents>, LumpedError> {
        self.events_until(impact_speed_m_per_s, horizon_s, |events| {
            events.iter().all(|event| event.time_of_rebound_s.is_some())
        })
    }

    /// The dynamic crush of the last mass alone, m, as [`events`](Self::events) gives it: the motion is followed no
    /// further. Errors: as there.
    pub fn dynamic_crush_m(&self, impact_speed_m_per_s: f64, horizon_s: f64) -> Result<Option<f64>, LumpedError> {
        let stops = |events: &[CrushEvents]| events.last().is_none_or(|last| last.dynamic_crush_m.is_some());
        Ok(self.events_until(impact_speed_m_per_s, horizon_s, stops)?.last().and_then(|last| last.dynamic_crush_m))
    }

    /// The events up to the end of the step after which `are_enough`; of a linear structure all.
    fn events_until(
        &self,
        impact_speed_m_per_s: f64,
        horizon_s: f64,
        are_enough: impl Fn(&[CrushEvents]) -> bool,
    ) -> Result<Vec<CrushEvents>, LumpedError> {
        if horizon_s.is_nan() || horizon_s <= 0.0 {
            return Err(LumpedError::Value { name: "horizon_s", value: horizon_s, expected: "a positive time" });
        }
        if let Some(system) = LinearSystem::new(self) {
            return crossing::events(&system, impact_speed_m_per_s, horizon_s);
        }
        let mut events = vec![CrushEvents::default(); self.masses_kg().len()];
        if impact_speed_m_per_s == 0.0 {
            return Ok(events);
        }
        let direction = impact_speed_m_per_s.signum();
        walk(self, &Drive::Impact(impact_speed_m_per_s), horizon_s, horizon_s, &[], |step, _| {
            for (mass, event) in events.iter_mut().enumerate() {
                let mut from = 0.0;
                if event.time_of_dynamic_crush_s.is_none() {
                    let speed = |state: State| state.velocity_m_per_s * direction;
                    let Some(tau) = zero(step, from, |tau| speed(step.state(mass, tau))) else { continue };
                    event.time_of_dynamic_crush_s = Some(step.start_s + tau);
                    event.dynamic_crush_m = Some(step.state(mass, tau).displacement_m);
                    from = tau;
                }
                let braking = |state: State| -state.acceleration_m_per_s2 * direction;
                if event.time_of_rebound_s.is_none()
                    && let Some(tau) = zero(step, from, |tau| braking(step.state(mass, tau)))
                {
                    event.time_of_rebound_s = Some(step.start_s + tau);
                    event.rebound_velocity_m_per_s = Some(step.state(mass, tau).velocity_m_per_s);
                }
            }
            !are_enough(&events)
        })?;
        Ok(events)
    }
}

/// Common velocity and parting of the last mass and of mass `partner`, which it runs into. Errors: a motion that cannot
/// be followed.
pub(crate) fn meeting(
    structure: &Structure,
    start: Start,
    partner: usize,
    horizon_s: f64,
) -> Result<Meeting, LumpedError> {
    let (last, links) = (structure.masses_kg().len() - 1, structure.connections());
    let (mut meeting, mut largest_m) = (Meeting::default(), vec![0.0_f64; links.len()]);
    walk(structure, &Drive::Start(start), horizon_s, horizon_s, &[], |step, _| {
        let relative = |tau: f64, of: fn(State) -> f64| of(step.state(last, tau)) - of(step.state(partner, tau));
        let at = |tau: f64, largest_m: &[f64]| {
            let masses = (0..=last).map(|mass| step.state(mass, tau)).collect();
            MeetingState { time_s: step.start_s + tau, masses, largest_m: largest_m.to_vec() }
        };
        let mut from = 0.0;
        if meeting.common.is_none() {
            let common = zero(step, from, |tau| relative(tau, |state| state.velocity_m_per_s));
            // An element turns where a step ends: what is largest stands at an end.
            for ((largest, connection), link) in largest_m.iter_mut().zip(links).zip(&step.links) {
                let strain = link.strain(common.unwrap_or(step.length_s));
                *largest = largest.max(connection.element.law().deflection(&strain));
            }
            let Some(tau) = common else { return true };
            meeting.common = Some(at(tau, &largest_m));
            from = tau;
        }
        let parting = zero(step, from, |tau| -relative(tau, |state| state.acceleration_m_per_s2));
        meeting.parting = parting.map(|tau| at(tau, &largest_m));
        meeting.parting.is_none()
    })?;
    Ok(meeting)
}

/// The first instant from `from` to the end of the step at which a value is no more positive, by bisection. That it is
/// positive before is given: where a step begins on a zero, the value there is rounding.
fn zero(step: &Step, from: f64, value: impl Fn(f64) -> f64) -> Option<f64> {
    let holds = |tau: f64| value(tau) > 0.0;
    let mut low = from;
    for part in 1..=PARTS {
        let mut high = from + (step.length_s - from) * f64::from(part) / f64::from(PARTS);
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

impl Structure {
    /// Motions, forces and energies at `k dt`, k = 0 .. `samples`.
    ///
    /// A linear structure by one matrix exponential, exact for drives linear between samples, any other by Taylor
    /// series from event to event, about `1e-15` of the largest motion a step. After an impact the motions are those of
    /// [`motions_at`](Self::motions_at). Errors: a force on a mass that is not there, a step or drive that is not
    /// finite, a motion that leaves the range of numbers or needs more than 200,000 steps.
    pub fn dynamics(&self, drive: &Drive, dt_s: f64, samples: usize) -> Result<Dynamics, LumpedError> {
        positive("dt_s", dt_s)?;
        self.check_drive(drive)?;
        let masses = self.masses_kg().len();
        let at = Instants { first_s: 0.0, dt_s, samples };
        let mut record = Record::new(self, &at, drive);
        let Some(system) = LinearSystem::new(self).filter(|_| !matches!(drive, Drive::BasePulse(_))) else {
            record.follow_series(drive, &at)?;
            return Ok(record.dynamics);
        };
        let branches: Vec<Branch> =
            self.connections().iter().map(|c| c.element.law().start(Strain::default())).collect();
        let mut k = 0;
        Driven::new(&system, drive).walk(drive, dt_s, samples, |Instant { z, rate, dissipated_j, input_j }| {
            for (mass, motion) in record.dynamics.response.motions.iter_mut().enumerate() {
                (motion.displacement_m[k], motion.velocity_m_per_s[k]) = (z[mass], z[masses + mass]);
                motion.acceleration_m_per_s2[k] = rate[masses + mass];
            }
            let felt = |link: usize| {
                let element = &system.elements[link];
                let [(front_x, front_v), (x, v)] = element.nodes.map(|node| system.place_of(node));
                let inner = element.inner.map_or(0.0, |(_, row)| z[row]);
                let strain = Strain { u: z[x] - z[front_x], w: z[v] - z[front_v], z: inner };
                (element.force.at(strain), strain)
            };
            record.add(k, &branches, felt, [dissipated_j, input_j]);
            k += 1;
        })?;
        if matches!(drive, Drive::Impact(_) | Drive::Start(_)) {
            record.dynamics.response.motions = self.motions_at(drive.start(), &at)?;
        }
        Ok(record.dynamics)
    }

    /// Refuses a force on a mass that is not there, a start that does not fit, a pulse that is none.
    pub(crate) fn check_drive(&self, drive: &Drive) -> Result<(), LumpedError> {
        let masses = self.masses_kg().len();
        if let Some((mass, _)) = drive.force().filter(|(mass, _)| *mass >= masses) {
            let expected = "the index of a mass of the model";
            return Err(LumpedError::Value { name: "mass", value: mass as f64, expected });
        }
        if let Drive::BasePulse(pulse) = drive {
            pulse.check()?;
        }
        drive.start().check(masses)
    }
}

/// Motions, forces and energies as they come.
struct Record<'a> {
    structure: &'a Structure,
    dynamics: Dynamics,
    /// Forces of each element: spring and damper in series have one each.
    parts: Vec<usize>,
    /// Of the impact, J.
    brought_in_j: f64,
}

impl<'a> Record<'a> {
    fn new(structure: &'a Structure, at: &Instants, drive: &Drive) -> Self {
        let masses_kg = structure.masses_kg().to_vec();
        let start = drive.start();
        // Elements between masses apart from each other may be compressed.
        let stored = |(element, nodes): (&Element, [usize; 2])| {
            let place = |node: usize| if node < masses_kg.len() { start.of_mass(node) } else { [0.0; 2] };
            let [[front_x, front_v], [x, v]] = nodes.map(place);
            let strain = Strain { u: x - front_x, w: v - front_v, z: 0.0 };
            let law = element.law();
            law.energies(&law.start(strain), &strain).iter().sum::<f64>()
        };
        let brought_in_j = start.kinetic_j(&masses_kg) + structure.joined().map(stored).sum::<f64>();
        let parts = structure.connections().iter().map(|c| c.element.law().symbols().len()).collect();
        let room = || Vec::with_capacity(at.samples);
        let forces = (0..structure.connections().len())
            .flat_map(|connection| structure.force_names(connection))
            .map(|name| ElementForce { name, force_n: room(), deflection_m: room() })
            .collect();
        let motions = vec![Motion::zeros(at.samples, Waves::All); masses_kg.len()];
        let response = Response { dt_s: at.dt_s, masses_kg, motions };
        let dynamics = Dynamics { response, forces, energy: Vec::with_capacity(at.samples) };
        Self { structure, dynamics, parts, brought_in_j }
    }

    /// Adds forces and energies of sample `k`, whose motion is there. Forces are read off the law at the sample.
    /// `felt` gives the force of an element, N, and what it feels.
    fn add(
        &mut self,
        k: usize,
        branches: &[Branch],
        felt: impl Fn(usize) -> (f64, Strain),
        [heat_j, work_j]: [f64; 2],
    ) {
        let mut energy = Energy { dissipated_j: heat_j, input_j: self.brought_in_j + work_j, ..Energy::default() };
        let mut forces = self.dynamics.forces.iter_mut();
        for (link, (connection, branch)) in self.structure.connections().iter().zip(branches).enumerate() {
            let (law, (force_n, strain)) = (connection.element.law(), felt(link));
            for (part, force) in forces.by_ref().take(self.parts[link]).enumerate() {
                force.force_n.push(force_n);
                force.deflection_m.push(law.compression(part, &strain));
            }
            let [stored_j, plastic_j] = law.energies(branch, &strain);
            energy.stored_j += stored_j;
            energy.dissipated_j += plastic_j;
        }
        for (mass, motion) in self.structure.masses_kg().iter().zip(&self.dynamics.response.motions) {
            energy.kinetic_j += 0.5 * mass * motion.velocity_m_per_s[k].powi(2);
        }
        self.dynamics.energy.push(energy);
    }

    /// From event to event. Heat and work are summed over whole steps, plus the part of the step up to the sample.
    fn follow_series(&mut self, drive: &Drive, at: &Instants) -> Result<(), LumpedError> {
        let mut reader = Reader::new(at);
        let (mut heat_j, mut work_j) = (0.0, 0.0);
        walk(self.structure, drive, at.dt_s, reader.end_s(), &[], |step, _| {
            let (heat, work) = (self.heat(step), work(step));
            let instants = reader.pass(step);
            reader.fill_motions(step, &instants, &mut self.dynamics.response.motions);
            for k in instants {
                let tau = reader.time(k) - step.start_s;
                let energies = [heat_j + integral(&heat, tau), work_j + integral(&work, tau)];
                let felt = |link: usize| {
                    let strain = step.links[link].strain(tau);
                    (step.force_at(link, tau), strain)
                };
                self.add(k, &step.branches, felt, energies);
            }
            heat_j += integral(&heat, step.length_s);
            work_j += integral(&work, step.length_s);
            reader.goes_on()
        })
    }

    /// Power of the dampers, W.
    fn heat(&self, step: &Step) -> Series {
        let mut power = [0.0; ORDER + 1];
        for link in 0..step.links.len() {
            if let Some(of_link) = heat_of(self.structure, step, link) {
                power.iter_mut().zip(of_link).for_each(|(sum, term)| *sum += term);
            }
        }
        power
    }
}

/// Power that an element turns into heat, W: force of its damper times the rate of its compression; `None` where it
/// does not.
pub(crate) fn heat_of(structure: &Structure, step: &Step, link: usize) -> Option<Series> {
    let law = structure.connections()[link].element.law();
    if let Some(own) = law.as_own() {
        return heat(own, &step.branches[link], &step.force(link), &step.links[link].u, &step.links[link].w);
    }
    let damping = law.damping(&step.branches[link]);
    if damping == Form::ZERO {
        return None;
    }
    let link = &step.links[link];
    let (force, mut rate) = (link.series(&damping), link.w);
    // The damper in series with a spring moves at what the spring leaves.
    if let Some(inner) = &link.inner {
        rate.iter_mut().zip(link.series(inner)).for_each(|(rate, inner)| *rate -= inner);
    }
    Some(std::array::from_fn(|k| product(&force, &rate, k)))
}

/// Power of the drive, W: force times velocity where it acts; the barrier gets the forces of the elements on it.
fn work(step: &Step) -> Series {
    let input = &step.input;
    if let Some(mass) = input.mass {
        return std::array::from_fn(|k| product(&input.terms, &step.nodes[mass].v, k));
    }
    let barrier = step.nodes.len() - 1;
    let mut power = [0.0; ORDER + 1];
    for LinkSeries { nodes, force, .. } in &step.links {
        for (node, sign) in nodes.iter().zip([-1.0, 1.0]) {
            if *node == barrier {
                for (k, power) in power.iter_mut().enumerate() {
                    *power += sign * product(force, &step.nodes[barrier].v, k);
                }
            }
        }
    }
    power
}
