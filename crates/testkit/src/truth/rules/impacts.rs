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
];

/// As many impacts as the summary lists.
fn several_impacts(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(!is_like_a_car(spot.made), || "it has one impact".to_owned())?;
    let [count] = said.values(["count"]);
    let listed = spot.made.list("/impacts").len();
    holds(count == listed as f64, || format!("{count} of {listed} impacts"))
}
