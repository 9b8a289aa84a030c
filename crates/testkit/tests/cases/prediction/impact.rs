//! Masses and elements against a barrier or against each other.

use crumple_lumped::{Collision, CollisionQuestions, Drive, ElementState, Moment, State};
use serde_json::{Map, Value, json};

use crate::prediction::fields::Fields;
use crate::prediction::model::{Case, force_deflection, say};

pub fn answer(inputs: &Fields) -> Result<Value, String> {
    let case = Case::of(inputs)?;
    let instants_s = if inputs.get("checkpoints_s").is_some() { inputs.numbers("checkpoints_s")? } else { Vec::new() };
    let questions = CollisionQuestions { seen_from: case.seen_from, instants_s, ..CollisionQuestions::default() };
    let drive = Drive::Start(case.start.clone());
    let collision = case.structure.collision(&drive, inputs.number("until_s")?, &questions).map_err(say)?;
    if inputs.get("fronts_in_series").is_some() {
        fronts_are_their_series(inputs)?;
    }
    let events: Vec<Value> = collision
        .events
        .iter()
        .map(|(time_s, connection, event)| {
            let name = case.elements.iter().find(|(_, parts)| parts.contains(connection)).map(|(name, _)| name);
            json!({ "time_s": time_s, "element": name, "what": event.name() })
        })
        .collect();
    Ok(json!({ "expected": values(&case, &collision), "events": events }))
}

/// An element of the case as the sum of the parts that stand beside each other.
fn per_element(case: &Case, moment: &Moment, of: impl Fn(&ElementState) -> f64) -> Value {
    let sum = |(_, parts): &(String, Vec<usize>)| parts.iter().map(|part| of(&moment.elements[*part])).sum::<f64>();
    case.elements.iter().map(sum).collect()
}

/// The same for what the parts share.
fn shared(case: &Case, moment: &Moment, of: impl Fn(&ElementState) -> f64) -> Value {
    case.elements.iter().map(|(_, parts)| of(&moment.elements[parts[0]])).collect()
}

fn of_masses(moment: &Moment, of: impl Fn(&State) -> f64) -> Value {
    moment.masses.iter().map(of).collect()
}

fn values(case: &Case, collision: &Collision) -> Value {
    let (end, peak) = (&collision.end, collision.peak_acceleration);
    let each = |of: fn(&State) -> f64| -> Value { collision.instants.iter().map(|m| of_masses(m, of)).collect() };
    let values = json!({
        "plastic_end_j": per_element(case, end, |e| e.energy.plastic_j),
        "rate_end_j": per_element(case, end, |e| e.energy.rate_j),
        "damped_end_j": per_element(case, end, |e| e.energy.damped_j),
        "stored_end_j": per_element(case, end, |e| e.energy.stored_j),
        "kinetic_start_j": collision.kinetic_start_j,
        "kinetic_end_j": collision.kinetic_j(end),
        "position_end_m": of_masses(end, |s| s.displacement_m),
        "velocity_end_m_per_s": of_masses(end, |s| s.velocity_m_per_s),
        "permanent_set_m": shared(case, end, |e| e.permanent_set_m),
        "peak_acceleration_magnitude_m_per_s2": peak.value,
        "time_of_peak_s": peak.time_s,
        "peak_wall_force_n": collision.peak_wall_force.map(|peak| peak.value),
        "time_of_peak_wall_force_s": collision.peak_wall_force.map(|peak| peak.time_s),
        "velocity_of_centre_of_mass_end_m_per_s": collision.velocity_of_centre_of_mass_m_per_s(end),
        "coefficient_of_restitution": collision.coefficient_of_restitution(),
        "separation_time_s": collision.separation_s,
        "momentum_n_s": collision.momentum_n_s(end),
        "checkpoints": {
            "position_m": each(|s| s.displacement_m),
            "velocity_m_per_s": each(|s| s.velocity_m_per_s),
            "acceleration_m_per_s2": each(|s| s.acceleration_m_per_s2),
        },
    });
    let Value::Object(mut values) = values else { unreachable!("an object was made") };
    values.extend(at_turn(case, collision));
    Value::Object(values)
}

/// Dynamic crush or common velocity; nothing where neither is reached.
fn at_turn(case: &Case, collision: &Collision) -> Map<String, Value> {
    let Some(turn) = &collision.turn else { return Map::new() };
    let moment = &turn.moment;
    let values = json!({
        "time_of_dynamic_crush_s": moment.time_s,
        "time_of_common_velocity_s": moment.time_s,
        "dynamic_crush_m": turn.crush_m,
        "mutual_crush_m": turn.crush_m,
        "velocity_then_m_per_s": of_masses(moment, |s| s.velocity_m_per_s),
        "deflection_then_m": shared(case, moment, |e| e.deflection_m),
        "force_then_n": per_element(case, moment, |e| e.force_n),
        "stored_then_j": per_element(case, moment, |e| e.energy.stored_j),
    });
    values.as_object().cloned().unwrap_or_default()
}

/// That the product makes the stated element of two fronts: the same force wherever either has a knot.
fn fronts_are_their_series(inputs: &Fields) -> Result<(), String> {
    let fronts = inputs.objects("fronts_in_series")?;
    let [first, second] = &fronts[..] else { return Err("not two fronts".to_owned()) };
    let (first, second) = (force_deflection(first)?, force_deflection(second)?);
    fronts.iter().try_for_each(Fields::all_read)?;
    let made = first.in_series(&second).map_err(say)?.element;
    let stated = inputs.objects("elements")?.into_iter().find(|e| e.text("name") == Ok("fronts"));
    let stated = force_deflection(&stated.ok_or("no element fronts")?)?;
    let unloading = [made.unloading_n_per_m(), stated.unloading_n_per_m()];
    let forces = made.knots().iter().chain(stated.knots()).map(|(d, _)| [&made, &stated].map(|e| e.static_force_n(*d)));
    for [made, stated] in forces.chain([unloading]) {
        // Stated to twelve digits.
        if (made - stated).abs() > 1e-10 * stated.abs() {
            return Err(format!("fronts in series: {made:e}, stated {stated:e}"));
        }
    }
    Ok(())
}
