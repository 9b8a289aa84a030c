//! Everything a structure does under a drive: motions, the force in every element, and where the energy is.
//!
//! The balance of energy is a check of the motion: kinetic + stored + dissipated = brought in. Heat and work are
//! integrated by themselves, never taken as what is left over: linear structures by exact integrals of quadratic forms
//! over a step, all others term by term on the Taylor series.

use crate::error::positive;
use crate::exact::driven::{Driven, Instant};
use crate::exact::linear_system::LinearSystem;
use crate::motion::mass_motion::Waves;
use crate::series::instants::Reader;
use crate::series::step::{LinkSeries, ORDER, Series, Step, integral, product};
use crate::series::walk::walk;
use crate::structure::connected_masses::Structure;
use crate::structure::form::{Form, Strain};
use crate::structure::law::Branch;
use crate::{Drive, Dynamics, Element, ElementForce, Energy, Instants, LumpedError, Motion, Response};

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
                    (step.links[link].law.at(strain), strain)
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
    let damping = structure.connections()[link].element.law().damping(&step.branches[link]);
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
