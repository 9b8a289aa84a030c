//! An occupant behind a restraint, driven by the pulse of the compartment.

use crumple_lumped::{CrashPulse, Motion, Occupant, OccupantMotion};

use crate::error::PredictError;

/// How long an occupant is followed after the pulse, s.
const AFTER_PULSE_S: f64 = 0.15;
/// Spacing of the pulse that drives the occupant, s: straight lines between, as all pulses here.
const SPACING_S: f64 = 5e-4;

/// The ride of an occupant in a compartment of this motion. `speed` is what the compartment loses until its own stop:
/// from the frame of that stop the share of ride-down is counted, whatever the ground does.
///
/// `None`: the compartment loses no speed. Errors: a motion that cannot be followed.
pub(crate) fn ride(
    occupant: &Occupant,
    compartment: &Motion,
    dt_s: f64,
    speed: f64,
) -> Result<Option<OccupantMotion>, PredictError> {
    if speed.is_nan() || speed <= 0.0 {
        return Ok(None);
    }
    let every = (SPACING_S / dt_s).round().max(1.0) as usize;
    let samples = compartment.acceleration_m_per_s2.iter().enumerate().step_by(every);
    let points: Vec<(f64, f64)> = samples.map(|(k, a)| (k as f64 * dt_s, -a)).collect();
    let Some(end_s) = points.last().map(|(t, _)| *t).filter(|t| *t > 0.0) else { return Ok(None) };
    Ok(Some(occupant.ride(&CrashPulse::Lines(points), speed, end_s + AFTER_PULSE_S)?))
}
