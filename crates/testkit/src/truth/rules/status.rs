//! The status word and its one reason, the question that was asked, and what the model answers.

use crate::truth::known::Subject;
use crate::truth::rules::rule::{
    Rule, Spot, Surface, holds, misses_its_own_test, misses_time_or_rebound, numbers_of_records, places_alone, rule,
    says, shows,
};
use crate::truth::run::Made;
use crate::truth::template::Place::{At, Number, Said as Inner, Words};
use crate::truth::template::Said;

/// Half width of a prediction up to which a model is usable, and how far the truth may be then, percent.
const USABLE_PERCENT: f64 = 10.0;
/// Half width beyond which a prediction answers nothing, percent; less the rounding of what is shown.
const WIDE_PERCENT: f64 = 29.0;

/// The words.
pub const WORDS: &[&str] = &["conclusion.usable_with_care", "conclusion.usable", "conclusion.do_not_use"];

/// The reasons.
pub const BECAUSE: &[&str] = &[
    "conclusion.because_good_to",
    "conclusion.because_beyond",
    "conclusion.because_check",
    "conclusion.because_sensors",
    "conclusion.because_few_forces",
    "conclusion.because_few_parameters",
    "conclusion.because_unassessed",
    "conclusion.because_dual",
    "conclusion.because_weak",
    "conclusion.because_contrary",
    "conclusion.because_misses_its_test",
    "conclusion.because_no_interval",
    "conclusion.because_no_stop",
    "conclusion.because_other_axis",
    "conclusion.because_two_vehicles",
    "conclusion.because_occupant",
    "conclusion.because_recorder",
    "conclusion.because_identified",
    "conclusion.because_no_mass",
    "conclusion.because_no_speed",
    "conclusion.because_no_mass_nor_speed",
    "conclusion.because_measured_only",
    "conclusion.because_none_recommended",
    "conclusion.because_no_result",
    "conclusion.because_decisive",
    "conclusion.because_not_adequate",
    "conclusion.because_poor_fit",
];

/// A reason that stands by itself: its own template with a full stop.
pub const REASON_AS_SENTENCE: &str = "reason.sentence";

/// What a warning puts in doubt.
const SUBJECTS: &[&str] = &[
    "conclusion.the_pulse",
    "conclusion.the_mass",
    "conclusion.the_impact_speed",
    "conclusion.the_time_axis",
    "conclusion.the_motion",
    "conclusion.the_model",
    "conclusion.the_record",
    "conclusion.the_identified_models",
];

const SCENARIO: &[&str] = &["conclusion.scenario"];

