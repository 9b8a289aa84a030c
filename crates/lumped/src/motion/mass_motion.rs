//! The motion of masses: states, samples, responses, events.
//!
//! What moves a model: an impact, a force, the motion of the barrier.
//!
//! Samples of a drive are linear between each other, as a recorder's are read everywhere in this program; a response to
//! them is exact, and so is that to a half-sine and a haversine. A drive that is shorter than the response is zero
//! afterwards.

use pulp::Arch;

use crate::LumpedError;
use crate::error::{finite, positive};

/// One mass at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Displacement since contact, m.
    pub displacement_m: f64,
    /// Velocity, m/s.
    pub velocity_m_per_s: f64,
    /// Acceleration, m/s²; at `t = 0` the limit from the right.
    pub acceleration_m_per_s2: f64,
}

/// The motion of one mass at `t = k·dt`, k = 0, 1, ...
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motion {
    /// Displacement since contact, m.
    pub displacement_m: Vec<f64>,
    /// Velocity, m/s.
    pub velocity_m_per_s: Vec<f64>,
    /// Acceleration, m/s²; sample 0 is the limit from the right.
    pub acceleration_m_per_s2: Vec<f64>,
}

/// Waves of a motion that are asked for. What is not asked for may stay empty, and then costs nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Waves {
    /// All three.
    All,
    /// The displacement.
    Displacement,
    /// The velocity.
    Velocity,
    /// The acceleration.
    Acceleration,
}

impl Waves {
    /// Which of displacement, velocity and acceleration are asked for.
    pub(crate) fn asked(self) -> [bool; 3] {
        [Self::Displacement, Self::Velocity, Self::Acceleration].map(|wave| self == Self::All || self == wave)
    }
}

/// What of a response is asked for: the rest may stay empty, and then costs nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Asked {
    /// Waves of a motion.
    pub waves: Waves,
    /// Index of the mass from the barrier on; `None`: all masses.
    pub mass: Option<usize>,
}

impl From<Waves> for Asked {
    /// Of all masses.
    fn from(waves: Waves) -> Self {
        Self { waves, mass: None }
    }
}

impl Asked {
    /// Indices of the masses, of so many.
    pub(crate) fn masses(self, count: usize) -> std::ops::Range<usize> {
        self.mass.map_or(0..count, |mass| mass.min(count)..(mass + 1).min(count))
    }

    /// Motions of so many masses with this many samples of what is asked for, all zero: to be filled in any order.
    pub(crate) fn zeros(self, samples: usize, count: usize) -> Vec<Motion> {
        let asked = self.masses(count);
        let of_mass =
            |mass: usize| if asked.contains(&mass) { Motion::zeros(samples, self.waves) } else { Motion::default() };
        (0..count).map(of_mass).collect()
    }
}

impl Motion {
    /// This many samples of what is asked for, all zero: to be filled in any order.
    pub(crate) fn zeros(samples: usize, waves: Waves) -> Self {
        let [displacement_m, velocity_m_per_s, acceleration_m_per_s2] =
            waves.asked().map(|asked| vec![0.0; if asked { samples } else { 0 }]);
        Self { displacement_m, velocity_m_per_s, acceleration_m_per_s2 }
    }

    /// Displacement, velocity and acceleration.
    pub(crate) fn waves_mut(&mut self) -> [&mut Vec<f64>; 3] {
        [&mut self.displacement_m, &mut self.velocity_m_per_s, &mut self.acceleration_m_per_s2]
    }

    /// Index of the first sample that is not finite.
    pub(crate) fn first_not_finite(&self) -> Option<usize> {
        let waves = [&self.displacement_m, &self.velocity_m_per_s, &self.acceleration_m_per_s2];
        // Nearly always all are finite, and a sum of flags without an early end is found side by side.
        let strays = |samples: &[f64]| samples.iter().map(|x| u64::from(!x.is_finite())).sum::<u64>();
        let all_finite = || waves.iter().all(|samples| strays(samples) == 0);
        if Arch::new().dispatch(all_finite) {
            return None;
        }
        waves.into_iter().filter_map(|samples| samples.iter().position(|x| !x.is_finite())).min()
    }
}

