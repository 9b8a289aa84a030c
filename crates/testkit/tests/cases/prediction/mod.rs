//! Prediction: impacts, partners, occupants, extraction and the rules of practice. One file a kind; a new kind is a
//! line of [`KINDS`].

use crumple_lumped::{
    Collision, CollisionQuestions, CrashPulse, Drive, Element, ElementState, ForceDeflection, ForceDeflectionParameter,
    FrontToFront, HORIZON_S, Leg, Meeting, Moment, Node, Occupant, PathPoint, Place, Start, State, Structure, lead,
};
use crumple_lumped_fit::{AskedCurve, Extraction, ExtractionTest, MeasuredElement, MeasuredMass, extract};
use crumple_metrics::{CrushStiffness, DamageProfile, energy_equivalent_speed, wall_stiffness};
use serde_json::{Map, Value, json};

use crate::prediction::model::{Case, Fields, force_deflection, say};

mod model;

/// What the product says to the inputs of a case, in the names of the case file.
type Answer = fn(&Fields) -> Result<Value, String>;

/// The kinds of cases.
const KINDS: &[(&str, Answer)] = &[
    ("impact", impact),
    ("element-path", element_path),
    ("partners", partners),
    ("occupant", occupant),
    ("sensitivity", sensitivity),
    ("extraction", of_one_test),
    ("joint-fit", of_several_tests),
    ("quadratic-program", of_a_program),
    ("kw400", of_wall),
    ("crash3", of_damage),
];

pub fn check(_: Value) -> crate::Check {
    Box::new(|case| met(case).err().into_iter().collect())
}

/// Whether a case is met; else what is not.
fn met(case: &Value) -> Result<(), String> {
    let kind = case["kind"].as_str().unwrap_or("?");
    let Some((_, answer)) = KINDS.iter().find(|(name, _)| *name == kind) else {
        return Err("no such kind".to_owned());
    };
    let inputs = Fields::of(&case["inputs"], "inputs")?;
    let found = answer(&inputs)?;
    inputs.all_read()?;
    let tolerance = |name: &str| case["tolerance"][name].as_f64().ok_or(format!("tolerance {name}"));
    let tolerance = model::Tolerance { relative: tolerance("rel")?, absolute: tolerance("abs")? };
    model::values(&case["expected"], &found["expected"], "", tolerance)?;
    match case.get("events") {
        Some(events) => model::events(events, &found["events"], tolerance),
        None => Ok(()),
    }
}

fn element_path(inputs: &Fields) -> Result<Value, String> {
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

fn of_one_test(inputs: &Fields) -> Result<Value, String> {
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
    let test = ExtractionTest {
        dt_s,
        masses,
        elements,
        total_mass_kg: masses_free.then_some(total),
        wall: None,
        through: None,
    };
    let found = extract(&[test], &curves, 0.0).ok_or("nothing was extracted")?;
    Ok(json!({ "expected": {
        "force_n": found.forces_n,
        "unloading_n_per_m": found.unloading_n_per_m,
        "mass_kg": found.masses_kg[0],
    } }))
}

fn of_several_tests(inputs: &Fields) -> Result<Value, String> {
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
        tests.push(ExtractionTest { dt_s, masses, elements, total_mass_kg: None, wall: None, through: None });
    }
    let (rate, found) = with_best_rate(&tests, &curve).ok_or("nothing was extracted")?;
    Ok(json!({ "expected": { "rate_s_per_m": rate, "force_n": found.forces_n[0] } }))
}

/// The rate factor up to 0.2 s/m with which the equations of motion are met best, and what is extracted with it: the
/// lowest of a grid, then golden sections of the root of the sum of squares, which has a corner near an exact record.
fn with_best_rate(tests: &[ExtractionTest], curve: &AskedCurve) -> Option<(f64, Extraction)> {
    let with = |rate_s_per_m: f64| extract(tests, &[AskedCurve { rate_s_per_m, ..curve.clone() }], 0.0);
    let misfit = |rate: f64| with(rate).map_or(f64::INFINITY, |extraction| extraction.objective.sqrt());
    let lowest = |rates: &[f64]| rates.iter().copied().min_by(|a, b| misfit(*a).total_cmp(&misfit(*b)));
    let grid: Vec<f64> = (0..=40).map(|i| 0.005 * f64::from(i)).collect();
    let start = lowest(&grid)?;
    let (mut low, mut high) = ((start - 0.005).max(0.0), (start + 0.005).min(0.2));
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    while high - low > 1e-12 {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if misfit(left) <= misfit(right) { high = right } else { low = left }
    }
    let rate = lowest(&[low, 0.5 * (low + high), high])?;
    Some((rate, with(rate)?))
}

