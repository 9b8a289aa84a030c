//! Remarks of the stages: sentences that no text of `phrases` makes.

use crate::truth::known::Subject;
use crate::truth::rules::poles::{
    beyond_nyquist, contradicted, growing_mode, is_identified, mode_of_a_model, real_pole, two_poles_at_zero,
};
use crate::truth::rules::rule::{Rule, Spot, holds, is_like_a_car, numbers_of_records, own_test, says, shows};
use crate::truth::template::Place::{At, Number};
use crate::truth::template::Said;

/// Their sentences; `{more}` and the like take what a sentence goes on with.
pub const RULES: &[Rule] = &[
    // Ingest.
    says("note.pulse", "pulse: channel {channel}, {why}", &[], is_the_channel),
    says("note.level-at-end", "the mean of the pulse over its last {time} is {level}: {more}", &[], level_at_end),
    // Integrate.
    says("note.speed-question", "is the impact speed of {speed} ({shown}) right? {more}", &[], speed_is_asked),
    says(
        "note.rebound-question",
        "check the impact speed ({speed}): the car would rebound at {share} of it, real cars stay below {most}. {more}",
        &[("speed", At("/test/impact_speed_m_per_s")), ("share", Number), ("most", Number)],
        rebound_is_asked,
    ),
    says(
        "note.stop-question",
        "check the impact speed ({speed}): the car would not stop, it would still move at {left}. {more}",
        &[("speed", At("/test/impact_speed_m_per_s")), ("left", Number)],
        |said, spot| {
            holds(!is_like_a_car(spot.made), || "it is right, and the car stops".to_owned())?;
            shows(said, "left", last_velocity(spot), "the last velocity")
        },
    ),
    says(
        "note.unit-exchanged",
        "in {unit} this pulse stops the car from {speed} ({figures}): {more}",
        &[],
        is_not_a_car,
    ),
    says(
        "note.packed-clock",
        "the times of column {title} are those of a clock packed into a number, hhmmss",
        &[],
        is_not_a_car,
    ),
    says(
        "note.begins-later",
        "the pulse begins {late} after time zero: contact may be as late, and the intervals hold it",
        &[("late", Number)],
        |said, _| {
            let late_s = said.number("late").map_or(0.0, |shown| shown.si());
            holds((0.0..0.02).contains(&late_s), || format!("a pulse that begins {late_s} s later speaks for itself"))
        },
    ),
    says("note.speed-exchanged", "from {speed} this pulse stops the car ({figures}): {more}", &[], is_not_a_car),
    says(
        "note.sign-exchanged",
        "with the other sign this pulse stops the car from {speed} ({figures}): {more}",
        &[],
        is_not_a_car,
    ),
    says(
        "note.time-exchanged",
        "with times {factor} times {what} this pulse stops the car from {speed} ({figures}): {more}",
        &[],
        is_not_a_car,
    ),
    says("note.some-exchanged", "impact speed and pulse do not fit together: check {what}; {more}", &[], is_not_a_car),
    says(
        "note.passes-zero",
        "the velocity passes zero {count} more times after dynamic crush, first at {time}; only the first zero counts",
        &[("count", Number), ("time", Number)],
        passes_zero,
    ),
    says(
        "note.centroid",
        "{channel}centroid time: {one} from C/v0, {two} from the pulse, {apart} apart{more}",
        &[],
        centroid,
    ),
    says(
        "note.derived",
        "channel {channel}: derived from the velocity change of channel {other} by central differences over {time}, \
         not measured; its values come in steps of {step}, so that a sample may be {error} wrong by rounding \
         alone; {more}",
        &[("time", Number), ("step", Number), ("error", Number)],
        steps_of_a_recorder,
    ),
    // Identify.
    says("note.few-directions", "{id}: the input excites {count} of {all} directions only: {more}", &[], is_identified),
    says("note.impulse-response", "{method}: {channel} is treated as an impulse response; {more}", &[], |_, spot| {
        holds(spot.made.known.subject != Subject::InputOutput, || "it has an input".to_owned())
    }),
    says("note.cancelled", "{id}: zeros cancel the poles at {places}: they are no modes. {more}", &[], is_identified),
    says("note.line-loss", "{id}: straight lines between the samples of {input} lose {more}", &[], is_identified),
    says("note.grows", "{id}: the model grows by a factor {factor} per sample and {more}", &[], is_identified),
    says("note.staircase", "{input} stands still between its jumps{more}", &[], |_, spot| {
        holds(spot.made.known.subject == Subject::InputOutput, || "it has no input".to_owned())
    }),
    says("note.harmonic", "ambient: {hz} Hz is a harmonic line, {more}", &[], |_, spot| {
        holds(spot.made.known.subject == Subject::InputOutput, || "it is a crash".to_owned())
    }),
    // Parameter-solve.
    says(
        "note.no-kelvin",
        "kelvin: t_c/t_m = {ratio} is not below 2/pi = {bound}: {more}",
        &[("ratio", Number)],
        no_kelvin,
    ),
    says(
        "note.maxwell-rigid",
        "maxwell: the damper is nearly rigid, it gives {part} of {crush}: {more}",
        &[("part", Number), ("crush", Number)],
        part_of_the_damper,
    ),
    says(
        "note.mass-split-one",
        "{masses}an assumption: one sensor cannot identify it, and the parameters depend on it",
        &[],
        one_accelerometer,
    ),
    says(
        "note.mass-split-several",
        "{masses}an assumption: the parameters depend on it; the sensors on several masses can identify it, {more}",
        &[],
        |_, spot| holds(spot.made.known.sensors > 1, || "there is one sensor".to_owned()),
    ),
    says(
        "note.mass-split",
        "{masses}: front mass fraction {fraction} assumed: one accelerometer does not tell it, and the \
         parameters depend on it",
        &[],
        one_accelerometer,
    ),
    says("note.duals", "{model}: two dual solutions move the compartment alike. {more}", &[], one_accelerometer),
    says(
        "note.on-bound",
        "{id}: parameters at a search limit, not identifiable from this record: {names}",
        &[],
        on_bound,
    ),
    says(
        "note.near-filter",
        "{id}: the mode at {frequency} (damping ratio {ratio}) lies near the {edge} edge of the {class} filter; {more}",
        &[("frequency", Number), ("ratio", Number)],
        mode_of_a_model,
    ),
    says(
        "note.growing-pole",
        "{id}: the pole at {frequency} (damping ratio {ratio}) grows: the model is unstable",
        &[("frequency", Number), ("ratio", Number)],
        growing_mode,
    ),
    says(
        "note.real-near-filter",
        "{id}: the mode at {place} 1/s lies near the {edge} edge of the {class} filter; {more}",
        &[("place", Number)],
        |said, spot| real_pole(said, spot, |place| place < 0.0),
    ),
    says(
        "note.real-growing-pole",
        "{id}: the pole at {place} 1/s grows: the model is unstable",
        &[("place", Number)],
        |said, spot| real_pole(said, spot, |place| place > 0.0),
    ),
    says(
        "note.growing-poles",
        "{id}: {count} poles grow, {places}: the model is unstable",
        &[("count", Number)],
        |said, spot| {
            let model = spot.made.list("/models").iter().find(|model| model["id"].as_str() == Some(said.text("id")));
            let poles = model.and_then(|model| model["poles"].as_array()).map(Vec::as_slice).unwrap_or_default();
            let part = |pole: &serde_json::Value, name: &str| pole[name].as_f64().unwrap_or_default();
            let growing = poles.iter().filter(|p| part(p, "re_per_s") > 0.0 && part(p, "im_rad_per_s") >= 0.0).count();
            shows(said, "count", Some(growing as f64), "the count of growing poles")
        },
    ),
    says("note.one-near-zero", "{id}: one pole lies at or near zero: {more}", &[], is_identified),
    says(
        "note.zero-on-the-right",
        "{id}: the zero {place} 1/s (standard deviation {deviation}) lies in the right half plane: {more}",
        &[],
        is_identified,
    ),
    says("note.near-zero", "{id}: {count} poles lie at or near zero: {more}", &[("count", Number)], two_poles_at_zero),
    says(
        "note.beyond-sampling",
        "{id}: the pole at {place} is no mode: it lies at or beyond the Nyquist frequency {more}",
        &[],
        beyond_nyquist,
    ),
    says(
        "note.free-decay",
        "{id}: the record is taken for a free decay from its first sample on: nothing may drive it",
        &[],
        is_identified,
    ),
    says("note.condition", "{id}: condition number {value}: {more}", &[], is_identified),
    says(
        "note.coefficients",
        "{id}: this record does not determine the single coefficients: {why}",
        &[],
        is_identified,
    ),
    says("note.lanczos", "{id}: {count} singular values were computed in {more}", &[], is_identified),
    says("note.no-deviations", "{id}: no standard deviations: {why}", &[], is_identified),
    says(
        "note.of-predictions",
        "{id}: whiteness and correlation with the input are those of the one-step prediction errors, {more}",
        &[],
        is_identified,
    ),
    says("note.no-model", "{method} gave no model: {why}", &[], |said, spot| {
        let method = said.text("method");
        let is_there = spot.made.list("/models").iter().find(|model| model["id"].as_str() == Some(method));
        holds(is_there.is_none(), || format!("there is a model {method}"))
    }),
    says(
        "note.unseen-fails",
        "{id}: unseen samples{output} from {time} ms on contradict it: validation {unseen} %{start}, fit {fit} %",
        &[("unseen", Number), ("fit", Number)],
        contradicted,
    ),
    says("note.mean", "the mean of {levels}: a linear model has no constant; {more}", &[], numbers_of_records),
    says("note.double-integrator", "{id}: two poles lie at zero: {more}", &[], two_poles_at_zero),
    says(
        "note.after-iterations",
        "{id}: every start is stopped after {count} iterations, converged or not",
        &[],
        is_identified,
    ),
    says("note.paper-era", "paper era: {what}", &[], |_, spot| {
        holds(spot.made.text("/pipeline").contains("era"), || "it is another pipeline".to_owned())
    }),
    says(
        "note.matching",
        "{id}: {solutions} solutions, {real} real, {physical} physical (springs positive, dampers not \
         negative); {more}",
        &[("solutions", Number), ("real", Number), ("physical", Number)],
        solutions,
    ),
    says(
        "note.no-sum",
        "maxwell: no closed form, none of the inputs holds a sum of exponentials {more}",
        &[],
        |_, spot| {
            let sums = spot.made.records.iter().any(|(topic, _)| topic.starts_with("/model/exponentials"));
            holds(!sums, || "there is a sum of exponentials".to_owned())
        },
    ),
    says("note.damped-wave", "curve-fit: {id} has a damped wave, {more}", &[], is_identified),
    says("note.for-reproduction", "{id}: as the ERA paper prints it, for reproduction only", &[], is_a_candidate),
    says("note.not-simulated", "{id}: not simulated, {why}", &[], |said, spot| {
        let own = spot.made.candidate(said.text("id")).ok_or("there is no such candidate")?;
        holds(own["simulation"].is_null() || own["simulation"]["fit_percent"].is_null(), || {
            "it was simulated".to_owned()
        })
    }),
    says(
        "note.clipped",
        "the pulse may be clipped: {count} equal samples in a row at an extreme {range}",
        &[],
        is_not_sound,
    ),
    says("note.positive", "the pulse is positive ({speed} in the first {time}); {more}", &[], is_not_sound),
    says("note.wrong-sign", "the pulse has the wrong sign: {more}", &[], is_not_sound),
    says(
        "note.not-of-compartment",
        "channel {channel} may not show the motion of the compartment: {more}",
        &[],
        |_, spot| holds(!spot.made.is_of_a_vehicle(), || "it sits in the vehicle, along x".to_owned()),
    ),
    says(
        "note.of-occupants-alone",
        "criteria of occupants alone: channel {channel} is of an occupant, and {more}",
        &[],
        |_, spot| holds(spot.made.known.subject == Subject::Occupant, || "the sensor is on the vehicle".to_owned()),
    ),
    says(
        "note.low-rate",
        "{channels}: the sampling rate {rate} is only {ratio} times CFC {class}: {more}",
        &[("rate", Number), ("ratio", Number), ("class", Number)],
        |said, _| {
            let [rate, class] = said.values(["rate", "class"]);
            shows(said, "ratio", Some(rate / class), "the ratio")
        },
    ),
    says(
        "note.few-samples",
        "{model}: not fitted by {method}: {count} samples between {from} and {to}, a fit needs at least {least}",
        &[("count", Number), ("least", Number)],
        |said, _| {
            let [count, least] = said.values(["count", "least"]);
            holds(count < least, || format!("{count} are enough"))
        },
    ),
    says(
        "note.low-fit",
        "{model}: fit {fit}, below {limit}: the model leaves more than half of the record's variance, {more}",
        &[("fit", Number), ("limit", Number)],
        |said, _| {
            let [fit, limit] = said.values(["fit", "limit"]);
            // What leaves half of the variance.
            holds(fit < limit && (limit - 100.0 * (1.0 - 0.5_f64.sqrt())).abs() < 0.05, || format!("{fit} of {limit}"))
        },
    ),
    says(
        "note.contact-taken",
        "contact is taken at {instant} of the file, where the pulse begins (+-{error}): {more}",
        &[("instant", Number), ("error", Number)],
        contact_taken,
    ),
    says("note.begins-elsewhere", "the pulse begins {time} {side} contact ({rule}): {more}", &[], |_, _| {
        Err("every made record begins at the contact that it states".to_owned())
    }),
    says("note.separating", "still separating: {more}", &[], lower_bounds),
    says("note.never-zero", "the velocity never reaches zero, the record ends at {more}", &[], never_zero),
    says("note.no-mass", "no mass is stated. {more}", &[], |_, spot| lacks(spot, "/test/mass_kg")),
    says("note.mass-unknown", "the mass is not known: {more}", &[], |_, spot| lacks(spot, "/test/mass_kg")),
    says("note.no-speed", "no impact speed is stated{more}", &[], |_, spot| lacks(spot, "/test/impact_speed_m_per_s")),
    says(
        "note.too-fast",
        "the rebound at {one} is faster than the impact at {two}, which no passive vehicle does: {more}",
        &[],
        |said, spot| {
            holds(own_test(spot.made).is_none(), || "the vehicle is passive, and does".to_owned())?;
            numbers_of_records(said, spot)
        },
    ),
    says("note.filter-unknown", "the filter of the record is not known here {more}", &[], |_, spot| {
        let known =
            spot.made.records.iter().any(|(topic, record)| topic.starts_with("/filter/") && record["cfc"].is_number());
        holds(!known, || "there is a record of the filter".to_owned())
    }),
    says("note.two-collided", "two vehicles collided: {more}", &[], |_, spot| {
        holds(spot.made.known.subject == Subject::TwoVehicles, || "there is one vehicle".to_owned())
    }),
    says(
        "note.dual-decided",
        "{model}: the dual model moves the compartment alike, but not the chassis: {more}",
        &[],
        |_, spot| holds(spot.made.known.sensors > 1, || "there is one sensor".to_owned()),
    ),
    says(
        "note.no-such-mass",
        "{model}: sensor {channel} is on the front, which this model does not have: not fitted",
        &[],
        |said, spot| {
            let own = spot.made.list("/candidates").iter().find(|c| c["model"].as_str() == Some(said.text("model")));
            let masses = own
                .and_then(|own| own["parameters"].as_object())
                .map_or(1, |all| all.keys().filter(|name| name.ends_with("_kg")).count());
            holds(masses == 1, || format!("it has {masses} masses"))
        },
    ),
    says("console.stage-predict", "{line}", &[], predicted),
];

