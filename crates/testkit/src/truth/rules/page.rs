//! Facts, cards and captions of the first screen, and the lines of the console: sentences that are put together there.

use serde_json::Value;

use crate::truth::known::Subject;
use crate::truth::rules::rule::{
    Rule, Spot, holds, is_like_a_car, is_rebound_cut, may_be_cut, numbers_of_records, own_test, places_alone, rule,
    says, shows,
};
use crate::truth::run::{Shown, numbers};
use crate::truth::template::Place::{At, Number, Said as Inner, Words};
use crate::truth::template::Said;

/// The sentences.
pub const RULES: &[Rule] = &[
    says("page.mass", "{mass}", &[("mass", At("/test/mass_kg"))], places_alone),
    says(
        "page.speed",
        "{km_per_h} ({m_per_s})",
        &[("km_per_h", At("/test/impact_speed_m_per_s")), ("m_per_s", At("/test/impact_speed_m_per_s"))],
        places_alone,
    ),
    says("page.words", "{words}", &[], in_the_test),
    rule("page.samples", &[("rate", At("/test/sample_rate_hz")), ("count", Number)], |said, spot| {
        let wave = spot.made.waves.get(spot.made.text("/test/channel"));
        let count = said.number("count").map(|shown| shown.value as usize);
        let longest = wave.map(|wave| wave.sampled.samples().len());
        holds(longest.is_none() || count >= longest.filter(|_| count.is_some()), || format!("{longest:?} are left"))
    }),
    rule("page.not_known", &[], |_, spot| {
        let pointer = match spot.key {
            "Test mass" => "/test/mass_kg",
            "Impact speed" => "/test/impact_speed_m_per_s",
            "Vehicle" => "/test/vehicle",
            "Barrier" => "/test/barrier",
            other => return Err(format!("{other} is not asked for")),
        };
        let own = spot.made.summary.pointer(pointer);
        holds(own.is_none_or(Value::is_null), || format!("it is {own:?}"))
    }),
    says("page.card-value", "{value}", &[("value", Words)], card_value),
    says("page.card-inputs", "inputs, 90 %: {low} to {high}", &[("low", Number), ("high", Number)], card_interval),
    says("page.card-resolution", "resolution: {low} to {high}", &[("low", Number), ("high", Number)], card_interval),
    says("page.card-interval", "interval: {low} to {high}", &[("low", Number), ("high", Number)], card_interval),
    says("page.card-ratio", "tc/tm = {ratio}", &[("ratio", Number)], |said, spot| {
        let of = |name: &str| spot.made.number(&format!("/events/{name}"));
        let ratio = of("centroid_time_s").zip(of("time_of_dynamic_crush_s")).map(|(c, m)| c / m);
        shows(said, "ratio", ratio, "the ratio of the times")
    }),
    says("page.card-olc", "OLC", &[], places_alone),
    says("page.card-hic", "HIC{limit}", &[], places_alone),
    says("page.card-absent", "absent: {why}", &[], |said, spot| {
        holds(key_number(spot).is_none_or(|number| number["value"].is_null()), || "it has a value".to_owned())?;
        numbers_of_records(said, spot)
    }),
    rule("numbers.peak_not_filtered", &[], |_, spot| {
        let filtered = spot.made.records.iter().any(|(topic, record)| topic == "/filter" && record["cfc"].is_number());
        holds(!filtered, || "the record was filtered".to_owned())
    }),
    rule("numbers.no_interval", &[], |_, spot| {
        holds(key_number(spot).is_some_and(|number| number["low"].is_null()), || "there is an interval".to_owned())
    }),
    rule("numbers.inputs_caption", &[("by", Words)], numbers_of_records),
    rule("numbers.resolution_caption", &[("by", Words)], numbers_of_records),
    rule("numbers.sensors_caption", &[("channels", Words)], |said, spot| {
        let spreads =
            spot.made.list("/key_numbers").iter().filter_map(|number| number["spread"]["channels"].as_array());
        let joined = |channels: &Vec<Value>| channels.iter().filter_map(Value::as_str).collect::<Vec<_>>().join(", ");
        let channels = spreads.map(joined).next();
        holds(channels.as_deref() == Some(said.text("channels")), || format!("the sensors are {channels:?}"))?;
        holds(spot.made.known.sensors == 1, || "its sensors sit on different masses".to_owned())
    }),
    rule("numbers.marked_caption", &[], |_, spot| {
        let beyond = spot.made.list("/key_numbers").iter().any(|number| {
            let ends = number["low"].as_f64().zip(number["high"].as_f64());
            let spread = number["spread"]["low"].as_f64().zip(number["spread"]["high"].as_f64());
            ends.zip(spread).is_some_and(|((low, high), (lowest, highest))| lowest < low || highest > high)
        });
        holds(beyond, || "no sensor lies outside of an interval".to_owned())
    }),
    says(
        "page.model-head",
        "{role}: {model}",
        &[(
            "role",
            Inner(&[
                "model.recommended_and_closest",
                "model.recommended",
                "model.closest",
                "model.closest_alone",
                "model.in_doubt",
            ]),
        )],
        |said, spot| {
            holds(spot.made.candidate_named(said.text("model")).is_some(), || "there is no such model".to_owned())
        },
    ),
    says(
        "page.determined",
        "{count}{magnitude}{open}{noise}{widened}.",
        &[
            ("count", Inner(&["conclusion.determined"])),
            ("magnitude", Inner(&["conclusion.order_of_magnitude"])),
            ("open", Inner(&["conclusion.open"])),
            ("noise", Inner(&["model.for_exact_mass"])),
            ("widened", Inner(&["model.held_by_intervals"])),
        ],
        |said, _| holds(said.inner("count").is_some(), || "no count".to_owned()),
    ),
    says(
        "page.prediction",
        "{speed}{impact} | {crush} | {low} to {high} | {peak} | {range}",
        &[("speed", Number), ("crush", Number), ("low", Number), ("high", Number)],
        prediction_of_a_row,
    ),
    says(
        "page.prediction-bare",
        "{speed}{impact} | {crush} | {low} | {peak} | {range}",
        &[("speed", Number)],
        prediction_of_a_row,
    ),
    says("console.number", "{number}", &[("number", Words)], console_number),
    says("console.model", "{model}: {parameters}", &[], |said, spot| {
        let own = spot.made.candidate_named(said.text("model")).ok_or("there is no such candidate")?;
        holds(own["id"] == spot.made.summary["recommended"], || "another is recommended".to_owned())?;
        let says_by_what = said.text("parameters").contains("for an exact mass and gain");
        let has_intervals = own["uncertainty"]["interval_low"].as_object().is_some_and(|ends| !ends.is_empty());
        holds(says_by_what == has_intervals, || format!("it has intervals: {has_intervals}"))
    }),
    says("console.warning", "{number}. {warning}", &[("number", Number)], is_a_warning),
    says(
        "console.more",
        "{more}: just notes {folder}",
        &[("more", Inner(&["conclusion.more", "conclusion.one_more"]))],
        |said, _| holds(said.inner("more").is_some(), || "nothing is counted".to_owned()),
    ),
    says("page.about", "{about}: {warning}", &[], is_a_warning),
];

