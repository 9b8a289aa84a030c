//! The values of `summary.json` against the truth of the record.

use std::f64::consts::TAU;

use crumple_signal::STANDARD_GRAVITY_M_PER_S2 as G;
use serde_json::Value;

use crate::numbers::{numbers, plain};
use crate::truth::found::Found;
use crate::truth::known::{Maker, Subject};
use crate::truth::models;
use crate::truth::run::Made;

type Check = fn(&Made, &mut Found);

/// Each rule by its name in the table.
const RULES: [(&str, Check); 15] = [
    ("mass and speed of the test", test),
    ("events", events),
    ("energy of a recorder", recorder),
    ("key numbers", key_numbers),
    ("record", record),
    ("remedy", remedy),
    ("status", status),
    ("reason of the status", reason),
    ("good for", good_for),
    ("question", question),
    ("predictions", predictions),
    ("recommended model", models::recommended),
    ("candidates", models::candidates),
    ("identified models", models::identified),
    ("numbers of the verdict", numbers_of_verdict),
];

/// Half width of a prediction up to which a model is usable, and how far the truth may be then, percent.
const USABLE_PERCENT: f64 = 10.0;
/// Half width beyond which a prediction answers nothing, percent; less the rounding of what is shown.
const WIDE_PERCENT: f64 = 29.0;
/// How far what a sound record shows may be from the truth: the trigger is off by 0.1 ms (0.3 % of the crush), the
/// speed by 0.1 km/h (0.2 %), and the zero level left by 2 % of noise (0.5 %).
const OF_RECORD: f64 = 0.02;
/// How far a restitution may be: the speed after the rebound is off by what the zero level makes of 0.1 s.
pub const OF_RESTITUTION: f64 = 0.03;

/// What each rule finds in a run.
pub fn check(made: &Made) -> Vec<(&'static str, Found)> {
    let of_rule = |(name, check): (&'static str, Check)| {
        let mut found = Found::default();
        check(made, &mut found);
        (name, found)
    };
    RULES.into_iter().map(of_rule).collect()
}

/// Of a sound record they are the true ones, where it states them; a stated speed is up to 1 % off.
fn test(made: &Made, found: &mut Found) {
    let known = &made.known;
    for (name, truth, relative) in
        [("mass_kg", known.mass_kg, 1e-6), ("impact_speed_m_per_s", known.speed_m_per_s, 0.011)]
    {
        let own = made.number(&format!("/test/{name}"));
        found.same(name, own, truth.filter(|_| known.is_sound && own.is_some()), relative);
    }
}

/// A vehicle that stops has a crush, at its time, with its rebound and change of velocity; what a record cuts off of a
/// rebound is a lower bound. One spring with the energy and the crush of the test has `k = m v0² / C²`.
fn events(made: &Made, found: &mut Found) {
    let Some((truth, speed)) = made.own_test().zip(made.known.speed_m_per_s) else { return };
    let of = |name: &str| made.number(&format!("/events/{name}"));
    let is_cut = models::is_rebound_cut(made);
    if !made.summary["events"].is_null() {
        measured(made, ("dynamic_crush", of("dynamic_crush_m"), truth.crush_m), found);
        measured(made, ("time_of_dynamic_crush", of("time_of_dynamic_crush_s"), truth.time_s), found);
        let own = of("coefficient_of_restitution").unwrap_or(f64::NAN);
        let least = if is_cut { own.min(truth.restitution) } else { truth.restitution };
        found.near("coefficient_of_restitution", own, least, OF_RESTITUTION);
    }
    let change = speed * (1.0 + truth.restitution);
    if let Some(own) = made.number("/metrics/delta_v/value").filter(|_| !is_cut) {
        found.near("delta_v", own, change, OF_RECORD * change + OF_RESTITUTION * speed);
    }
    let stiffness = made.number("/metrics/average_stiffness/value");
    let spring = made.number("/test/mass_kg").zip(of("dynamic_crush_m"));
    let spring = spring.map(|(mass, crush)| mass * (speed / crush).powi(2));
    found.same("average_stiffness", stiffness, spring.filter(|_| stiffness.is_some()), 0.03);
}

