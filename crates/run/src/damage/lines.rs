//! What `damage` prints: results, warnings, and what is assumed.

use crumple_signal::display::{sentence, shown};
use crumple_signal::key_quantities::KM_PER_H_PER_M_PER_S;
use crumple_stage::labelled;

use super::result::{
    CollisionResult, CrushSource, DamageResult, EnergyKind, StiffnessResult, VehicleDamage, VehicleResult,
};
use super::stiffness::{NoDamageSpeedSource, StiffnessSource};

/// Columns of the labels.
const LABEL: usize = 26;
/// Columns of a line: the same on every terminal, so that lines can be quoted.
const WIDTH: usize = 110;

/// Accuracy that was published, with its sources.
pub(super) const ACCURACY: &str = "Published accuracy of the method: 95 % limits of one delta-v by CRASH are 9 to 25 % \
    (53 vehicles, Smith and Noga 1982). 10 % of stiffness moves it by 2 to 6 % (same). CRASH3 is 33 % low in tests \
    with 40 % offset (41 tests, O'Neill et al. 1996). WinSMASH is 23 % low against recorders without restitution, \
    1 % with it (121 frontal crashes, Niehoff and Gabler 2006).";

/// A number from SI as metric pages show it, with its unit, or that of the reader.
fn number(value: f64, metric: (f64, usize, &'static str)) -> (String, &'static str) {
    let (factor, places, unit) = shown(metric);
    (format!("{:.places$}", factor * value), unit)
}

fn quantity(value: f64, metric: (f64, usize, &'static str)) -> String {
    let (number, unit) = number(value, metric);
    format!("{number} {unit}")
}

fn range([low, high]: [f64; 2], metric: (f64, usize, &'static str)) -> String {
    format!("{} to {}", number(low, metric).0, quantity(high, metric))
}

const SPEED: (f64, usize, &str) = (KM_PER_H_PER_M_PER_S, 1, "km/h");
const ENERGY: (f64, usize, &str) = (1e-3, 1, "kJ");

fn km_h(speed_m_per_s: f64) -> String {
    quantity(speed_m_per_s, SPEED)
}

fn km_h_range(ends: [f64; 2]) -> String {
    range(ends, SPEED)
}

fn kj(energy_j: f64) -> String {
    quantity(energy_j, ENERGY)
}

fn mm(length_m: f64) -> String {
    quantity(length_m, (1e3, 0, "mm"))
}

fn kg(mass_kg: f64) -> String {
    quantity(mass_kg, (1.0, 0, "kg"))
}

/// `(95 %: 30.1 to 37.2 km/h)` behind a speed, where it has an interval.
fn with_interval(speed_m_per_s: f64, interval: Option<[f64; 2]>) -> String {
    let interval = interval.map_or(String::new(), |interval| format!(" (95 %: {})", km_h_range(interval)));
    format!("{}{interval}", km_h(speed_m_per_s))
}

/// All lines.
pub(super) fn lines(result: &DamageResult) -> Vec<String> {
    let mut rows: Vec<(String, String)> = Vec::new();
    let names = if result.other.is_some() { ["first vehicle", "other vehicle"] } else { ["vehicle", ""] };
    for (name, vehicle) in names.iter().zip([Some(&result.vehicle), result.other.as_ref()]) {
        if let Some(vehicle) = vehicle {
            rows.extend(vehicle_rows(name, vehicle));
        }
    }
    if let Some(collision) = &result.collision {
        rows.extend(collision_rows(collision));
    }
    // Sentences of the result are SI, as its JSON is.
    rows.extend(result.warnings.iter().map(|text| ("warning".to_owned(), sentence(text).into_owned())));
    rows.extend(result.assumed.iter().map(|text| ("assumed".to_owned(), sentence(text).into_owned())));
    rows.push(("accuracy".to_owned(), ACCURACY.to_owned()));
    rows.iter().flat_map(|(label, text)| labelled(label, LABEL, text, WIDTH)).collect()
}

fn vehicle_rows(name: &str, vehicle: &VehicleResult) -> Vec<(String, String)> {
    let mut rows = stiffness_rows(&vehicle.stiffness);
    if let Some(damage) = &vehicle.damage {
        rows.extend(damage_rows(damage));
    }
    let title = |(label, text): (&str, String)| (format!("{name}, {label}"), text);
    rows.into_iter().map(title).collect()
}

fn stiffness_rows(stiffness: &StiffnessResult) -> Vec<(&'static str, String)> {
    let whose = match stiffness.source {
        StiffnessSource::Run => "from the run",
        StiffnessSource::Tests => "from barrier tests",
        StiffnessSource::Line => "from b0 and b1 as typed",
        StiffnessSource::Coefficients => "as typed",
    };
    let a = quantity(stiffness.a_n_per_m, (1e-3, 1, "kN/m"));
    let b = quantity(stiffness.b_n_per_m2, (1e-3, 0, "kN/m²"));
    let g = quantity(stiffness.g_n, (1e-3, 2, "kN"));
    let mut rows = vec![("stiffness", format!("A {a}, B {b}, G {g}, {whose}"))];
    for test in &stiffness.tests {
        rows.push((
            "test",
            format!(
                "{}: {}, {}, mean residual crush {}, width {}",
                test.name,
                kg(test.mass_kg),
                km_h(test.impact_speed_m_per_s),
                mm(test.mean_residual_crush_m),
                mm(test.width_m)
            ),
        ));
    }
    let b0 = with_interval(stiffness.b0_m_per_s, stiffness.b0_interval_m_per_s);
    let b1 = match stiffness.b1_interval_per_s {
        Some([low, high]) => format!("{:.2} 1/s (95 %: {low:.2} to {high:.2})", stiffness.b1_per_s),
        None => format!("{:.2} 1/s", stiffness.b1_per_s),
    };
    rows.push(("line", format!("b0 {b0}, b1 {b1}")));
    if let Some((deviation, freedom)) = stiffness.deviation_m_per_s.zip(stiffness.degrees_of_freedom) {
        let plural = if freedom == 1 { "degree" } else { "degrees" };
        let scatter =
            format!("the tests scatter by {} about the line ({freedom} {plural} of freedom)", km_h(deviation));
        rows.push(("scatter", scatter));
    }
    rows
}

fn damage_rows(damage: &VehicleDamage) -> Vec<(&'static str, String)> {
    let stations = damage.residual_crush_m.len();
    let mean = mm(damage.mean_residual_crush_m);
    let crush = match damage.crush_source {
        CrushSource::Profile => format!("{stations} stations over {}, mean {mean}", mm(damage.width_m)),
        CrushSource::ForceBalance => {
            format!("even over {}, {mean} by the force of the first vehicle", mm(damage.width_m))
        }
    };
    let angle = damage.force_angle_rad.to_degrees();
    let oblique =
        format!(" ({} times {:.3} for a force at {angle:.1}°)", kj(damage.energy_without_angle_j), damage.angle_factor);
    let energy = format!("{}{}", kj(damage.energy_j), if angle == 0.0 { "" } else { &oblique });
    let interval = damage.energy_interval_j;
    let interval = interval.map_or(String::new(), |ends| format!(" (95 %: {})", range(ends, ENERGY)));
    let speed =
        with_interval(damage.equivalent_barrier_speed_m_per_s, damage.equivalent_barrier_speed_interval_m_per_s);
    let mut rows = vec![
        ("crush", crush),
        ("energy", format!("{energy}{interval}")),
        ("EBS", format!("{speed}: the equivalent barrier speed at {}", kg(damage.mass_kg))),
    ];
    if let Some(interval) = damage.one_vehicle_interval_m_per_s {
        let text = format!("{} holds 95 % of single vehicles like the tests", km_h_range(interval));
        rows.push(("one of its kind", text));
    }
    rows
}

fn collision_rows(collision: &CollisionResult) -> Vec<(String, String)> {
    let [first, other] = collision.delta_v_m_per_s;
    let intervals = collision.delta_v_intervals_m_per_s;
    let is_central = collision.effective_mass_shares == [1.0, 1.0];
    let place = if is_central { "" } else { " where they touch, along the force" };
    let shares = collision.effective_mass_shares;
    let energy = match collision.energy_is {
        EnergyKind::Approach => "the energy of the approach",
        EnergyKind::Lost => "the energy lost for good",
    };
    let closing = with_interval(collision.closing_speed_m_per_s, collision.closing_speed_interval_m_per_s);
    let mut rows = vec![
        ("collision, energy", format!("{}, taken as {energy}", kj(collision.energy_j))),
        ("collision, closing speed", format!("{closing}{place}")),
        ("delta-v, first vehicle", with_interval(first, intervals.map(|both| both[0]))),
        ("delta-v, other vehicle", with_interval(other, intervals.map(|both| both[1]))),
        (
            "collision, force ratio",
            format!("{:.2}: peak force of the first vehicle over the other", collision.force_ratio),
        ),
    ];
    if !is_central {
        let text = format!("{:.3} and {:.3} of the masses act where they touch", shares[0], shares[1]);
        rows.push(("collision, lever arms", text));
    }
    rows.into_iter().map(|(label, text)| (label.to_owned(), text)).collect()
}

// Warnings, and what is assumed.

/// Peak forces that differ by more than this factor: one of the profiles, widths or stiffnesses is wrong. Ours: the
/// speed of a side goes with its force at a given stiffness, and a published result is good to 25 %, both ways.
pub(super) const FORCE_FACTOR: f64 = 1.5;

/// Masses a width of tests that differ by more than this share are no tests of one front. Ours: cargo and equipment.
const MASS_SHARE: f64 = 0.1;

/// What speaks against a vehicle's result.
pub(super) fn vehicle_warnings(name: &str, vehicle: &VehicleResult) -> Vec<String> {
    let mut warnings = Vec::new();
    let stiffness = &vehicle.stiffness;
    let tests = &stiffness.tests;
    if stiffness.degrees_of_freedom.is_none() {
        let why = match (stiffness.source, tests.len()) {
            (StiffnessSource::Line | StiffnessSource::Coefficients, _) => "typed values state no error",
            (_, 2) => "two tests always lie on a line; a third shows how far tests scatter",
            _ => "one test shows no scatter; three tests at different speeds do",
        };
        warnings.push(format!("The {name} has no interval: {why}."));
    }
    if stiffness.b1_interval_per_s.is_some_and(|[low, _]| low <= 0.0) {
        warnings.push(format!(
            "The tests of the {name} do not show that the speed rises with the crush: the interval of b1 holds zero. \
             Add tests at other speeds, or state --no-damage-speed."
        ));
    }
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
    };
    let (low, high) = range(&mut tests.iter().map(|test| test.mass_kg / test.width_m));
    if high > (1.0 + MASS_SHARE) * low {
        let share = 100.0 * (high / low - 1.0);
        warnings.push(format!(
            "Mass over width differs by {share:.0} % between the tests of the {name}; their mean is used. Our limit is \
             {:.0} %. Look whether all tests are of one front.",
            100.0 * MASS_SHARE
        ));
    }
    let (least, high) = range(&mut tests.iter().map(|test| test.mean_residual_crush_m));
    // One test has a line from zero crush on.
    let low = if tests.len() > 1 { least } else { 0.0 };
    let crush = vehicle.damage.as_ref().map(|damage| damage.mean_residual_crush_m);
    if let Some(crush) = crush.filter(|crush| !tests.is_empty() && !(low..=high).contains(crush)) {
        let (crush, low, high) = (mm(crush), mm(low), mm(high));
        warnings.push(format!(
            "The mean crush of the {name} is {crush}, outside the tests ({low} to {high}): the line is extended."
        ));
    }
    warnings
}

/// Whether both sides of a collision bear the same force.
pub(super) fn force_warning(collision: &CollisionResult) -> Option<String> {
    let ratio = collision.force_ratio;
    let is_balanced = (1.0 / FORCE_FACTOR..=FORCE_FACTOR).contains(&ratio);
    (!is_balanced).then(|| {
        format!(
            "The peak forces of both vehicles differ by a factor of {:.2}, beyond our limit of {FORCE_FACTOR}; they \
             should be equal. Check widths, profiles and stiffness, or leave out --other-profile: the crush of the \
             other vehicle then follows from the force.",
            ratio.max(1.0 / ratio)
        )
    })
}

/// What is assumed about a vehicle.
pub(super) fn vehicle_assumptions(name: &str, vehicle: &VehicleResult) -> Vec<String> {
    let mut assumed = Vec::new();
    assumed.push(match vehicle.stiffness.b0_source {
        NoDamageSpeedSource::Typed if vehicle.stiffness.source == StiffnessSource::Coefficients => {
            format!("b0 and b1 of the {name} follow from A and B as typed, at its own mass and width.")
        }
        NoDamageSpeedSource::Fitted => format!("b0 of the {name} is that of the line of its tests."),
        NoDamageSpeedSource::Typed => format!("b0 of the {name} is as typed."),
        NoDamageSpeedSource::Run => format!("b0 of the {name} is that of its run (--no-damage-speed of integrate)."),
        NoDamageSpeedSource::Assumed => {
            format!("b0 of the {name} is 8.0 km/h, the usual value where it is not known.")
        }
    });
    if vehicle.damage.as_ref().is_some_and(|damage| damage.crush_source == CrushSource::ForceBalance) {
        assumed.push(format!("The {name} is crushed evenly, as far as it bears the force of the first."));
    }
    assumed
}

/// What is assumed about damage and collision.
pub(super) fn common_assumptions(result: &DamageResult) -> Vec<String> {
    let mut assumed = vec!["The force rises linearly with the residual crush, alike over the whole width.".to_owned()];
    let Some(damage) = &result.vehicle.damage else { return assumed };
    assumed.push(
        "The stations are equally spaced over the width, straight between them; the crush does not change over the \
         height (no undercut, no override)."
            .to_owned(),
    );
    if damage.energy_interval_j.is_some() {
        assumed.push(
            "The intervals come from the scatter of the tests. Profile, angle, mass and restitution are taken as exact."
                .to_owned(),
        );
    }
    let Some(collision) = &result.collision else { return assumed };
    let e = collision.restitution;
    assumed.push(format!(
        "Restitution is {e} (0: both leave with a common velocity; about 0.1 at medium and high speed, SAE 931842)."
    ));
    if collision.effective_mass_shares == [1.0, 1.0] {
        assumed.push(
            "The impact is central and collinear: the force goes through both centres of mass. --lever and \
             --yaw-radius state another one."
                .to_owned(),
        );
    }
    if collision.closing_speed_interval_m_per_s.is_some() {
        assumed.push("The errors of both stiffnesses are independent.".to_owned());
    }
    assumed
}