/// The words of a fact stand in the record of the test, or name its pulse.
fn in_the_test(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let test = spot.made.records.iter().find(|(topic, _)| topic == "/test").map(|(_, test)| test.to_string());
    let text = crate::truth::plain(&format!("{} {}", test.unwrap_or_default(), spot.made.text("/test/channel")));
    let first = said.text("words").split(", ").next().unwrap_or_default().replace('"', "\\\"");
    holds(text.contains(&first), || format!("{first:?} is not said of the test"))
}

/// The key number of a card or of a line.
fn key_number<'a>(spot: &Spot<'a>) -> Option<&'a Value> {
    spot.made.list("/key_numbers").iter().find(|number| number["name"].as_str() == Some(spot.key))
}

fn card_value(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let number = key_number(spot).ok_or_else(|| format!("the summary has no {}", spot.key))?;
    match number["value"].as_f64() {
        Some(value) => shows(said, "value", Some(value), spot.key),
        None => holds(said.number("value").is_none(), || "the summary has no value".to_owned()),
    }
}

fn card_interval(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let number = key_number(spot).ok_or_else(|| format!("the summary has no {}", spot.key))?;
    shows(said, "low", number["low"].as_f64(), "the lower end")?;
    shows(said, "high", number["high"].as_f64(), "the upper end")
}