/// The sentences.
pub const RULES: &[Rule] = &[
    rule("conclusion.status", &[("status", Inner(WORDS)), ("reason", Inner(BECAUSE))], |said, _| {
        holds(said.inner("status").is_some() && said.inner("reason").is_some(), || "no status".to_owned())
    }),
    rule("conclusion.usable", &[], usable),
    rule("conclusion.usable_with_care", &[], |_, spot| has_status(spot, "usable-with-care")),
    rule("conclusion.do_not_use", &[], do_not_use),
    rule("conclusion.because_good_to", &[("good_to", Number), ("scenario", Inner(SCENARIO))], |said, spot| {
        good_to(said, spot, false)
    }),
    rule("conclusion.because_beyond", &[("good_to", Number), ("scenario", Inner(SCENARIO))], |said, spot| {
        good_to(said, spot, true)
    }),
    rule(
        "conclusion.because_sensors",
        &[("low", Number), ("high", Number), ("half_width", Number), ("count", Number)],
        sensors_of_one_place,
    ),
    rule(
        "conclusion.because_few_forces",
        &[("determined", Number), ("parameters", Number), ("are", Words)],
        few_determined,
    ),
    rule(
        "conclusion.because_few_parameters",
        &[("determined", Number), ("parameters", Number), ("are", Words)],
        few_determined,
    ),
    rule("conclusion.because_unassessed", &[], |_, spot| {
        let has = spot.made.recommended().is_some_and(|best| !best["uncertainty"].is_null());
        holds(!has, || "the recommended model has intervals".to_owned())
    }),
    rule("conclusion.sensors_differ", &[("low", Number), ("high", Number), ("count", Number)], sensors_of_one_place),
    rule("conclusion.because_check", &[("subject", Words), ("number", Number)], |_, spot| {
        holds(spot.made.text("/verdict/record") == "check", || "nothing of the record is to be checked".to_owned())
    }),
    rule("conclusion.because_dual", &[], crate::truth::rules::models::one_sensor_and_several_masses),
    rule("conclusion.because_misses_its_test", &[("events", Words)], misses_its_test),
    rule("conclusion.because_weak", &[("model", Words)], names_a_candidate),
    rule("conclusion.because_contrary", &[("model", Words)], names_a_candidate),
    // A reason as a sentence of the verdict.
    says(REASON_AS_SENTENCE, "{reason}.", &[("reason", Inner(BECAUSE))], places_alone),
    rule("conclusion.because_no_interval", &[], |_, spot| {
        let has = answer(spot.made).is_some_and(|prediction| half_width_percent(prediction).is_some());
        holds(!has, || "its prediction has an interval".to_owned())
    }),
    rule("conclusion.because_no_stop", &[], |_, spot| {
        holds(spot.made.number("/events/dynamic_crush_m").is_none(), || "it stopped".to_owned())
    }),
    rule("conclusion.because_other_axis", &[("axis", Words)], |_, spot| {
        holds(!spot.made.is_of_a_vehicle(), || "the pulse is along x".to_owned())
    }),
    rule("conclusion.because_two_vehicles", &[], |_, spot| is_of(spot, Subject::TwoVehicles)),
    rule("conclusion.because_occupant", &[], |_, spot| {
        holds(!spot.made.is_of_a_vehicle(), || "the sensor is on the vehicle".to_owned())
    }),
    rule("conclusion.because_recorder", &[], |_, spot| is_of(spot, Subject::Recorder)),
    rule("conclusion.because_identified", &[], |_, spot| is_of(spot, Subject::InputOutput)),
    rule("conclusion.because_no_mass", &[], |_, spot| lacks(spot, true, false)),
    rule("conclusion.because_no_speed", &[], |_, spot| lacks(spot, false, true)),
    rule("conclusion.because_no_mass_nor_speed", &[], |_, spot| lacks(spot, true, true)),
    rule("conclusion.because_measured_only", &[], |_, spot| {
        holds(spot.made.list("/candidates").is_empty(), || "models were fitted".to_owned())
    }),
    rule("conclusion.because_none_recommended", &[], |_, spot| {
        holds(spot.made.recommended().is_none(), || "a model is recommended".to_owned())
    }),
    rule("conclusion.because_no_result", &[], |_, spot| {
        holds(spot.made.code == 4, || format!("the run ended with code {}", spot.made.code))
    }),
    rule("conclusion.because_decisive", &[("subject", Inner(SUBJECTS)), ("number", Number)], decisive),
    rule("conclusion.the_pulse", &[], |_, spot| is_doubted(spot, "pulse")),
    rule("conclusion.the_mass", &[], |_, spot| is_doubted(spot, "mass")),
    rule("conclusion.the_impact_speed", &[], |_, spot| is_doubted(spot, "impact-speed")),
    rule("conclusion.the_time_axis", &[], |_, spot| is_doubted(spot, "time")),
    rule("conclusion.the_motion", &[], |_, spot| is_doubted(spot, "motion")),
    rule("conclusion.the_model", &[], |_, spot| is_doubted(spot, "model:")),
    rule("conclusion.the_record", &[], |_, spot| is_doubted(spot, "")),
    rule("conclusion.the_identified_models", &[], |_, spot| is_doubted(spot, "identified-models")),
    rule("conclusion.because_not_adequate", &[], none_adequate),
    rule("conclusion.because_poor_fit", &[("fit", Number), ("limit", Number)], |said, spot| {
        let [fit, limit] = said.values(["fit", "limit"]);
        holds(fit < limit, || format!("{fit} % is not below {limit} %"))?;
        holds(spot.made.recommended().is_none(), || "a model is recommended beside it".to_owned())
    }),
    rule(
        "conclusion.scenario",
        &[
            ("speed", Number),
            ("mass", Inner(&["conclusion.with_mass"])),
            ("partner", Inner(&["conclusion.against_partner"])),
        ],
        scenario,
    ),
    rule("conclusion.with_mass", &[("mass", Number)], numbers_of_records),
    rule("conclusion.against_partner", &[("partner", Words)], |said, spot| {
        let asked = spot.made.question.and_then(|question| question.partner);
        holds(asked.is_some_and(|asked| said.text("partner").to_lowercase().contains(asked)), || {
            format!("{} was not asked for", said.text("partner"))
        })
    }),
    rule(
        "conclusion.predicts",
        &[
            ("scenario", Inner(SCENARIO)),
            ("crush", Number),
            ("speed", Number),
            ("interval", Inner(&["conclusion.interval"])),
        ],
        |said, spot| predicts(said, spot, Some(false)),
    ),
    rule(
        "conclusion.predicts_beyond",
        &[
            ("scenario", Inner(SCENARIO)),
            ("crush", Number),
            ("speed", Number),
            ("interval", Inner(&["conclusion.interval"])),
        ],
        |said, spot| predicts(said, spot, Some(true)),
    ),
    rule(
        "conclusion.asked_for",
        &[
            ("scenario", Inner(SCENARIO)),
            ("model", Inner(&["conclusion.force_deflection_curve", "conclusion.named_model"])),
            ("crush", Number),
            ("interval", Inner(&["conclusion.interval"])),
        ],
        |said, spot| {
            holds(spot.made.question.is_some(), || "nothing was asked for".to_owned())?;
            predicts(said, spot, None)
        },
    ),
    rule("conclusion.few_forces", &[("determined", Number), ("parameters", Number), ("are", Words)], few_determined),
    rule(
        "conclusion.few_parameters",
        &[("determined", Number), ("parameters", Number), ("are", Words)],
        few_determined,
    ),
    rule("conclusion.extrapolates", &[("crush", At("/events/dynamic_crush_m"))], beyond_is_predicted),
    rule("conclusion.warn_extrapolates", &[("crush", At("/events/dynamic_crush_m"))], beyond_is_predicted),
    rule("conclusion.no_fault", &[], |_, spot| {
        holds(spot.made.known.is_sound, || "the record has a fault".to_owned())?;
        holds(spot.made.text("/verdict/status") != "do-not-use", || "beside it stands not to use it".to_owned())
    }),
    rule("conclusion.one_more", &[], |_, spot| counts_warnings(spot, 1)),
    rule("conclusion.more", &[("count", Number)], |said, spot| {
        counts_warnings(spot, said.number("count").map_or(0, |shown| shown.value as usize))
    }),
    rule("conclusion.before_use", &[], |_, spot| {
        let is_there = spot.made.page.iter().any(|block| block.section == "before-use" && block.element != "h2");
        holds(is_there, || "nothing stands below it".to_owned())
    }),
];

