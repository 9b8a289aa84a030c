//! A model as a picture: barrier, masses, springs, dampers and curves, each with its value and interval.

mod layout;
mod motion;
mod parts;
mod svg;

use crate::drawing::escape::html;
use crate::drawing::numbers::{KM_PER_H_PER_M_PER_S, MILLI, NBSP};
use crate::findings::{CandidateResult, Ranking, Run, Status, capitalised};
use crate::frame::caption;
use crate::words;
use crumple_artifact::records::SimulationV1;
use layout::layout;
use motion::motion;
use parts::{ElementPart, Glyph, parts};

use crate::figures::crash::curves::view_ms;

/// What the pictures look like, for the style of the page.
pub(super) const STYLE: &str = include_str!("style.css");

/// Role of the recommended candidate.
pub(super) const RECOMMENDED: &str = "Recommended for predictions";
/// Role of the candidate that follows the record best.
pub(super) const CLOSEST: &str = "Closest to the record";

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking, status: Option<Status>) {
    let shown = shown(run, ranking);
    if shown.is_empty() {
        return;
    }
    out.push_str("<section id=\"model\" aria-labelledby=\"model-title\">\n<h2 id=\"model-title\">The model</h2>\n");
    for (number, (role, candidate)) in shown.iter().enumerate() {
        // Nothing is recommended that is not to be used.
        let is_recommended = ranking.best.as_ref() == Some(&candidate.id);
        let role = if status == Some(Status::DoNotUse) && is_recommended { "In doubt" } else { *role };
        // What nobody is told to use waits.
        let (open, close) = match number {
            0 => (String::new(), ""),
            _ => (format!("<details class=\"no-paper\"><summary>{}</summary>\n", html(role)), "</details>\n"),
        };
        out.push_str(&open);
        write_one(out, run, number + 1, role, candidate);
        out.push_str(close);
    }
    out.push_str(&caption(
        "Under a value its 95 % interval, if the model is true and mass, speed and gain are as stated. How often such \
         intervals hold the truth: docs/calibration.md. Determined: known within a factor of ten. Dashed and “?”: not \
         determined. Zigzag: spring; box and piston: damper; small curve: force over deflection.",
    ));
    out.push_str("</section>\n");
}

/// The candidates to show, with what each is: the recommended and the closest, once where they are one; without either
/// the leading one.
fn shown<'a>(run: &'a Run, ranking: &Ranking) -> Vec<(&'static str, &'a CandidateResult)> {
    let recommended = ranking.best.as_deref();
    let closest = run.recommendation.as_ref().and_then(|choice| choice.closest.as_deref());
    let leading = || ranking.leading(run).filter(|_| recommended.is_none()).map(|candidate| candidate.id.as_str());
    let closest = closest.or_else(leading);
    let names = match (recommended, closest) {
        (Some(a), Some(b)) if a == b => vec![("Recommended, and closest to the record", a)],
        (Some(a), Some(b)) => vec![(RECOMMENDED, a), (CLOSEST, b)],
        (None, Some(b)) => vec![("Closest to the record; none is recommended", b)],
        (Some(a), None) => vec![(RECOMMENDED, a)],
        (None, None) => Vec::new(),
    };
    names.into_iter().filter_map(|(role, id)| Some((role, run.candidate(id)?))).collect()
}

fn write_one(out: &mut String, run: &Run, number: usize, role: &str, candidate: &CandidateResult) {
    let name = run.name_of(&candidate.id);
    out.push_str(&format!("<figure class=\"model\">\n<h3>{}: {}</h3>\n", html(role), html(&name)));
    match parts(candidate) {
        Some(parts) => {
            let speed = run.test.impact_speed_m_per_s.filter(|_| run.joint.is_none());
            let speed = speed.map(|v| words::quantity(KM_PER_H_PER_M_PER_S * v, 1, "km/h").replace(NBSP, " "));
            let layout = layout(&parts);
            let motion = view_ms(run).and_then(|[_, until_ms]| motion(candidate, &layout, until_ms));
            out.push_str(&svg::drawing(
                number,
                &capitalised(&name),
                &parts,
                &layout,
                motion.as_ref(),
                speed.as_deref(),
            ));
        }
        None => out.push_str("<p>No structure of masses and elements belongs to this model.</p>\n"),
    }
    // Of the first model, whichever it is, the one number that people ask for; it is the same of all.
    let spring = one_spring(run, candidate).filter(|_| number == 1);
    let spring = spring.map_or_else(String::new, |spring| format!("<span class=\"one-spring\">{spring}</span> "));
    out.push_str(&format!("<figcaption>{spring}{}</figcaption>\n</figure>\n", words(run, candidate)));
}

