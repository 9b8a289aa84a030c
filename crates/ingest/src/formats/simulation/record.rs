//! A simulation as a record: units, the line of driving, the node, contact by the wall, mass and speed.
//!
//! Channels are the walls, contacts, energies, the node of the car and nodes with a title; parts in a list only.

use crumple_signal::{Notes, QuantityKind};

use crate::error::Question;
use crate::formats::simulation::channels::{AXES, Channels, Line, mark_walls};
use crate::formats::simulation::history::{Kind, Member, Simulation, integral};
use crate::formats::simulation::nodes;
use crate::formats::simulation::remarks::{
    Aliased, NoWall, Simulated, StartMissing, Turned, Undersampled, UnitsDoubted, UnitsOfModel,
};
use crate::recording::content::{Fitness, PulseRule, Recording};
use crate::recording::details::{Details, Stated};
use crate::recording::unit_system::{Evidence, Units};
use crate::{IngestError, IngestSettings, Result, refuse_channel};

/// The wall acts from this part of its peak on.
const CONTACT: f64 = 0.005;
/// A wall with less than this part of the largest force along the line is none that is hit.
const HIT: f64 = 0.01;
/// Integral of the acceleration off the velocity, m/s; impulse off the momentum, as a part.
const ALIASED_M_PER_S: f64 = 0.1;
const UNDERSAMPLED: f64 = 0.02;

/// The record of a simulation.
///
/// # Errors
/// Units that nothing states, with the system that fits; a node that cannot be chosen; no node.
pub fn recording(file: &str, mut simulation: Simulation, settings: &IngestSettings) -> Result<Recording> {
    let mut notes = std::mem::take(&mut simulation.notes);
    let contents = simulation.contents.join("; ");
    notes.push(Simulated { solver: simulation.solver.clone(), contents: contents.clone() });
    let choice = nodes::choose(file, &simulation, settings);
    let node = choice.as_ref().ok().copied().flatten();
    let (line, speed) = line(&simulation, node, settings);
    let mass = mass(&simulation);
    let end = simulation.members.iter().filter_map(|member| member.times.last()).copied().reduce(f64::max);
    let evidence = Evidence { end, speed: Some(speed).filter(|v| *v > 0.0), mass: mass.map(|(mass, _)| mass) };
    let units = units(file, &simulation, evidence, settings, &mut notes)?;
    if !settings.listing && choice?.is_none() && settings.allow_missing != Some(true) {
        return refuse_channel(file, NO_NODE, "the motion of a node (nodout, /TH/NODE)", NO_NODE_HINT);
    }
    let facts = vec![format!("simulation by {}: {contents}", simulation.solver)];
    let title = Some(simulation.title.clone()).filter(|title| !title.is_empty());
    let title = title.map(|value| Stated { value, from: file.to_owned() });
    let mut details = Details { title, facts, ..Details::default() };
    let walls = walls(&simulation, line, settings);
    if let Some(units) = units {
        details.mass_kg = mass.map(|(mass, from)| Stated { value: mass * units.mass_kg, from: from.to_owned() });
        if let Some(node) = node {
            let motion = Motion { node: &simulation.members[node], units, line };
            motion.check(&mut notes);
            motion.settle(&walls, &mut details, &mut notes);
        }
        check_impulse(&simulation, &walls, line, units, mass.map(|(mass, _)| mass), &mut notes);
    }
    let mut channels = Channels::new(file, settings, units, line);
    for (k, member) in simulation.members.iter().enumerate() {
        let is_channel = match member.kind {
            Kind::Node => Some(k) == node || !member.title.is_empty(),
            Kind::Part => false,
            _ => true,
        };
        if is_channel || settings.listing {
            channels.add(member, &mut notes)?;
        }
    }
    let mut channels = channels.found;
    let of_walls: Vec<&Member> = if settings.wall.is_none() { walls } else { Vec::new() };
    mark_walls(&mut channels, &of_walls);
    let pulse = node.map(|node| format!("node.{}.{}_acceleration", simulation.members[node].id, AXES[line.axis]));
    if let Some(read) = channels.iter_mut().find(|read| pulse.as_ref() == Some(&read.channel.id)) {
        let why = if settings.node.is_some() { "the node of --node" } else { "the only node" };
        read.fitness = Fitness::of_only(QuantityKind::Acceleration, why);
    }
    Ok(Recording { details, channels, pulse_rule: PulseRule::OnlyOne, contact_at_zero: false, notes })
}