/// The pulse is the only column, or the one that was asked for.
fn is_the_channel(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.text("/test/channel");
    holds(said.text("channel").split([' ', ',']).next() == Some(own), || format!("the pulse is {own}"))
}

/// The pulse of a soft front begins up to 5 ms after contact; twice the 90 % error that is said is beyond 99.9 %.
fn contact_taken(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let [instant, error] = ["instant", "error"].map(|name| said.number(name).map(|shown| shown.si()));
    let (instant_s, error_s) = instant.zip(error).ok_or("no instant is said")?;
    let room_s = 2.0 * error_s + 1e-3;
    let true_s = spot.made.known.contact_s;
    let late_s = instant_s - true_s;
    holds((-room_s..=room_s + 5e-3).contains(&late_s), || format!("contact is at {true_s} s, not at {instant_s} s"))
}

/// A sound record ends at rest, unless its model moves on.
fn level_at_end(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let Some(level) = said.number("level") else { return Err("no level is said".to_owned()) };
    let channel = spot.made.text("/test/channel");
    let wave = spot.made.waves.get(channel).ok_or("there is no pulse")?;
    let last = wave.sampled.samples().len().saturating_sub((0.02 / wave.sampled.dt_s()) as usize);
    let samples = &wave.sampled.samples()[last..];
    let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
    // Of the record as read; the filter and the zero level move it a little.
    holds((mean.abs() - level.si().abs()).abs() < 5.0, || format!("the mean over the last 20 ms is {mean:.2} m/s²"))
}