fn is_of(spot: &Spot<'_>, subject: Subject) -> Result<(), String> {
    holds(spot.made.known.subject == subject, || format!("it is of {:?}", spot.made.known.subject))
}

fn has_status(spot: &Spot<'_>, status: &str) -> Result<(), String> {
    let own = spot.made.text("/verdict/status");
    holds(own == status, || format!("the summary says {own}"))
}

/// A usable model repeats its own test, is known to 10 %, all of its numbers are determined, and the truth is as near.
fn usable(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let made = spot.made;
    has_status(spot, "usable")?;
    let best = made.recommended().ok_or("no model is recommended")?;
    holds(made.known.is_sound, || "the record states something wrong".to_owned())?;
    if let Some(miss) = misses_its_own_test(made, best) {
        return Err(format!("the recommended model does not repeat its own test: {miss}"));
    }
    let certainties = &best["certainties"];
    let all_are_known = certainties["determined"] == certainties["parameters"];
    holds(all_are_known || has_the_forces(made, best), || {
        format!("{} of {} numbers are determined", certainties["determined"], certainties["parameters"])
    })?;
    let prediction = answer(made).ok_or("nothing is predicted")?;
    let half = half_width_percent(prediction).ok_or("its prediction has no interval")?;
    holds(half <= USABLE_PERCENT, || format!("its crush is known to {half:.1} %"))?;
    let speed = prediction["impact_speed_m_per_s"].as_f64().unwrap_or_default();
    let mass = prediction["mass_kg"].as_f64().unwrap_or_default();
    let (Some(truth), Some(crush)) = (made.known.impact(speed, mass), prediction["dynamic_crush_m"].as_f64()) else {
        return Ok(());
    };
    let off = 100.0 * (crush / truth.crush_m - 1.0);
    holds(!prediction["partner"].is_null() || off.abs() <= USABLE_PERCENT, || {
        format!("its crush at {:.1} km/h is off by {off:.1} %", 3.6 * speed)
    })
}

