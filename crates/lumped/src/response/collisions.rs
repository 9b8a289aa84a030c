//! Collisions of any structure: with a barrier, of two bodies, under a pulse of the base; events, peaks, energies.
//!
//! An occupant behind a restraint, in a vehicle that is slowed down by a pulse.
//!
//! The vehicle is the base and its pulse is given: that the occupant pushes back on it is left out. All is seen from a
//! frame that keeps the impact speed, in which everything starts from rest.

use crate::error::positive;
use crate::motion::collision::{Collision, ElementEnergy, ElementEvent, ElementState, Extremum, Moment, Turn};
use crate::response::motions::heat_of;
use crate::series::changes::Changes;
use crate::series::step::{Series, Step, falls, integral, largest_coefficient, product, value};
use crate::series::walk::walk;
use crate::structure::connected_masses::{Node, Place, Structure};
use crate::structure::force_deflection::ForceDeflection;
use crate::{CrashPulse, Drive, LumpedError, State};

/// What is asked of a collision beside its end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CollisionQuestions {
    /// The body from which the last mass is seen: the barrier, or a mass of the other vehicle.
    pub seen_from: Node,
    /// Instants at which everything is wanted, s.
    pub instants_s: Vec<f64>,
    /// Parameters by which derivatives are wanted.
    pub places: Vec<Place>,
}

impl Structure {
    /// A collision up to `until_s`: the turn (dynamic crush or common velocity), separation, peaks, events of the
    /// elements, the energies of each of them, all on the exact solution, with derivatives by the parameters asked for.
    ///
    /// Errors: a drive, place or node that does not fit the structure, an end that is not positive, an instant that is
    /// not between start and end, a motion that cannot be followed.
    pub fn collision(
        &self,
        drive: &Drive,
        until_s: f64,
        questions: &CollisionQuestions,
    ) -> Result<Collision, LumpedError> {
        self.check_drive(drive)?;
        self.check_places(&questions.places)?;
        positive("until_s", until_s)?;
        let masses = self.masses_kg().len();
        let refuse = |name, value, expected| Err(LumpedError::Value { name, value, expected });
        if let Some(t) = questions.instants_s.iter().find(|t| !(0.0..=until_s).contains(*t)) {
            return refuse("instant, s", *t, "a time between start and end");
        }
        let seen_from = match questions.seen_from {
            Node::Wall => masses,
            Node::Mass(i) if i + 1 < masses => i,
            Node::Mass(i) => return refuse("body the last mass is seen from", i as f64, "the index of another mass"),
        };
        let mut watch = Watch::new(self, questions, seen_from, until_s);
        // A drive without samples: any spacing will do.
        walk(self, drive, until_s, until_s, &questions.places, |step, changes| {
            watch.see(step, changes);
            true
        })?;
        watch.tell(drive, until_s)
    }
}

/// What was seen of a collision so far.
struct Watch<'a> {
    structure: &'a Structure,
    questions: &'a CollisionQuestions,
    seen_from: usize,
    until_s: f64,
    /// Heat of every element up to the step, J.
    heat_j: Vec<f64>,
    /// Power on the step that turns into heat, of the elements where some does.
    power: Vec<Option<Series>>,
    approaches: bool,
    turn: Option<Turn>,
    instants: Vec<Option<Moment>>,
    end: Option<Moment>,
    peak_acceleration: Extremum,
    peak_wall_force: Extremum,
    /// Elements on the barrier, with the sign of their force on it.
    on_wall: Vec<(usize, f64)>,
    is_pressed: bool,
    separation_s: Option<f64>,
    events: Vec<(f64, usize, ElementEvent)>,
}

