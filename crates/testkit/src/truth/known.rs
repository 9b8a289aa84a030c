//! What is true of a made record, and how often intervals hold it.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crumple_lumped::Model;

use crate::prediction_error::MadeCar;
use crate::records::LowPass;

/// Sample interval, s, and number of the instants at which a model is moved: 0.3 s, beyond any rebound.
const DT_S: f64 = 1e-4;
const INSTANTS: usize = 3001;
/// Samples of rest before contact while a motion is filtered: 50 ms.
const REST: usize = 500;

/// What made a record.
#[derive(Debug, Clone)]
pub enum Maker {
    /// A lumped model, by its exact motion.
    Lumped(Model),
    /// A car of the testkit's own simulator.
    Car(MadeCar),
    /// A pulse of which the test as it was is known, and nothing at another speed or mass.
    Pulse(Impact),
    /// A process with a mode of this frequency, Hz, and damping ratio.
    Mode { frequency_hz: f64, damping_ratio: f64 },
    /// Something that nothing is asked of at another speed.
    Nothing,
}

/// What kind of record it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// A vehicle at a rigid wall.
    Vehicle,
    /// A vehicle that met another one.
    TwoVehicles,
    /// The table of an event data recorder.
    Recorder,
    /// A sensor in an occupant.
    Occupant,
    /// A vehicle whose pulse lies along another axis than that of the models.
    OtherAxis,
    /// Inputs and outputs, no crash.
    InputOutput,
}

/// The truth of a record.
#[derive(Debug, Clone)]
pub struct Known {
    /// What it is of.
    pub subject: Subject,
    /// What made it.
    pub maker: Maker,
    /// The true mass, kg.
    pub mass_kg: Option<f64>,
    /// The true impact speed, m/s.
    pub speed_m_per_s: Option<f64>,
    /// Whether the record states what is true, of a sensor that works: no fault is to be looked for.
    pub is_sound: bool,
    /// What the first or second warning has to name: the flag that makes the record right.
    pub remedy: Option<&'static str>,
    /// Sensors on the vehicle, each on another mass.
    pub sensors: usize,
    /// First contact on the time axis of the file, s.
    pub contact_s: f64,
}

/// A test as it would be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Dynamic crush, m.
    pub crush_m: f64,
    /// Its time, s.
    pub time_s: f64,
    /// Speed of the rebound over that of the impact.
    pub restitution: f64,
    /// Largest deceleration behind CFC 60, m/s².
    pub peak_m_per_s2: f64,
}

impl From<[f64; 4]> for Impact {
    fn from([crush_m, time_s, restitution, peak_m_per_s2]: [f64; 4]) -> Self {
        Self { crush_m, time_s, restitution, peak_m_per_s2 }
    }
}

impl Impact {
    /// A number of it by the name of a key number, or with its unit behind it.
    pub fn named(&self, name: &str, speed_m_per_s: f64) -> Option<f64> {
        match name {
            "dynamic_crush" | "dynamic_crush_m" => Some(self.crush_m),
            "time_of_dynamic_crush" | "time_of_dynamic_crush_s" => Some(self.time_s),
            "coefficient_of_restitution" => Some(self.restitution),
            "peak_acceleration_m_per_s2" => Some(self.peak_m_per_s2),
            "delta_v" | "delta_v_m_per_s" => Some(speed_m_per_s * (1.0 + self.restitution)),
            _ => None,
        }
    }
}

impl Known {
    /// A vehicle that a record states rightly.
    pub fn vehicle(maker: Maker, mass_kg: f64, speed_m_per_s: f64) -> Self {
        Self {
            subject: Subject::Vehicle,
            maker,
            mass_kg: Some(mass_kg),
            speed_m_per_s: Some(speed_m_per_s),
            is_sound: true,
            remedy: None,
            sensors: 1,
            contact_s: 0.0,
        }
    }

    /// A record of which nothing is known but what it is of.
    pub fn of(subject: Subject) -> Self {
        Self { subject, mass_kg: None, speed_m_per_s: None, ..Self::vehicle(Maker::Nothing, 0.0, 0.0) }
    }