/// A measured value is true. Where nothing states contact, or a force goes on, one interval holds it and the truth.
fn measured(made: &Made, (name, own, truth): (&str, Option<f64>, f64), found: &mut Found) {
    let interval = made.key_number(name).and_then(ends);
    let holds = |value: f64| interval.is_some_and(|(low, high)| (low..=high).contains(&value));
    if own.is_some_and(holds) && holds(truth) {
        return found.holds(true, String::new);
    }
    found.same(name, own, Some(truth), OF_RECORD);
}

/// What went into deformation is what the speed before and that after leave, by the stated speed and the table.
fn recorder(made: &Made, found: &mut Found) {
    let stated = made.known.speed_m_per_s.filter(|_| made.known.subject == Subject::Recorder);
    if let Some((v0, change)) = stated.zip(made.number("/metrics/maximum_delta_v/value")) {
        let energy = v0 * v0 - (v0 - change.abs()).powi(2);
        let of = |name: &str| made.number(&format!("/metrics/{name}/value"));
        found.same("recorded_ees", of("recorded_ees"), Some(energy.sqrt()), 1e-3);
        found.same("absorbed_energy_share", of("absorbed_energy_share"), Some(energy / (v0 * v0)), 1e-3);
    }
}

/// Each lies in its interval; the intervals hold the truth of a sound test as often as they say.
fn key_numbers(made: &Made, found: &mut Found) {
    let truth = made.own_test().zip(made.known.speed_m_per_s);
    for number in made.list("/key_numbers") {
        let name = number["name"].as_str().unwrap_or_default();
        let Some((value, (low, high))) = number["value"].as_f64().zip(ends(number)) else { continue };
        let is_inside = (low..=high).contains(&value) || number["is_lower_bound"] == true;
        found.holds(is_inside, || format!("{name} is {value}, its interval {low} to {high}"));
        if let Some(truth) = truth.and_then(|(truth, speed)| truth.named(name, speed)) {
            found.count("of the test", name, (low..=high).contains(&truth));
        }
    }
}

fn ends(interval: &Value) -> Option<(f64, f64)> {
    interval["low"].as_f64().zip(interval["high"].as_f64())
}

/// A record that states what is true is not called wrong; one with a fault is not called sound. What is not sound has
/// what is doubted: the speed where another one makes it right.
fn record(made: &Made, found: &mut Found) {
    let own = made.text("/verdict/record");
    let is_right = match made.known.subject {
        Subject::Vehicle => made.is_like_a_car(),
        // Along another axis it is another thing than it is taken for.
        Subject::OtherAxis => false,
        _ => made.known.is_sound,
    };
    if is_right {
        found.holds(own != "wrong", || "it is called wrong".to_owned());
    }
    if made.is_of_a_vehicle() && !made.known.is_sound {
        found.holds(own != "sound", || "it is called sound".to_owned());
    }
    let about = made.summary.pointer("/verdict/record_about").and_then(Value::as_str);
    found.holds(about.is_none() == (own == "sound"), || format!("it is {own} about {about:?}"));
    if made.known.remedy == Some("--impact-speed") {
        found.holds(about == Some("impact-speed"), || format!("the speed is wrong, and {about:?} is doubted"));
    }
}

/// The first or second remark has the flag that makes a wrong record right.
fn remedy(made: &Made, found: &mut Found) {
    let Some(remedy) = made.known.remedy else { return };
    let flags = || made.list("/remarks").iter().take(2).filter_map(|remark| remark["values"]["flag"].as_str());
    let has = flags().any(|flag| flag.starts_with(remedy));
    found.holds(has, || format!("{remedy} is not said, but {:?}", flags().collect::<Vec<_>>()));
}

