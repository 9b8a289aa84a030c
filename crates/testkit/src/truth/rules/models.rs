//! Which model to use, how well its numbers are known, how it follows the test.

use crumple_artifact::records::{ExponentialSumV1, ExponentialTermV1};
use serde_json::Value;

use crate::truth::known::{Subject, fit_percent};
use crate::truth::rules::rule::{
    Rule, Spot, holds, misses_its_own_test, misses_time_or_rebound, numbers_of_records, places_alone, rule, says, shows,
};
use crate::truth::template::Place::{At, Number, Rest, Said as Inner, Words};
use crate::truth::template::Said;

/// How far the fit of the model as measured may be from that of its motion, points: the filter moves both.
const AS_MEASURED: f64 = 2.0;

/// The sentences.
pub const RULES: &[Rule] = &[
    says(
        "note.left-out",
        "{id} is left out: its {field} is {value}, which is no number of a vehicle",
        &[],
        |said, _| {
            let value = said.text("value");
            let is_no_number = value.parse::<f64>().is_ok_and(|value| !value.is_finite() || value.abs() >= 1e15);
            holds(is_no_number, || format!("{value} can be written"))
        },
    ),
    says("note.start-of-sum", "{id}: at its start the sum is {value}, its slope {slope}", &[], start_of_sum),
    rule(
        "conclusion.use_model",
        &[
            ("model", Inner(&["conclusion.force_deflection_curve", "conclusion.named_model"])),
            ("predicts", Inner(&["conclusion.predicts", "conclusion.predicts_beyond"])),
        ],
        use_model,
    ),
    rule("conclusion.force_deflection_curve", &[], |_, spot| {
        let model = spot.made.recommended().map_or("", |best| best["model"].as_str().unwrap_or_default());
        holds(model.starts_with("force-deflection"), || format!("the recommended model is {model}"))
    }),
    rule("conclusion.named_model", &[("model", Words)], |said, spot| {
        let best = spot.made.recommended().and_then(|best| best["id"].as_str()).unwrap_or_default();
        let name = crate::truth::run::in_words(best);
        // A partner that is described before it may hold the word "the".
        holds(name.split(',').next().is_some_and(|name| said.text("model").ends_with(name)), || {
            format!("the recommended model is {name}")
        })
    }),
    rule("conclusion.one_spring", &[("stiffness", Words)], one_spring),
    rule("conclusion.determined", &[("determined", Number), ("parameters", Number)], |said, spot| {
        counts(said, candidate(spot).ok_or("there is no such candidate")?)
    }),
    rule("conclusion.order_of_magnitude", &[("count", Number)], |said, spot| {
        let best = candidate(spot).ok_or("there is no such candidate")?;
        shows(said, "count", Some(known_as(best, Certainty::OrderOfMagnitude) as f64), "the count of such numbers")
    }),
    rule("conclusion.open", &[("count", Number)], |said, spot| {
        let best = candidate(spot).ok_or("there is no such candidate")?;
        shows(said, "count", Some(known_as(best, Certainty::Open) as f64), "the count of open numbers")
    }),
    rule("conclusion.none_recommended", &[("because", Words)], |said, spot| {
        holds(spot.made.recommended().is_none(), || "a model is recommended".to_owned())?;
        holds(!said.text("because").is_empty(), || "no reason is given".to_owned())
    }),
    rule("conclusion.no_crush", &[], |_, spot| {
        holds(spot.made.number("/events/dynamic_crush_m").is_none_or(|crush| crush <= 0.0), || "it stopped".to_owned())
    }),
    rule("conclusion.other_axis", &[("axis", Words)], |_, spot| {
        holds(!spot.made.is_of_a_vehicle(), || "the pulse is along x".to_owned())
    }),
    rule("conclusion.closest", &[("model", Words), ("fit", Number), ("time", Number)], |said, spot| {
        let own = spot.made.candidate_named(said.text("model")).ok_or("there is no such candidate")?;
        fit_is_right(said, spot, own)
    }),
    rule("conclusion.open_numbers", &[("names", Words)], |said, spot| named(said, spot, Certainty::Open)),
    rule("conclusion.warn_open", &[("model", Words), ("names", Words)], |said, spot| {
        named(said, spot, Certainty::Open)
    }),
    rule("conclusion.warn_hardly", &[("model", Words), ("names", Words)], |said, spot| {
        named(said, spot, Certainty::OrderOfMagnitude)
    }),
    rule("conclusion.dual", &[], one_sensor_and_several_masses),
    rule("conclusion.warn_dual", &[("model", Words)], one_sensor_and_several_masses),
    rule("conclusion.warn_two_vehicles", &[], |_, spot| is_collision(spot)),
    rule("conclusion.warn_clipped", &[("channels", Words)], |_, spot| {
        holds(!spot.made.known.is_sound, || "nothing in it is clipped".to_owned())
    }),
    rule("conclusion.force_at", &[("deflection", Number)], numbers_of_records),
    rule("conclusion.forces_at", &[("deflection", Words)], numbers_of_records),
    rule(
        "model.off_the_test",
        &[("crush", Number), ("time", Number), ("restitution", Inner(&["model.and_restitution"])), ("fit", Number)],
        off_the_test,
    ),
    rule("model.and_restitution", &[("restitution", Number)], |said, spot| {
        let own = candidate(spot).and_then(|own| own["simulation"]["coefficient_of_restitution"].as_f64());
        let test = spot.made.number("/events/coefficient_of_restitution");
        shows(said, "restitution", own.zip(test).map(|(own, test)| own - test), "the error of the restitution")
    }),
    rule("model.follows", &[("fit", Number)], |said, spot| {
        fit_is_right(said, spot, candidate(spot).ok_or("there is no such candidate")?)
    }),
    rule("model.one_spring", &[("stiffness", Words)], one_spring),
    rule("model.for_exact_mass", &[], |_, spot| {
        let known = candidate(spot).map_or(&Value::Null, |candidate| &candidate["uncertainty"]);
        holds(known["interval_low"].is_object(), || "the candidate has no intervals".to_owned())
    }),
    rule("model.held_by_intervals", &[], |_, spot| {
        let own = candidate(spot).ok_or("there is no such candidate")?;
        let ends = ["interval_low", "interval_high"].map(|end| &own["uncertainty"][end]);
        let values = own["parameters"].as_object().into_iter().flatten();
        let is_end = |(name, value): (&String, &Value)| ends.iter().any(|ends| ends[name.as_str()] == *value);
        holds(values.into_iter().any(is_end), || "no value is an end of its interval".to_owned())
    }),
    rule("model.rating", &[("value", Number), ("grade", Rest)], rating),
    rule("model.same_record", &[("model", Words)], |said, spot| {
        let dual = spot.made.candidate_named(said.text("model")).ok_or("there is no such candidate")?;
        let own = candidate(spot).ok_or("there is no such candidate")?;
        let are_equal = own["equivalent_to"] == dual["id"] || dual["equivalent_to"] == own["id"];
        let fitted = own["fit"]["sensors"].as_array().map_or(0, Vec::len);
        holds(are_equal && fitted == 0, || "the records of its sensors differ".to_owned())
    }),
    rule(
        "model.sensor_fitted",
        &[("sensor", Words), ("mass", Number), ("quantity", Words), ("error", Number)],
        |said, spot| {
            holds(spot.made.known.sensors > 1, || "there is one sensor".to_owned())?;
            numbers_of_records(said, spot)
        },
    ),
    rule(
        "model.sensor_not_seen",
        &[("sensor", Words), ("mass", Number), ("error", Number), ("fit", Inner(&["model.fit"]))],
        |said, spot| {
            holds(spot.made.known.sensors > 1, || "there is one sensor".to_owned())?;
            numbers_of_records(said, spot)
        },
    ),
    rule("model.fit", &[("fit", Number)], numbers_of_records),
    rule("model.no_sensor_on_front", &[], no_second_sensor),
    rule("model.no_sensor_in_front", &[], no_second_sensor),
    rule("model.no_structure", &[], places_alone),
    rule("model.recommended_and_closest", &[], |_, spot| {
        let (best, closest) = (&spot.made.summary["recommended"], &spot.made.summary["closest"]);
        holds(best == closest, || format!("{best} is recommended, and {closest} is closest"))
    }),
    rule("model.recommended", &[], |_, spot| {
        holds(spot.made.recommended().is_some(), || "none is recommended".to_owned())
    }),
    rule("model.in_doubt", &[], |_, spot| {
        holds(spot.made.text("/verdict/status") == "do-not-use", || "nothing is in doubt".to_owned())
    }),
    rule("model.decided_by", &[("sensors", Words)], |said, spot| {
        let count = said.text("sensors").split(", ").count();
        holds(count > 1 && count <= spot.made.known.sensors, || format!("there are {}", spot.made.known.sensors))
    }),
    rule("model.closest", &[], |_, spot| {
        holds(spot.made.summary["closest"] != spot.made.summary["recommended"], || "it is the recommended".to_owned())
    }),
    rule("model.closest_alone", &[], |_, spot| {
        holds(spot.made.recommended().is_none(), || "a model is recommended".to_owned())
    }),
    rule("remarks.no_choice", &[], |_, spot| {
        holds(spot.made.choice.is_none(), || "there is a recommendation".to_owned())
    }),
    rule("remarks.no_raw", &[], |_, spot| {
        let channels = spot.made.records.iter().find(|(topic, _)| topic == "/test");
        let channels = channels.and_then(|(_, test)| test["channels"].as_array().cloned()).unwrap_or_default();
        holds(!channels.iter().any(|channel| channel["quantity"] == "acceleration"), || "one was read".to_owned())
    }),
    rule("remarks.no_filtered", &[], |_, spot| {
        let filtered = spot.made.records.iter().any(|(topic, _)| topic.starts_with("/filter"));
        holds(!filtered, || "it was filtered".to_owned())
    }),
    rule("remarks.no_displacement", &[], |_, spot| is_missing(spot, "/displacement")),
    rule("remarks.no_crash", &[], |_, spot| {
        holds(spot.made.number("/events/dynamic_crush_m").is_none(), || "there is a crash".to_owned())
    }),
    rule("remarks.no_motion", &[], |_, spot| {
        holds(spot.made.summary["events"].is_null(), || "there are events".to_owned())
    }),
    rule("remarks.no_motion_without_speed", &[], |_, spot| {
        holds(spot.made.number("/test/impact_speed_m_per_s").is_none(), || "there is a speed".to_owned())
    }),
    rule("remarks.no_events", &[], |_, spot| {
        holds(spot.made.summary["events"].is_null(), || "there are events".to_owned())
    }),
    rule("remarks.no_models", &[], |_, spot| {
        holds(spot.made.list("/models").is_empty(), || "there are identified models".to_owned())
    }),
    rule("remarks.no_parameters", &[], |_, spot| {
        holds(spot.made.list("/candidates").is_empty(), || "there are candidates".to_owned())
    }),
    rule(
        "remarks.none_found",
        &[("what", Inner(&["remarks.parameters", "remarks.models"])), ("reason", Rest)],
        |said, spot| {
            holds(said.inner("what").is_some(), || "nothing is named".to_owned())?;
            let reasons = spot.made.list("/concerns").iter().filter_map(|concern| concern["text"].as_str());
            let is_said = reasons.into_iter().any(|reason| crate::truth::plain(reason) == said.text("reason"));
            holds(is_said, || "no stage says so".to_owned())
        },
    ),
    rule("remarks.parameters", &[], |_, spot| {
        holds(spot.made.list("/candidates").is_empty(), || "there are candidates".to_owned())
    }),
    rule("remarks.models", &[], |_, spot| {
        holds(spot.made.list("/models").is_empty(), || "there are identified models".to_owned())
    }),
    rule("remarks.no_responses", &[], |_, spot| {
        let simulated = spot.made.list("/candidates").iter().any(|candidate| !candidate["simulation"].is_null());
        holds(!simulated, || "candidates were simulated".to_owned())
    }),
    rule("numbers.velocity_never_zero", &[], |_, spot| {
        holds(spot.made.number("/events/dynamic_crush_m").is_none(), || "it stopped".to_owned())
    }),
    rule("numbers.does_not_reach_zero", &[], |_, spot| {
        holds(spot.made.number("/events/dynamic_crush_m").is_none(), || "it stopped".to_owned())
    }),
    rule("numbers.at", &[("time", Number)], numbers_of_records),
    rule("numbers.rebound", &[("speed", At("/events/rebound_velocity_m_per_s"))], places_alone),
    rule("numbers.sensors", &[("count", Number), ("interval", Words)], |said, spot| {
        holds(spot.made.known.sensors == 1, || "its sensors sit on different masses".to_owned())?;
        numbers_of_records(said, spot)
    }),
];

