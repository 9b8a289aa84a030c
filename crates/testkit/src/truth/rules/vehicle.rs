//! What happened: crush, time, rebound, change of velocity; what the record lacks.

use super::rule::{Rule, Spot, holds, is_rebound_cut, numbers_of_records, own_test, places_alone, rule, shows};
use crate::truth::known::Subject;
use crate::truth::template::Place::{At, Number, Said as Inner, Words};
use crate::truth::template::Said;

/// How far what a sound record shows may be from the truth: the trigger is off by 0.1 ms (0.3 % of the crush), the
/// speed by 0.1 km/h (0.2 %), and the zero level left by 2 % of noise (0.5 %).
const OF_RECORD: f64 = 0.02;

/// The sentences.
pub const RULES: &[Rule] = &[
    rule(
        "conclusion.crushed",
        &[
            ("crush", At("/events/dynamic_crush_m")),
            ("time", At("/events/time_of_dynamic_crush_s")),
            ("rebound", Inner(&["conclusion.rebounded", "conclusion.rebounded_at_least", "conclusion.no_rebound"])),
        ],
        crushed,
    ),
    rule(
        "conclusion.interval",
        &[("level", Inner(&["conclusion.level"])), ("low", Number), ("high", Number)],
        interval_is_ordered,
    ),
    rule("conclusion.level", &[("percent", Number)], level),
    rule("conclusion.rebounded", &[("speed", At("/events/rebound_velocity_m_per_s"))], |said, spot| {
        holds(!is_rebound_cut(spot.made), || "the record ends before the rebound does".to_owned())?;
        rebounded(said, spot)
    }),
    rule("conclusion.rebounded_at_least", &[("speed", At("/events/rebound_velocity_m_per_s"))], |said, spot| {
        holds(is_rebound_cut(spot.made), || "the record shows all of the rebound".to_owned())?;
        rebounded(said, spot)
    }),
    rule("conclusion.no_rebound", &[], no_rebound),
    rule("conclusion.no_stop", &[("change", At("/events/delta_v_m_per_s")), ("time", Number)], no_stop),
    rule("conclusion.no_stop_no_end", &[], no_stop),
    rule(
        "conclusion.two_vehicles",
        &[("change", At("/events/delta_v_m_per_s")), ("time", Inner(&["conclusion.within"]))],
        two_vehicles,
    ),
    rule("conclusion.within", &[("time", Number)], numbers_of_records),
    rule("conclusion.occupant", &[("place", Words), ("criteria", Words)], |_, spot| {
        holds(!spot.made.is_of_a_vehicle(), || "the sensor is on the vehicle".to_owned())
    }),
    rule("conclusion.occupant_use", &[("bounds", Inner(&["conclusion.lower_bounds"]))], |_, spot| {
        holds(!spot.made.is_of_a_vehicle(), || "the sensor is on the vehicle".to_owned())
    }),
    rule("conclusion.lower_bounds", &[], |_, spot| {
        holds(!spot.made.is_of_a_vehicle(), || "the sensor is on the vehicle".to_owned())
    }),
    rule(
        "conclusion.recorded",
        &[("change", At("/metrics/maximum_delta_v/value")), ("time", Inner(&["conclusion.reached"]))],
        recorder,
    ),
    rule("conclusion.reached", &[("time", At("/metrics/maximum_delta_v/from_s"))], places_alone),
    rule(
        "conclusion.recorder_use",
        &[("crush", Inner(&["conclusion.rough_crush"])), ("none", Inner(&["conclusion.recorder_without_model"]))],
        recorder,
    ),
    rule("conclusion.recorder_without_model", &[], |_, spot| {
        holds(spot.made.recommended().is_none(), || "a model is recommended".to_owned())
    }),
    rule(
        "conclusion.rough_crush",
        &[("crush", At("/events/dynamic_crush_m")), ("interval", Inner(&["conclusion.interval"]))],
        recorder,
    ),
    rule(
        "conclusion.changed",
        &[
            ("change", At("/metrics/delta_v/value")),
            ("time", Inner(&["conclusion.within"])),
            ("peak", Inner(&["conclusion.and_peak"])),
            ("olc", Inner(&["conclusion.and_olc"])),
        ],
        changed,
    ),
    rule("conclusion.and_peak", &[("peak", At("/metrics/peak_acceleration/value"))], places_alone),
    rule("conclusion.and_olc", &[("olc", At("/metrics/olc/value"))], places_alone),
    rule("conclusion.not_stated_both", &[], |_, spot| states(spot, false, false)),
    rule("conclusion.not_stated_mass", &[], |_, spot| states(spot, false, true)),
    rule("conclusion.not_stated_speed", &[], |_, spot| states(spot, true, false)),
    rule("conclusion.measured_only", &[], |_, spot| {
        holds(spot.made.summary["events"].is_null(), || "there are events of a motion".to_owned())
    }),
    rule("conclusion.no_models_here", &[], |_, spot| {
        holds(spot.made.list("/candidates").is_empty(), || "there are candidates".to_owned())
    }),
    rule(
        "conclusion.identified",
        &[("fit", Number), ("unseen", Inner(&["conclusion.unseen"])), ("mode", Inner(&["conclusion.mode"]))],
        identified,
    ),
    rule("conclusion.unseen", &[("fit", Number)], numbers_of_records),
    rule("conclusion.identified_fails", &[("fit", Number), ("unseen", Inner(&["conclusion.unseen"]))], identified),
    rule("conclusion.identified_none", &[], |_, spot| {
        let fits = spot.made.list("/models").iter().any(|model| model["fit_percent"].is_number());
        holds(!fits, || "a model has a fit".to_owned())
    }),
    rule("conclusion.identified_no_use", &[], |_, spot| {
        holds(spot.made.text("/verdict/status") != "usable", || "it is called usable".to_owned())
    }),
    rule("conclusion.mode", &[("frequency", Number), ("damping", Inner(&["conclusion.damping"]))], slowest_mode),
    rule("conclusion.damping", &[("ratio", Number)], numbers_of_records),
    rule("conclusion.no_model", &[("reason", Words)], |said, spot| {
        shows_reason(said.text("reason"), spot, "/verdict/reason")
    }),
    rule("conclusion.what_to_do", &[("remedy", Words)], |said, spot| {
        let remedies = spot.made.list("/concerns").iter().filter_map(|concern| concern["remedy"].as_str());
        let own = remedies.chain(["the notes of the run say more: just notes, and the folder of the run"]);
        let is_own =
            own.into_iter().any(|remedy| crate::truth::plain(remedy).trim_end_matches('.') == said.text("remedy"));
        holds(is_own, || "no warning has this remedy".to_owned())
    }),
];

