//! Derivatives of crush, its time and the motion at an instant by entries of the model.

use crumple_lumped::{CollisionQuestions, Drive, Element, ForceDeflectionParameter, Place};
use serde_json::{Map, Value, json};

use crate::prediction::fields::Fields;
use crate::prediction::model::{Case, say};

/// The place in the structure of an entry of the case's model.
fn place(case: &Case, path: &Value) -> Result<Place, String> {
    let unknown = || format!("no parameter {path}");
    let entry = |i: usize| path.get(i).ok_or_else(unknown);
    let number = |i: usize| entry(i)?.as_u64().map(|n| n as usize).ok_or_else(unknown);
    let (list, which) = (entry(0)?.as_str(), number(1)?);
    let name = entry(2)?.as_str().ok_or_else(unknown)?;
    if list == Some("masses") {
        return match name {
            "mass_kg" => Ok(Place::Mass(which)),
            "initial_velocity_m_per_s" => Ok(Place::Velocity(which)),
            "initial_position_m" => Ok(Place::Position(which)),
            _ => Err(unknown()),
        };
    }
    let (_, parts) = case.elements.get(which).filter(|_| list == Some("elements")).ok_or_else(unknown)?;
    let connections = case.structure.connections();
    let at = |connection: usize, parameter: usize| Ok(Place::Element { connection, parameter });
    let parameter = match &connections[parts[0]].element {
        Element::ForceDeflection(element) => {
            let parameter = match name {
                "force_n" => ForceDeflectionParameter::KnotForce(number(3)?),
                "deflection_m" => ForceDeflectionParameter::KnotDeflection(number(3)?),
                "unloading_n_per_m" => ForceDeflectionParameter::Unloading,
                "rate_s_per_m" => ForceDeflectionParameter::Rate,
                "gap_m" => ForceDeflectionParameter::Gap,
                "force_limit_n" => ForceDeflectionParameter::Limit,
                _ => return Err(unknown()),
            };
            return at(parts[0], element.place_of(parameter).ok_or_else(unknown)?);
        }
        _ => ["stiffness_n_per_m", "damping_n_s_per_m"].iter().position(|of| *of == name).ok_or_else(unknown)?,
    };
    // A spring and a damper beside each other, or both parameters in one element.
    if parts.len() == 2 { at(parts[parameter], 0) } else { at(parts[0], parameter) }
}

pub fn answer(inputs: &Fields) -> Result<Value, String> {
    let (model, parameters) = (inputs.object("model")?, inputs.object("parameters")?);
    let case = Case::of(&model)?;
    let names: Vec<&str> = parameters.names().collect();
    let places = names.iter().map(|name| place(&case, parameters.get(name).unwrap_or(&Value::Null)));
    let questions = CollisionQuestions {
        instants_s: vec![inputs.number("checkpoint_s")?],
        places: places.collect::<Result<_, String>>()?,
        seen_from: case.seen_from,
    };
    let drive = Drive::Start(case.start.clone());
    let found = case.structure.collision(&drive, model.number("until_s")?, &questions).map_err(say)?;
    // Instants of another question to the same model.
    let _ = model.get("checkpoints_s");
    model.all_read()?;
    let turn = found.turn.as_ref().ok_or("no dynamic crush")?;
    let time_by = turn.time_by.as_ref().ok_or("the time has no derivative")?;
    let mut values = Map::new();
    for (p, name) in names.iter().enumerate() {
        let last = found.instants[0].derivatives[p].last().ok_or("no mass")?;
        let outputs = json!({
            "dynamic_crush": turn.crush_by[p],
            "time_of_dynamic_crush": time_by[p],
            "position_at_checkpoint": last.displacement_m,
            "velocity_at_checkpoint": last.velocity_m_per_s,
        });
        values.insert((*name).to_owned(), outputs);
    }
    Ok(json!({ "expected": values }))
}