    /// The name of the model that made it.
    pub fn model(&self) -> Option<&'static str> {
        match &self.maker {
            Maker::Lumped(model) => Some(model.kind().name()),
            _ => None,
        }
    }

    /// The impact at a speed, m/s, with a mass, kg: what is added sits in the compartment. `None` where the car is not
    /// known or does not stop.
    pub fn impact(&self, speed_m_per_s: f64, mass_kg: f64) -> Option<Impact> {
        let own_kg = self.mass_kg?;
        match &self.maker {
            Maker::Nothing | Maker::Mode { .. } => None,
            // The speed that the record states is up to 1 % off.
            Maker::Pulse(impact) => {
                let own = self.speed_m_per_s?;
                ((speed_m_per_s - own).abs() <= 0.01 * own && mass_kg == own_kg).then_some(*impact)
            }
            Maker::Car(car) => Some(car.impact(speed_m_per_s, mass_kg / own_kg).into()),
            Maker::Lumped(model) => {
                let model = with_mass(model, mass_kg - own_kg)?;
                let response = model.respond(speed_m_per_s, DT_S, INSTANTS).ok()?;
                let motion = response.compartment();
                let rebound = motion.velocity_m_per_s.iter().fold(0.0_f64, |lowest, v| lowest.min(*v));
                let events = model.events(speed_m_per_s).ok()?;
                Some(Impact {
                    crush_m: events.dynamic_crush_m?,
                    time_s: events.time_of_dynamic_crush_s?,
                    restitution: -rebound / speed_m_per_s,
                    peak_m_per_s2: peak_behind_cfc_60(&motion.acceleration_m_per_s2),
                })
            }
        }
    }
}

/// Largest deceleration behind CFC 60, m/s².
fn peak_behind_cfc_60(acceleration: &[f64]) -> f64 {
    let wave = std::iter::repeat_n(0.0, REST).chain(acceleration.iter().copied());
    LowPass::of_class(60.0).both_ways(wave, DT_S).iter().fold(0.0, |peak, a| peak.max(-a))
}

/// A model with more mass in its compartment.
fn with_mass(model: &Model, more_kg: f64) -> Option<Model> {
    let mut parameters = model.parameters();
    let last = ["m3_kg", "m2_kg", "mass_kg"].into_iter().find(|name| parameters.contains_key(*name))?;
    *parameters.get_mut(last)? += more_kg;
    Model::from_parameters(model.kind(), &parameters).ok()
}

/// Counts by quantity: statements, and those that hold the truth.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Counts(BTreeMap<(&'static str, String), (usize, usize)>);

/// Nominal level of all of them, or the lower one of two.
const LEVEL: f64 = 0.9;
/// Standard deviations of the binomial count by which it may be lower; one in a thousand counts is.
const ALLOWANCE: f64 = 3.1;

impl Counts {
    /// Counts a statement of what `kind` has of a quantity.
    pub fn add(&mut self, kind: &'static str, quantity: &str, holds: bool) {
        let (all, held) = self.0.entry((kind, quantity.to_owned())).or_default();
        *all += 1;
        *held += usize::from(holds);
    }

    /// Quantities that hold the truth less often than their level says, chance allowed for.
    pub fn too_low(&self) -> Vec<String> {
        let is_low = |all: usize, held: usize| {
            let all = all as f64;
            (held as f64) < LEVEL * all - ALLOWANCE * (all * LEVEL * (1.0 - LEVEL)).sqrt()
        };
        let low = self.0.iter().filter(|(_, (all, held))| is_low(*all, *held));
        low.map(|((kind, quantity), (all, held))| format!("{kind} {quantity}: {held} of {all} intervals hold"))
            .collect()
    }

    /// Lines of a table: of what, quantity, how many of how many.
    pub fn table(&self) -> String {
        let mut out = "\n| 90 % intervals | quantity | hold the truth |\n|---|---|---|\n".to_owned();
        for ((kind, quantity), (all, held)) in &self.0 {
            let _infallible = writeln!(out, "| {kind} | {quantity} | {held} of {all} |");
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_is_allowed_for() {
        let mut counts = Counts::default();
        for k in 0..40 {
            counts.add("of a test", "enough", k % 5 != 0);
            counts.add("of a test", "few", k % 3 != 0);
        }
        assert_eq!(counts.too_low(), ["of a test few: 26 of 40 intervals hold"]);
    }
}