fn crushed(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let made = spot.made;
    holds(matches!(made.known.subject, Subject::Vehicle), || "it is no vehicle at a wall".to_owned())?;
    let Some(truth) = own_test(made) else { return Ok(()) };
    for (name, true_value, tolerance) in [
        ("dynamic_crush_m", truth.crush_m, OF_RECORD * truth.crush_m),
        ("time_of_dynamic_crush_s", truth.time_s, OF_RECORD * truth.time_s),
        // The speed after the rebound is off by what the zero level makes of 0.1 s.
        ("coefficient_of_restitution", truth.restitution, 0.03),
    ] {
        let value = made.number(&format!("/events/{name}")).unwrap_or_default();
        // What a record shows of a rebound that it cuts off is a lower bound.
        let is_bound = name == "coefficient_of_restitution" && is_rebound_cut(made);
        let error = if is_bound { (value - true_value).max(0.0) } else { value - true_value };
        holds(error.abs() <= tolerance, || format!("{name} is {value:.4}, in truth {true_value:.4}"))?;
    }
    Ok(())
}

fn rebounded(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let e = spot.made.number("/events/coefficient_of_restitution").unwrap_or_default();
    holds(e > 0.0, || format!("the restitution is {e}"))?;
    holds(!said.text("speed").is_empty(), || "no speed is said".to_owned())
}

