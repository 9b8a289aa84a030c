//! Two vehicles of one mass each, or a vehicle and a moving barrier.

use crumple_lumped::{Partner, collide};
use serde_json::{Map, Value, json};

use crate::prediction::fields::Fields;
use crate::prediction::model::{force_deflection, say};

fn partner(fields: &Fields) -> Result<Partner, String> {
    let front = fields.object("front")?;
    let partner = Partner {
        mass_kg: fields.number("mass_kg")?,
        velocity_m_per_s: fields.number("velocity_m_per_s")?,
        front: force_deflection(&front)?,
    };
    front.all_read()?;
    fields.all_read()?;
    Ok(partner)
}

pub fn answer(inputs: &Fields) -> Result<Value, String> {
    let [first, second] = ["vehicle_1", "vehicle_2"].map(|name| inputs.object(name).and_then(|v| partner(&v)));
    // Says of the case that one side stops on a plateau: the product must see that by itself.
    let _ = inputs.get("flat_at_stop");
    let found = collide(&first?, &second?).map_err(say)?;
    let mut values = Map::new();
    for (name, value) in [
        ("common_velocity_m_per_s", found.common_velocity_m_per_s),
        ("time_of_common_velocity_s", found.time_of_common_velocity_s),
        ("mutual_crush_m", found.mutual_crush_m),
        ("peak_force_n", found.peak_force_n),
        ("coefficient_of_restitution", found.coefficient_of_restitution),
        ("separation_time_s", found.separation_s),
        ("momentum_n_s", found.momentum_n_s),
    ] {
        values.insert(name.to_owned(), value.into());
    }
    for (number, one) in found.partners.iter().enumerate() {
        let number = number + 1;
        for (name, value) in [
            (format!("crush_{number}_m"), one.crush_m),
            (format!("energy_{number}_j"), one.energy_j),
            (format!("plastic_{number}_j"), one.plastic_j),
            (format!("permanent_set_{number}_m"), one.permanent_set_m),
            (format!("velocity_{number}_end_m_per_s"), one.velocity_end_m_per_s),
            (format!("delta_v_{number}_m_per_s"), one.delta_v_m_per_s),
            (format!("energy_equivalent_speed_{number}_m_per_s"), one.energy_equivalent_speed_m_per_s),
        ] {
            values.insert(name, value.into());
        }
    }
    Ok(json!({ "expected": values }))
}
