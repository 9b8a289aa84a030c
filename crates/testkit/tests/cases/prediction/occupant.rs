//! An occupant behind a restraint under a pulse of the vehicle.

use crumple_lumped::{CrashPulse, Occupant};
use serde_json::{Value, json};

use crate::prediction::fields::Fields;
use crate::prediction::model::{force_deflection, say};

fn pulse(fields: &Fields) -> Result<CrashPulse, String> {
    match fields.text("kind")? {
        "half-sine" => Ok(CrashPulse::HalfSine {
            peak_m_per_s2: fields.number("peak_m_per_s2")?,
            duration_s: fields.number("duration_s")?,
        }),
        "triangle" => {
            let duration_s = fields.number("duration_s")?;
            // In the middle, unless said otherwise.
            let peak_s = fields.number_or("time_of_peak_s", 0.5 * duration_s)?;
            CrashPulse::triangle(fields.number("peak_m_per_s2")?, peak_s, duration_s).map_err(say)
        }
        "polyline" => {
            let (times, values) = (fields.numbers("time_s")?, fields.numbers("deceleration_m_per_s2")?);
            if times.len() != values.len() {
                return Err("times and decelerations differ in number".to_owned());
            }
            Ok(CrashPulse::Lines(times.into_iter().zip(values).collect()))
        }
        other => Err(format!("pulse {other} is not known")),
    }
}

pub fn answer(inputs: &Fields) -> Result<Value, String> {
    let (restraint, shape) = (inputs.object("restraint")?, inputs.object("pulse")?);
    let element = force_deflection(&restraint)?.with_gap(inputs.number_or("slack_m", 0.0)?).map_err(say)?;
    let occupant = Occupant { mass_kg: inputs.number("occupant_mass_kg")?, restraint: element };
    let pulse = pulse(&shape)?;
    restraint.all_read()?;
    shape.all_read()?;
    let (speed, until_s) = (inputs.number("impact_speed_m_per_s")?, inputs.number("until_s")?);
    let found = occupant.ride(&pulse, speed, until_s).map_err(say)?;
    Ok(json!({ "expected": {
        "time_of_restraint_contact_s": found.contact.map(|[time, _]| time),
        "relative_speed_at_contact_m_per_s": found.contact.map(|[_, speed]| speed),
        "peak_occupant_deceleration_m_per_s2": found.peak_deceleration.value,
        "time_of_peak_s": found.peak_deceleration.time_s,
        "largest_excursion_m": found.largest_excursion.value,
        "time_of_largest_excursion_s": found.largest_excursion.time_s,
        "permanent_set_m": found.permanent_set_m,
        "work_of_restraint_j": found.work_of_restraint_j,
        "relative_speed_end_m_per_s": found.relative_speed_end_m_per_s,
        "excursion_end_m": found.excursion_end_m,
        "vehicle_speed_end_m_per_s": found.vehicle_speed_end_m_per_s,
        "time_occupant_stops_s": found.stop.map(|stop| stop.time_s),
        "ridedown_share": found.stop.map(|stop| stop.ridedown_share),
        "restraint_share": found.stop.map(|stop| stop.restraint_share),
    } }))
}