/// Every number of the line is the value, an end of its interval, its time or a percentage of it.
fn console_number(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let number = key_number(spot).ok_or_else(|| format!("the summary has no {}", spot.key))?;
    let own = ["/value", "/low", "/high", "/at_s", "/spread/low", "/spread/high"].map(|at| number.pointer(at));
    let channels = number["spread"]["channels"].as_array().map_or(0, Vec::len);
    let all = numbers(said.text("number"));
    for shown in &all {
        // The ends of the interval have the unit of the value before them.
        let in_its_unit = shown.in_unit_of(&all[0]);
        let is_own = own.iter().flatten().any(|value| shown.is(value) || in_its_unit.is(value));
        let is_own = is_own || [90.0, channels as f64].contains(&shown.value);
        holds(is_own, || format!("{} of {:?} is no number of it", shown.value, said.text("number")))?;
    }
    Ok(())
}

/// A prediction of the recommended model has these numbers, and is where the row says.
fn prediction_of_a_row(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let value = |place: &str| numbers(said.text(place)).into_iter().next();
    let speed = value("speed").ok_or("no speed is said")?;
    let is_close = |shown: Option<Shown>, own: Option<f64>| match (shown, own) {
        (Some(shown), Some(own)) => shown.is_of(own),
        (shown, _) => shown.is_none(),
    };
    let is_it = |p: &&Value| {
        let interval = p["intervals"].as_array().and_then(|all| all.iter().find(|i| i["name"] == "dynamic_crush_m"));
        let end = |name: &str| interval.and_then(|interval| interval[name].as_f64()).map(|end| 1e3 * end);
        p["candidate"] == spot.made.summary["recommended"]
            && is_close(Some(speed.clone()), p["impact_speed_m_per_s"].as_f64().map(|v| 3.6 * v))
            && is_close(value("impact"), p["mass_kg"].as_f64())
            && is_close(value("crush"), p["dynamic_crush_m"].as_f64().map(|c| 1e3 * c))
            && is_close(value("low"), end("low"))
            && is_close(value("peak"), p["peak_acceleration_m_per_s2"].as_f64().map(|a| a / 9.806_65))
    };
    let own = spot.made.list("/predictions").iter().find(is_it).ok_or("no prediction has these numbers")?;
    let by_record = said.text("peak").ends_with('*');
    holds(by_record == (own["peak_by"] == "record"), || format!("its peak is by {}", own["peak_by"]))?;
    let beyond = said.text("range").starts_with("beyond");
    holds(own["extrapolates"] == beyond, || format!("it is {}", said.text("range")))?;
    let tested = spot.made.number("/test/impact_speed_m_per_s").unwrap_or_default();
    let is_tested = own["impact_speed_m_per_s"].as_f64().is_some_and(|v| (v / tested - 1.0).abs() < 0.01);
    holds(is_tested || !said.text("range").starts_with("as tested"), || "it was not tested".to_owned())
}

/// A warning of the summary, whole or cut at the end of the line.
fn is_a_warning(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let warning = said.text("warning");
    let start = warning.strip_suffix(" ...").unwrap_or(warning);
    let of_summary = |concern: &str| crate::truth::plain(concern);
    let is_one = spot
        .made
        .concerns()
        .map(of_summary)
        .any(|concern| concern.starts_with(start) || start.starts_with(concern.trim_end_matches('.')));
    holds(is_one, || format!("{start:?} is no warning of the summary"))
}