/// A usable model repeats its own test, is known to 10 %, all of its numbers are determined, and the truth is as near.
/// A sound record whose recommended model repeats the test is not called useless, unless what was asked is wide.
fn status(made: &Made, found: &mut Found) {
    let best = made.recommended();
    let half = answer(made).and_then(half_width_percent);
    let miss = best.map_or(Some("no model is recommended".to_owned()), |best| models::miss(made, best));
    match made.text("/verdict/status") {
        "usable" => {
            found.holds(made.known.is_sound, || "usable, and the record states something wrong".to_owned());
            found.holds(miss.is_none(), || format!("usable, and {miss:?}"));
            let known = best.map_or(&Value::Null, |best| &best["certainties"]);
            let has_all = known["determined"] == known["parameters"];
            found.holds(has_all || best.is_some_and(|best| models::has_the_forces(made, best)), || {
                format!("usable, and {} of {} numbers are determined", known["determined"], known["parameters"])
            });
            found.holds(half.is_some_and(|half| half <= USABLE_PERCENT), || format!("usable, and known to {half:?} %"));
            let off = answer(made).and_then(|prediction| off_percent(made, prediction)).unwrap_or(0.0);
            found.holds(off.abs() <= USABLE_PERCENT, || format!("usable, and its crush is off by {off:.1} %"));
        }
        "do-not-use" => {
            let is_good = made.is_like_a_car() && miss.is_none() && half.is_none_or(|half| half <= WIDE_PERCENT);
            found.holds(!is_good, || "not to be used, and record and model are good".to_owned());
        }
        own => found.holds(own == "usable-with-care", || format!("it is {own:?}")),
    }
}

/// How far the crush of a prediction at a wall is from the truth, percent.
fn off_percent(made: &Made, prediction: &Value) -> Option<f64> {
    let (speed, mass) = prediction["impact_speed_m_per_s"].as_f64().zip(prediction["mass_kg"].as_f64())?;
    let truth = made.known.impact(speed, mass).filter(|_| prediction["partner"].is_null())?;
    Some(100.0 * (prediction["dynamic_crush_m"].as_f64()? / truth.crush_m - 1.0))
}

/// The prediction that answers what was asked: by the recommended model, at the speed, mass and partner asked for;
/// where nothing was asked, inside the test at the lowest speed.
fn answer(made: &Made) -> Option<&Value> {
    let question = made.question.unwrap_or_default();
    let is_close = |value: &Value, asked: Option<f64>| {
        asked.is_none_or(|asked| value.as_f64().is_some_and(|value| (value / asked - 1.0).abs() < 1e-6))
    };
    let has_partner = |partner: &Value| match question.partner {
        Some(asked) => partner.as_str().is_some_and(|partner| partner.to_lowercase().contains(asked)),
        None => partner.is_null(),
    };
    let fitting = made.list("/predictions").iter().filter(|p| {
        p["candidate"] == made.summary["recommended"]
            && !p["dynamic_crush_m"].is_null()
            && is_close(&p["impact_speed_m_per_s"], question.speed_m_per_s)
            && is_close(&p["mass_kg"], question.mass_kg)
            && has_partner(&p["partner"])
    });
    let order = |p: &Value| (p["extrapolates"] == true, p["impact_speed_m_per_s"].as_f64().unwrap_or(f64::NAN));
    fitting.min_by(|a, b| order(a).0.cmp(&order(b).0).then(order(a).1.total_cmp(&order(b).1)))
}

/// Half of the interval of a predicted crush, percent of it.
fn half_width_percent(prediction: &Value) -> Option<f64> {
    let interval = prediction["intervals"].as_array()?.iter().find(|interval| interval["name"] == "dynamic_crush_m")?;
    let (low, high) = ends(interval)?;
    Some(50.0 * (high - low) / prediction["dynamic_crush_m"].as_f64()?)
}