/// The candidate that a text is about: by its id, else the recommended one.
fn candidate<'a>(spot: &Spot<'a>) -> Option<&'a Value> {
    spot.made.candidate(spot.key).or_else(|| spot.made.recommended())
}

/// How little is known of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Certainty {
    /// Beyond a factor of ten.
    OrderOfMagnitude,
    /// Anything.
    Open,
}

/// How many of the numbers that were asked of the record are known so, as its intervals say.
fn known_as(candidate: &Value, certainty: Certainty) -> usize {
    names_known_as(candidate, certainty).len()
}

/// The names of those. An interval within a factor of ten determines; one without an end, or beyond a factor of a
/// thousand, tells nothing.
fn names_known_as(candidate: &Value, certainty: Certainty) -> Vec<String> {
    let list = match certainty {
        Certainty::Open => &candidate["certainties"]["open"],
        _ => &candidate["certainties"]["order_of_magnitude"],
    };
    list.as_array().into_iter().flatten().filter_map(|name| name.as_str().map(str::to_owned)).collect()
}

/// The counts that are said, and what the intervals of the candidate come to.
pub fn counts(said: &Said, candidate: &Value) -> Result<(), String> {
    let count = |name: &str| candidate["certainties"][name].as_f64();
    shows(said, "determined", count("determined"), "the count of determined numbers")?;
    shows(said, "parameters", count("parameters"), "the count of numbers")?;
    let (low, high) = (&candidate["uncertainty"]["interval_low"], &candidate["uncertainty"]["interval_high"]);
    let Some(asked) = low.as_object().filter(|asked| Some(asked.len() as f64) == count("parameters")) else {
        return Ok(());
    };
    let mass_and_window = candidate["fit"]["to_s"].as_f64().map(|to_s| (total_mass_kg(candidate), to_s));
    // The force that by itself stops the vehicle within the window of the fit, with a tenth of it for a zero.
    let is_small = |name: &str, high: f64| {
        let per_time = [("_n_s_per_m", 1), ("_n_per_m", 2)].into_iter().find(|(unit, _)| name.ends_with(unit));
        let size = per_time.zip(mass_and_window).map(|((_, power), (mass_kg, to_s))| mass_kg / to_s.powi(power));
        size.is_none_or(|size| high <= 0.1001 * size)
    };
    let within_ten = asked.iter().filter(|(name, low)| {
        let ends = low.as_f64().zip(high[name.as_str()].as_f64());
        let is_zero = candidate["parameters"][name.as_str()] == 0.0;
        ends.is_some_and(|(low, high)| {
            low > 0.0 && high <= 10.0 * low || low <= 0.0 && high >= 0.0 && (!is_zero || is_small(name, high))
        })
    });
    // An interval that reaches zero may count either way: of a damper that is hardly there, it is known to be small.
    let most = within_ten.count() as f64;
    let determined = count("determined").unwrap_or_default();
    holds(determined <= most, || format!("the intervals of {most} numbers lie within a factor of ten"))
}