/// Whether a model misses the decelerations of the record by no more than 15 % of their mean, `v0²/2C`: then its forces
/// are known together, though none may be known beside the others.
fn has_the_forces(made: &Made, best: &serde_json::Value) -> bool {
    let misfit = made.rated(best).and_then(|rated| rated.misfit);
    let events = made.number("/events/impact_speed_m_per_s").zip(made.number("/events/dynamic_crush_m"));
    misfit.zip(events).is_some_and(|(misfit, (speed, crush))| misfit <= 0.15 * 0.5 * speed * speed / crush)
}

/// Of a sound record with a model that repeats its own test there is something to use.
fn do_not_use(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    has_status(spot, "do-not-use")?;
    let made = spot.made;
    let is_wide = answer(made).and_then(half_width_percent).is_some_and(|half| half > WIDE_PERCENT);
    let is_good = made.recommended().is_some_and(|best| misses_its_own_test(made, best).is_none());
    holds(!(crate::truth::rules::rule::is_like_a_car(made) && is_good) || is_wide, || {
        "the record is sound, and its recommended model repeats the test".to_owned()
    })
}

/// The prediction that answers what was asked: by the recommended model, at the speed, mass and partner asked for;
/// where nothing was asked, inside the test at the lowest speed.
pub fn answer(made: &Made) -> Option<&serde_json::Value> {
    let question = made.question.unwrap_or_default();
    let is_close = |value: &serde_json::Value, asked: Option<f64>| {
        asked.is_none_or(|asked| value.as_f64().is_some_and(|value| (value / asked - 1.0).abs() < 1e-6))
    };
    let mut fitting: Vec<&serde_json::Value> = made
        .list("/predictions")
        .iter()
        .filter(|p| p["candidate"] == made.summary["recommended"] && !p["dynamic_crush_m"].is_null())
        .filter(|p| is_close(&p["impact_speed_m_per_s"], question.speed_m_per_s))
        .filter(|p| is_close(&p["mass_kg"], question.mass_kg) && p["partner"].is_null() == question.partner.is_none())
        .collect();
    let speed = |p: &serde_json::Value| p["impact_speed_m_per_s"].as_f64().unwrap_or_default();
    fitting.sort_by(|a, b| {
        let beyond = |p: &serde_json::Value| p["extrapolates"].as_bool().unwrap_or_default();
        beyond(a).cmp(&beyond(b)).then(speed(a).total_cmp(&speed(b)))
    });
    fitting.first().copied()
}