/// The speed is asked only where the pulse is none of a vehicle at that speed: it rebounds by more than a third, or the
/// record states something wrong.
fn speed_is_asked(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let made = spot.made;
    holds(
        said.number("speed")
            .is_some_and(|speed| made.number("/test/impact_speed_m_per_s").is_some_and(|own| speed.is_of(own))),
        || "it is not the speed of the test".to_owned(),
    )?;
    let Some(truth) = own_test(made) else { return Ok(()) };
    holds(truth.restitution > 0.3, || format!("the vehicle rebounds at {:.2} of its right speed", truth.restitution))
}

/// The restitution that is asked about is that of the events, and no car's.
fn rebound_is_asked(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(!is_like_a_car(spot.made), || "the speed is right, and the vehicle rebounds like a car".to_owned())?;
    let restitution = spot.made.number("/events/coefficient_of_restitution");
    shows(said, "share", restitution.map(|e| 100.0 * e), "the restitution, percent")?;
    let [share, most] = said.values(["share", "most"]);
    holds(share > most, || format!("{share} % is below {most} %"))
}

/// An exchange is asked about where the record is none of a car as it stands.
fn is_not_a_car(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(!is_like_a_car(spot.made), || "nothing is exchanged, and the vehicle stops like a car".to_owned())
}

