//! A half sine that stops a vehicle, its test, and tables of accelerations made of it or of a model.

use std::f64::consts::PI;
use std::fmt::Write as _;

use crumple_lumped::{LumpedError, Model};
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;

/// Impact speed of the half sine, m/s.
pub(crate) const HALF_SINE_SPEED: f64 = 50.0 / 3.6;
/// Its length, s, and its restitution.
const LENGTH_S: f64 = 0.09;
const REBOUND: f64 = 0.1;

/// The pulse, in g, at a time in s.
pub(crate) fn half_sine(time_s: f64) -> f64 {
    let peak = HALF_SINE_SPEED * (1.0 + REBOUND) * PI / (2.0 * LENGTH_S) / G;
    if (0.0..LENGTH_S).contains(&time_s) { -peak * (PI * time_s / LENGTH_S).sin() } else { 0.0 }
}

/// Its crush, m, time of crush, s, restitution and peak, m/s²: `v = v0 - h (1 - cos(pi t / L))`, `h = v0 (1 + e) / 2`.
pub(crate) fn test_of_half_sine() -> [f64; 4] {
    let half = 0.5 * HALF_SINE_SPEED * (1.0 + REBOUND);
    let time_s = LENGTH_S / PI * (1.0 - HALF_SINE_SPEED / half).acos();
    let crush_m = HALF_SINE_SPEED * time_s - half * (time_s - LENGTH_S / PI * (PI * time_s / LENGTH_S).sin());
    [crush_m, time_s, REBOUND, half * PI / LENGTH_S]
}

/// A table of 0.25 s, 0.1 ms apart, with 50 ms before contact, and the columns of this head.
pub(crate) fn table(head: &str, values: &dyn Fn(f64) -> Vec<f64>) -> String {
    let mut text = format!("time [s],{head}\n");
    for k in 0..2500 {
        let t = f64::from(k) * 1e-4 - 0.05;
        let cells: String = values(t).iter().map(|value| format!(",{:.6}", value + 0.0)).collect();
        let _infallible = writeln!(text, "{t:.4}{cells}");
    }
    text
}

/// A table of both masses of a model. Errors: those of the model.
pub(crate) fn two_sensors(model: &Model, mass_kg: f64, speed: f64) -> Result<String, LumpedError> {
    let response = model.respond(speed, 1e-4, 2001)?;
    let km_per_h = speed * 3.6;
    let mut csv = format!(
        "# title: made, two sensors\n# mass: {mass_kg} kg\n# impact speed: {km_per_h} km/h\n\
         time_s,accel (g),engine (g)\n"
    );
    for k in 0..2501_usize {
        let [front, rear] = match k.checked_sub(500) {
            None => [0.0, 0.0],
            Some(k) => [&response.motions[0], response.compartment()].map(|m| m.acceleration_m_per_s2[k] / G),
        };
        let _infallible = writeln!(csv, "{:.4},{},{}", k as f64 * 1e-4 - 0.05, rear + 0.0, front + 0.0);
    }
    Ok(csv)
}
