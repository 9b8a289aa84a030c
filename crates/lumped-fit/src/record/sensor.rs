//! Sensors: where they sit, what they measured, how far a model misses them.
//!
//! A place names a mass of any model, so that one list of sensors serves models of one, two and three masses: a
//! sensor on a mass that a model does not have is left out for that model.

use std::fmt;
use std::str::FromStr;

use crumple_signal::Sampled;

use crate::{FitQuantity, Measurement};

/// How the sentence on the misfit of several sensors begins.
const ERRORS: &str = "root mean square errors ";

/// The root mean square error of each sensor with its channel and place: `8.1 mm at 93 (compartment)`. Displacements
/// are given in mm, other quantities in their SI unit.
pub fn errors_in_words<'a>(errors: impl IntoIterator<Item = (f64, FitQuantity, &'a str, String)>) -> String {
    let error_text = |(rmse, quantity, channel, place): (f64, FitQuantity, &str, String)| {
        let (value, unit) = match quantity {
            FitQuantity::Displacement => (1e3 * rmse, "mm"),
            other => (rmse, other.unit()),
        };
        format!("{value:.4} {unit} at {channel} ({place})")
    };
    errors.into_iter().map(error_text).collect::<Vec<_>>().join(", ")
}

/// The note on these [`errors_in_words`]. `seen`: how the model was compared, `"through the filter"`; `None` for the
/// motion itself.
pub fn note_of_errors(errors: &str, seen: Option<&str>) -> String {
    let seen = seen.map_or_else(String::new, |seen| format!("seen {seen} "));
    format!("{ERRORS}{seen}{errors}; residuals weighted by the noise level of each sensor")
}

/// The mass of a model that a sensor sits on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SensorPlace {
    /// The last mass.
    Compartment,
    /// The mass next to the barrier: engine and front structure.
    Front,
    /// The mass in front of the compartment.
    Chassis,
    /// A mass by its number from the barrier on, from 1.
    Mass(usize),
    /// The occupant, who is the last mass of a chain that says so, behind the compartment.
    Occupant,
}

impl SensorPlace {
    /// Index of the mass, from the barrier on, in a model of so many masses; `None` if the model has no such mass. A
    /// model of one mass has a compartment only; in one of two, front and chassis are the same mass.
    pub fn mass(self, masses: usize) -> Option<usize> {
        match self {
            Self::Compartment => masses.checked_sub(1),
            Self::Front => (masses > 1).then_some(0),
            Self::Chassis => (masses > 1).then(|| masses - 2),
            Self::Mass(number) => (number >= 1 && number <= masses).then(|| number - 1),
            Self::Occupant => None,
        }
    }

    /// The same in a model whose last mass is the occupant, so that the compartment is the one in front of it.
    pub fn mass_before_occupant(self, masses: usize) -> Option<usize> {
        match self {
            Self::Occupant => masses.checked_sub(1).filter(|last| *last > 0),
            Self::Mass(_) => self.mass(masses),
            _ => self.mass(masses.saturating_sub(1)),
        }
    }
}

impl fmt::Display for SensorPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Compartment => f.write_str("compartment"),
            Self::Front => f.write_str("front"),
            Self::Chassis => f.write_str("chassis"),
            Self::Mass(number) => write!(f, "m{number}"),
            Self::Occupant => f.write_str("occupant"),
        }
    }
}

impl FromStr for SensorPlace {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "compartment" => Ok(Self::Compartment),
            "front" | "engine" => Ok(Self::Front),
            "chassis" => Ok(Self::Chassis),
            "occupant" => Ok(Self::Occupant),
            _ => text
                .strip_prefix('m')
                .and_then(|number| number.parse().ok())
                .filter(|number| *number > 0)
                .map(Self::Mass)
                .ok_or_else(|| {
                    format!(
                        "no place of a sensor: {text:?}; expected compartment, front, chassis, occupant or m1, m2, ..."
                    )
                }),
        }
    }
}

/// A record of a sensor that a model is fitted to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor<'a> {
    /// Its channel, for records and notes.
    pub channel: &'a str,
    /// Where it sits.
    pub place: SensorPlace,
    /// What it says.
    pub quantity: FitQuantity,
    /// Its samples, SI.
    pub record: &'a Sampled,
    /// How it was measured; `None`: not known, the motion itself is compared.
    pub measurement: Option<Measurement>,
    /// Its noise level, unit of the quantity; `None`: from the residuals, so that every sensor counts by how well the
    /// model can meet it.
    pub noise: Option<f64>,
}

/// How far a fitted model misses a sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorFit {
    /// Its channel.
    pub channel: String,
    /// Number of its mass, from 1 at the barrier.
    pub mass: usize,
    /// What was fitted.
    pub quantity: FitQuantity,
    /// Root mean square error, unit of the quantity.
    pub rmse: f64,
    /// Noise level its residuals were divided by, unit of the quantity.
    pub noise: f64,
}