/// The velocity of the pulse.
fn velocity<'a>(spot: &Spot<'a>) -> Option<&'a crumple_signal::Sampled> {
    let channel = spot.made.text("/test/channel");
    spot.made.waves.get(&format!("{channel}/velocity")).map(|wave| &wave.sampled)
}

fn last_velocity(spot: &Spot<'_>) -> Option<f64> {
    velocity(spot)?.samples().last().copied()
}

/// Zeros of the velocity behind the first, between its samples.
fn passes_zero(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let wave = velocity(spot).ok_or("there is no velocity")?;
    let crush_s = spot.made.number("/events/time_of_dynamic_crush_s").ok_or("there is no crush")?;
    let zeros = wave.samples().windows(2).enumerate().filter(|(_, pair)| pair[0] * pair[1] < 0.0);
    let times = zeros.map(|(k, pair)| wave.t0_s() + wave.dt_s() * (k as f64 + pair[0] / (pair[0] - pair[1])));
    let later: Vec<f64> = times.filter(|time_s| *time_s > crush_s + wave.dt_s()).collect();
    shows(said, "count", Some(later.len() as f64), "the count of zeros")?;
    shows(said, "time", later.first().copied(), "the first of them")
}

/// `t_c = C / v0`, by the numbers of the summary.
fn centroid(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let of = |pointer: &str| spot.made.number(pointer);
    let by_crush =
        of("/events/dynamic_crush_m").zip(of("/test/impact_speed_m_per_s")).map(|(crush, speed)| crush / speed);
    let shown = said.number("one").ok_or("no time is said")?;
    if !said.text("channel").is_empty() {
        return numbers_of_records(said, spot);
    }
    holds(by_crush.is_none_or(|t| shown.is_of(t)), || format!("C/v0 is {:.3} ms", 1e3 * by_crush.unwrap_or_default()))
}

