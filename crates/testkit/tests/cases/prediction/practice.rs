//! KW400, initial stiffness, and the coefficients of CRASH3.

use crumple_metrics::{CrushStiffness, DamageProfile, energy_equivalent_speed, wall_stiffness};
use serde_json::{Map, Value, json};

use crate::prediction::fields::Fields;

pub fn of_wall(inputs: &Fields) -> Result<Value, String> {
    let of = wall_stiffness(&inputs.numbers("displacement_m")?, &inputs.numbers("wall_force_n")?);
    let of = of.ok_or("the product gives no stiffness")?;
    Ok(json!({ "expected": {
        "work_25_to_400_mm_j": of.work_j,
        "kw400_n_per_m": of.kw400_n_per_m,
        "kw400_full_square_n_per_m": of.kw400_full_square_n_per_m,
        "kw400_from_zero_n_per_m": of.kw400_from_zero_n_per_m,
        "initial_stiffness_25_to_200_mm_n_per_m": of.initial_n_per_m,
        "initial_stiffness_through_origin_n_per_m": of.initial_through_origin_n_per_m,
    } }))
}

pub fn of_damage(inputs: &Fields) -> Result<Value, String> {
    let (mass_kg, width_m) = (inputs.number("mass_kg")?, inputs.number("damage_width_m")?);
    let (v0, b0) = (inputs.number("impact_speed_m_per_s")?, inputs.number("no_damage_speed_m_per_s")?);
    let crush_m = inputs.numbers("residual_crush_m")?;
    let profile = DamageProfile::new(&crush_m).ok_or("no damage profile")?;
    let mut values = Map::new();
    values.insert("mean_crush_m".to_owned(), profile.mean_m().into());
    values.insert("mean_square_crush_m2".to_owned(), profile.mean_square_m2().into());
    let by_mean = CrushStiffness::from_barrier_test(mass_kg, width_m, v0, profile.mean_m(), b0);
    let by_energy = CrushStiffness::from_energy(mass_kg, width_m, v0, profile, b0);
    for (rule, stiffness) in [("mean", by_mean), ("energy", by_energy)] {
        let of = stiffness.ok_or("no coefficients")?;
        let energy = of.energy(width_m, &crush_m, 0.0).value.ok_or("no crush energy")?;
        for (name, value) in [
            (format!("b1_by_{rule}_per_s"), of.b1_per_s),
            (format!("a_by_{rule}_n_per_m"), of.a_n_per_m),
            (format!("b_by_{rule}_n_per_m2"), of.b_n_per_m2),
            (format!("g_by_{rule}_n"), of.g_n),
            (format!("crush_energy_by_{rule}_j"), energy),
            (format!("energy_equivalent_speed_by_{rule}_m_per_s"), energy_equivalent_speed(mass_kg, energy)),
        ] {
            values.insert(name, value.into());
        }
    }
    Ok(json!({ "expected": values }))
}