impl<'a> Watch<'a> {
    fn new(structure: &'a Structure, questions: &'a CollisionQuestions, seen_from: usize, until_s: f64) -> Self {
        let wall = structure.masses_kg().len();
        let on_wall = |(link, (_, [front, rear])): (usize, (_, [usize; 2]))| match (front == wall, rear == wall) {
            (true, _) => Some((link, 1.0)),
            (_, true) => Some((link, -1.0)),
            _ => None,
        };
        Self {
            structure,
            questions,
            seen_from,
            until_s,
            heat_j: vec![0.0; structure.connections().len()],
            power: vec![None; structure.connections().len()],
            approaches: false,
            turn: None,
            instants: vec![None; questions.instants_s.len()],
            end: None,
            peak_acceleration: Extremum::default(),
            peak_wall_force: Extremum::default(),
            on_wall: structure.joined().enumerate().filter_map(on_wall).collect(),
            is_pressed: false,
            separation_s: None,
            events: Vec::new(),
        }
    }

    fn see(&mut self, step: &Step, changes: &Changes) {
        for (link, power) in self.power.iter_mut().enumerate() {
            *power = heat_of(self.structure, step, link);
        }
        let (last, stop) = (self.structure.masses_kg().len() - 1, step.start_s + step.length_s);
        for entry in &step.entered {
            let law = self.structure.connections()[entry.link].element.law();
            if let Some(event) = law.event(&entry.before, &entry.after) {
                self.events.push((step.start_s, entry.link, event));
            }
        }
        self.see_wall(step);
        largest_coefficient(&step.nodes[last].a, f64::abs, step.start_s, step.length_s, &mut self.peak_acceleration);
        if self.turn.is_none() {
            let (rear, front) = (&step.nodes[last].v, &step.nodes[self.seen_from].v);
            let relative: Series = std::array::from_fn(|k| rear[k] - front[k]);
            self.approaches |= relative[0] > 0.0 && step.start_s == 0.0;
            if let Some(tau) = falls(&relative, step.length_s, &mut self.approaches) {
                self.turn = Some(self.turn_at(step, changes, tau));
            }
        }
        for (k, t) in self.questions.instants_s.iter().enumerate() {
            if self.instants[k].is_none() && *t <= stop {
                self.instants[k] = Some(self.moment(step, changes, t - step.start_s));
            }
        }
        if stop >= self.until_s * (1.0 - 2.0 * f64::EPSILON) {
            self.end = Some(self.moment(step, changes, step.length_s));
        }
        for (sum, power) in self.heat_j.iter_mut().zip(&self.power) {
            *sum += power.as_ref().map_or(0.0, |power| integral(power, step.length_s));
        }
    }

    /// The force on the barrier over a step.
    fn see_wall(&mut self, step: &Step) {
        let is_pressed = self.on_wall.iter().any(|(link, _)| step.presses(*link));
        if is_pressed {
            let mut force = [0.0; crate::series::step::ORDER + 1];
            for (link, sign) in &self.on_wall {
                force.iter_mut().zip(step.force(*link)).for_each(|(sum, term)| *sum += sign * term);
            }
            largest_coefficient(&force, f64::abs, step.start_s, step.length_s, &mut self.peak_wall_force);
            self.separation_s = None;
        } else if self.is_pressed {
            self.separation_s = Some(step.start_s);
        }
        self.is_pressed = is_pressed;
    }

    /// Everything at `tau` after the start of a step.
    fn moment(&self, step: &Step, changes: &Changes, tau: f64) -> Moment {
        let element = |link: usize| {
            let law = self.structure.connections()[link].element.law();
            let (series, branch) = (&step.links[link], &step.branches[link]);
            let strain = series.strain(tau);
            let [stored_j, plastic_j] = law.energies(branch, &strain);
            let heat_j = self.heat_j[link] + self.power[link].as_ref().map_or(0.0, |power| integral(power, tau));
            let [rate_j, damped_j] = if law.has_rate_effect() { [heat_j, 0.0] } else { [0.0, heat_j] };
            ElementState {
                deflection_m: law.deflection(&strain),
                force_n: step.force_at(link, tau),
                permanent_set_m: branch.set,
                energy: ElementEnergy { stored_j, plastic_j, rate_j, damped_j },
            }
        };
        let masses = self.structure.masses_kg().len();
        let change = |p: usize, mass: usize| {
            let [displacement_m, velocity_m_per_s, acceleration_m_per_s2] =
                [0, 1, 2].map(|wave| value(&changes.series(mass, p, wave), tau));
            State { displacement_m, velocity_m_per_s, acceleration_m_per_s2 }
        };
        Moment {
            time_s: step.start_s + tau,
            masses: (0..masses).map(|mass| step.state(mass, tau)).collect(),
            elements: (0..step.links.len()).map(element).collect(),
            derivatives: (0..self.questions.places.len())
                .map(|p| (0..masses).map(|mass| change(p, mass)).collect())
                .collect(),
        }
    }