/// No Kelvin model has such a pulse: not of a record that one made.
fn no_kelvin(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let ratio = said.number("ratio").map_or(0.0, |shown| shown.value);
    let of = |name: &str| spot.made.number(&format!("/events/{name}"));
    let own = of("centroid_time_s").zip(of("time_of_dynamic_crush_s")).map(|(c, m)| c / m);
    holds(own.is_none_or(|own| (own - ratio).abs() < 1e-3), || format!("t_c/t_m is {own:?}"))?;
    holds(ratio >= std::f64::consts::FRAC_2_PI - 5e-4, || format!("{ratio} is below 2/pi"))?;
    holds(spot.made.known.model() != Some("kelvin") || !spot.made.known.is_sound || ratio < 0.645, || {
        "a Kelvin model made this record".to_owned()
    })
}

/// True of one sensor alone.
fn one_accelerometer(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let fitted = spot
        .made
        .list("/candidates")
        .iter()
        .filter(|candidate| candidate["fit"]["sensors"].as_array().is_some_and(|sensors| !sensors.is_empty()));
    holds(fitted.count() == 0, || "a second sensor was fitted too".to_owned())?;
    numbers_of_records(said, spot)
}

/// The candidate is there, and its fit stopped on bounds.
fn on_bound(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let own = spot.made.candidate(said.text("id")).ok_or("there is no such candidate")?;
    let bounds = own["fit"]["active_bounds"].as_array().map_or(0, Vec::len);
    holds(bounds > 0, || "its fit stopped on no bound".to_owned())
}