fn total_mass_kg(candidate: &Value) -> f64 {
    let parameters = candidate["parameters"].as_object().into_iter().flatten();
    parameters.filter(|(name, _)| name.ends_with("_kg")).filter_map(|(_, value)| value.as_f64()).sum()
}

/// The names that are said are those of the numbers that are known so, as many as there are.
fn named(said: &Said, spot: &Spot<'_>, certainty: Certainty) -> Result<(), String> {
    let own = match said.text("model") {
        "" => candidate(spot),
        words => spot.made.candidate_named(words),
    };
    let names = names_known_as(own.ok_or("there is no such candidate")?, certainty);
    holds(!names.is_empty(), || format!("no number is known so, and {} is said", said.text("names")))?;
    let text = said.text("names").replace("the forces at ", "").replace("the force at ", "").replace(" and ", ", ");
    let shown = text.split(", ").count();
    holds(shown <= names.len(), || format!("{names:?} are, and {:?} is said", said.text("names")))
}

fn use_model(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let made = spot.made;
    let best = made.recommended().ok_or("no model is recommended")?;
    holds(said.inner("model").is_some() || made.candidate_named(said.text("model")).is_some(), || {
        format!("{} is no candidate", said.text("model"))
    })?;
    let miss = misses_its_own_test(made, best).filter(|_| made.is_of_a_vehicle() && made.known.is_sound);
    holds(miss.is_none(), || {
        format!("{} does not repeat its own test: {}", best["id"], miss.clone().unwrap_or_default())
    })?;
    adequate_fit(made, best)
}

