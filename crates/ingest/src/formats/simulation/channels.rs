//! Histories as channels in SI on uniform grids, along the line of driving.

use std::rc::Rc;

use crumple_signal::{Axis, BARRIER, Channel, ChannelStatus, Notes, QuantityKind, Sampled};

use crate::formats::simulation::history::{Kind, Member, derivative, quantity};
use crate::formats::simulation::remarks::UnequalStates;
use crate::recording::content::{Ids, ReadChannel};
use crate::recording::unit_system::Units;
use crate::time::{Grid, LinearInterpolation, OnGrid, on_grid};
use crate::{IngestSettings, Place, Result};

/// Letters of the axes in names of columns.
pub const AXES: [&str; 3] = ["x", "y", "z"];

/// The line of driving: which axis, and whether the model drives along (1) or against it (-1).
#[derive(Debug, Clone, Copy)]
pub struct Line {
    pub axis: usize,
    pub sign: f64,
}

impl Line {
    /// The axis of a column after the model is turned to drive along x, and the factor of its values. The turn is half
    /// a one about the vertical.
    fn turned(self, name: &str) -> (Option<Axis>, f64) {
        let Some(own) = AXES.iter().position(|axis| name.trim_start_matches("global_").split('_').next() == Some(axis))
        else {
            return (None, 1.0);
        };
        match (own == self.axis, own, self.axis) {
            (true, ..) => (Some(Axis::X), self.sign),
            (_, 2, _) => (Some(Axis::Z), 1.0),
            (_, _, 0 | 1) => (Some(Axis::Y), self.sign),
            _ => (None, 1.0),
        }
    }
}

/// Times of a member in s, on a grid.
struct OwnGrid {
    times: Vec<f64>,
    grid: Grid,
    interpolation: Option<LinearInterpolation>,
}

/// What members become channels of.
pub struct Channels<'a> {
    pub file: &'a str,
    pub settings: &'a IngestSettings,
    /// `None`: a list, of which the units are not known; values stay as they are.
    pub units: Option<Units>,
    pub line: Line,
    pub found: Vec<ReadChannel>,
    ids: Ids,
    /// The last one: nodes share it.
    grid: Option<Rc<OwnGrid>>,
}

impl<'a> Channels<'a> {
    /// No channels yet.
    pub fn new(file: &'a str, settings: &'a IngestSettings, units: Option<Units>, line: Line) -> Self {
        Self { file, settings, units, line, found: Vec::new(), ids: Ids::default(), grid: None }
    }

    /// The channels of a member. A node's acceleration is the derivative of its velocity where it has one.
    pub fn add(&mut self, member: &Member, notes: &mut Notes) -> Result<()> {
        let Some(own) = self.grid(member, notes)? else { return Ok(()) };
        for (name, values) in &member.columns {
            let of_velocity = name.replace("_acceleration", "_velocity");
            let is_derived = of_velocity != *name && member.column(&of_velocity).is_some();
            if is_derived || name == "normal_force" || name.ends_with("_impulse") {
                continue;
            }
            self.push(member, name, values, &own);
            if let Some(axis) = name.strip_suffix("_velocity").filter(|_| member.kind == Kind::Node) {
                self.push(member, &format!("{axis}_acceleration"), &derivative(&member.times, values), &own);
            }
        }
        Ok(())
    }