/// How far what a sound record shows may be from the truth: the trigger is off by 0.1 ms (0.3 % of the crush), the
/// speed by 0.1 km/h (0.2 %), and the zero level left by 2 % of noise (0.5 %).
const OF_RECORD: f64 = 0.02;

/// The sentences.
pub const VEHICLE_RULES: &[Rule] = &[
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
        holds(may_be_cut(spot.made), || "the record shows all of the rebound".to_owned())?;
        rebounded(said, spot)
    }),
    rule("conclusion.no_rebound", &[], no_rebound),
    rule("conclusion.at_least", &[], places_alone),
    rule("conclusion.at_most", &[], places_alone),
    rule(
        "conclusion.no_stop",
        &[("bound", Inner(&["conclusion.at_least"])), ("change", At("/events/delta_v_m_per_s")), ("time", Number)],
        no_stop,
    ),
    rule("conclusion.no_stop_in_impact", &[("change", At("/events/delta_v_m_per_s")), ("time", Number)], no_stop),
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
    rule(
        "conclusion.recorded_at_least",
        &[("change", At("/metrics/maximum_delta_v/value")), ("time", At("/metrics/maximum_delta_v/from_s"))],
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
        &[("crush", At("/metrics/recorded_crush/value")), ("interval", Inner(&["conclusion.interval"]))],
        recorder,
    ),
    rule(
        "conclusion.recorder_energy",
        &[
            ("ees", At("/metrics/recorded_ees/value")),
            ("interval", Inner(&["conclusion.interval"])),
            ("share", Inner(&["conclusion.of_energy"])),
            ("speed", Inner(&["conclusion.speed_is_exact"])),
        ],
        energy_of_a_recorder,
    ),
    rule(
        "conclusion.recorder_energy_at_least",
        &[
            ("ees", At("/metrics/recorded_ees/value")),
            ("share", Inner(&["conclusion.of_energy"])),
            ("speed", Inner(&["conclusion.speed_is_exact"])),
        ],
        recorder,
    ),
    rule("conclusion.speed_is_exact", &[], |_, spot| {
        holds(spot.made.number("/test/impact_speed_m_per_s").is_some(), || "no speed is stated".to_owned())
    }),
    rule("conclusion.of_energy", &[("share", At("/metrics/absorbed_energy_share/value"))], energy_of_a_recorder),
    rule(
        "conclusion.changed",
        &[
            ("bound", Inner(&["conclusion.at_least"])),
            ("change", At("/metrics/delta_v/value")),
            ("time", Inner(&["conclusion.within"])),
            ("peak", Inner(&["conclusion.and_peak"])),
            ("olc", Inner(&["conclusion.and_olc"])),
            ("stroke", Inner(&["conclusion.and_stroke"])),
        ],
        changed,
    ),
    rule("conclusion.and_peak", &[("peak", At("/metrics/peak_acceleration/value"))], places_alone),
    rule("conclusion.and_olc", &[("olc", At("/metrics/olc/value"))], places_alone),
    rule("conclusion.and_stroke", &[("stroke", At("/metrics/stroke/value"))], places_alone),
    rule("conclusion.not_stated_both", &[], |_, spot| states(spot, false, false)),
    rule("conclusion.not_stated_mass", &[], |_, spot| states(spot, false, true)),
    rule("conclusion.not_stated_speed", &[], |_, spot| states(spot, true, false)),
    rule("conclusion.measured_only", &[], |_, spot| {
        holds(spot.made.summary["events"].is_null(), || "there are events of a motion".to_owned())
    }),
    rule("conclusion.no_structure", &[], |_, spot| {
        holds(!is_like_a_car(spot.made) && spot.made.list("/candidates").is_empty(), || "it is a car".to_owned())
    }),
    rule("conclusion.no_models_here", &[], |_, spot| {
        holds(spot.made.list("/candidates").is_empty(), || "there are candidates".to_owned())
    }),
    rule(
        "conclusion.identified",
        &[("fit", Number), ("unseen", Inner(&["conclusion.unseen"])), ("mode", Inner(&["conclusion.mode"]))],
        identified,
    ),
    rule(
        "conclusion.identified_chosen",
        &[("fit", Number), ("unseen", Inner(&["conclusion.unseen"])), ("mode", Inner(&["conclusion.mode"]))],
        identified,
    ),
    rule("conclusion.unseen", &[("fit", Number)], numbers_of_records),
    rule("conclusion.identified_fails", &[("fit", Number), ("unseen", Inner(&["conclusion.unseen"]))], identified),
    rule("conclusion.ambient", &[("modes", Words)], ambient_modes),
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
        let own = remedies.chain(["the notes of the run say more, and its folder"]);
        let is_own =
            own.into_iter().any(|remedy| crate::truth::plain(remedy).trim_end_matches('.') == said.text("remedy"));
        holds(is_own, || "no warning has this remedy".to_owned())
    }),
];