/// Half of the interval of a predicted crush, percent of it.
fn half_width_percent(prediction: &serde_json::Value) -> Option<f64> {
    let interval = prediction["intervals"].as_array()?.iter().find(|interval| interval["name"] == "dynamic_crush_m")?;
    let crush = prediction["dynamic_crush_m"].as_f64()?;
    Some(50.0 * (interval["high"].as_f64()? - interval["low"].as_f64()?) / crush)
}

fn good_to(said: &Said, spot: &Spot<'_>, beyond: bool) -> Result<(), String> {
    let prediction = answer(spot.made).ok_or("nothing is predicted")?;
    holds(prediction["extrapolates"].as_bool() == Some(beyond), || "it is on the other side of the test".to_owned())?;
    let half = half_width_percent(prediction).ok_or("the prediction has no interval")?;
    let shown = said.number("good_to").ok_or("no number")?.value;
    // Rounded, unless that would be on the other side of a limit of the status, or exact.
    let side = |percent: f64| (percent > 0.0, percent > USABLE_PERCENT, percent > 30.0);
    let rounded = if side(half.round()) == side(half) { half.round() } else { half.ceil() };
    holds(shown == rounded, || format!("the half width is {half:.2} %"))
}

fn scenario(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let made = spot.made;
    let prediction = answer(made).ok_or("nothing is predicted")?;
    shows(said, "speed", prediction["impact_speed_m_per_s"].as_f64(), "the speed of the answer")?;
    let question = made.question.unwrap_or_default();
    let mass = said.inner("mass").and_then(|said| said.number("mass")).map(|shown| shown.value);
    let is_asked =
        question.mass_kg.map(f64::round) == mass || (mass.is_none() && question.mass_kg == made.known.mass_kg);
    holds(is_asked, || format!("{:?} kg was asked for, and {mass:?} is said", question.mass_kg))?;
    holds(said.inner("partner").is_some() == question.partner.is_some(), || {
        format!("asked against {:?}", question.partner)
    })
}

/// What is said to be predicted is the answer to what was asked.
fn predicts(said: &Said, spot: &Spot<'_>, beyond: Option<bool>) -> Result<(), String> {
    let prediction = answer(spot.made).ok_or("nothing like that is predicted")?;
    shows(said, "crush", prediction["dynamic_crush_m"].as_f64(), "the crush that was asked for")?;
    if said.places.contains_key("speed") {
        shows(said, "speed", prediction["impact_speed_m_per_s"].as_f64(), "the speed that was asked for")?;
    }
    let question = spot.made.question.unwrap_or_default();
    holds(question.mass_kg.is_none() || said.inner("scenario").is_some(), || "the mass is not named".to_owned())?;
    let own = prediction["extrapolates"].as_bool();
    holds(beyond.is_none() || own == beyond, || format!("it is beyond the test: {own:?}"))
}

fn beyond_is_predicted(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let predictions = || spot.made.list("/predictions").iter().filter(|p| p["recommended"] == true);
    holds(predictions().any(|p| p["extrapolates"] == true), || "nothing beyond the test is predicted".to_owned())?;
    // By the crush of the model: it may miss that of the test by 3.5 %.
    let tested = 1.04 * spot.made.number("/events/dynamic_crush_m").unwrap_or(f64::INFINITY);
    let is_deeper = |p: &&serde_json::Value| p["dynamic_crush_m"].as_f64().is_some_and(|crush| crush > tested);
    let inside = predictions().filter(|p| p["partner"].is_null()).filter(is_deeper).find(|p| p["extrapolates"] != true);
    holds(inside.is_none(), || "a deeper crush is said to be inside the test".to_owned())
}