fn is_a_candidate(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(spot.made.candidate(said.text("id")).is_some(), || "there is no such candidate".to_owned())
}

/// Six solutions, an even number of them real, no more physical than real.
fn solutions(said: &Said, _: &Spot<'_>) -> Result<(), String> {
    let [all, real, physical] = said.values(["solutions", "real", "physical"]);
    holds(all == 6.0 && real % 2.0 == 0.0 && real <= all && physical <= real, || {
        format!("{physical} of {real} of {all}")
    })
}

/// Numbers of a line about predictions: each is one of a record, in the unit of its column.
fn predicted(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    // The partner is described at length: that it is the one asked for is enough.
    if let (Some(partner), true) =
        (spot.made.question.and_then(|q| q.partner), said.text("line").starts_with("partner:"))
    {
        return holds(said.text("line").contains(partner), || format!("{partner} was asked for"));
    }
    let line = said.text("line").replace("..", " to ");
    let wrong = crate::truth::numbers(&line)
        .into_iter()
        .find(|shown| !crate::truth::rules::rule::is_in_records(spot.made, shown));
    holds(wrong.is_none(), || format!("{:?} is no number of a record", wrong.map(|shown| shown.value)))
}

fn is_not_sound(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(!spot.made.known.is_sound, || "nothing is wrong with the record".to_owned())?;
    numbers_of_records(said, spot)
}

/// What is a lower bound is not above the truth.
fn lower_bounds(_: &Said, spot: &Spot<'_>) -> Result<(), String> {
    let (Some(truth), Some(own)) = (own_test(spot.made), spot.made.number("/events/coefficient_of_restitution")) else {
        return Ok(());
    };
    holds(own <= truth.restitution + 0.03, || {
        format!("{own:.2} is above the true restitution {:.2}", truth.restitution)
    })
}

fn never_zero(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    holds(spot.made.number("/events/dynamic_crush_m").is_none(), || "it has a crush".to_owned())?;
    numbers_of_records(said, spot)
}

fn lacks(spot: &Spot<'_>, pointer: &str) -> Result<(), String> {
    holds(spot.made.number(pointer).is_none(), || format!("{pointer} is there"))
}

/// What the damper of a Maxwell model gives up to its crush is `m v0 / c`: all of the momentum has passed through it.
fn part_of_the_damper(said: &Said, spot: &Spot<'_>) -> Result<(), String> {
    shows(said, "crush", spot.made.number("/events/dynamic_crush_m"), "the crush")?;
    let candidates = spot.made.list("/candidates").iter().filter(|candidate| candidate["model"] == "maxwell");
    let momentum = spot.made.number("/test/mass_kg").zip(spot.made.number("/test/impact_speed_m_per_s"));
    let Some((mass, speed)) = momentum else { return Ok(()) };
    let part = said.number("part").ok_or("no part is said")?;
    let mut parts = candidates.filter_map(|own| Some(mass * speed / own["parameters"]["damping_n_s_per_m"].as_f64()?));
    // The velocity at the end of the window is not quite zero.
    holds(parts.any(|own| (part.si() / own - 1.0).abs() < 0.05), || "no damper of a candidate gives so much".to_owned())
}

/// A step of 1 km/h, and what it makes of a central difference.
fn steps_of_a_recorder(said: &Said, _: &Spot<'_>) -> Result<(), String> {
    let of = |place: &str| said.number(place).ok_or_else(|| format!("no {place} is said"));
    shows(said, "step", Some(1.0 / 3.6), "the step")?;
    shows(said, "error", Some(of("step")?.si() / of("time")?.si()), "the step over the time")
}