/// The modes of an ambient record are those of its diagram.
fn ambient_modes(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let mut records = spot.made.records.iter();
    let diagram = records.find(|(topic, _)| topic == "/stabilisation/ambient").map(|(_, record)| record);
    let clusters = diagram.and_then(|diagram| diagram["clusters"].as_array()).ok_or("there is no diagram")?;
    let of = |cluster: &Value| cluster["natural_frequency_rad_per_s"].as_f64();
    let mut known: Vec<f64> = clusters.iter().filter_map(of).map(|w| w / std::f64::consts::TAU).collect();
    known.sort_by(f64::total_cmp);
    let text = said.text("modes");
    let shown = numbers(text);
    // Two digits after the point.
    let is_near = |(shown, known): (&Shown, &f64)| (shown.value - known).abs() < 0.0051;
    holds(shown.len() == known.len() && shown.iter().zip(&known).all(is_near), || {
        format!("the diagram has {known:?} Hz")
    })
}

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

/// What went into deformation is what the speed before and that after leave, by the table that was made and the speed
/// that was stated.
fn energy_of_a_recorder(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    recorder(said, spot)?;
    let known = (spot.made.known.speed_m_per_s, spot.made.number("/metrics/maximum_delta_v/value"));
    let (Some(v0), Some(change)) = known else { return Ok(()) };
    let ees = (v0 * v0 - (v0 + change) * (v0 + change)).sqrt();
    let shows_as = |place: &str, value: f64| said.number(place).is_none_or(|shown| shown.is_of(value));
    let is_true = shows_as("ees", ees) && shows_as("share", ees * ees / (v0 * v0));
    holds(is_true, || format!("the speed is {ees:.3} m/s, its share {:.3}", ees * ees / (v0 * v0)))
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
    let decides = |model: &Value| model["unseen_fit_percent"].as_f64().or(model["fit_percent"].as_f64());
    let best = models.iter().filter_map(decides).fold(f64::NEG_INFINITY, f64::max);
    let own = model.and_then(decides).unwrap_or_default();
    let recommends = |record: &Value| record["recommended"].as_str() == Some(said.text("model"));
    let is_of_selection = |(topic, record): &(String, Value)| topic.starts_with("/selection/") && recommends(record);
    let is_chosen = own >= best || spot.made.records.iter().any(is_of_selection);
    holds(is_chosen && own <= 100.0 + 1e-9, || format!("the highest fit is {best} %"))
}

/// The slowest oscillation among the poles of the models.
fn slowest_mode(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let poles = spot.made.list("/models").iter().flat_map(|model| model["poles"].as_array().into_iter().flatten());
    let of_pole = |pole: &Value| {
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