/// The motion of every mass of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Sampling interval, s.
    pub dt_s: f64,
    /// Masses, kg, from the barrier on.
    pub masses_kg: Vec<f64>,
    /// Their motions, in the same order; the last is the passenger compartment.
    pub motions: Vec<Motion>,
}

impl Response {
    /// The motion an accelerometer in the compartment records: that of the last mass.
    pub fn compartment(&self) -> &Motion {
        // Every constructor puts one motion a mass in, and there is no model without a mass.
        &self.motions[self.motions.len() - 1]
    }
}

/// The instants of a response, from the exact solution and not from samples.
///
/// Times count from contact. What the model never reaches is `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CrushEvents {
    /// Time of dynamic crush `t_m`, s: the first zero of velocity.
    pub time_of_dynamic_crush_s: Option<f64>,
    /// Dynamic crush `C = x(t_m)`, m.
    pub dynamic_crush_m: Option<f64>,
    /// Time of rebound, s: the first zero of acceleration after `t_m`, where a real contact would open.
    pub time_of_rebound_s: Option<f64>,
    /// Velocity there, m/s, negative.
    pub rebound_velocity_m_per_s: Option<f64>,
}

/// A crash is over in so many seconds or never: up to then crush, common velocity and separation are looked for.
pub const HORIZON_S: f64 = 2.0;

/// What moves a model.
#[derive(Debug, Clone, PartialEq)]
pub enum Drive {
    /// All masses meet the barrier at this speed, m/s.
    Impact(f64),
    /// A force on one mass (index from 0) of a model that starts from rest, N, samples at the response's interval,
    /// linear between them and zero after the last.
    Force {
        /// Mass the force acts on.
        mass: usize,
        /// Samples, N, positive towards the barrier.
        samples: Vec<f64>,
    },
    /// The acceleration of the barrier (a sled, a shaker), m/s², in the direction of crush; everything starts from
    /// rest.
    BaseAcceleration(Vec<f64>),
    /// Both: the masses meet the barrier at a speed and a force acts on one of them.
    ImpactAndForce {
        /// Speed, m/s.
        speed_m_per_s: f64,
        /// Mass the force acts on.
        mass: usize,
        /// Samples, N, as above.
        samples: Vec<f64>,
    },
    /// Every mass from its own position at its own velocity.
    Start(Start),
    /// The acceleration of the barrier in the direction of crush, in between samples too; everything starts from rest.
    BasePulse(CrashPulse),
}

impl Drive {
    /// Positions and speeds of all masses at the start.
    pub fn start(&self) -> Start {
        match self {
            Self::Impact(speed) | Self::ImpactAndForce { speed_m_per_s: speed, .. } => Start::Impact(*speed),
            Self::Start(start) => start.clone(),
            Self::Force { .. } | Self::BaseAcceleration(_) | Self::BasePulse(_) => Start::Impact(0.0),
        }
    }

    /// The mass a force acts on, and the force.
    pub(crate) fn force(&self) -> Option<(usize, &[f64])> {
        match self {
            Self::Force { mass, samples } | Self::ImpactAndForce { mass, samples, .. } => Some((*mass, samples)),
            Self::Impact(_) | Self::BaseAcceleration(_) | Self::Start(_) | Self::BasePulse(_) => None,
        }
    }

    /// The acceleration of the barrier.
    pub(crate) fn base(&self) -> Option<&[f64]> {
        match self {
            Self::BaseAcceleration(samples) => Some(samples),
            _ => None,
        }
    }

    /// Samples of the force or of the acceleration; none for an impact.
    pub(crate) fn source(&self) -> &[f64] {
        self.force().map(|(_, samples)| samples).or(self.base()).unwrap_or(&[])
    }