/// A program of given size: one mass in one loading.
fn of_a_program(inputs: &Fields) -> Result<Value, String> {
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
        ExtractionTest { dt_s: 1e-3, masses: vec![mass], elements, total_mass_kg: None, wall: None, through: None };
    let curve = AskedCurve { knots_m: inputs.numbers("knots_m")?, rate_s_per_m: 0.0 };
    let weight = inputs.number("slope_change_weight_m2_per_n2")?;
    let found = extract(&[test], &[curve], weight).ok_or("nothing was extracted")?;
    Ok(json!({ "expected": {
        "force_n": found.forces_n[0],
        "objective": found.objective,
        "knots_at_zero": found.knots_at_zero[0],
    } }))
}

fn impact(inputs: &Fields) -> Result<Value, String> {
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

fn occupant(inputs: &Fields) -> Result<Value, String> {
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

/// Two vehicles of one mass each, or a vehicle and a moving barrier.
fn partners(inputs: &Fields) -> Result<Value, String> {
    let mut sides = Vec::new();
    for name in ["vehicle_1", "vehicle_2"] {
        let fields = inputs.object(name)?;
        let front = fields.object("front")?;
        sides.push((fields.number("mass_kg")?, fields.number("velocity_m_per_s")?, force_deflection(&front)?));
        front.all_read()?;
        fields.all_read()?;
    }
    // Says of the case that one side stops on a plateau: the product must see that by itself.
    let _ = inputs.get("flat_at_stop");
    let structure = |k: usize| Structure::row(&[sides[k].0], [vec![sides[k].2.clone().into()]]).map_err(say);
    let both = FrontToFront::new(&structure(0)?, sides[0].1, &structure(1)?, -sides[1].1).map_err(say)?;
    let Meeting { common: Some(common), parting: Some(parting) } = both.meeting(HORIZON_S).map_err(say)? else {
        return Err("they do not meet and part".to_owned());
    };
    // The masses are those of the partner, then the own ones.
    let position = |k: usize| common.masses[1 - k].displacement_m;
    let contact_m = both.contact_m(|i| common.masses[i].displacement_m, common.largest_m[0]);
    let crush_m = [position(0) - contact_m, contact_m - position(1)];
    let energy_j = both.absorbed_j(&common).map_err(say)?;
    let force_n = sides[0].2.static_force_n(crush_m[0]);
    let end = [1, 0].map(|i: usize| parting.masses[i].velocity_m_per_s);
    let mut values = json!({
        "common_velocity_m_per_s": common.masses[1].velocity_m_per_s,
        "time_of_common_velocity_s": common.time_s,
        "mutual_crush_m": crush_m[0] + crush_m[1],
        "peak_force_n": force_n,
        "coefficient_of_restitution": (end[1] - end[0]) / (sides[0].1 - sides[1].1),
        "separation_time_s": parting.time_s,
        "momentum_n_s": sides[0].0 * end[0] + sides[1].0 * end[1],
    });
    for (k, (mass_kg, velocity, front)) in sides.iter().enumerate() {
        for (name, value) in [
            (format!("crush_{}_m", k + 1), crush_m[k]),
            (format!("energy_{}_j", k + 1), energy_j[k]),
            (format!("plastic_{}_j", k + 1), energy_j[k] - 0.5 * force_n * force_n / front.unloading_n_per_m()),
            (format!("permanent_set_{}_m", k + 1), crush_m[k] - force_n / front.unloading_n_per_m()),
            (format!("velocity_{}_end_m_per_s", k + 1), end[k]),
            (format!("delta_v_{}_m_per_s", k + 1), (end[k] - velocity).abs()),
            (format!("energy_equivalent_speed_{}_m_per_s", k + 1), (2.0 * energy_j[k] / mass_kg).sqrt()),
        ] {
            values[name] = value.into();
        }
    }
    Ok(json!({ "expected": values }))
}

fn of_wall(inputs: &Fields) -> Result<Value, String> {
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

fn of_damage(inputs: &Fields) -> Result<Value, String> {
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

fn sensitivity(inputs: &Fields) -> Result<Value, String> {
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
