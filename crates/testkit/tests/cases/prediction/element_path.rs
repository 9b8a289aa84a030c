//! The law of an element alone, along way points at given rates.

use crumple_lumped::{Leg, PathPoint, lead};
use serde_json::{Value, json};

use crate::prediction::fields::Fields;
use crate::prediction::model::{force_deflection, say};

pub fn answer(inputs: &Fields) -> Result<Value, String> {
    let element = inputs.object("element")?;
    let law = force_deflection(&element)?;
    element.all_read()?;
    let mut legs = Vec::new();
    for leg in inputs.objects("legs")? {
        legs.push(Leg { to_m: leg.number("to_m")?, rate_m_per_s: leg.number("rate_m_per_s")? });
        leg.all_read()?;
    }
    let points = lead(&law.into(), &legs).map_err(say)?;
    let each = |of: fn(&PathPoint) -> f64| -> Value { points.iter().map(of).collect() };
    Ok(json!({ "expected": {
        "force_n": each(|p| p.force_n),
        "work_j": each(|p| p.work_j),
        "permanent_set_m": each(|p| p.permanent_set_m),
    } }))
}
