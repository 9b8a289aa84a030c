//! Curves, and masses, extracted from motions that the truth makes; curves of several tests with one rate factor.

use crumple_lumped::{CollisionQuestions, Drive, ForceDeflection, Node, Start, Structure};
use crumple_lumped_fit::{
    AskedCurve, Extraction, MeasuredElement, MeasuredMass, MeasuredTest, extract, extract_with_rate,
};
use serde_json::{Value, json};

use crate::prediction::fields::Fields;
use crate::prediction::model::{Case, force_deflection, say};

/// Motions of all masses, sampled up to an instant.
fn motions(structure: &Structure, drive: &Drive, until_s: f64, dt_s: f64) -> Result<Vec<MeasuredMass>, String> {
    let samples = (until_s / dt_s + 1e-9).floor() as usize;
    let instants_s = (0..=samples).map(|k| k as f64 * dt_s).collect();
    let questions = CollisionQuestions { instants_s, ..CollisionQuestions::default() };
    let collision = structure.collision(drive, until_s, &questions).map_err(say)?;
    let of = |(i, mass): (usize, &f64)| MeasuredMass {
        mass_kg: Some(*mass),
        displacement_m: collision.instants.iter().map(|m| m.masses[i].displacement_m).collect(),
        velocity_m_per_s: collision.instants.iter().map(|m| m.masses[i].velocity_m_per_s).collect(),
        acceleration_m_per_s2: collision.instants.iter().map(|m| m.masses[i].acceleration_m_per_s2).collect(),
        noise_n: 1.0,
    };
    Ok(structure.masses_kg().iter().enumerate().map(of).collect())
}

fn asked(fields: &Fields) -> Result<AskedCurve, String> {
    Ok(AskedCurve { knots_m: fields.numbers("deflection_m")?, rate_s_per_m: fields.number_or("rate_s_per_m", 0.0)? })
}

pub fn of_one_test(inputs: &Fields) -> Result<Value, String> {
    let truth = inputs.object("truth")?;
    let case = Case::of(&truth)?;
    let drive = Drive::Start(case.start.clone());
    let dt_s = inputs.number("sample_interval_s")?;
    let mut masses = motions(&case.structure, &drive, inputs.number("until_s")?, dt_s)?;
    let total = case.structure.masses_kg().iter().sum();
    let masses_free = inputs.get("masses_free").is_some_and(|free| free == true);
    if masses_free {
        masses.iter_mut().for_each(|mass| mass.mass_kg = None);
    }
    let (mut curves, mut elements) = (Vec::new(), Vec::new());
    for (element, connection) in truth.objects("elements")?.iter().zip(case.structure.connections()) {
        let place = |node: Node| if let Node::Mass(i) = node { Some(i) } else { None };
        elements.push(MeasuredElement {
            front: place(connection.front),
            rear: place(connection.rear).ok_or("an element without a mass behind it")?,
            curve: curves.len(),
            gap_m: element.number_or("gap_m", 0.0)?,
        });
        curves.push(asked(element)?);
    }
    let test =
        MeasuredTest { dt_s, masses, elements, total_mass_kg: masses_free.then_some(total), wall: None, through: None };
    let found = extract(&[test], &curves, 0.0).ok_or("nothing was extracted")?;
    Ok(json!({ "expected": {
        "force_n": found.forces_n,
        "unloading_n_per_m": found.unloading_n_per_m,
        "mass_kg": found.masses_kg[0],
    } }))
}

pub fn of_several_tests(inputs: &Fields) -> Result<Value, String> {
    let element = inputs.object("element")?;
    let law: ForceDeflection = force_deflection(&element)?;
    element.all_read()?;
    let curve = asked(&element)?;
    let dt_s = inputs.number("sample_interval_s")?;
    let mut tests = Vec::new();
    for fields in inputs.objects("tests")? {
        let mass_kg = fields.number("mass_kg")?;
        let structure = Structure::named(&[("car", mass_kg)], [("wall", "car", law.clone().into())]).map_err(say)?;
        let velocities_m_per_s = vec![fields.number("impact_speed_m_per_s")?];
        let drive = Drive::Start(Start::Each { positions_m: vec![0.0], velocities_m_per_s });
        let masses = motions(&structure, &drive, fields.number("until_s")?, dt_s)?;
        fields.all_read()?;
        let elements = vec![MeasuredElement { front: None, rear: 0, curve: 0, gap_m: law.gap_m() }];
        tests.push(MeasuredTest { dt_s, masses, elements, total_mass_kg: None, wall: None, through: None });
    }
    let found: Option<(f64, Extraction)> = extract_with_rate(&tests, &[curve], 0.0, None);
    let (rate, found) = found.ok_or("nothing was extracted")?;
    Ok(json!({ "expected": { "rate_s_per_m": rate, "force_n": found.forces_n[0] } }))
}

/// A program of given size: one mass in one loading.
pub fn of_a_program(inputs: &Fields) -> Result<Value, String> {
    let displacement_m = inputs.numbers("deflection_m")?;
    let mass = MeasuredMass {
        mass_kg: Some(inputs.number("mass_kg")?),
        velocity_m_per_s: vec![0.0; displacement_m.len()],
        displacement_m,
        acceleration_m_per_s2: inputs.numbers("acceleration_m_per_s2")?,
        noise_n: inputs.number("noise_n")?,
    };
    let elements = vec![MeasuredElement { front: None, rear: 0, curve: 0, gap_m: 0.0 }];
    let test =
        MeasuredTest { dt_s: 1e-3, masses: vec![mass], elements, total_mass_kg: None, wall: None, through: None };
    let curve = AskedCurve { knots_m: inputs.numbers("knots_m")?, rate_s_per_m: 0.0 };
    let weight = inputs.number("slope_change_weight_m2_per_n2")?;
    let found = extract(&[test], &[curve], weight).ok_or("nothing was extracted")?;
    Ok(json!({ "expected": {
        "force_n": found.forces_n[0],
        "objective": found.objective,
        "knots_at_zero": found.knots_at_zero[0],
    } }))
}