/// What the reason says of the run is so.
fn reason(made: &Made, found: &mut Found) {
    let reason = &made.summary["verdict"]["status_reason"];
    let kind = reason["kind"].as_str().unwrap_or_default();
    let best = made.recommended();
    let known = best.map_or(&Value::Null, |best| &best["certainties"]);
    let lacks = ["mass_kg", "impact_speed_m_per_s"].map(|name| made.number(&format!("/test/{name}")).is_none());
    // What says why there is no result is none of the numbered warnings.
    let warnings = || made.list("/remarks").iter().filter(|remark| remark["code"] != "CR900");
    let warning = || warnings().nth(reason["number"].as_u64()?.checked_sub(1)? as usize);
    let is_about = || warning().is_some_and(|remark| remark["about"] == reason["about"]);
    let spread = made.key_number("dynamic_crush").and_then(|crush| crush["spread"]["channels"].as_array());
    let holds = match kind {
        "good-to" | "beyond" => return good_to(made, reason, found),
        "sensors-differ" => {
            made.known.sensors == 1 && spread.is_some_and(|channels| reason["sensors"] == channels.len())
        }
        "few-determined" => reason["determined"] == known["determined"] && reason["parameters"] == known["parameters"],
        "misses-its-test" => best.is_some_and(|best| models::misses_time_or_rebound(made, best).is_some()),
        "weak" | "contrary" => {
            reason["candidate"].as_str().and_then(|id| made.candidate(id)).is_some_and(|own| Some(own) != best)
        }
        "unassessed" => best.is_some_and(|best| best["uncertainty"].is_null()),
        "dual" => best.is_some_and(|best| models::has_an_open_dual(made, best)),
        "no-interval" => best.is_some() && answer(made).and_then(half_width_percent).is_none(),
        "no-stop" => made.number("/events/dynamic_crush_m").is_none() && made.own_test().is_none(),
        "other-axis" => made.known.subject == Subject::OtherAxis,
        "two-vehicles" => made.known.subject == Subject::TwoVehicles,
        "occupant" => made.known.subject == Subject::Occupant,
        "recorder" => made.known.subject == Subject::Recorder,
        "identified" => made.known.subject == Subject::InputOutput,
        "no-mass" => lacks == [true, false],
        "no-speed" => lacks == [false, true],
        "no-mass-nor-speed" => lacks == [true, true],
        "measured-only" => made.list("/candidates").is_empty(),
        "none-recommended" | "none-adequate" => best.is_none() && !made.list("/candidates").is_empty(),
        "no-result" => made.code == 4,
        "decisive-warning" => {
            is_about() && warning().is_some_and(|remark| remark["weight"] == 3) && !made.is_like_a_car()
        }
        "check" => is_about() && made.text("/verdict/record") != "sound",
        "not-adequate" => best.is_none(),
        "poor-fit" => best.is_none() && reason["fit_percent"].as_f64() < reason["limit_percent"].as_f64(),
        _ => false,
    };
    found.holds(holds, || format!("it is not so: {reason}"));
}

/// The half width of the prediction of this place, which is the answer, on this side of the test.
fn good_to(made: &Made, reason: &Value, found: &mut Found) {
    let own = reason["prediction"].as_u64().and_then(|place| made.list("/predictions").get(place as usize));
    let Some(own) = own else { return found.holds(false, || "there is no such prediction".to_owned()) };
    found.holds(answer(made) == Some(own), || "another prediction answers what was asked".to_owned());
    found.holds((own["extrapolates"] == true) == (reason["kind"] == "beyond"), || {
        "the prediction is on the other side of the test".to_owned()
    });
    let half = half_width_percent(own).unwrap_or(f64::NAN);
    // Rounded, unless that would be on the other side of a limit of the status, or exact.
    let side = |percent: f64| (percent > 0.0, percent > USABLE_PERCENT, percent > 30.0);
    let rounded = if side(half.round()) == side(half) { half.round() } else { half.ceil() };
    found.near("good_to_percent", reason["good_to_percent"].as_f64().unwrap_or(f64::NAN), rounded, 1e-9);
}

