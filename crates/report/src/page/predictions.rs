//! Impacts that were not made, as the models of the test predict them; tests that were, as the others predict them.

use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, G_PER_M_PER_S2, KM_PER_H_PER_M_PER_S, MILLI};
use crate::findings::{LeftOut, Ranking, Run, Status, TestOfJointModel, candidate_name};
use crate::page::{UNFOLDED, folded};
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;
use crumple_artifact::records::{AnsweredByV1, PredictionV1};

use crate::frame::{Column, table};

/// Predictions on the first screen.
const SHOWN_FIRST: usize = 5;

/// What the recommended model gives for the impacts that were asked for, else at the standing speeds, in a few columns;
/// nothing where nothing is to be used.
pub(super) fn write_first(out: &mut String, run: &Run, ranking: &Ranking, status: Option<Status>) {
    let of_best = |p: &&PredictionV1| Some(&p.candidate) == ranking.best.as_ref() && status != Some(Status::DoNotUse);
    let all: Vec<&PredictionV1> = run.predictions.iter().filter(of_best).collect();
    let asked: Vec<&PredictionV1> = all.iter().filter(|prediction| prediction.asked).copied().collect();
    let shown = if asked.is_empty() { &all } else { &asked };
    if shown.is_empty() {
        return;
    }
    let texts = &PHRASES.predictions;
    let level = shown.iter().flat_map(|prediction| &prediction.intervals).map(|interval| interval.level).next();
    let level = level.map_or_else(String::new, |level| words::quantity(1e2 * level, 0, "%"));
    let columns = [
        Column::number(texts.speed_head),
        Column::number(texts.crush_head),
        Column::number(&level),
        Column::number(texts.peak_head),
        Column::text(texts.range_head),
    ];
    let title = texts.at_other_speeds;
    out.push_str(&format!("<section id=\"other-speeds\">\n<h2>{title}</h2>\n{}", table("", &columns)));
    shown.iter().take(SHOWN_FIRST).for_each(|prediction| first_row(out, run, prediction));
    let more = if all.len() > SHOWN_FIRST.min(shown.len()) {
        format!("<p><a href=\"#predictions\">{}</a></p>\n", texts.all_predictions)
    } else {
        String::new()
    };
    let is_by_record = |prediction: &&&PredictionV1| prediction.peak_by == Some(AnsweredByV1::Record);
    let by_record = shown.iter().take(SHOWN_FIRST).find(is_by_record);
    let caption = by_record.map_or_else(String::new, |_| format!("<p class=\"caption\">{}</p>\n", texts.peak_caption));
    out.push_str(&format!("</tbody>\n</table></div>\n{caption}{more}</section>\n"));
}

fn first_row(out: &mut String, run: &Run, prediction: &PredictionV1) {
    let texts = &PHRASES.predictions;
    let mm = |m: f64| words::decimals(MILLI * m, 0);
    let or_absent = |text: Option<String>| text.unwrap_or_else(|| ABSENT.to_owned());
    let interval = prediction.intervals.iter().find(|interval| interval.name == "dynamic_crush_m");
    let range = match prediction.extrapolates {
        true => texts.beyond,
        false if run.is_as_tested(prediction) => texts.as_tested,
        false => texts.inside,
    };
    let phrases = &PHRASES.conclusion;
    let is_other_mass = !run.is_of_own_mass(prediction);
    let mass = is_other_mass.then(|| words::quantity(prediction.mass_kg, 0, "kg"));
    let mass = mass.map(|mass| fill(phrases.with_mass, &[("mass", mass)]));
    let partner = prediction.partner.as_ref();
    let partner = partner.map(|partner| fill(phrases.against_partner, &[("partner", html(partner))]));
    let other = [mass, partner].into_iter().flatten().collect::<String>();
    let other = if other.is_empty() { other } else { format!("<br><small>{}</small>", other.trim_start()) };
    let peak = prediction.peak_acceleration_m_per_s2.map(|peak| {
        let peak = words::decimals(G_PER_M_PER_S2 * peak, 0);
        match prediction.peak_by {
            Some(AnsweredByV1::Record) => fill(texts.by_the_record, &[("peak", peak)]),
            _ => peak,
        }
    });
    out.push_str(&format!(
        "<tr><td class=\"n\">{}{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
         <td{}>{range}</td></tr>\n",
        words::at_most(KM_PER_H_PER_M_PER_S * prediction.impact_speed_m_per_s, 1),
        other,
        or_absent(prediction.dynamic_crush_m.map(mm)),
        or_absent(interval.map(|interval| words::between(&mm(interval.low), &mm(interval.high)))),
        or_absent(peak),
        if prediction.extrapolates { " class=\"no\"" } else { "" },
    ));
}