/// A recommended model follows nine tenths of the displacement, by its own waves.
fn adequate_fit(made: &crate::truth::run::Made, best: &Value) -> Result<(), String> {
    let fit = best["simulation"]["fit_as_measured_percent"].as_f64();
    let fit = fit.or(best["simulation"]["fit_percent"].as_f64());
    holds(fit.is_none_or(|fit| fit >= 90.0), || format!("its fit is {:.1} %", fit.unwrap_or_default()))?;
    let Some(own) = fit_percent(made, best["id"].as_str().unwrap_or_default()) else { return Ok(()) };
    holds(own >= 90.0, || format!("its waves fit {own:.1} %"))
}

fn one_spring(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    shows(said, "stiffness", spot.made.number("/metrics/average_stiffness/value"), "the stiffness")?;
    // The spring with the energy and the crush of the test: k = m v0² / C².
    let of = |pointer: &str| spot.made.number(pointer);
    let inputs = of("/test/mass_kg").zip(of("/test/impact_speed_m_per_s")).zip(of("/events/dynamic_crush_m"));
    let Some(((mass, speed), crush)) = inputs else { return Ok(()) };
    let (stiffness, own) = (mass * (speed / crush).powi(2), of("/metrics/average_stiffness/value").unwrap_or_default());
    holds((own / stiffness - 1.0).abs() < 0.02, || format!("m v² / C² is {stiffness:.0} N/m, and {own:.0} is said"))
}

