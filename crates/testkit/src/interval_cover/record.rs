//! A test of a car as a laboratory records it: noise, zero level, resolution.

use std::fmt::Write as _;

use crumple_estimation::random::RandomNumbers;
use crumple_lumped::LumpedError;
use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;

use super::car::Car;

const DT_S: f64 = 1e-4;
/// Samples before contact: 50 ms.
const BEFORE: usize = 500;
/// Samples from contact on: up to 150 ms, beyond the rebound.
const AFTER: usize = 1501;
/// The range of the digitiser over the largest value of the pulse.
const RANGE: f64 = 2.0;

/// The record as CSV: columns `accel` and, where the car has that sensor, `engine`.
///
/// White noise of 0.5 to 3 % of the pulse's peak at 10 kHz, a zero level off by up to 2 % of it, 12 to 16 bit over
/// twice the peak. Errors: those of the model.
pub(super) fn record(car: &Car, random: &mut RandomNumbers) -> Result<String, LumpedError> {
    let response = car.model.respond(car.impact_speed_m_per_s, DT_S, AFTER)?;
    let mut motions = vec![response.compartment()];
    motions.extend(car.engine.then(|| &response.motions[0]));
    let columns: Vec<Vec<f64>> =
        motions.iter().map(|motion| digitised(&motion.acceleration_m_per_s2, random)).collect();
    let mut csv = format!(
        "# title: made for a trial of intervals\n# mass: {} kg\n# impact speed: {} km/h\ntime_s,accel (g){}\n",
        car.mass_kg,
        (car.impact_speed_m_per_s * 3.6).round(),
        if car.engine { ",engine (g)" } else { "" }
    );
    for k in 0..BEFORE + AFTER {
        let _infallible = write!(csv, "{:.4}", (k as f64 - BEFORE as f64) * DT_S);
        for column in &columns {
            let _infallible = write!(csv, ",{}", column[k]);
        }
        csv.push('\n');
    }
    Ok(csv)
}

/// An acceleration, m/s², as the numbers in g that a digitiser gives.
fn digitised(acceleration: &[f64], random: &mut RandomNumbers) -> Vec<f64> {
    let peak = acceleration.iter().fold(0.0_f64, |m, a| m.max(a.abs())) / G;
    let noise = (0.005 + 0.025 * random.uniform()) * peak;
    let zero_level = (2.0 * random.uniform() - 1.0) * 0.02 * peak;
    let bits = 12 + (5.0 * random.uniform()) as i32;
    let step = 2.0 * RANGE * peak / 2.0_f64.powi(bits);
    (0..BEFORE + AFTER)
        .map(|k| {
            let a = k.checked_sub(BEFORE).map_or(0.0, |k| acceleration[k] / G);
            ((a + zero_level + noise * random.normal()) / step).round() * step + 0.0
        })
        .collect()
}