    /// Adds a channel of values in the units of the file.
    fn push(&mut self, member: &Member, name: &str, values: &[f64], own: &OwnGrid) {
        let OwnGrid { grid, interpolation, .. } = own;
        let samples = match interpolation {
            Some(interpolation) => interpolation.apply(values.len(), |k| values[k]),
            None => values.to_vec(),
        };
        let (kind, powers) = quantity(name);
        let (axis, turn) = self.line.turned(name);
        let of_units = self.units.map_or(1.0, |units| {
            let [length, time, mass] = powers;
            units.length_m.powi(length) * units.time_s.powi(time) * units.mass_kg.powi(mass)
        });
        // The force on a wall is that along the line of driving, as load cells have it.
        let is_along = axis == Some(Axis::X);
        let is_on_wall = member.kind == Kind::Wall && kind == QuantityKind::Force && is_along;
        let turn = if is_on_wall { values.iter().sum::<f64>().signum() } else { turn };
        // No -0.
        let samples: Vec<f64> = samples.into_iter().map(|x| turn * of_units * x + 0.0).collect();
        let id = format!("{}.{name}", member.name());
        let mut channel = Channel::new(self.ids.unique(&id), self.units.map_or(QuantityKind::Other, |_| kind));
        channel.axis = axis;
        channel.location = member.title.clone();
        if kind == QuantityKind::Acceleration && member.column(&name.replace("acceleration", "velocity")).is_some() {
            channel.status = ChannelStatus::Computed;
        }
        let of_file = if turn < 0.0 { "; the file has the other sign" } else { "" };
        channel.comment = match (self.units, kind) {
            (None, _) => member
                .times
                .last()
                .map(|end| format!("{} states up to {end}, in units of the file", member.times.len())),
            (Some(_), QuantityKind::Other) => Some(format!("{}{of_file}", unit_of(powers))),
            (Some(_), _) => Some(of_file.trim_start_matches("; ").to_owned()).filter(|text| !text.is_empty()),
        };
        let wave = Sampled::new(grid.t0_s, grid.dt_s, samples).ok();
        let jitter = grid.jitter;
        let aliases = if is_along && kind == QuantityKind::Force {
            vec![member.id.clone(), format!("wall {}", member.id), member.title.clone()]
        } else {
            vec![format!("{}/{name}", member.title)]
        };
        self.found.push(ReadChannel { wave, jitter, aliases, ..ReadChannel::new(channel) });
    }

    /// The grid of a member's times; `None` with fewer than two states. States at unequal times are resampled.
    fn grid(&mut self, member: &Member, notes: &mut Notes) -> Result<Option<Rc<OwnGrid>>> {
        if member.times.len() < 2 {
            return Ok(None);
        }
        if let Some(known) = self.grid.as_ref().filter(|own| own.times == member.times) {
            return Ok(Some(Rc::clone(known)));
        }
        // By division where that is exact: 20 ms are 0.02 s to the last bit.
        let unit_s = self.units.map_or(1.0, |units| units.time_s);
        let inverse = (1.0 / unit_s).round();
        let times: Vec<f64> =
            member.times.iter().map(|t| if unit_s < 1.0 { t / inverse } else { t * unit_s }).collect();
        // As a list has it: at the median step where a solver could not hit its interval.
        let settings = IngestSettings { listing: true, resample: self.settings.resample, ..IngestSettings::default() };
        let place = |_| Place::file(self.file).in_column(member.name());
        let OnGrid { grid, interpolation, .. } = on_grid(&times, resolution(&member.times) * unit_s, &settings, place)?;
        if interpolation.is_some() && !self.settings.listing {
            notes.push(UnequalStates { of: member.name(), rate_hz: 1.0 / grid.dt_s });
        }
        let own = Rc::new(OwnGrid { times: member.times.clone(), grid, interpolation });
        Ok(Some(Rc::clone(self.grid.insert(own))))
    }
}

/// The resolution of times: of what is printed with six to eight digits, of single precision, else none.
fn resolution(times: &[f64]) -> f64 {
    let largest = times.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
    let is_printed = |digits: &usize| times.iter().all(|t| format!("{t:.digits$e}").parse() == Ok(*t));
    match [5, 6, 7].into_iter().find(is_printed) {
        Some(digits) => 10_f64.powf(largest.log10().floor() - digits as f64),
        None if times.iter().all(|t| f64::from(*t as f32) == *t) => largest * f64::from(f32::EPSILON),
        None => 0.0,
    }
}

fn unit_of(powers: [i32; 3]) -> &'static str {
    match powers {
        [2, -2, 1] => "J",
        [1, -1, 1] => "N s",
        [0, 0, 1] => "kg",
        [0, 1, 0] => "s",
        _ => "",
    }
}

/// Marks the forces along the line of driving of these walls as those on the barrier.
pub fn mark_walls(channels: &mut [ReadChannel], walls: &[&Member]) {
    for read in channels.iter_mut().filter(|read| read.channel.quantity == QuantityKind::Force) {
        let is_of = |wall: &&&Member| {
            read.channel.axis == Some(Axis::X) && read.channel.id.starts_with(&format!("{}.", wall.name()))
        };
        if let Some(wall) = walls.iter().find(is_of) {
            let title = if wall.title.is_empty() { String::new() } else { format!(", {}", wall.title) };
            read.channel.location = format!("{BARRIER}{title}");
        } else if read.channel.location.is_empty() {
            "rigid wall or contact".clone_into(&mut read.channel.location);
        }
    }
}