/// A fit that is said is that of the summary, and that of the waves.
fn fit_is_right(said: &Said, spot: &Spot<'_>, own: &Value) -> Result<(), String> {
    let rated = spot.made.rated(own).and_then(|rated| rated.fit_as_measured_percent);
    let measured = own["simulation"]["fit_as_measured_percent"].as_f64().or(rated);
    shows(said, "fit", measured.or(own["simulation"]["fit_percent"].as_f64()), "the fit")?;
    let shown = said.number("fit").map_or(f64::NAN, |shown| shown.value);
    let Some(waves) = fit_percent(spot.made, own["id"].as_str().unwrap_or_default()) else { return Ok(()) };
    let allowed = AS_MEASURED.max(0.2 * (100.0 - waves));
    holds((shown - waves).abs() <= allowed, || format!("the waves fit {waves:.1} %, and {shown} % is said"))
}

fn off_the_test(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = candidate(spot).ok_or("there is no such candidate")?;
    for (place, name) in [("crush", "dynamic_crush"), ("time", "time_of_dynamic_crush")] {
        let unit = if place == "crush" { "m" } else { "s" };
        let [model, test] =
            [own["simulation"][format!("{name}_{unit}")].as_f64(), spot.made.number(&format!("/events/{name}_{unit}"))];
        let error = model.zip(test).map(|(model, test)| model - test);
        if said.number(place).is_some() {
            shows(said, place, error, &format!("the error of the {place}"))?;
        }
    }
    fit_is_right(said, spot, own)
}

/// The grade of ISO/TS 18571: excellent above 0.94, good above 0.80, fair above 0.58, else poor.
fn rating(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = candidate(spot).ok_or("there is no such candidate")?;
    let score = own["simulation"]["iso18571_score"].as_f64();
    let ratings = own["simulation"]["ratings"].as_array().into_iter().flatten();
    let of_acceleration = ratings.filter_map(|rating| rating["value"].as_f64());
    let shown = said.number("value").ok_or("no rating")?;
    let own = score.into_iter().chain(of_acceleration).find(|value| shown.is_of(*value));
    let own = own.ok_or_else(|| format!("{} is none of its ratings", said.text("value")))?;
    let grade = [(0.94, "excellent"), (0.80, "good"), (0.58, "fair")].into_iter().find(|(limit, _)| own > *limit);
    let grade = grade.map_or("poor", |(_, grade)| grade);
    holds(said.text("grade").is_empty() || said.text("grade").contains(grade), || format!("{own} is {grade}"))
}