/// How well it is known, how well it follows the test, and what the second sensor says.
fn words(run: &Run, candidate: &CandidateResult) -> String {
    let mut sentences = Vec::new();
    let intervals = candidate.about_intervals();
    sentences.extend(candidate.certainties().words().map(|text| format!("{text}{intervals}.")));
    if let Some(simulation) = &candidate.simulation {
        sentences.extend(against_its_test(run, simulation));
        if let Some(fit) = candidate.fit_percent() {
            sentences.push(format!("Displacement fit {}{NBSP}%.", words::decimals(fit, 1)));
        }
        let rating = simulation.ratings.iter().find(|r| r.definition_id == "iso18571" && r.quantity == "acceleration");
        if let Some((rating, value)) = rating.and_then(|rating| Some((rating, rating.value?))) {
            let grade = rating.note.as_deref().map(|note| format!(" ({})", html(note)));
            let (value, grade) = (words::decimals(value, 2), grade.unwrap_or_default());
            sentences.push(format!("ISO/TS 18571 of the acceleration {value}{grade}."));
        }
    }
    // Where more than the pulse has chosen, the sensors are named.
    let chosen = run.recommendation.as_ref().filter(|choice| choice.recommended.as_ref() == Some(&candidate.id));
    let deciding = chosen.map(|choice| choice.decided_by.as_slice()).filter(|channels| channels.len() > 1);
    sentences.extend(deciding.map(|channels| {
        let sensors: Vec<String> = channels.iter().map(|channel| sensor_with_place(run, channel)).collect();
        format!("Chosen by sensors {}.", sensors.join(", "))
    }));
    if let Some(other) = &candidate.record.equivalent_to {
        sentences.push(format!("{} gives the same record on this sensor.", html(&capitalised(&run.name_of(other)))));
    }
    sentences.extend(second_sensor(run, candidate));
    sentences.join(" ")
}

/// `Model (test): crush 750 mm (750), time 73.4 ms (74.2), restitution 0.17 (0.16).` Nothing of a record without a
/// crush.
fn against_its_test(run: &Run, simulation: &SimulationV1) -> Option<String> {
    let pair = |what: &str, model: Option<f64>, error: Option<f64>, (factor, places, unit): (f64, usize, &str)| {
        let (model, error) = model.zip(error)?;
        let test = words::cell(factor * (model - error), places, unit);
        Some(format!("{what} {} ({test})", words::quantity(factor * model, places, unit)))
    };
    let measured = run.events.as_ref().and_then(|events| events.coefficient_of_restitution);
    // Of a record that ends before the rebound does, a model that rebounds faster is off by nothing known.
    let restitution = simulation.coefficient_of_restitution;
    let off = restitution.zip(measured).map(|(model, test)| model - test);
    let off = off.filter(|off| !run.is_rebound_cut() || *off < 0.0);
    let (crush, time) = (simulation.dynamic_crush_m, simulation.time_of_dynamic_crush_s);
    let crush = pair("crush", crush, simulation.dynamic_crush_error_m, (MILLI, 0, "mm"));
    let time = pair("time", time, simulation.time_of_dynamic_crush_error_s, (MILLI, 1, "ms"));
    let restitution = pair("restitution", restitution, off, (1.0, 2, "")).filter(|_| crush.is_some() || time.is_some());
    let pairs: Vec<String> = [crush, time, restitution].into_iter().flatten().collect();
    (!pairs.is_empty()).then(|| format!("Model (test): {}.", pairs.join(", ")))
}

/// One stiffness for a model of one mass whose spring is a curve of knots: that of the spring with the energy and the
/// crush of the test.
fn one_spring(run: &Run, candidate: &CandidateResult) -> Option<String> {
    let drawn = parts(candidate)?;
    let has_a_curve = matches!(drawn.elements.first(), Some(ElementPart { glyph: Glyph::Curve(_), .. }));
    let has_a_stiffness = candidate.record.parameters.contains_key("loading_stiffness_n_per_m");
    if drawn.masses.len() > 1 || !has_a_curve || has_a_stiffness {
        return None;
    }
    let stiffness = run.one_spring()?.with_interval();
    Some(format!("One spring with the energy and the crush of the test: <strong>k{NBSP}={NBSP}{stiffness}</strong>."))
}

/// `96 (engine, top)`.
fn sensor_with_place(run: &Run, channel: &str) -> String {
    let location = run.test.channel(channel).map(|c| c.location.as_str()).filter(|text| !text.is_empty());
    html(&location.map_or_else(|| channel.to_owned(), |location| format!("{channel} ({location})")))
}

/// What sensors on the masses in front say of a model with several masses.
fn second_sensor(run: &Run, candidate: &CandidateResult) -> Option<String> {
    let masses = parts(candidate)?.masses.len();
    if masses < 2 {
        return None;
    }
    let place = |channel: &str| sensor_with_place(run, channel);
    let in_front = |mass: u32| (mass as usize) < masses;
    let fitted = candidate.record.fit.iter().flat_map(|fit| &fit.sensors).filter(|sensor| in_front(sensor.mass));
    let mut said: Vec<String> = fitted
        .map(|sensor| {
            let (factor, unit) = match sensor.quantity.as_str() {
                "displacement" => (MILLI, "mm"),
                "velocity" => (KM_PER_H_PER_M_PER_S, "km/h"),
                _ => (1.0, "m/s²"),
            };
            format!(
                "Sensor {} on mass {}, fitted too: {} off by {} rms.",
                place(&sensor.channel),
                sensor.mass,
                html(&sensor.quantity),
                words::quantity(factor * sensor.rmse, 1, unit)
            )
        })
        .collect();
    let others = candidate.simulation.iter().flat_map(|s| &s.other_sensors).filter(|sensor| in_front(sensor.mass));
    said.extend(others.map(|sensor| {
        let fit = sensor.fit_percent.map(|fit| format!(", fit {}", words::quantity(fit, 1, "%")));
        format!(
            "Sensor {} on mass {}, which the fit did not see: displacement off by {} rms{}.",
            place(&sensor.channel),
            sensor.mass,
            words::quantity(MILLI * sensor.rmse_displacement_m, 1, "mm"),
            fit.unwrap_or_default()
        )
    }));
    if said.is_empty() {
        let where_none_is = if masses == 2 { "its front mass" } else { "the masses in front" };
        said.push(format!("No sensor on {where_none_is}: nothing in this record tests how the mass is divided."));
    }
    Some(said.join(" "))
}