/// The warning of this number is there and is as grave as can be.
fn decisive(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let number = said.number("number").map_or(0, |shown| shown.value as usize);
    let concern = number.checked_sub(1).and_then(|at| spot.made.list("/concerns").get(at));
    let weight = concern.and_then(|concern| concern["weight"].as_u64());
    holds(weight.is_some_and(|weight| weight >= 6), || format!("warning {number} has the weight {weight:?}"))?;
    holds(!crate::truth::rules::rule::is_like_a_car(spot.made), || {
        format!("a sound record, and warning {number} makes it useless")
    })
}

/// One of the gravest warnings is about it.
fn is_doubted(spot: &Spot<'_>, about: &str) -> Result<(), String> {
    let grave = spot.made.list("/concerns").iter().filter(|concern| concern["weight"].as_u64().is_some_and(|w| w >= 6));
    let mut abouts = grave.filter_map(|concern| concern["about"].as_str());
    holds(abouts.any(|own| own.starts_with(about)), || format!("no grave warning is about {about}"))
}

fn names_a_candidate(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(spot.made.candidate_named(said.text("model")).is_some(), || "there is no such candidate".to_owned())
}

fn few_determined(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let best = spot.made.recommended().ok_or("no model is recommended")?;
    crate::truth::rules::models::counts(said, best)
}

/// Sensors of one place, more than one of them, and as many as are named.
pub fn sensors_of_one_place(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let numbers = spot.made.list("/key_numbers");
    let crush = numbers.iter().find(|number| number["name"] == "dynamic_crush");
    let count = crush.and_then(|crush| crush["spread"]["channels"].as_array()).map_or(0, Vec::len);
    holds(count > 1 && spot.made.known.sensors == 1, || {
        format!("the {} sensors of this vehicle sit on different masses", spot.made.known.sensors)
    })?;
    let shown = said.number("count").map(|shown| shown.value as usize);
    holds(shown.is_none_or(|shown| shown == count), || format!("there are {count}"))?;
    numbers_of_records(said, spot)
}

fn lacks(spot: &Spot<'_>, mass: bool, speed: bool) -> Result<(), String> {
    let stated = (spot.made.number("/test/mass_kg"), spot.made.number("/test/impact_speed_m_per_s"));
    holds((stated.0.is_none(), stated.1.is_none()) == (mass, speed), || {
        format!("the record states a mass of {:?} kg and a speed of {:?} m/s", stated.0, stated.1)
    })
}

/// No candidate with physical parameters repeats the test by its own figures.
fn none_adequate(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let rated = spot.made.choice.iter().flat_map(|choice| &choice.candidates);
    let adequate = rated.into_iter().find(|candidate| candidate.adequate);
    holds(adequate.is_none(), || format!("{} is adequate", adequate.map_or("", |c| c.id.as_str())))
}

/// So many warnings stand beside those that are listed, the same sum everywhere; the console lists methods that failed.
fn counts_warnings(spot: &Spot<'_>, more: usize) -> Result<(), String> {
    let warnings = || spot.made.list("/concerns").iter().filter(|concern| concern["severity"] == "warning");
    let listed = match spot.surface {
        Surface::Console => {
            let is_numbered = |line: &&String| {
                let text = line.trim_start_matches("warnings").trim_start();
                text.split_once(". ").is_some_and(|(number, _)| number.parse::<usize>().is_ok())
            };
            let is_failed = |warning: &&serde_json::Value| {
                warning["about"].as_str().is_some_and(|about| about.starts_with("method"))
            };
            spot.made.console.iter().filter(is_numbered).count() + warnings().filter(is_failed).count()
        }
        _ => spot.made.page.iter().filter(|block| block.section == "before-use" && block.element == "li").count(),
    };
    let all = warnings().count();
    holds(listed + more == all, || format!("{all} warnings, {listed} listed, and {more} more are said"))
}

/// The recommended model misses an event of its own test by more than an adequate one may.
fn misses_its_test(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.recommended().ok_or("no model is recommended")?;
    holds(misses_time_or_rebound(spot.made, own).is_some(), || "it repeats its own test".to_owned())
}