/// Several masses, and no sensor but that of the compartment was fitted.
pub fn one_sensor_and_several_masses(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = candidate(spot).ok_or("no model is recommended")?;
    let model = own["model"].as_str().unwrap_or_default();
    holds(!own["equivalent_to"].is_null(), || format!("{model} has no dual among the candidates"))?;
    let fitted = own["fit"]["sensors"].as_array().map_or(0, Vec::len);
    holds(spot.made.known.sensors == 1 || fitted == 0, || "a sensor on the front was fitted too".to_owned())
}

fn no_second_sensor(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = candidate(spot).ok_or("there is no such candidate")?;
    let fitted = own["fit"]["sensors"].as_array().map_or(0, Vec::len);
    holds(fitted == 0, || "a sensor on the front was fitted".to_owned())
}

fn is_collision(spot: &Spot<'_>) -> Result<(), String> {
    holds(spot.made.known.subject == Subject::TwoVehicles, || "there is one vehicle".to_owned())
}

fn is_missing(spot: &Spot<'_>, wave: &str) -> Result<(), String> {
    holds(!spot.made.waves.keys().any(|id| id.contains(wave)), || format!("there is a wave {wave}"))
}

/// The sentences.
pub const CHOICE_RULES: &[Rule] = &[
    says(
        "because.recommended",
        "{class}, {determined} of {parameters} parameters determined{more}",
        &[("determined", Number), ("parameters", Number), ("more", Rest)],
        recommended,
    ),
    says(
        "because.simplest",
        "{count} numbers, all determined, displacement fit as measured {fit}{missed}",
        &[("count", Number), ("fit", Number), ("missed", Rest)],
        simplest,
    ),
    says(
        "because.simplest-open",
        "{determined} of {parameters} parameters determined{magnitude}, displacement fit as measured {fit}{missed}",
        &[("determined", Number), ("parameters", Number), ("magnitude", Rest), ("fit", Number), ("missed", Rest)],
        simplest,
    ),
    says(
        "because.closest",
        "best displacement fit of the physical candidates, {fit} as measured{open}",
        &[("fit", Number), ("open", Rest)],
        closest,
    ),
    says(
        "because.simplest-none",
        "each of the {count} adequate candidates has a number that the record does not determine",
        &[("count", Number)],
        each_has_an_open_number,
    ),
    says(
        "because.simplest-one",
        "one number, determined, displacement fit as measured {fit}{missed}",
        &[("fit", Number), ("missed", Rest)],
        simplest,
    ),
    says(
        "because.simplest-unassessed",
        "{count} numbers, not known how well, displacement fit as measured {fit}{missed}",
        &[("count", Number), ("fit", Number), ("missed", Rest)],
        unassessed,
    ),
    says("because.recommended-unassessed", "{class}, {count} numbers, not known how well{more}", &[], unassessed),
    says("because.none", "no candidate is adequate ({reasons})", &[], none_adequate),
    says("because.none-qualifies", "no adequate candidate qualifies ({reasons})", &[], |_, spot| {
        holds(spot.made.recommended().is_none(), || "a model is recommended".to_owned())
    }),
    says(
        "because.no-stop",
        "the dynamic crush is not in the record: the velocity never reaches zero",
        &[],
        |_, spot| {
            let crush = spot.made.number("/events/dynamic_crush_m").filter(|crush| *crush > 0.0);
            holds(crush.is_none(), || format!("the crush is {} m", crush.unwrap_or_default()))
        },
    ),
    says(
        "because.other-axis",
        "channel {channel} is along {axis}, and the models are of a crush along x",
        &[("channel", Words), ("axis", Words)],
        |_, spot| holds(spot.made.known.subject == Subject::OtherAxis, || "the pulse is along x".to_owned()),
    ),
    says("because.no-waves", "no acceleration and displacement of the pulse up to dynamic crush", &[], none_adequate),
    says("because.no-closest", "no physical candidate has a displacement to compare", &[], |_, spot| {
        let physical = spot
            .made
            .list("/candidates")
            .iter()
            .find(|c| c["physical"] == true && c["simulation"]["fit_percent"].is_number());
        holds(physical.is_none(), || format!("{} has", physical.map_or("", |c| c["id"].as_str().unwrap_or_default())))
    }),
];