    /// Stretch `number` of the input of samples `dt_s` apart, with the instant of its end, s; `None` after the last.
    pub(crate) fn stretch(&self, number: usize, dt_s: f64) -> Option<(Course, f64)> {
        if let Self::BasePulse(pulse) = self {
            return pulse.stretch(number);
        }
        let source = self.source();
        let value = *source.get(number)?;
        let slope = (source.get(number + 1).copied().unwrap_or(0.0) - value) / dt_s;
        Some((Course::Line { from_s: number as f64 * dt_s, value, slope }, (number + 1) as f64 * dt_s))
    }
}

/// An acceleration over time, m/s²; zero before its start and after its end.
#[derive(Debug, Clone, PartialEq)]
pub enum CrashPulse {
    /// `peak sin(π t/T)` for `0 <= t <= T`.
    HalfSine {
        /// Peak, m/s².
        peak_m_per_s2: f64,
        /// Duration `T`, s.
        duration_s: f64,
    },
    /// `peak (1 - cos(2 π t/T))/2` for `0 <= t <= T`: it begins and ends without a slope.
    Haversine {
        /// Peak, m/s².
        peak_m_per_s2: f64,
        /// Duration `T`, s.
        duration_s: f64,
    },
    /// Straight lines between `(time, acceleration)`, s and m/s², times rising from zero or more.
    Lines(Vec<(f64, f64)>),
}

/// An input between two instants of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Course {
    /// `value + slope (t - from)`.
    Line { from_s: f64, value: f64, slope: f64 },
    /// `peak sin(frequency t)`, rad/s.
    Sine { peak: f64, frequency: f64 },
    /// `peak (1 - cos(frequency t))/2`, rad/s.
    Haversine { peak: f64, frequency: f64 },
}

impl CrashPulse {
    /// From zero to the peak at `peak_s` and back to zero at `duration_s`. Errors: a peak that is not inside.
    pub fn triangle(peak_m_per_s2: f64, peak_s: f64, duration_s: f64) -> Result<Self, LumpedError> {
        let pulse = Self::Lines(vec![(0.0, 0.0), (peak_s, peak_m_per_s2), (duration_s, 0.0)]);
        pulse.check()?;
        Ok(pulse)
    }

    /// Refuses numbers that are not finite, a duration that is not positive, times that do not rise.
    pub fn check(&self) -> Result<(), LumpedError> {
        match self {
            Self::HalfSine { peak_m_per_s2, duration_s } | Self::Haversine { peak_m_per_s2, duration_s } => {
                finite("peak_m_per_s2", *peak_m_per_s2)?;
                positive("duration_s", *duration_s)
            }
            Self::Lines(points) => {
                points.iter().flat_map(|(t, a)| [t, a]).try_for_each(|x| finite("sample of a pulse", *x))?;
                let rises = points.windows(2).all(|pair| pair[0].0 < pair[1].0);
                let first = points.first().map_or(0.0, |(t, _)| *t);
                if !rises || first < 0.0 {
                    let expected = "zero or more, and every time above the one before";
                    return Err(LumpedError::Value { name: "first time of a pulse", value: first, expected });
                }
                Ok(())
            }
        }
    }

    /// The same, upside down: the deceleration of a vehicle as the acceleration of a base.
    pub fn reversed(&self) -> Self {
        match self {
            Self::HalfSine { peak_m_per_s2, duration_s } => {
                Self::HalfSine { peak_m_per_s2: -peak_m_per_s2, duration_s: *duration_s }
            }
            Self::Haversine { peak_m_per_s2, duration_s } => {
                Self::Haversine { peak_m_per_s2: -peak_m_per_s2, duration_s: *duration_s }
            }
            Self::Lines(points) => Self::Lines(points.iter().map(|(t, a)| (*t, -a)).collect()),
        }
    }

