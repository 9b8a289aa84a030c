//! A test of a car that the programs see, as a laboratory records it.

use std::fmt::Write as _;

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;

use super::car::{BEFORE, Car, DT_S, filtered};

/// The range of the digitiser over the largest value of the pulse.
const RANGE: f64 = 2.0;
const BITS: i32 = 14;
/// How far the stated impact speed may be off: 0.1 km/h.
const SPEED_ERROR_M_PER_S: f64 = 0.1 / 3.6;
/// Random numbers between the first of one test and of the next: more than one test draws.
const OF_ONE_TEST: usize = 20_000;

/// The compartment's record of an impact at a stated `speed`, m/s, as CSV: a speed off by up to 0.1 km/h, CFC 1000,
/// white noise of 0.5 to 2 % of the peak, a zero level off by up to 1 % of it, 14 bit over twice the peak at 10 kHz.
/// Tests of other numbers have other errors.
pub(super) fn record(car: &Car, speed: f64, number: usize) -> String {
    let mut random = car.random.clone();
    for _ in 0..number * OF_ONE_TEST {
        let _of_an_earlier_test = random.uniform();
    }
    let actual = speed + (2.0 * random.uniform() - 1.0) * SPEED_ERROR_M_PER_S;
    let acceleration = filtered(&car.test(actual, 1.0).acceleration, 1000.0);
    let peak = acceleration.iter().fold(0.0_f64, |m, a| m.max(a.abs())) / G;
    let noise = (0.005 + 0.015 * random.uniform()) * peak;
    let zero_level = (2.0 * random.uniform() - 1.0) * 0.01 * peak;
    let step = 2.0 * RANGE * peak / 2.0_f64.powi(BITS);
    let mut csv = format!(
        "# title: made for a trial of predictions\n# mass: {} kg\n# impact speed: {} km/h\ntime_s,accel (g)\n",
        car.mass_kg(),
        speed * 3.6
    );
    for (k, a) in acceleration.iter().enumerate() {
        let measured = ((a / G + zero_level + noise * random.normal()) / step).round() * step + 0.0;
        let _infallible = writeln!(csv, "{:.4},{measured}", (k as f64 - BEFORE as f64) * DT_S);
    }
    csv
}
