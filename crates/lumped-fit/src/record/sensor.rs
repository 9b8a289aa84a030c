//! Sensors on a model: which quantity they say, where they sit, what a test hands to all solvers, and the force on the
//! wall.

use std::fmt;
use std::str::FromStr;

use crumple_lumped::{Asked, Instants, LumpedError, Motion, Place, Sensitivity, Structure, Waves};
use crumple_signal::{Displacement, Measurement, QuantityKind, Sampled, Signal};

use crate::error::SolveError;
use crate::record::observation::ObservedWave;

/// What of a motion is fitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, PartialOrd, Ord)]
pub enum FitQuantity {
    /// Displacement, m: smooth, and what crush is read from.
    #[default]
    Displacement,
    /// Velocity, m/s.
    Velocity,
    /// Acceleration, m/s²: what the sensor measures; stiff structures show here.
    Acceleration,
    /// Force on the wall, N, positive in compression.
    Force,
}

impl FitQuantity {
    /// Those of a mass.
    pub const ALL: [Self; 3] = [Self::Displacement, Self::Velocity, Self::Acceleration];

    /// The name in options and records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Force => "force",
        }
    }

    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::Velocity => "m/s",
            Self::Acceleration => "m/s^2",
            Self::Force => "N",
        }
    }

    /// The quantity as a channel has it.
    pub const fn kind(self) -> QuantityKind {
        match self {
            Self::Displacement => QuantityKind::Displacement,
            Self::Velocity => QuantityKind::Velocity,
            Self::Acceleration => QuantityKind::Acceleration,
            Self::Force => QuantityKind::Force,
        }
    }

    /// What is asked of a motion for it.
    pub(crate) const fn waves(self) -> Waves {
        match self {
            Self::Displacement => Waves::Displacement,
            Self::Velocity => Waves::Velocity,
            Self::Acceleration | Self::Force => Waves::Acceleration,
        }
    }

    /// What is recorded before filter and integration: the acceleration, of the wall its force.
    pub(crate) const fn recorded(self) -> Self {
        match self {
            Self::Force => Self::Force,
            _ => Self::Acceleration,
        }
    }

    /// Its samples in a motion, in its unit. The motion of the wall has its force in the place of the acceleration.
    pub(crate) fn of(self, motion: &Motion) -> &[f64] {
        match self {
            Self::Displacement => &motion.displacement_m,
            Self::Velocity => &motion.velocity_m_per_s,
            Self::Acceleration | Self::Force => &motion.acceleration_m_per_s2,
        }
    }
}

impl FitQuantity {
    /// The same, taken out of it.
    pub(crate) fn taken_of(self, motion: Motion) -> Vec<f64> {
        match self {
            Self::Displacement => motion.displacement_m,
            Self::Velocity => motion.velocity_m_per_s,
            Self::Acceleration | Self::Force => motion.acceleration_m_per_s2,
        }
    }
}

impl fmt::Display for FitQuantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for FitQuantity {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|quantity| quantity.name() == text).ok_or_else(|| {
            format!("unknown quantity {text:?}, expected one of {}", Self::ALL.map(Self::name).join(", "))
        })
    }
}

/// How the sentence on the misfit of several sensors begins.
const ERRORS: &str = "root mean square errors ";

/// The root mean square error of each sensor with its channel and place: `8.1 mm at 93 (compartment)`. Displacements
/// are given in mm, forces in kN, other quantities in their SI unit.
pub(crate) fn errors_in_words<'a>(errors: impl IntoIterator<Item = (f64, FitQuantity, &'a str, String)>) -> String {
    let error_text = |(rmse, quantity, channel, place): (f64, FitQuantity, &str, String)| {
        let (value, unit) = match quantity {
            FitQuantity::Displacement => (1e3 * rmse, "mm"),
            FitQuantity::Force => (1e-3 * rmse, "kN"),
            other => (rmse, other.unit()),
        };
        format!("{value:.4} {unit} at {channel} ({place})")
    };
    errors.into_iter().map(error_text).collect::<Vec<_>>().join(", ")
}