const NO_NODE: &str = "no node is in it (no nodout, no /TH/NODE): no motion, so no pulse";
const NO_NODE_HINT: &str =
    "give the folder with the file that has nodout; --allow-missing reads forces and energies alone";

/// The line of driving, along the axis of `--axis`, else that of the largest speed at the start; and that speed, in the
/// units of the file, 0 where nothing has one: of the node, the model or the first node.
fn line(simulation: &Simulation, node: Option<usize>, settings: &IngestSettings) -> (Line, f64) {
    let at_start = |axis: &str| {
        let name = format!("{axis}_velocity");
        let of_node = node.and_then(|node| simulation.members[node].column(&name));
        let of_model = || simulation.of(Kind::Global).find_map(|model| model.column(&format!("global_{name}")));
        let of_first = || simulation.of(Kind::Node).find_map(|node| node.column(&name));
        of_node.or_else(of_model).or_else(of_first).and_then(|values| values.first().copied()).unwrap_or(0.0)
    };
    let speeds = AXES.map(at_start);
    let fastest = (0..3).fold(0, |best, k| if speeds[k].abs() > speeds[best].abs() { k } else { best });
    let axis = settings.axis.map_or(fastest, |axis| axis as usize);
    let sign = if speeds[axis] < 0.0 { -1.0 } else { 1.0 };
    (Line { axis, sign }, speeds[axis].abs())
}

/// Mass of what moves, in the units of the file, and what says so: the globals; else twice the kinetic energy over the
/// square of the speed of the whole at the start.
fn mass(simulation: &Simulation) -> Option<(f64, &'static str)> {
    let model = simulation.of(Kind::Global).next()?;
    let first = |name: &str| model.column(name).and_then(|values| values.first()).copied();
    let stated = first("mass").map(|mass| (mass, "the globals of the file"));
    let of_energy = || {
        let squares = AXES.map(|axis| first(&format!("global_{axis}_velocity")).unwrap_or(0.0).powi(2));
        let square: f64 = squares.iter().sum();
        let mass = 2.0 * first("kinetic_energy")? / square;
        Some((mass, "kinetic energy and speed at the start"))
    };
    stated.or_else(of_energy).filter(|(mass, _)| mass.is_finite() && *mass > 0.0)
}