    /// The turn: its time changes by the change of the relative velocity over the relative deceleration, its crush by
    /// the change of the relative position alone, for the relative velocity is zero.
    fn turn_at(&self, step: &Step, changes: &Changes, tau: f64) -> Turn {
        let moment = self.moment(step, changes, tau);
        let (last, front) = (moment.masses.len() - 1, step.state(self.seen_from, tau));
        let rear = moment.masses[last];
        let deceleration = front.acceleration_m_per_s2 - rear.acceleration_m_per_s2;
        let relative = |p: usize, of: fn(&State) -> f64| {
            let states = &moment.derivatives[p];
            of(&states[last]) - states.get(self.seen_from).map_or(0.0, of)
        };
        let places = 0..self.questions.places.len();
        let size = rear.acceleration_m_per_s2.abs() + front.acceleration_m_per_s2.abs();
        let touches_only = deceleration.abs() <= 1e-12 * size || size == 0.0;
        Turn {
            crush_m: rear.displacement_m - front.displacement_m,
            time_by: (!touches_only)
                .then(|| places.clone().map(|p| relative(p, |s| s.velocity_m_per_s) / deceleration).collect()),
            crush_by: places.map(|p| relative(p, |s| s.displacement_m)).collect(),
            moment,
        }
    }

    fn tell(self, drive: &Drive, until_s: f64) -> Result<Collision, LumpedError> {
        let masses_kg = self.structure.masses_kg().to_vec();
        let (start, total) = (drive.start(), masses_kg.iter().sum::<f64>());
        let momentum: f64 = masses_kg.iter().enumerate().map(|(i, mass)| mass * start.of_mass(i)[1]).sum();
        let instants: Option<Vec<Moment>> = self.instants.into_iter().collect();
        let (Some(instants), Some(end)) = (instants, self.end) else {
            return Err(LumpedError::ChainDiverges { time_s: until_s });
        };
        Ok(Collision {
            kinetic_start_j: start.kinetic_j(&masses_kg),
            velocity_of_centre_of_mass_start_m_per_s: momentum / total,
            masses_kg,
            turn: self.turn,
            instants,
            end,
            peak_acceleration: self.peak_acceleration,
            peak_wall_force: (!self.on_wall.is_empty()).then_some(self.peak_wall_force),
            separation_s: self.separation_s,
            events: self.events,
        })
    }
}

/// An occupant and what holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Occupant {
    /// The mass that the restraint holds, kg.
    pub mass_kg: f64,
    /// The restraint; its gap is the slack.
    pub restraint: ForceDeflection,
}

/// What becomes of an occupant.
#[derive(Debug, Clone, PartialEq)]
pub struct OccupantMotion {
    /// When the slack is used up, s, and the relative speed then, m/s.
    pub contact: Option<[f64; 2]>,
    /// Largest deceleration by the restraint, m/s².
    pub peak_deceleration: Extremum,
    /// Largest way ahead of the vehicle, m.
    pub largest_excursion: Extremum,
    /// Permanent set of the restraint, m.
    pub permanent_set_m: f64,
    /// Work done on the restraint up to the end, J.
    pub work_of_restraint_j: f64,
    /// Speed ahead of the vehicle at the end, m/s.
    pub relative_speed_end_m_per_s: f64,
    /// Way ahead of the vehicle at the end, m.
    pub excursion_end_m: f64,
    /// Speed of the vehicle over ground at the end, m/s.
    pub vehicle_speed_end_m_per_s: f64,
    /// The occupant's stop over ground.
    pub stop: Option<OccupantStop>,
}