/// The note on these [`errors_in_words`]. `seen`: how the model was compared, `"through the filter"`; `None` for the
/// motion itself.
pub(crate) fn note_of_errors(errors: &str, seen: Option<&str>) -> String {
    let seen = seen.map_or_else(String::new, |seen| format!("seen {seen} "));
    format!("{ERRORS}{seen}{errors}; residuals weighted by the noise level of each sensor")
}

/// The mass of a model that a sensor sits on, or the wall.
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
    /// The wall, whose force is measured.
    Wall,
}

impl SensorPlace {
    /// Index of the mass, from the barrier on, in a model of so many masses; `None` if the model has no such mass. A
    /// model of one mass has a compartment only; in one of two, front and chassis are the same mass. The wall stands
    /// behind the last.
    pub fn mass(self, masses: usize) -> Option<usize> {
        match self {
            Self::Compartment => masses.checked_sub(1),
            Self::Front => (masses > 1).then_some(0),
            Self::Chassis => (masses > 1).then(|| masses - 2),
            Self::Mass(number) => (number >= 1 && number <= masses).then(|| number - 1),
            Self::Occupant => None,
            Self::Wall => Some(masses),
        }
    }

    /// The same in a model whose last mass is the occupant, so that the compartment is the one in front of it.
    pub fn mass_before_occupant(self, masses: usize) -> Option<usize> {
        match self {
            Self::Occupant => masses.checked_sub(1).filter(|last| *last > 0),
            Self::Mass(_) | Self::Wall => self.mass(masses),
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
            Self::Wall => f.write_str("wall"),
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
            "wall" => Ok(Self::Wall),
            _ => text
                .strip_prefix('m')
                .and_then(|number| number.parse().ok())
                .filter(|number| *number > 0)
                .map(Self::Mass)
                .ok_or_else(|| {
                    format!(
                        "no place of a sensor: {text:?}; expected compartment, front, chassis, occupant, wall or m1, \
                         m2, ..."
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
    /// Number of its mass, from 1 at the barrier; 0: the wall.
    pub mass: usize,
    /// What was fitted.
    pub quantity: FitQuantity,
    /// Root mean square error, unit of the quantity.
    pub rmse: f64,
    /// Noise level its residuals were divided by, unit of the quantity.
    pub noise: f64,
}

/// The data of a test: mass, speed, crash events and records.
///
/// Times are seconds after time zero unless stated otherwise. An event that the record does not show is `None`: a
/// vehicle that never stops has no dynamic crush, one that is recorded too shortly no rebound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestData<'a> {
    /// Test mass, kg.
    pub mass_kg: f64,
    /// Speed at contact, m/s.
    pub impact_speed_m_per_s: f64,
    /// Time of dynamic crush after time zero, s, if the velocity reaches zero.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Dynamic crush, m.
    pub dynamic_crush_m: Option<f64>,
    /// Coefficient of restitution, if the record shows the rebound.
    pub coefficient_of_restitution: Option<f64>,
    /// Time of rebound after time zero, s, if the record shows it.
    pub time_of_rebound_s: Option<f64>,
    /// Displacement of the compartment.
    pub displacement: Option<&'a Signal<Displacement>>,
    /// How it was measured; `None`: not known, the motion itself is compared.
    pub measurement: Option<Measurement>,
    /// Sensors to fit instead of it; none: the compartment's displacement.
    pub sensors: &'a [Sensor<'a>],
}

/// The wave of this quantity that a mass of a structure has after an impact ([`motion_of`]), and its derivatives by the
/// parameters at `places`; other masses stay empty. Of the force on the wall the accelerations of all masses, and the
/// wall behind the last.
pub(crate) fn response_of(
    (mass, quantity): (Option<usize>, FitQuantity),
    structure: &Structure,
    v0_m_per_s: f64,
    at: &Instants,
    places: &[Place],
) -> Result<Sensitivity, LumpedError> {
    let last = structure.masses_kg().len() - 1;
    let mass = (quantity != FitQuantity::Force).then(|| mass.filter(|mass| *mass < last).unwrap_or(last));
    let response = structure.sensitivity_of(Asked { waves: quantity.waves(), mass }, v0_m_per_s, at, places)?;
    Ok(match quantity {
        FitQuantity::Force => with_wall_force(response, structure.masses_kg(), places),
        _ => response,
    })
}

/// The motion of this mass; `None` for `mass`, or beyond the last: of the last, the compartment or the wall behind it.
pub(crate) fn motion_of(motions: &[Motion], mass: Option<usize>) -> Option<&Motion> {
    mass.and_then(|mass| motions.get(mass)).or(motions.last())
}

/// The response with the wall behind its masses, kg: the force `-Σ m_i a_i`, N, and its derivatives.
fn with_wall_force(mut response: Sensitivity, masses_kg: &[f64], places: &[Place]) -> Sensitivity {
    let force_of = |motions: &[Motion]| -> Vec<f64> {
        let samples = motions.first().map_or(0, |motion| motion.acceleration_m_per_s2.len());
        let at = |k: usize| -masses_kg.iter().zip(motions).map(|(m, x)| m * x.acceleration_m_per_s2[k]).sum::<f64>();
        (0..samples).map(at).collect()
    };
    let wall = |force: Vec<f64>| Motion { acceleration_m_per_s2: force, ..Motion::default() };
    for (place, derivative) in places.iter().zip(&mut response.derivatives) {
        let mut force = force_of(derivative);
        // More mass at the same acceleration.
        if let Place::Mass(mass) = place
            && let Some(motion) = response.motions.get(*mass)
        {
            force.iter_mut().zip(&motion.acceleration_m_per_s2).for_each(|(force, a)| *force -= a);
        }
        derivative.push(wall(force));
    }
    let force = force_of(&response.motions);
    response.motions.push(wall(force));
    response
}

/// A measured force on the wall, from contact to the end of its window.
#[derive(Debug, Clone, PartialEq)]
pub struct WallForce {
    wave: ObservedWave,
}

impl WallForce {
    /// The force, N, up to `to_s` after contact; `measurement`: how it was measured. Errors: a window that leaves the
    /// record, or fewer than 12 samples.
    pub fn new(force: &Sampled, measurement: Measurement, to_s: f64) -> Result<Self, SolveError> {
        let what = (None, FitQuantity::Force);
        let wave = ObservedWave::new(force, what, measurement, (0.0, to_s), usize::MAX)?;
        Ok(Self { wave })
    }

    /// End of the window, s after contact.
    pub fn to_s(&self) -> f64 {
        self.wave.window_s().1
    }

    /// How far a model that hits the wall at this speed misses the force, percent: root mean square of the force of the
    /// model, filtered as that measured, less the one measured, over the root mean square of that. `None` for a record
    /// of zeros, and where the model has no response.
    pub fn misfit_percent(&self, structure: &Structure, impact_speed_m_per_s: f64) -> Option<f64> {
        let force = self.wave.response(impact_speed_m_per_s, structure).ok()?;
        let missed: f64 = force.iter().zip(&self.wave.samples).map(|(model, record)| (model - record).powi(2)).sum();
        let measured: f64 = self.wave.samples.iter().map(|force| force * force).sum();
        let same_length = force.len() == self.wave.samples.len();
        Some(100.0 * (missed / measured).sqrt()).filter(|percent| same_length && percent.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_lumped::{Kelvin, Model};

    /// A spring alone: the force is `k x`, the wall feels nothing else.
    #[test]
    fn the_force_of_the_model_itself_is_not_missed_and_half_of_it_by_as_much_again() {
        let model = Kelvin { mass_kg: 1000.0, stiffness_n_per_m: 9e5, damping_n_s_per_m: 0.0 };
        let structure = Model::Kelvin(model).structure().unwrap();
        let omega = 30.0_f64;
        let force = |scale: f64| -> Vec<f64> {
            (0..800).map(|k| scale * 9e5 * 14.0 / omega * (omega * 1e-4 * f64::from(k)).sin()).collect()
        };
        let misfit = |scale: f64| {
            let record = Sampled::new(0.0, 1e-4, force(scale)).unwrap();
            let wall = WallForce::new(&record, Measurement::of_samples(&record), 0.07).unwrap();
            wall.misfit_percent(&structure, 14.0).unwrap()
        };
        // Rounding of 700 steps.
        assert!(misfit(1.0) < 1e-9, "{}", misfit(1.0));
        assert!((misfit(0.5) - 100.0).abs() < 1e-9, "{}", misfit(0.5));
    }
}
