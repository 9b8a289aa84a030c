//! A test of a car of known parameters as a laboratory records it.

use crumple_lumped::LumpedError;
use crumple_numerics::estimation::random::RandomNumbers;

use super::car::Car;
use crate::records::{FINE_S, Measurement};

/// Samples of the motion from contact on: up to 155 ms, beyond the rebound.
const SAMPLES: usize = 15_501;

/// The record as CSV: columns `accel` and, where the car has that sensor, `engine`. Errors: those of the model.
pub(super) fn record(car: &Car, clean: bool, random: &mut RandomNumbers) -> Result<String, LumpedError> {
    let measurement = Measurement::drawn(random, clean);
    let speed_m_per_s = car.impact_speed_m_per_s + measurement.speed_error_m_per_s;
    let response = car.model.respond(speed_m_per_s, FINE_S, SAMPLES)?;
    let mut sensors = vec![("accel", response.compartment().acceleration_m_per_s2.as_slice())];
    sensors.extend(car.engine.then(|| ("engine", response.motions[0].acceleration_m_per_s2.as_slice())));
    let head = format!(
        "# title: made for a trial of intervals\n# mass: {} kg\n# impact speed: {} km/h\n",
        car.mass_kg,
        (car.impact_speed_m_per_s * 3.6).round()
    );
    Ok(measurement.csv(&head, &sensors, random))
}
