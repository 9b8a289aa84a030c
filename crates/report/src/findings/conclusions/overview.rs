//! The numbers of a run in a few lines, as the console shows them below the verdict.

use crate::words;
use std::path::Path;

use crate::drawing::numbers::MILLI;
use crumple_artifact::records::Certainty;
use crumple_signal::About;
use crumple_signal::key_quantities::{CRUSH, PEAK};
use crumple_stage::{by_way, program};

use crate::findings::conclusions::concerns::{
    Concern, decisive_warning, first_warnings, is_of_a_failed_method, more_warnings,
};
use crate::findings::conclusions::conclusion::Conclusion;
use crate::findings::conclusions::key_numbers::KeyNumber;
use crate::findings::conclusions::kind::Kind;
use crate::findings::conclusions::status::{Status, StatusReason};
use crate::findings::results::parameters::ShownParameter;
use crate::findings::text::{capitalised, parameter_order};
use crate::findings::{CandidateResult, Ranking, Run, Summary};

/// Parameters of a curve of many knots are not listed beyond so many.
const MOST_PARAMETERS: usize = 8;

/// Before the first warning.
const WARNINGS: &str = "warnings";

/// One number or warning of the overview.
pub struct OverviewLine {
    /// What it is; empty where the line goes on with what the one before it is.
    pub label: String,
    /// The number, its interval and its unit, or the sentence.
    pub text: String,
    /// Code of the warning that it is; empty where it is none. It stands behind the text.
    pub code: String,
}

/// Warnings that the sentences of the verdict say already are left out. `folder`: that of the run, for commands that
/// show more.
pub fn overview(run: &Run, ranking: &Ranking, summary: &Summary, folder: &Path) -> Vec<OverviewLine> {
    let Summary { verdict, concerns, key_numbers, .. } = summary;
    let mut lines: Vec<OverviewLine> = Vec::new();
    let line = |label: &str, text: String| OverviewLine { label: label.to_owned(), text, code: String::new() };
    lines.extend(verdict.answers().map(|(label, text)| line(label, text)));
    if !summary.allowed.is_empty() {
        let codes: Vec<&str> = summary.allowed.keys().map(String::as_str).collect();
        let count = summary.allowed.values().sum::<usize>();
        lines.push(line("allowed", format!("{count} by the pipeline: {}", codes.join(", "))));
    }
    // Of an occupant's sensor these are no numbers of the vehicle.
    let of_vehicle = verdict.kind != Kind::Occupant;
    for number in key_numbers.iter().filter(|number| of_vehicle && !number.quantity().console.is_empty()) {
        let is_over_ground = verdict.kind == Kind::TwoVehicles && number.name == CRUSH.key;
        let label = if is_over_ground { "motion over ground" } else { number.quantity().console };
        let Some(value) = number.value else { continue };
        let own = words::with_interval(value, number.interval(), number.interval_source, number.quantity());
        let mut text = format!("{}{own}", number.bound());
        if let Some(at_s) = number.at_s.filter(|_| number.name == PEAK.key) {
            text.push_str(&format!(", {}", words::quantity(MILLI * at_s, 1, "ms")));
        }
        if let Some(side) = number.side(run) {
            text.push_str(&format!(", {side}"));
        }
        if let Some(spread) = number.spread.as_ref().filter(|_| number.interval_misses_a_sensor()) {
            let range = words::ends((spread.low, spread.high), number.interval(), number.quantity().shown());
            text.push_str(&format!("; {} sensors of the compartment: {range}", spread.sensors()));
        }
        if let Some(condition) = number.condition(verdict.is_speed_in_doubt()) {
            text.push_str(&format!(", {condition}"));
        }
        lines.push(line(label, text));
    }
    // Where sensors differ, the numbers and intervals above are those of one of them.
    if key_numbers.iter().any(KeyNumber::interval_misses_a_sensor)
        && let Some(channel) = run.channel()
    {
        let place = if channel.location.is_empty() { String::new() } else { format!(", {}", channel.location) };
        lines.push(line("sensor", format!("channel {}{place}: values and intervals are of it alone", channel.id)));
    }
    if let Some(best) = ranking.best.as_deref().filter(|_| of_vehicle).and_then(|id| run.candidate(id)) {
        let label = if verdict.status == Some(Status::DoNotUse) { "model in doubt" } else { "recommended" };
        lines.push(line(label, parameters(run, best, folder)));
    }
    let decisive = decisive_warning(run, concerns).is_some();
    // The verdict names a decisive warning by its number among all.
    let said = if decisive { Vec::new() } else { said_already(ranking, verdict, concerns) };
    let failed: Vec<&Concern> = concerns.iter().filter(|concern| is_of_a_failed_method(concern)).collect();
    let is_said = |concern: &Concern| said.contains(&concern) || failed.contains(&concern);
    let (first, others) = first_warnings(concerns, is_said, run, ranking);
    // Methods that failed have lines of their own.
    let others = others - failed.len();
    for (number, concern) in first.iter().enumerate() {
        let label = if number == 0 { WARNINGS } else { "" };
        let text = format!("{}. {}", number + 1, concern.text);
        lines.push(OverviewLine { code: concern.code.clone(), ..line(label, text) });
    }
    if run.contradictions.iter().any(|found| !run.allowed.contains(&found.code)) {
        let command = program("artifact explain");
        lines.push(line("", format!("what contradicts, and what to do: {command} {}", folder.display())));
    }
    if others > 0 {
        let label = if first.is_empty() { WARNINGS } else { "" };
        let more = if first.is_empty() { none_first(others) } else { more_warnings(others) };
        lines.push(line(label, format!("{more}: {} {}", by_way("just notes", "crumple notes"), folder.display())));
    }
    for (number, concern) in failed.into_iter().enumerate() {
        lines.push(line(if number == 0 { "not identified" } else { "" }, concern.text.clone()));
    }
    // Of a run that is whole the verdict says why something is not there.
    if matches!(verdict.kind, Kind::Barrier | Kind::NoStop | Kind::TwoVehicles | Kind::MeasuredOnly) {
        lines.extend(run.missing.iter().map(|what| line("not in it", what.clone())));
    }
    lines
}