fn no_rebound(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let e = spot.made.number("/events/coefficient_of_restitution");
    holds(e.is_some_and(|e| e <= 0.0), || format!("the restitution is {e:?}"))
}

fn no_stop(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(spot.made.number("/events/dynamic_crush_m").is_none(), || "it stopped, and has a crush".to_owned())?;
    if let Some(truth) = own_test(spot.made) {
        return Err(format!("in truth it stopped after {:.1} ms", 1e3 * truth.time_s));
    }
    numbers_of_records(said, spot)
}

fn interval_is_ordered(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let ends = said.number("low").zip(said.number("high"));
    let (low, high) = ends.ok_or("an interval without ends")?;
    holds(low.value <= high.value, || format!("{} is above {}", said.text("low"), said.text("high")))?;
    numbers_of_records(said, spot)
}

fn level(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let percent = said.number("percent").map(|shown| shown.value);
    let levels = [Some(90.0), Some(95.0)];
    holds(levels.contains(&percent), || format!("{percent:?} is the level of no interval of {}", spot.made.name))
}

fn two_vehicles(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(spot.made.known.subject == Subject::TwoVehicles, || "there is one vehicle".to_owned())
}

fn recorder(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(spot.made.known.subject == Subject::Recorder, || "it is no recorder's table".to_owned())?;
    numbers_of_records(said, spot)
}

/// What a record without mass or speed states; its change of velocity needs neither.
fn changed(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let made = spot.made;
    let (Some(speed), Some(change)) = (made.known.speed_m_per_s, made.number("/metrics/delta_v/value")) else {
        return Ok(());
    };
    // The made pulse rebounds at a tenth of its speed.
    let truth = 1.1 * speed;
    let is_close = !made.known.is_sound || (change / truth - 1.0).abs() <= OF_RECORD;
    holds(is_close, || format!("the change is {change:.2} m/s, in truth {truth:.2}"))
}

fn states(spot: &Spot<'_>, mass: bool, speed: bool) -> Result<(), String> {
    let stated = (spot.made.number("/test/mass_kg"), spot.made.number("/test/impact_speed_m_per_s"));
    holds((stated.0.is_some(), stated.1.is_some()) == (mass, speed), || {
        format!("the record states a mass of {:?} kg and a speed of {:?} m/s", stated.0, stated.1)
    })
}

/// The fit that is named is the highest of all identified models, and no motion fits better than wholly.
fn identified(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let models = spot.made.list("/models");
    let model = models.iter().find(|model| model["id"].as_str() == Some(said.text("model")));
    let fit = model.and_then(|model| model["fit_percent"].as_f64());
    shows(said, "fit", fit, "the fit of the model")?;
    // On samples that no model has seen, where there are some.
    let decides = |model: &serde_json::Value| model["unseen_fit_percent"].as_f64().or(model["fit_percent"].as_f64());
    let best = models.iter().filter_map(decides).fold(f64::NEG_INFINITY, f64::max);
    let own = model.and_then(decides).unwrap_or_default();
    holds(own >= best && own <= 100.0 + 1e-9, || format!("the highest fit is {best} %"))
}

/// The slowest oscillation among the poles of the models.
fn slowest_mode(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let poles = spot.made.list("/models").iter().flat_map(|model| model["poles"].as_array().into_iter().flatten());
    let of_pole = |pole: &serde_json::Value| {
        let (re, im) = (pole["re_per_s"].as_f64()?, pole["im_rad_per_s"].as_f64()?);
        (im > 0.0).then(|| re.hypot(im) / std::f64::consts::TAU)
    };
    let shown = said.number("frequency").ok_or("no frequency")?;
    let is_there = poles.filter_map(of_pole).any(|hz| (hz - shown.value).abs() <= 0.006);
    holds(is_there, || format!("no pole oscillates at {}", said.text("frequency")))
}

fn shows_reason(text: &str, spot: &Spot<'_>, pointer: &str) -> Result<(), String> {
    let reason = crate::truth::plain(spot.made.text(pointer));
    holds(reason.trim_end_matches('.') == text.trim_end_matches('.'), || format!("the summary says {reason:?}"))
}