pub(super) fn write(out: &mut String, run: &Run, status: Option<Status>) {
    if run.predictions.is_empty() {
        return;
    }
    let texts = &PHRASES.predictions;
    let columns = [
        Column::number(texts.speed),
        Column::number(texts.mass),
        Column::text(texts.model),
        Column::number(texts.dynamic_crush),
        Column::number(texts.time),
        Column::number(texts.change),
        Column::number("e"),
        Column::number(texts.peak),
        Column::number(texts.olc),
        Column::text(texts.remarks_head),
    ];
    out.push_str(&format!("<section id=\"predictions\">\n{}{}", folded(texts.title), table("", &columns)));
    for prediction in &run.predictions {
        row(out, prediction, status);
    }
    out.push_str(&format!("</tbody>\n</table></div>\n<p class=\"caption\">{}</p>\n{UNFOLDED}", texts.caption));
}

fn row(out: &mut String, prediction: &PredictionV1, status: Option<Status>) {
    let texts = &PHRASES.predictions;
    let cell = |value: Option<f64>, name: &str, factor: f64, digits: usize| {
        let Some(value) = value else { return format!("<td class=\"n\">{ABSENT}</td>") };
        let interval = prediction.intervals.iter().find(|interval| interval.name == name).map(|interval| {
            let end = |end: f64| words::decimals(factor * end, digits);
            let ends = fill(texts.interval, &[("low", end(interval.low)), ("high", end(interval.high))]);
            format!("<br><span tabindex=\"0\" title=\"{}\">{ends}</span>", html(&interval.interval_by))
        });
        format!("<td class=\"n\">{}{}</td>", words::decimals(factor * value, digits), interval.unwrap_or_default())
    };
    let remarks: String = prediction.notes.iter().map(|note| format!("<li>{}</li>", html(note))).collect();
    let partner = partner(prediction);
    let roles = &PHRASES.candidates;
    let role = |name: &String| match name.as_str() {
        "recommended" if status == Some(Status::DoNotUse) => PHRASES.model.in_doubt.to_lowercase(),
        "recommended" => roles.badge_recommended.to_owned(),
        "simplest" => roles.badge_simplest.to_owned(),
        "closest" => roles.badge_closest.to_owned(),
        other => other.to_owned(),
    };
    let names: Vec<String> = prediction.names.iter().map(role).collect();
    let names = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
    let asked = if prediction.asked { format!("<br><strong>{}</strong>", texts.asked) } else { String::new() };
    out.push_str(&format!(
        "<tr{}><td class=\"n\">{}{asked}</td><td class=\"n\">{}</td><td>{}{}{partner}</td>{}{}{}{}{}{}\
         <td>{}</td></tr>\n",
        if prediction.recommended { " class=\"best\"" } else { "" },
        words::decimals(KM_PER_H_PER_M_PER_S * prediction.impact_speed_m_per_s, 1),
        words::decimals(prediction.mass_kg, 0),
        html(&candidate_name(&prediction.candidate)),
        html(&names),
        cell(prediction.dynamic_crush_m, "dynamic_crush_m", MILLI, 0),
        cell(prediction.time_of_dynamic_crush_s, "time_of_dynamic_crush_s", MILLI, 1),
        cell(prediction.delta_v_m_per_s, "delta_v_m_per_s", KM_PER_H_PER_M_PER_S, 1),
        cell(prediction.coefficient_of_restitution, "coefficient_of_restitution", 1.0, 3),
        cell(prediction.peak_acceleration_m_per_s2, "peak_acceleration_m_per_s2", G_PER_M_PER_S2, 1),
        cell(prediction.olc_m_per_s2, "olc_m_per_s2", G_PER_M_PER_S2, 1),
        if remarks.is_empty() {
            String::new()
        } else {
            format!(
                "<details><summary>{}</summary><ul>{remarks}</ul></details>",
                if prediction.extrapolates { texts.extrapolates } else { texts.remarks }
            )
        },
    ));
}