    /// Stretch `number` from zero on, with the instant of its end, s; `None` after the last.
    pub(crate) fn stretch(&self, number: usize) -> Option<(Course, f64)> {
        match self {
            Self::HalfSine { peak_m_per_s2, duration_s } => {
                let course = Course::Sine { peak: *peak_m_per_s2, frequency: std::f64::consts::PI / duration_s };
                (number == 0).then_some((course, *duration_s))
            }
            Self::Haversine { peak_m_per_s2, duration_s } => {
                let course = Course::Haversine { peak: *peak_m_per_s2, frequency: std::f64::consts::TAU / duration_s };
                (number == 0).then_some((course, *duration_s))
            }
            Self::Lines(points) => {
                let first_s = points.first()?.0;
                // Nothing comes before a first time above zero.
                let ((from_s, value), (to_s, next)) = match (number + usize::from(first_s == 0.0)).checked_sub(1) {
                    None => ((0.0, 0.0), (first_s, 0.0)),
                    Some(i) => (*points.get(i)?, *points.get(i + 1)?),
                };
                Some((Course::Line { from_s, value, slope: (next - value) / (to_s - from_s) }, to_s))
            }
        }
    }
}

/// Instants `first_s + k dt_s`, k = 0 .. `samples`, after contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instants {
    /// First instant, s.
    pub first_s: f64,
    /// Their spacing, s.
    pub dt_s: f64,
    /// Their number.
    pub samples: usize,
}

/// Motions and what a parameter changes in them.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// Motion of every mass, from the barrier on.
    pub motions: Vec<Motion>,
    /// `derivatives[p][mass]`: derivative of that motion by the p-th parameter asked for, per its unit.
    pub derivatives: Vec<Vec<Motion>>,
}

/// Where every mass is at the start, and how fast. A number is a speed: all masses meet the barrier.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// All masses at zero at this speed, m/s.
    Impact(f64),
    /// Each mass at its own position, with its own velocity: two vehicles, one of them at rest, or a part ahead of the
    /// others.
    Each {
        /// Positions, m.
        positions_m: Vec<f64>,
        /// Velocities, m/s.
        velocities_m_per_s: Vec<f64>,
    },
}

impl From<f64> for Start {
    fn from(impact_speed_m_per_s: f64) -> Self {
        Self::Impact(impact_speed_m_per_s)
    }
}

impl Start {
    /// Each mass at zero with its own velocity, m/s.
    pub fn at_velocities(velocities_m_per_s: Vec<f64>) -> Self {
        Self::Each { positions_m: vec![0.0; velocities_m_per_s.len()], velocities_m_per_s }
    }

    /// Position, m, and velocity, m/s, of a mass.
    pub(crate) fn of_mass(&self, mass: usize) -> [f64; 2] {
        match self {
            Self::Impact(speed) => [0.0, *speed],
            Self::Each { positions_m, velocities_m_per_s } => [positions_m[mass], velocities_m_per_s[mass]],
        }
    }

    /// Kinetic energy of these masses, kg, in J.
    pub(crate) fn kinetic_j(&self, masses_kg: &[f64]) -> f64 {
        match self {
            Self::Impact(speed) => 0.5 * masses_kg.iter().sum::<f64>() * speed.powi(2),
            Self::Each { velocities_m_per_s, .. } => {
                masses_kg.iter().zip(velocities_m_per_s).map(|(mass, v)| 0.5 * mass * v * v).sum()
            }
        }
    }

    /// Refuses what is not finite, and lists of another length than that of the masses.
    pub(crate) fn check(&self, masses: usize) -> Result<(), LumpedError> {
        match self {
            Self::Impact(speed) => finite("impact_speed_m_per_s", *speed),
            Self::Each { positions_m, velocities_m_per_s } => {
                for (name, list) in [("positions at the start", positions_m), ("velocities", velocities_m_per_s)] {
                    if list.len() != masses {
                        let value = list.len() as f64;
                        return Err(LumpedError::Value { name, value, expected: "as many as there are masses" });
                    }
                    list.iter().try_for_each(|value| finite(name, *value))?;
                }
                Ok(())
            }
        }
    }
}
