//! Remarks on pulses with several impacts, and on a vehicle that stops without a rebound.

use crate::truth::rules::rule::{Rule, Spot, holds, is_like_a_car, own_test, says};
use crate::truth::template::Place::{At, Number};
use crate::truth::template::Said;

/// Their sentences.
pub const RULES: &[Rule] = &[
    says(
        "note.impacts",
        "the pulse holds {count} impacts: {each}. All numbers and models are of impact {number}; {more}",
        &[("count", Number), ("number", Number)],
        several_impacts,
    ),
    says(
        "note.impact-taken",
        "the pulse holds {count} impacts: {each}. Impact {number} is taken, {more}",
        &[("count", Number), ("number", Number)],
        |_, spot| holds(!is_like_a_car(spot.made), || "it has one impact, which stops it".to_owned()),
    ),
    says(
        "note.impacts-of-table",
        "the table holds {count} impacts: {each}. The maximum delta-v is the largest change within 300 ms (49 CFR 563)",
        &[("count", Number)],
        several_impacts,
    ),
    says(
        "note.impact-leaves",
        "this impact leaves the vehicle {left}, and another one follows: it has no dynamic crush and no rebound; \
         delta-v is {change} at {time}",
        &[("change", At("/events/delta_v_m_per_s")), ("time", At("/events/time_of_delta_v_s"))],
        |_, spot| holds(spot.made.list("/impacts").len() > 1, || "it has one impact".to_owned()),
    ),
    says(
        "note.stopped",
        "the velocity left at {time}, {left}, is within the error of the impact speed: the vehicle has stopped",
        &[("time", At("/events/time_of_dynamic_crush_s")), ("left", At("/events/rebound_velocity_m_per_s"))],
        |_, spot| match own_test(spot.made) {
            // What is left of the speed is no rebound.
            Some(truth) => holds(truth.restitution < 0.01, || format!("it rebounds at {:.2}", truth.restitution)),
            None => Ok(()),
        },
    ),
    says(
        "note.simple-pulse",
        "the simple pulse that fits best is a {wave}: it misses the pulse by {rms} RMS, {share} of its peak",
        &[("rms", Number), ("share", Number)],
        closest_wave,
    ),
    says("note.sled-pulse", "sled pulse {name} ({source}) is {verdict}: {demands}", &[], |_, spot| {
        holds(!is_like_a_car(spot.made), || "nobody asked for one".to_owned())
    }),
    says("note.kind", "what was tested is a {kind} ({rule}): {more}", &[], |_, spot| {
        holds(!is_like_a_car(spot.made), || "it is a car".to_owned())
    }),
    says("note.needs-neither", "mass and impact speed are not both stated: a {kind} needs neither", &[], |_, spot| {
        holds(!is_like_a_car(spot.made), || "it is a car".to_owned())
    }),
];

/// What is said is the misfit of one of the simple pulses in the summary, and no other misses clearly less.
fn closest_wave(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let share = said.number("share").ok_or("no share of the peak")?;
    let metrics = spot.made.summary["metrics"].as_object().into_iter().flatten();
    let misfits: Vec<f64> = metrics
        .filter(|(name, _)| name.starts_with("simple_pulse_"))
        .filter_map(|(_, metric)| metric["value"].as_f64())
        .collect();
    let least = misfits.iter().copied().fold(f64::INFINITY, f64::min);
    // Of those that miss at most 5 % more than the closest the simplest is named.
    let is_said = |misfit: f64| (share.value - 100.0 * misfit).abs() <= 0.0501;
    let is_one = misfits.iter().any(|misfit| is_said(*misfit) && *misfit <= 1.05 * least + 1e-6);
    holds(is_one, || format!("{} of {misfits:?}", said.text("share")))
}

/// As many impacts as the summary lists.
fn several_impacts(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(!is_like_a_car(spot.made), || "it has one impact".to_owned())?;
    let [count] = said.values(["count"]);
    let listed = spot.made.list("/impacts").len();
    holds(count == listed as f64, || format!("{count} of {listed} impacts"))
}