/// A candidate that is called adequate repeats its own test.
fn adequate(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    let miss = misses_its_own_test(spot.made, own).filter(|_| spot.made.known.is_sound);
    holds(miss.is_none(), || miss.clone().unwrap_or_default())?;
    numbers_of_records(said, spot)
}

/// Counts of the candidate; one that is called damped has a damper, one that is called plastic none.
fn recommended(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    counts(said, own)?;
    let has_damper = own["parameters"].as_object().is_some_and(|all| all.keys().any(|name| name.contains("n_s_per_m")));
    holds((said.text("class") == "damped") == has_damper || said.text("class") == "elastic", || {
        format!("it is called {}", said.text("class"))
    })?;
    adequate(said, spot)
}

fn simplest(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    if said.places.contains_key("determined") {
        counts(said, own)?;
    } else if said.places.contains_key("count") {
        shows(said, "count", own["certainties"]["determined"].as_f64(), "the count of determined numbers")?;
    } else {
        holds(own["certainties"]["determined"] == 1, || format!("{} are", own["certainties"]["determined"]))?;
    }
    fit_is_right(said, spot, own)?;
    adequate(said, spot)
}

/// Of a candidate that is adequate, nobody says how well its numbers are known.
fn unassessed(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    holds(own["certainties"]["parameters"] == 0, || format!("{} are known", own["certainties"]["parameters"]))?;
    adequate(said, spot)
}

/// As many adequate candidates as are said, each with an open number.
fn each_has_an_open_number(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let rated = spot.made.choice.iter().flat_map(|choice| &choice.candidates).filter(|rated| rated.adequate);
    let open =
        |id: &str| spot.made.candidate(id).map_or(0, |own| own["certainties"]["open"].as_array().map_or(0, Vec::len));
    let open: Vec<usize> = rated.map(|rated| open(&rated.id)).collect();
    shows(said, "count", Some(open.len() as f64), "the count of adequate candidates")?;
    holds(open.iter().all(|count| *count > 0), || format!("{open:?} are open"))
}

/// No physical candidate has a higher fit.
fn closest(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(spot.key).ok_or("there is no such candidate")?;
    fit_is_right(said, spot, own)?;
    let fit = |candidate: &Value| {
        let simulation = &candidate["simulation"];
        simulation["fit_as_measured_percent"].as_f64().or(simulation["fit_percent"].as_f64())
    };
    let physical = spot.made.list("/candidates").iter().filter(|candidate| candidate["physical"] == true);
    let best = physical.filter_map(fit).fold(f64::NEG_INFINITY, f64::max);
    let shown = said.number("fit").map_or(f64::NAN, |shown| shown.value);
    holds(shown >= best - 0.01, || format!("another has a fit of {best:.2} %"))
}

/// Nothing that a reader could use is called inadequate: no physical candidate with all of its own test right.
/// No model is recommended, or one for its crush alone, which misses its own test.
fn none_adequate(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let best = spot.made.recommended();
    holds(best.is_none_or(|best| misses_time_or_rebound(spot.made, best).is_some()), || {
        "an adequate model is recommended".to_owned()
    })
}

/// Value and slope at the start follow from the terms of the model, to the seven digits shown.
fn start_of_sum(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let topic = format!("/model/{}", said.text("id"));
    let (_, model) = spot.made.records.iter().find(|(own, _)| *own == topic).ok_or("there is no such sum")?;
    let sum: ExponentialSumV1 = serde_json::from_value(model.clone()).map_err(|error| error.to_string())?;
    let value: f64 = sum.terms.iter().map(|term| term.re_amplitude).sum();
    let slope = |term: &ExponentialTermV1| term.re_amplitude * term.re_per_s - term.im_amplitude * term.im_rad_per_s;
    let slope: f64 = sum.terms.iter().map(slope).sum();
    let shows = |place: &str, known: f64| {
        let shown: f64 = said.text(place).parse().unwrap_or(f64::NAN);
        holds((shown - known).abs() <= 1e-6 * known.abs(), || format!("{place} is {known:e}, and {shown:e} is said"))
    };
    shows("value", value).and_then(|()| shows("slope", slope))
}