/// The units: of the flag, else of the file; `None` for a list of which nothing states them.
fn units(
    file: &str,
    simulation: &Simulation,
    evidence: Evidence,
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Result<Option<Units>> {
    let fitting = evidence.fitting();
    let names: Vec<String> = fitting.iter().map(|system| format!("--units {system}")).collect();
    let stated = settings.units.map(|system| (system.units(), "--units"));
    let Some((units, from)) = stated.or_else(|| simulation.units.map(|units| (units, "the file"))) else {
        if settings.listing {
            return Ok(fitting.first().filter(|_| fitting.len() == 1).map(|system| system.units()));
        }
        let reason = if simulation.of(Kind::Node).next().is_none() { format!("; {NO_NODE}") } else { String::new() };
        let in_all = evidence.in_all();
        let hint = match fitting.as_slice() {
            [one] => format!("add {} ({}), if the model is in these", names[0], evidence.words(one.units())),
            [] => format!(
                "no system makes it a crash of a car ({in_all}): state the one of the model, such as --units mm-s-t"
            ),
            _ => format!("add {}: nothing in it tells them apart ({in_all})", names.join(" or ")),
        };
        let expected = "the system of units of the model: mm-ms-kg, mm-s-t, m-s-kg or mm-ms-g";
        let error = IngestError::not_stated(file, format!("its units{reason}"), expected, &hint);
        return Err(error.asking(Question::Units(fitting.first().map(|system| system.name()))));
    };
    let system = units.system().map_or_else(|| "of its own".to_owned(), |system| system.to_string());
    let (from, words) = (from.to_owned(), evidence.words(units));
    // A flag that is wrong, where mass and speed tell which one is right.
    let is_told = evidence.speed.is_some() && evidence.mass.is_some();
    if stated.is_some() && is_told && !fitting.is_empty() && !evidence.is_car(units) && !settings.listing {
        let found = format!("{system} by --units give {words}, which is no crash of a car");
        let expected = "mass, speed and duration of a crash of a car";
        let error = IngestError::units(file, found, expected, &names.join(" or "));
        return Err(error.asking(Question::Units(fitting.first().map(|system| system.name()))));
    }
    if evidence.is_car(units) {
        notes.push(UnitsOfModel { system, from, words });
    } else {
        let fitting =
            if names.is_empty() { "no system does".to_owned() } else { format!("{} fits", names.join(" or ")) };
        notes.push(UnitsDoubted { system, from, words, fitting });
    }
    Ok(Some(units))
}

/// The walls that are hit: those asked for, else those with a force along the line.
fn walls<'a>(simulation: &'a Simulation, line: Line, settings: &IngestSettings) -> Vec<&'a Member> {
    let name = format!("{}_force", AXES[line.axis]);
    let peak =
        |wall: &Member| wall.column(&name).map_or(0.0, |force| force.iter().fold(0.0_f64, |most, f| most.max(f.abs())));
    if let Some(wanted) = settings.wall.as_deref().map(str::trim) {
        let is_it = |member: &&Member| {
            let channel = format!("{}.{}.{name}", member.kind.word(), member.id);
            member.id == wanted || member.title.eq_ignore_ascii_case(wanted) || channel == wanted
        };
        return simulation.of(Kind::Wall).chain(simulation.of(Kind::Contact)).filter(is_it).collect();
    }
    let largest = simulation.of(Kind::Wall).map(peak).fold(0.0, f64::max);
    simulation.of(Kind::Wall).filter(|wall| largest > 0.0 && peak(wall) >= HIT * largest).collect()
}

/// The motion that stands for the car.
struct Motion<'a> {
    node: &'a Member,
    units: Units,
    line: Line,
}

impl Motion<'_> {
    fn column(&self, what: &str) -> Option<&[f64]> {
        self.node.column(&format!("{}_{what}", AXES[self.line.axis]))
    }

    fn m_per_s(&self) -> f64 {
        self.units.length_m / self.units.time_s
    }

    /// Says where the acceleration as written does not fit the velocity.
    fn check(&self, notes: &mut Notes) {
        let Some(velocity) = self.column("velocity").filter(|v| !v.is_empty()) else { return };
        let Some(acceleration) = self.column("acceleration") else { return };
        let of: Vec<f64> = integral(&self.node.times, acceleration).iter().map(|dv| velocity[0] + dv).collect();
        let off = of.iter().zip(velocity).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) * self.m_per_s();
        if off > ALIASED_M_PER_S {
            let end = |values: &[f64]| self.line.sign * self.m_per_s() * values.last().copied().unwrap_or(0.0);
            let (integral_m_per_s, velocity_m_per_s) = (end(&of), end(velocity));
            let node = self.node.id.clone();
            notes.push(Aliased { node, largest_m_per_s: off, integral_m_per_s, velocity_m_per_s });
        }
    }

    /// States contact by the force of the walls, and the speed there.
    fn settle(&self, walls: &[&Member], details: &mut Details, notes: &mut Notes) {
        let contacts = walls.iter().filter_map(|wall| Some((*wall, contact(wall, AXES[self.line.axis])?)));
        let first = contacts.reduce(|a, b| if b.1.0 < a.1.0 { b } else { a });
        let mut at = self.node.times.first().copied().unwrap_or(0.0);
        match first {
            Some((wall, (time, is_missing))) => {
                let word = wall.kind.word();
                if is_missing {
                    notes.push(StartMissing { wall: wall.id.clone() });
                }
                at = time;
                let from = format!("the force of {word} {}", wall.id);
                // To the nanosecond, as the flag may state it.
                let value = (time * self.units.time_s * 1e9).round() / 1e9;
                details.time_zero_s = Some(Stated { value, from });
            }
            None => notes.push(NoWall {}),
        }
        let Some(velocity) = self.column("velocity") else { return };
        let speed = interpolated(&self.node.times, velocity, at).map_or(0.0, |v| v.abs() * self.m_per_s());
        if self.line.sign < 0.0 {
            notes.push(Turned { axis: AXES[self.line.axis].to_owned(), speed_m_per_s: speed });
        }
        if speed > 0.0 {
            let what = if first.is_some() { "at contact" } else { "at the start" };
            let from = format!("the velocity of node {} {what}", self.node.id);
            details.impact_speed_m_per_s = Some(Stated { value: speed, from });
        }
    }
}