/// Where an occupant stops over ground, and what stopped it. Both shares together are one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OccupantStop {
    /// When, s.
    pub time_s: f64,
    /// Share of its energy taken by riding down with the vehicle, `(2/v0²) integral of F/m v_vehicle dt`.
    pub ridedown_share: f64,
    /// Share taken by the restraint.
    pub restraint_share: f64,
}

impl Occupant {
    /// The motion up to `until_s` in a vehicle of this impact speed, m/s, under a pulse of deceleration.
    ///
    /// Errors: a mass, speed or end that is not positive, a pulse that is none, a motion that cannot be followed.
    pub fn ride(
        &self,
        pulse: &CrashPulse,
        impact_speed_m_per_s: f64,
        until_s: f64,
    ) -> Result<OccupantMotion, LumpedError> {
        positive("impact_speed_m_per_s", impact_speed_m_per_s)?;
        positive("until_s", until_s)?;
        let structure = Structure::row(&[self.mass_kg], [vec![self.restraint.clone().into()]])?;
        let drive = Drive::BasePulse(pulse.reversed());
        structure.check_drive(&drive)?;
        let law = structure.connections()[0].element.law();
        let v0 = impact_speed_m_per_s;
        let of_energy = 2.0 / (self.mass_kg * v0 * v0);
        let mut motion = OccupantMotion {
            contact: (self.restraint.gap_m() == 0.0).then_some([0.0; 2]),
            peak_deceleration: Extremum::default(),
            largest_excursion: Extremum::default(),
            permanent_set_m: 0.0,
            work_of_restraint_j: 0.0,
            relative_speed_end_m_per_s: 0.0,
            excursion_end_m: 0.0,
            vehicle_speed_end_m_per_s: v0,
            stop: None,
        };
        let (mut moves_on, mut ridedown_j) = (true, 0.0);
        walk(&structure, &drive, until_s, until_s, &[], |step, _| {
            let (link, start_s, length_s) = (&step.links[0], step.start_s, step.length_s);
            for entry in &step.entered {
                if law.event(&entry.before, &entry.after) == Some(ElementEvent::Contact) {
                    motion.contact.get_or_insert([start_s, link.w[0]]);
                }
            }
            let force = link.series(&link.law);
            let over_ground = |v: &Series| -> Series { std::array::from_fn(|k| v[k] + if k == 0 { v0 } else { 0.0 }) };
            let [occupant, vehicle] = [0, 1].map(|node| over_ground(&step.nodes[node].v));
            let power = |speed: &Series| -> Series { std::array::from_fn(|k| product(&force, speed, k)) };
            let (restraint, ridedown) = (power(&link.w), power(&vehicle));
            let deceleration: Series = force.map(|term| term / self.mass_kg);
            largest_coefficient(&deceleration, |x| x, start_s, length_s, &mut motion.peak_deceleration);
            largest_coefficient(&link.u, |x| x, start_s, length_s, &mut motion.largest_excursion);
            if motion.stop.is_none()
                && let Some(tau) = falls(&occupant, length_s, &mut moves_on)
            {
                motion.stop = Some(OccupantStop {
                    time_s: start_s + tau,
                    ridedown_share: of_energy * (ridedown_j + integral(&ridedown, tau)),
                    restraint_share: of_energy * (motion.work_of_restraint_j + integral(&restraint, tau)),
                });
            }
            motion.work_of_restraint_j += integral(&restraint, length_s);
            ridedown_j += integral(&ridedown, length_s);
            motion.permanent_set_m = step.branches[0].set;
            motion.relative_speed_end_m_per_s = value(&link.w, length_s);
            motion.excursion_end_m = value(&link.u, length_s);
            motion.vehicle_speed_end_m_per_s = value(&vehicle, length_s);
            true
        })?;
        Ok(motion)
    }
}
