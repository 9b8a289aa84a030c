//! A candidate beside a sensor that its fit did not see.

use crumple_lumped::Motion;
use crumple_metrics::{fit_percent, rmse};
use crumple_signal::{Channel, Sampled};

use crate::comparison::simulation::Simulation;

/// Another accelerometer on the vehicle, integrated.
#[derive(Debug, Clone)]
pub struct OtherSensor {
    /// Channel.
    pub channel: String,
    /// Whether it sits on the engine, and so on the mass next to the barrier.
    pub on_engine: bool,
    /// Its displacement, m.
    pub displacement: Sampled,
}

/// The error of a candidate at another sensor, over the window of its comparison with the pulse.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorFit {
    /// Channel.
    pub channel: String,
    /// Mass compared, counted from the barrier, from 1.
    pub mass: usize,
    /// Root mean square displacement error over the window, m.
    pub rmse_m: f64,
    /// Displacement fit, percent.
    pub fit_percent: Option<f64>,
}

/// Whether a sensor sits on the engine: as its location says, and without a location, as in a plain table, its name.
/// The rule by which integration tells what moves apart from the compartment.
pub fn is_on_engine(channel: &Channel) -> bool {
    let place = if channel.location.trim().is_empty() { &channel.id } else { &channel.location };
    place.to_lowercase().contains("engine")
}

/// Compares the displacement of the sensor with that of its mass over the window of the simulation: the engine's with
/// the mass next to the barrier, any other with the compartment. `None` where the record does not cover the window, and
/// for a model of one mass beside the engine's sensor: that mass is the compartment, and nothing of such a model moves
/// as an engine does.
///
/// For two dual double models this is the only figure that differs.
pub fn beside(simulation: &Simulation, sensor: &OtherSensor, time_zero_s: f64, dt_s: f64) -> Option<SensorFit> {
    if sensor.on_engine && simulation.masses.len() == 1 {
        return None;
    }
    beside_mass(simulation, sensor, if sensor.on_engine { 1 } else { simulation.compartment + 1 }, time_zero_s, dt_s)
}

/// As [`beside`], with the mass that the sensor sits on, counted from the barrier, from 1. `None` for mass 0 and for a
/// mass that the model does not have.
///
/// The sensor is interpolated linearly at `time_zero_s + k·dt_s`, k from 0 to the end of the window, and has to cover
/// all of it. Error and fit are those of [`Comparison`](crate::Comparison), the sensor in the place of the pulse.
pub fn beside_mass(
    simulation: &Simulation,
    sensor: &OtherSensor,
    mass: usize,
    time_zero_s: f64,
    dt_s: f64,
) -> Option<SensorFit> {
    let motion: &Motion = simulation.masses.get(mass.checked_sub(1)?)?;
    let compared = (simulation.comparison.to_s / dt_s).round() as usize + 1;
    let (mut x, mut xh) = (Vec::new(), Vec::new());
    for (k, modelled) in motion.displacement_m.iter().enumerate().take(compared) {
        x.push(sensor.displacement.at(time_zero_s + k as f64 * dt_s)?);
        xh.push(*modelled);
    }
    Some(SensorFit { channel: sensor.channel.clone(), mass, rmse_m: rmse(&x, &xh)?, fit_percent: fit_percent(&x, &xh) })
}