/// Where no warning is about the numbers shown.
fn none_first(count: usize) -> String {
    let warnings = if count == 1 { "1 warning" } else { &format!("{count} warnings") };
    format!("{warnings}, none about these numbers")
}

/// Concerns of the report itself that status and sentences of the verdict say: sensors that differ, what is not known
/// of the recommended model, else that it extrapolates; of two vehicles that the motion is no crush.
fn said_already<'a>(ranking: &Ranking, verdict: &Conclusion, concerns: &'a [Concern]) -> Vec<&'a Concern> {
    let about = |what: &About| {
        let what = what.to_string();
        concerns.iter().find(|concern| concern.stage == "report" && concern.about == what)
    };
    let of_two = verdict.kind == Kind::TwoVehicles;
    let names_sensors = matches!(verdict.status_reason, Some(StatusReason::SensorsDiffer { .. }));
    let mut said: Vec<&Concern> = about(&About::Motion).filter(|_| of_two || names_sensors).into_iter().collect();
    let best = ranking.best.as_deref().filter(|_| !of_two);
    said.extend(best.and_then(|id| about(&About::Model(id.to_owned())).or_else(|| about(&About::Predictions))));
    said
}

/// `Kelvin model (fitted): m 873 kg, k 330.0 kN/m (329.1 to 330.9), c ...`.
fn parameters(run: &Run, candidate: &CandidateResult, folder: &Path) -> String {
    let curve = curve(run, candidate);
    let mut names: Vec<&str> = candidate.record.parameters.keys().map(String::as_str).collect();
    // Beside a curve there is no room for its knots, nor for what was given.
    let is_mass = |name: &str| parameter_order(&candidate.record.model, name).0 == 0;
    let is_asked = |name: &str| is_mass(name) || candidate.record.certainty(name).is_some();
    names.retain(|name| curve.is_none() || (!name.starts_with(KNOT) && is_asked(name)));
    // What nobody asked the record for comes last, masses aside.
    names.sort_by_key(|name| {
        let order = parameter_order(&candidate.record.model, name);
        (order.0 > 0 && candidate.record.certainty(name).is_none(), order)
    });
    let count = names.len();
    names.truncate(MOST_PARAMETERS);
    let ends = candidate.record.uncertainty.as_ref().map(|known| &known.interval_low);
    let shows_intervals = ends.is_some_and(|ends| names.iter().any(|name| ends.contains_key(*name)));
    let mut texts: Vec<String> = names.into_iter().map(|name| named_value(candidate, name)).collect();
    texts.extend(curve.map(|curve| format!("{curve}: {} {}", by_way("just curve", "crumple curve"), folder.display())));
    let more = if count > MOST_PARAMETERS { ", ..." } else { "" };
    let name = capitalised(&run.name_of(&candidate.id));
    let intervals = if shows_intervals { candidate.about_intervals() } else { String::new() };
    format!("{name}: {}{more}{intervals}", texts.join(", "))
}

/// `k 330.0 kN/m (329.1 to 330.9)`, with a question mark where it is not determined; what was not asked of the record,
/// masses aside, is said to be given.
fn named_value(candidate: &CandidateResult, name: &str) -> String {
    let shown = ShownParameter::of(&candidate.record, name);
    let sure = how_sure(candidate, name, &shown);
    format!("{} {} {}{sure}", shown.symbol, shown.value, shown.unit).trim_end().to_owned()
}

/// ` (329.1 to 330.9)`, a question mark where a parameter is not determined, ` (given)` where nobody asked for it.
fn how_sure(candidate: &CandidateResult, name: &str, shown: &ShownParameter) -> String {
    let interval = match &shown.ends {
        Some([Some(_), Some(high)]) if candidate.record.parameters.get(name) == Some(&0.0) => {
            format!(" (at most {high})")
        }
        Some([Some(low), Some(high)]) => format!(" ({})", words::between(low, high)),
        _ => String::new(),
    };
    let is_mass = parameter_order(&candidate.record.model, name).0 == 0;
    match candidate.record.certainty(name) {
        Some(Certainty::Determined) => interval,
        None if is_mass || !interval.is_empty() => interval,
        None => " (given)".to_owned(),
        Some(Certainty::OrderOfMagnitude | Certainty::Open) if interval.is_empty() => " (not determined)".to_owned(),
        Some(Certainty::OrderOfMagnitude | Certainty::Open) => format!("{interval} not determined"),
    }
}

/// What the parameters of a knot of a force-deflection curve begin with.
const KNOT: &str = "knot";

/// `as one spring k 769 kN/m (750 to 790), knots to 750 mm`: of a candidate with deflections and forces. One
/// stiffness for a curve on one mass is that of the spring with the energy and the crush of the test.
fn curve(run: &Run, candidate: &CandidateResult) -> Option<String> {
    let parameters = &candidate.record.parameters;
    let deflections_m = (1..).map_while(|number| parameters.get(&format!("{KNOT}{number}_m")));
    let last_m = deflections_m.last()?;
    let knots = format!("knots to {}", words::quantity(MILLI * last_m, 0, "mm"));
    let spring = run.one_spring().filter(|_| parameters.contains_key("mass_kg"));
    Some(match spring {
        Some(spring) => format!("as one spring k {}, {knots}", spring.with_interval()),
        None => knots,
    })
}
