//! A test of a car that the programs see, as a laboratory records it.

use super::car::Car;
use crate::records::Measurement;

/// Random numbers between the first of one test and of the next: more than one test draws.
const OF_ONE_TEST: usize = 20_000;

/// The record of an impact at a stated `speed`, m/s, as CSV. Tests of other numbers have other errors.
pub(super) fn record(car: &Car, speed: f64, number: usize) -> String {
    let mut random = car.random.clone();
    for _ in 0..number * OF_ONE_TEST {
        let _of_an_earlier_test = random.uniform();
    }
    let measurement = Measurement::drawn(&mut random, false);
    let motion = car.test(speed + measurement.speed_error_m_per_s, 1.0);
    let head = format!(
        "# title: made for a trial of predictions\n# mass: {} kg\n# impact speed: {} km/h\n",
        car.mass_kg(),
        speed * 3.6
    );
    measurement.csv(&head, &[("accel", &motion.acceleration)], &mut random)
}
