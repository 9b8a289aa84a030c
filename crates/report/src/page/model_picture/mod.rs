//! A model as a picture: barrier, masses, springs, dampers and curves, each with its value and interval.
//! Uses results and text.

mod layout;
mod parts;
mod svg;

use crumple_drawing::escape::html;
use crumple_drawing::numbers::{ABSENT, KM_PER_H_PER_M_PER_S, MILLI, NBSP, decimals, signed};
use parts::parts;

use crate::text::names::candidate_name;
use crate::{CandidateResult, Ranking, Run};

/// What the pictures look like, for the style of the page.
pub(super) const STYLE: &str = include_str!("style.css");

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    let shown = shown(run, ranking);
    if shown.is_empty() {
        return;
    }
    out.push_str("<section id=\"model\" aria-labelledby=\"model-title\">\n<h2 id=\"model-title\">The model</h2>\n");
    out.push_str(if shown.len() == 1 { "<div class=\"models alone\">\n" } else { "<div class=\"models\">\n" });
    for (number, (role, candidate)) in shown.iter().enumerate() {
        write_one(out, run, number + 1, role, candidate);
    }
    out.push_str(
        "</div>\n<p class=\"caption\">Under a value its 95 % interval if the model is true. Dashed and “?”: this \
         record does not determine it. Zigzag: spring; box and piston: damper; small curve: force over \
         deflection.</p>\n</section>\n",
    );
}

/// The candidates to show, with what each is: the recommended and the closest, once where they are one; without either
/// the one that follows the displacement best.
fn shown<'a>(run: &'a Run, ranking: &Ranking) -> Vec<(String, &'a CandidateResult)> {
    let recommended = ranking.best.as_deref();
    let closest = run.recommendation.as_ref().and_then(|choice| choice.closest.as_deref());
    let closest = closest.or_else(|| ranking.order.first().map(String::as_str));
    let names = match (recommended, closest) {
        (Some(a), Some(b)) if a == b => vec![("Recommended, and closest to the record".to_owned(), a)],
        (Some(a), Some(b)) => {
            vec![("Recommended for predictions".to_owned(), a), ("Closest to the record".to_owned(), b)]
        }
        (None, Some(b)) => vec![("Closest to the record; none is recommended".to_owned(), b)],
        (Some(a), None) => vec![("Recommended for predictions".to_owned(), a)],
        (None, None) => Vec::new(),
    };
    names.into_iter().filter_map(|(role, id)| Some((role, run.candidate(id)?))).collect()
}

fn write_one(out: &mut String, run: &Run, number: usize, role: &str, candidate: &CandidateResult) {
    let name = candidate_name(&candidate.id);
    out.push_str(&format!("<figure class=\"model\">\n<h3>{}: {}</h3>\n", html(role), html(&name)));
    match parts(candidate) {
        Some(parts) => {
            let speed = run.test.impact_speed_m_per_s;
            let speed = speed.map(|v| format!("{} km/h", decimals(KM_PER_H_PER_M_PER_S * v, 1)));
            out.push_str(&svg::drawing(number, &name, &parts, speed.as_deref()));
        }
        None => out.push_str("<p>No structure of masses and elements belongs to this model.</p>\n"),
    }
    out.push_str(&format!("<figcaption>{}</figcaption>\n</figure>\n", words(run, candidate)));
}

/// How well it is known, how well it follows the test, and what the second sensor says.
fn words(run: &Run, candidate: &CandidateResult) -> String {
    let mut sentences = Vec::new();
    sentences.extend(candidate.certainties().words(run.language).map(|text| format!("{text}.")));
    if let Some(simulation) = &candidate.simulation {
        let error = |value: Option<f64>| value.map_or_else(|| ABSENT.to_owned(), |x| signed(MILLI * x, 1));
        sentences.push(format!(
            "Crush {}{NBSP}mm, t<sub>m</sub> {}{NBSP}ms off the test; displacement fit {}{NBSP}%.",
            error(simulation.dynamic_crush_error_m),
            error(simulation.time_of_dynamic_crush_error_s),
            candidate.fit_percent().map_or_else(|| ABSENT.to_owned(), |fit| decimals(fit, 2))
        ));
        let rating = simulation.ratings.iter().find(|r| r.definition_id == "iso18571" && r.quantity == "acceleration");
        if let Some((rating, value)) = rating.and_then(|rating| Some((rating, rating.value?))) {
            let grade = rating.note.as_deref().map_or_else(String::new, |grade| format!(" ({})", html(grade)));
            sentences.push(format!("ISO/TS 18571 of the acceleration {}{grade}.", decimals(value, 2)));
        }
    }
    if let Some(other) = &candidate.record.equivalent_to {
        sentences.push(format!("{} gives the same record on this sensor.", html(&candidate_name(other))));
    }
    sentences.extend(second_sensor(run, candidate));
    sentences.join(" ")
}

/// What sensors on the masses in front say of a model with several masses.
fn second_sensor(run: &Run, candidate: &CandidateResult) -> Option<String> {
    let masses = parts(candidate)?.masses.len();
    if masses < 2 {
        return None;
    }
    let place = |channel: &str| {
        let location = run.test.channel(channel).map(|c| c.location.as_str()).filter(|text| !text.is_empty());
        html(&location.map_or_else(|| channel.to_owned(), |location| format!("{channel} ({location})")))
    };
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
                "Sensor {} on mass {}, fitted too: {} off by {}{NBSP}{unit} rms.",
                place(&sensor.channel),
                sensor.mass,
                html(&sensor.quantity),
                decimals(factor * sensor.rmse, 1)
            )
        })
        .collect();
    let others = candidate.simulation.iter().flat_map(|s| &s.other_sensors).filter(|sensor| in_front(sensor.mass));
    said.extend(others.map(|sensor| {
        let fit = sensor.fit_percent.map_or_else(String::new, |fit| format!(", fit {}{NBSP}%", decimals(fit, 1)));
        format!(
            "Sensor {} on mass {}, which the fit did not see: displacement off by {}{NBSP}mm rms{fit}.",
            place(&sensor.channel),
            sensor.mass,
            decimals(MILLI * sensor.rmse_displacement_m, 1)
        )
    }));
    if said.is_empty() {
        said.push(format!(
            "No sensor on {}: nothing in this record tests how the mass is divided.",
            if masses == 2 { "its front mass" } else { "the masses in front" }
        ));
    }
    Some(said.join(" "))
}