/// What a run is called good for is right.
fn good_for(made: &Made, found: &mut Found) {
    let (known, truth) = (&made.known, made.own_test());
    for own in made.list("/verdict/good_for") {
        let kind = own["kind"].as_str().unwrap_or_default();
        let holds = match kind {
            // The pulse is in the unit and of the sign that the record states.
            "measured-quantities" => known.remedy.is_none_or(|flag| flag.starts_with("--impact-speed")),
            "crush-at-the-tested-speed" => {
                let crush = made.number("/events/dynamic_crush_m");
                truth.into_iter().for_each(|truth| measured(made, ("dynamic_crush", crush, truth.crush_m), found));
                made.is_of_a_vehicle() && known.is_sound
            }
            "other-speeds" => {
                let off = answer(made).and_then(|prediction| off_percent(made, prediction));
                if let Some((off, to)) = off.filter(|_| truth.is_some()).zip(own["to_percent"].as_f64()) {
                    found.count("good for", "other speeds to ±x %", off.abs() <= to);
                }
                known.is_sound
            }
            "forces" | "parameters" => {
                made.recommended().into_iter().for_each(|best| {
                    models::forces_or_parameters(made, best, found);
                    models::named_parameters(best, &own["names"], found);
                });
                known.is_sound
            }
            "occupant-criteria" => known.subject == Subject::Occupant && known.is_sound,
            "identified-modes" => matches!(known.maker, Maker::Mode { .. }),
            _ => false,
        };
        found.holds(holds, || format!("not for {kind}"));
    }
}

/// What was asked is predicted: this speed, this mass, this partner.
fn question(made: &Made, found: &mut Found) {
    if let Some(question) = made.question.filter(|_| made.recommended().is_some()) {
        let is_asked = answer(made).is_some_and(|answer| answer["asked"] == true);
        found.holds(is_asked, || format!("{:?} is not answered", question.flags));
    }
}

/// Energies and intervals fit the values; what is called inside the test is; intervals hold the truth as often as they
/// say.
fn predictions(made: &Made, found: &mut Found) {
    // By the crush of the model: it may miss that of the test by 3.5 %.
    let tested_m = 1.04 * made.number("/events/dynamic_crush_m").unwrap_or(f64::INFINITY);
    let is_sound = made.own_test().is_some();
    for own in made.list("/predictions").iter().filter(|p| p["recommended"] == true) {
        let (speed, mass) = (own["impact_speed_m_per_s"].as_f64(), own["mass_kg"].as_f64());
        let Some((speed, mass)) = speed.zip(mass) else { continue };
        // Against a partner it is that of both.
        let energy = own["energy"]["kinetic_at_impact_j"].as_f64().filter(|_| own["partner"].is_null());
        found.same("kinetic_at_impact_j", energy, energy.map(|_| 0.5 * mass * speed * speed), 1e-6);
        let is_deeper = own["dynamic_crush_m"].as_f64().is_some_and(|crush| crush > tested_m);
        found.holds(!is_deeper || own["extrapolates"] == true || !own["partner"].is_null(), || {
            format!("{:.1} km/h is deeper than the test and called inside", 3.6 * speed)
        });
        let truth = made.known.impact(speed, mass).filter(|_| is_sound && own["partner"].is_null());
        for interval in own["intervals"].as_array().into_iter().flatten() {
            let name = interval["name"].as_str().unwrap_or_default();
            let Some((value, (low, high))) = own[name].as_f64().zip(ends(interval)) else { continue };
            found.holds((low..=high).contains(&value), || format!("{name} is {value}, its interval {low} to {high}"));
            if let Some(truth) = truth.and_then(|truth| truth.named(name, speed)) {
                found.count("of predictions", name, (low..=high).contains(&truth));
            }
        }
    }
}

/// Each number of the sentences is that of the summary at its place, as it is shown.
fn numbers_of_verdict(made: &Made, found: &mut Found) {
    for own in made.list("/verdict/numbers") {
        let there = made.number(own["at"].as_str().unwrap_or_default());
        found.holds(there.is_some() && there == own["value"].as_f64(), || format!("{own}, and there it is {there:?}"));
        let shown = plain(own["shown"].as_str().unwrap_or_default());
        let value = own["value"].as_f64().unwrap_or(f64::NAN);
        // Ends of an interval have the unit of the value before them.
        let factors = if shown.contains(' ') { &[1.0, 1.0 / TAU][..] } else { &[1.0, 1e3, 3.6, 1e-3, 1.0 / G] };
        let is_it = numbers(&shown).first().is_some_and(|number| {
            factors.iter().any(|factor| [value, -value].iter().any(|value| number.is_of(value * factor)))
        });
        found.holds(is_it, || format!("{value} is shown as {shown:?}"));
    }
}