/// When the force of a wall begins, and whether it has begun in the first state; `None` without a force.
///
/// Of the first two states above 0.5 % of the peak a line is drawn down to 0, not before the state in front of them: a
/// force begins in proportion to the way. An impulse begins with its square, so that its root is such a line.
fn contact(wall: &Member, axis: &str) -> Option<(f64, bool)> {
    let impulse = wall.column(&format!("{axis}_impulse"));
    let values: Vec<f64> = match impulse {
        Some(impulse) => impulse.iter().map(|x| x.abs().sqrt()).collect(),
        None => wall.column(&format!("{axis}_force"))?.iter().map(|x| x.abs()).collect(),
    };
    let peak = values.iter().copied().fold(0.0, f64::max);
    let first = values.iter().position(|x| *x > CONTACT * peak)?;
    let times = &wall.times;
    let (Some(before), Some(next)) = (first.checked_sub(1), values.get(first + 1)) else {
        return Some((times[first], first == 0));
    };
    let slope = (next - values[first]) / (times[first + 1] - times[first]);
    let back = if slope > 0.0 { values[first] / slope } else { 0.0 };
    Some(((times[first] - back).max(times[before]), false))
}

/// The value at a time, between two states; that of the end outside.
fn interpolated(times: &[f64], values: &[f64], at: f64) -> Option<f64> {
    let next = times.partition_point(|t| *t < at);
    let (Some(before), Some(b)) = (next.checked_sub(1), times.get(next)) else {
        return if next == 0 { values.first().copied() } else { values.last().copied() };
    };
    let part = (at - times[before]) / (b - times[before]);
    Some(values[before] + part * (values[next] - values[before]))
}

/// Says where the walls' impulse is not the change of momentum.
fn check_impulse(
    simulation: &Simulation,
    walls: &[&Member],
    line: Line,
    units: Units,
    mass: Option<f64>,
    notes: &mut Notes,
) {
    let axis = AXES[line.axis];
    let change = |values: &[f64]| values.last().zip(values.first()).map(|(last, first)| last - first);
    let of = |kind: Kind| {
        let changes = simulation.of(kind).filter_map(|member| change(member.column(&format!("{axis}_momentum"))?));
        changes.reduce(|sum, change| sum + change)
    };
    let of_speed = || {
        let speed = simulation.of(Kind::Global).find_map(|model| model.column(&format!("global_{axis}_velocity")));
        Some(mass? * change(speed?)?)
    };
    let momentum = of(Kind::Part).or_else(|| of(Kind::Global)).or_else(of_speed);
    let forces = || walls.iter().filter_map(|wall| Some((*wall, wall.column(&format!("{axis}_force"))?)));
    let impulse: f64 = forces().filter_map(|(wall, force)| integral(&wall.times, force).pop()).sum();
    let states = forces().flat_map(|(_, force)| force.iter().map(|f| f.abs()).zip(1..));
    let Some(((peak, state), momentum)) = states.reduce(|a, b| if b.0 > a.0 { b } else { a }).zip(momentum) else {
        return;
    };
    let n_s = units.mass_kg * units.length_m / units.time_s;
    if momentum != 0.0 && (impulse.abs() / momentum.abs() - 1.0).abs() > UNDERSAMPLED {
        let (impulse_n_s, momentum_n_s, peak_n) =
            (impulse.abs() * n_s, momentum.abs() * n_s, peak * n_s / units.time_s);
        notes.push(Undersampled { impulse_n_s, momentum_n_s, peak_n, state });
    }
}