/// What the vehicle meets and what that makes of the other, and of the occupant; nothing at the wall without one.
fn partner(prediction: &PredictionV1) -> String {
    let texts = &PHRASES.predictions;
    let number = |value: Option<f64>, factor: f64, digits: usize| {
        value.map_or_else(|| ABSENT.to_owned(), |value| words::decimals(factor * value, digits))
    };
    let mut lines = Vec::new();
    if let Some(both) = &prediction.collision {
        let filled = [
            ("partner", html(prediction.partner.as_deref().unwrap_or(texts.a_partner))),
            ("mass", words::decimals(both.partner_mass_kg, 0)),
            ("closing", words::decimals(KM_PER_H_PER_M_PER_S * both.closing_speed_m_per_s, 1)),
            ("common", number(both.common_velocity_m_per_s, KM_PER_H_PER_M_PER_S, 1)),
            ("mutual", number(both.mutual_crush_m, MILLI, 0)),
            ("crush", number(both.partner_crush_m, MILLI, 0)),
            ("energy", number(both.absorbed_j, 1e-3, 1)),
            ("energy_of_partner", number(both.partner_absorbed_j, 1e-3, 1)),
            ("change", number(both.partner_delta_v_m_per_s, KM_PER_H_PER_M_PER_S, 1)),
        ];
        lines.push(fill(texts.collision, &filled));
    }
    if let Some(occupant) = &prediction.occupant {
        let filled = [
            ("peak", words::decimals(G_PER_M_PER_S2 * occupant.peak_acceleration_m_per_s2, 1)),
            ("excursion", words::decimals(MILLI * occupant.largest_excursion_m, 0)),
            ("share", number(occupant.ride_down_share, 1e2, 0)),
        ];
        lines.push(fill(texts.occupant, &filled));
    }
    lines.iter().map(|line| format!("<br><small>{line}</small>")).collect()
}

/// The tests of a joint model as measured, and what the others say of each.
pub(super) fn write_left_out(out: &mut String, run: &Run) {
    let Some(joint) = &run.joint else { return };
    let texts = &PHRASES.joint;
    let columns = [
        Column::text(texts.test),
        Column::number(texts.mass),
        Column::number(texts.speed),
        Column::number(texts.crush),
        Column::number(texts.time),
        Column::number(texts.restitution),
        Column::number(texts.crush_error),
        Column::number(texts.time_error),
        Column::number(texts.peak_error),
        Column::number(texts.rating),
        Column::text(texts.held),
        Column::text(texts.by),
    ];
    out.push_str(&format!("<section id=\"tests\">\n<h2>{}</h2>\n{}", texts.title, table("", &columns)));
    joint.tests.iter().for_each(|test| test_row(out, test));
    out.push_str(&format!("</tbody>\n</table></div>\n<p class=\"caption\">{}</p>\n</section>\n", texts.caption));
}

fn test_row(out: &mut String, joint: &TestOfJointModel) {
    let (texts, page) = (&PHRASES.joint, &PHRASES.page);
    let number = |value: Option<f64>, text: &dyn Fn(f64) -> String| {
        format!("<td class=\"n\">{}</td>", value.map_or_else(|| ABSENT.to_owned(), text))
    };
    let TestOfJointModel { test, left_out } = joint;
    out.push_str(&format!("<tr><th scope=\"row\">{}</th>", html(&test.name)));
    out.push_str(&number(Some(test.mass_kg), &|v| words::decimals(v, 0)));
    out.push_str(&number(Some(test.impact_speed_m_per_s), &|v| words::decimals(KM_PER_H_PER_M_PER_S * v, 1)));
    out.push_str(&number(test.dynamic_crush_m, &|v| words::decimals(MILLI * v, 1)));
    out.push_str(&number(test.time_of_dynamic_crush_s, &|v| words::decimals(MILLI * v, 1)));
    out.push_str(&number(test.coefficient_of_restitution, &|v| words::decimals(v, 3)));
    match (left_out, joint.against()) {
        (LeftOut::Predicted(prediction), Some(against)) => {
            let percent = |v: f64| words::signed(v, 1);
            out.push_str(&number(against.dynamic_crush_error_percent, &percent));
            out.push_str(&number(against.time_of_dynamic_crush_error_percent, &percent));
            out.push_str(&number(against.peak_acceleration_error_percent, &percent));
            out.push_str(&number(against.iso18571_score, &|v| words::decimals(v, 2)));
            let held = if against.held.iter().any(|name| name == "dynamic_crush_m") { page.yes } else { page.no };
            let class = if against.missed_crush_percent().is_some() { " class=\"no\"" } else { "" };
            out.push_str(&format!("<td{class}>{held}</td><td>{}</td>", html(&candidate_name(&prediction.candidate))));
        }
        (LeftOut::NotPredicted(why), _) => {
            out.push_str(&format!("<td colspan=\"6\">{}</td>", fill(texts.not_predicted, &[("why", html(why))])));
        }
        _ => out.push_str(&format!("<td colspan=\"6\">{ABSENT}</td>")),
    }
    out.push_str("</tr>\n");
}
