//! Details of a test from the records of its specification.

use crumple_artifact::records::DamageV1;
use crumple_signal::ANOTHER_VEHICLE;

use crate::formats::ev5::records::{Barrier, Test, Vehicle};
use crate::recording::details::{Details, Stated};

/// Stations of a crush profile.
const STATIONS: usize = 6;

/// Facts of the test from its records.
pub fn details(test: &Test, barrier: Option<&Barrier>, vehicle: &Vehicle, vehicles: &[Vehicle]) -> Details {
    let stated = |value: String, from: &str| Stated { value, from: from.to_owned() };
    let speed = speed_km_per_h(test, vehicle, vehicles);
    Details {
        title: test.title.clone().map(|t| stated(t, "TITLE")),
        vehicle: vehicle_words(test, vehicle).map(|v| stated(v, "TITLE")),
        barrier: match test.configuration.as_deref() {
            Some("VTV") => Some(stated(ANOTHER_VEHICLE.to_owned(), "TSTCFN")),
            _ => barrier.and_then(Barrier::words).map(|b| stated(b, "BARRIER")),
        },
        mass_kg: vehicle.test_mass_kg.map(|value| Stated { value, from: "VEHTWT".to_owned() }),
        impact_speed_m_per_s: speed.map(|(v, from)| Stated { value: v / 3.6, from: from.to_owned() }),
        time_zero_s: None,
        damage: damage(vehicle),
        vehicles: Vec::new(),
        closing_speed_m_per_s: test.closing_speed_km_per_h.map(|v| v / 3.6),
        speed_not_taken: None,
        no_pulse: false,
        facts: facts(test, vehicle),
    }
}

/// The speed of a vehicle, km/h, and the field that states it. 0 is a speed where another vehicle moves, or where the
/// closing speed is that of something that hits this one; else it means not recorded.
pub fn speed_km_per_h(test: &Test, vehicle: &Vehicle, vehicles: &[Vehicle]) -> Option<(f64, &'static str)> {
    let is_barrier = test.configuration.as_deref() == Some("VTB");
    let another_moves = vehicles.iter().any(|other| other.number != vehicle.number && other.speed_km_per_h > Some(0.0));
    let may_stand = another_moves || (test.closing_speed_km_per_h.is_some() && !is_barrier);
    let own = vehicle.speed_km_per_h.filter(|v| *v > 0.0 || may_stand).map(|v| (v, "VEHSPD"));
    // The closing speed is the vehicle's own only if the other object stands still.
    own.or_else(|| test.closing_speed_km_per_h.filter(|_| is_barrier).map(|v| (v, "CLSSPD")))
}

/// `2018 TOYOTA CAMRY LE 4-DOOR SEDAN`: the title from the model year on, its part after `INTO` for the second vehicle.
/// Make and model are codes whose tables are not public: they stay out.
pub fn vehicle_words(test: &Test, vehicle: &Vehicle) -> Option<String> {
    let year = vehicle.year.as_deref()?;
    let from_title = test.title.as_deref().and_then(|title| {
        let part = title.split(" INTO ").nth(usize::try_from(vehicle.number).ok()?.checked_sub(1)?)?;
        let words = part[part.find(year)?..].trim();
        (words.len() > year.len()).then(|| words.to_owned())
    });
    from_title.or_else(|| Some(format!("of model year {year}")))
}

/// The crush profile DPD1 to DPD6; all zero is nothing recorded.
fn damage(vehicle: &Vehicle) -> Option<DamageV1> {
    let stations = &vehicle.crush_profile_mm;
    let is_recorded = stations.len() == STATIONS && stations.iter().any(|crush| *crush != 0.0);
    is_recorded.then(|| DamageV1 {
        residual_crush_m: stations.iter().map(|mm| mm / 1e3).collect(),
        damage_width_m: vehicle.damage_width_mm.map(|mm| mm / 1e3),
        vehicle_width_m: vehicle.width_mm.map(|mm| mm / 1e3),
        classification: vehicle.damage_classification.clone(),
        from: "DPD1-DPD6, LENCNT, VEHWID, VDI".to_owned(),
    })
}

fn facts(test: &Test, vehicle: &Vehicle) -> Vec<String> {
    let mut facts = Vec::new();
    if let Some(crush) = vehicle.static_crush_mm {
        let profile: Vec<String> = vehicle.crush_profile_mm.iter().map(f64::to_string).collect();
        let profile = if vehicle.crush_profile_mm.iter().any(|x| *x != 0.0) {
            format!("; profile across the front {} mm", profile.join(", "))
        } else {
            String::new()
        };
        facts.push(format!("static crush {crush} mm at most (measured after the test){profile}"));
    }
    if let Some(laboratory) = &test.laboratory {
        let date = test.date.as_deref().map_or_else(String::new, |d| format!(", {d}"));
        let reference = test.reference.as_deref().map_or_else(String::new, |r| format!(", reference {r}"));
        facts.push(format!("tested by {laboratory}{date}{reference}"));
    }
    if let Some(configuration) = &test.configuration {
        let words = match configuration.as_str() {
            "VTB" => "vehicle to barrier",
            "VTV" => "vehicle to vehicle",
            "ITV" => "impactor to vehicle",
            other => other,
        };
        let angle = test.impact_angle_deg.map_or_else(String::new, |a| format!(", impact angle {a} deg"));
        let offset = test.offset_mm.filter(|o| *o != 0.0).map_or_else(String::new, |o| format!(", offset {o} mm"));
        facts.push(format!("configuration: {words}{angle}{offset}"));
    }
    let angles =
        [("crab angle", vehicle.crab_angle_deg), ("principal direction of force", vehicle.principal_direction_deg)];
    for (what, angle) in angles.into_iter().filter_map(|(what, angle)| Some((what, angle?))) {
        facts.push(format!("{what} {angle} deg"));
    }
    if let Some(offset) = vehicle.damage_offset_mm {
        facts.push(format!("middle of the damage {offset} mm from that of the vehicle"));
    }
    facts.extend(vehicle.comment.iter().chain(&test.comment).cloned());
    facts
}
