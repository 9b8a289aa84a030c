//! Impacts that were not made, as the models of the test predict them; tests that were, as the others predict them.

use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, G_PER_M_PER_S2, KILO, KM_PER_H_PER_M_PER_S, MILLI};
use crate::findings::{LeftOut, Ranking, Run, Status, TestOfJointModel, capitalised, with_mass_against};
use crate::page::{UNFOLDED, folded};
use crate::words;
use crumple_artifact::records::{AnsweredByV1, PredictionV1};
use crumple_signal::display::{self, factor_shown};
use crumple_signal::key_quantities::CRUSH;

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
    let level = shown.iter().flat_map(|prediction| &prediction.intervals).map(|interval| interval.level).next();
    let level = level.map_or_else(String::new, |level| words::quantity(1e2 * level, 0, "%"));
    let columns = [
        Column::number("").of("km/h"),
        Column::number("crush").of("mm"),
        Column::number(&level),
        Column::number("peak, g"),
        Column::text("test"),
    ];
    out.push_str(&format!("<section id=\"other-speeds\">\n<h2>At other speeds</h2>\n{}", table("", &columns)));
    shown.iter().take(SHOWN_FIRST).for_each(|prediction| first_row(out, run, prediction));
    let more = if all.len() > SHOWN_FIRST.min(shown.len()) {
        "<p><a href=\"#predictions\">all predictions</a></p>\n"
    } else {
        ""
    };
    let is_by_record = |prediction: &&&PredictionV1| prediction.peak_by == Some(AnsweredByV1::Record);
    let by_record = shown.iter().take(SHOWN_FIRST).find(is_by_record);
    let caption = by_record
        .map_or("", |_| "<p class=\"caption\">* Peak read from the test up to this energy, not from the model.</p>\n");
    out.push_str(&format!("</tbody>\n</table></div>\n{caption}{more}</section>\n"));
}

/// How a crush is shown in a column with its unit.
fn in_mm() -> (f64, usize, &'static str) {
    let (factor, places, _) = CRUSH.shown();
    (factor, places, "")
}

fn first_row(out: &mut String, run: &Run, prediction: &PredictionV1) {
    let or_absent = |text: Option<String>| text.unwrap_or_else(|| ABSENT.to_owned());
    let interval = prediction.intervals.iter().find(|interval| interval.name == "dynamic_crush_m");
    let ends = interval.map(|interval| (interval.low, interval.high));
    let range = match prediction.extrapolates {
        true => "beyond",
        false if run.is_as_tested(prediction) => "as tested",
        false => "inside",
    };
    let is_other_mass = !run.is_of_own_mass(prediction);
    let mass = is_other_mass.then(|| words::quantity(prediction.mass_kg, 0, "kg"));
    let other = with_mass_against(mass, prediction.partner.as_deref().map(html).as_deref());
    let other = if other.is_empty() { other } else { format!("<br><small>{}</small>", other.trim_start()) };
    let peak = prediction.peak_acceleration_m_per_s2.map(|peak| {
        let peak = words::decimals(G_PER_M_PER_S2 * peak, 0);
        match prediction.peak_by {
            Some(AnsweredByV1::Record) => format!("{peak}*"),
            _ => peak,
        }
    });
    out.push_str(&format!(
        "<tr><td class=\"n\">{}{other}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
         <td{}>{range}</td></tr>\n",
        words::at_most(factor_shown("km/h") * KM_PER_H_PER_M_PER_S * prediction.impact_speed_m_per_s, 1),
        or_absent(prediction.dynamic_crush_m.map(|crush_m| words::rounded(crush_m, ends, in_mm()))),
        or_absent(ends.map(|both| words::ends(both, ends, in_mm()))),
        or_absent(peak),
        if prediction.extrapolates { " class=\"no\"" } else { "" }
    ));
}

pub(super) fn write(out: &mut String, run: &Run, status: Option<Status>) {
    if run.predictions.is_empty() {
        return;
    }
    let columns = [
        Column::number("Speed").of("km/h"),
        Column::number("Mass").of("kg"),
        Column::text("Model"),
        Column::number("Dynamic crush").of("mm"),
        Column::number("t<sub>m</sub>, ms"),
        Column::number("Δv").of("km/h"),
        Column::number("e"),
        Column::number("Peak (CFC 60), g"),
        Column::number("OLC, g"),
        Column::text("Remarks"),
    ];
    out.push_str(&format!("<section id=\"predictions\">\n{}{}", folded("Predictions"), table("", &columns)));
    for prediction in &run.predictions {
        row(out, run, prediction, status);
    }
    out.push_str(&format!(
        "</tbody>\n</table></div>\n<p class=\"caption\">The models of this test at other speeds and masses, against \
         the same wall where nothing else is said. In brackets the 90 % interval: of the parameters as measured, of \
         the inputs, of what adequate models differ by, of a rate effect that one test hardly shows, and of the force \
         beyond the tested crush. Not in it: a part that was not reached, another failure mode, another overlap. \
         Highlighted is the chosen model.</p>\n{UNFOLDED}"
    ));
}

fn row(out: &mut String, run: &Run, prediction: &PredictionV1, status: Option<Status>) {
    let cell = |value: Option<f64>, name: &str, metric: (f64, usize, &'static str)| {
        let Some(value) = value else { return format!("<td class=\"n\">{ABSENT}</td>") };
        let interval = prediction.intervals.iter().find(|interval| interval.name == name);
        let known = interval.map(|interval| (interval.low, interval.high));
        let (factor, digits, _) = display::shown(metric);
        let shown = (factor, digits, "");
        let interval = interval.map(|interval| {
            let ends = words::ends((interval.low, interval.high), known, shown);
            format!("<br><span tabindex=\"0\" title=\"{}\">[{ends}]</span>", html(&interval.interval_by))
        });
        format!("<td class=\"n\">{}{}</td>", words::rounded(value, known, shown), interval.unwrap_or_default())
    };
    let remarks: String = prediction.notes.iter().map(|note| format!("<li>{}</li>", html(note))).collect();
    let partner = partner(prediction);
    let names = prediction.names.iter().map(|name| match name.as_str() {
        "recommended" if status == Some(Status::DoNotUse) => "in doubt",
        other => other,
    });
    let names: Vec<&str> = names.collect();
    let names = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
    let asked = if prediction.asked { "<br><strong>asked for</strong>" } else { "" };
    out.push_str(&format!(
        "<tr{}><td class=\"n\">{}{asked}</td><td class=\"n\">{}</td><td>{}{}{partner}</td>{}{}{}{}{}{}\
         <td>{}</td></tr>\n",
        if prediction.recommended { " class=\"best\"" } else { "" },
        words::cell(KM_PER_H_PER_M_PER_S * prediction.impact_speed_m_per_s, 1, "km/h"),
        words::cell(prediction.mass_kg, 0, "kg"),
        html(&capitalised(&run.name_of(&prediction.candidate))),
        html(&names),
        cell(prediction.dynamic_crush_m, "dynamic_crush_m", (MILLI, 0, "mm")),
        cell(prediction.time_of_dynamic_crush_s, "time_of_dynamic_crush_s", (MILLI, 1, "ms")),
        cell(prediction.delta_v_m_per_s, "delta_v_m_per_s", (KM_PER_H_PER_M_PER_S, 1, "km/h")),
        cell(prediction.coefficient_of_restitution, "coefficient_of_restitution", (1.0, 3, "")),
        cell(prediction.peak_acceleration_m_per_s2, "peak_acceleration_m_per_s2", (G_PER_M_PER_S2, 1, "g")),
        cell(prediction.olc_m_per_s2, "olc_m_per_s2", (G_PER_M_PER_S2, 1, "g")),
        if remarks.is_empty() {
            String::new()
        } else {
            format!(
                "<details><summary>{}</summary><ul>{remarks}</ul></details>",
                if prediction.extrapolates { "extrapolates" } else { "remarks" }
            )
        },
    ));
}

/// What the vehicle meets and what that makes of the other, and of the occupant; nothing at the wall without one.
fn partner(prediction: &PredictionV1) -> String {
    let number = |value: Option<f64>, (factor, digits, unit): (f64, usize, &str)| {
        value.map_or_else(|| ABSENT.to_owned(), |value| words::quantity(factor * value, digits, unit))
    };
    const SPEED: (f64, usize, &str) = (KM_PER_H_PER_M_PER_S, 1, "km/h");
    const LENGTH: (f64, usize, &str) = (MILLI, 0, "mm");
    const ENERGY: (f64, usize, &str) = (KILO, 1, "kJ");
    let mut lines = Vec::new();
    if let Some(both) = &prediction.collision {
        lines.push(format!(
            "against {}, {}, closing at {}: common velocity {}, mutual crush {}, of it the partner’s {}; energy {} and \
             {}; partner’s Δv {}",
            html(prediction.partner.as_deref().unwrap_or("a partner")),
            words::quantity(both.partner_mass_kg, 0, "kg"),
            number(Some(both.closing_speed_m_per_s), SPEED),
            number(both.common_velocity_m_per_s, SPEED),
            number(both.mutual_crush_m, LENGTH),
            number(both.partner_crush_m, LENGTH),
            number(both.absorbed_j, ENERGY),
            number(both.partner_absorbed_j, ENERGY),
            number(both.partner_delta_v_m_per_s, SPEED)
        ));
    }
    if let Some(occupant) = &prediction.occupant {
        lines.push(format!(
            "occupant: peak {}, {} ahead of the compartment, ride-down {}",
            words::quantity(G_PER_M_PER_S2 * occupant.peak_acceleration_m_per_s2, 1, "g"),
            number(Some(occupant.largest_excursion_m), LENGTH),
            number(occupant.ride_down_share, (1e2, 0, "%"))
        ));
    }
    lines.iter().map(|line| format!("<br><small>{line}</small>")).collect()
}

/// The tests of a joint model as measured, and what the others say of each.
pub(super) fn write_left_out(out: &mut String, run: &Run) {
    let Some(joint) = &run.joint else { return };
    let columns = [
        Column::text("Test"),
        Column::number("Mass").of("kg"),
        Column::number("Speed").of("km/h"),
        Column::number("C").of("mm"),
        Column::number("t<sub>m</sub>, ms"),
        Column::number("e"),
        Column::number("ΔC, %"),
        Column::number("Δt<sub>m</sub>, %"),
        Column::number("Δpeak, %"),
        Column::number("ISO/TS 18571"),
        Column::text("C in its 90 % interval"),
        Column::text("By"),
    ];
    out.push_str(&format!(
        "<section id=\"tests\">\n<h2>The tests, and each predicted from the others</h2>\n{}",
        table("", &columns)
    ));
    joint.tests.iter().for_each(|test| test_row(out, run, test));
    out.push_str(
        "</tbody>\n</table></div>\n<p class=\"caption\">Mass, speed, dynamic crush C, its time t<sub>m</sub> and \
         restitution e of each test as measured; then what a model of the other tests alone says of it, less what was \
         measured. This is how far a prediction by these tests was off in tests that were made.</p>\n</section>\n",
    );
}

fn test_row(out: &mut String, run: &Run, joint: &TestOfJointModel) {
    let number = |value: Option<f64>, text: &dyn Fn(f64) -> String| {
        format!("<td class=\"n\">{}</td>", value.map_or_else(|| ABSENT.to_owned(), text))
    };
    let TestOfJointModel { test, left_out } = joint;
    out.push_str(&format!("<tr><th scope=\"row\">{}</th>", html(&test.name)));
    out.push_str(&number(Some(test.mass_kg), &|v| words::cell(v, 0, "kg")));
    out.push_str(&number(Some(test.impact_speed_m_per_s), &|v| words::cell(KM_PER_H_PER_M_PER_S * v, 1, "km/h")));
    out.push_str(&number(test.dynamic_crush_m, &|v| words::cell(MILLI * v, 1, "mm")));
    out.push_str(&number(test.time_of_dynamic_crush_s, &|v| words::decimals(MILLI * v, 1)));
    out.push_str(&number(test.coefficient_of_restitution, &|v| words::decimals(v, 3)));
    match (left_out, joint.against()) {
        (LeftOut::Predicted(prediction), Some(against)) => {
            let percent = |v: f64| words::signed(v, 1);
            out.push_str(&number(against.dynamic_crush_error_percent, &percent));
            out.push_str(&number(against.time_of_dynamic_crush_error_percent, &percent));
            out.push_str(&number(against.peak_acceleration_error_percent, &percent));
            out.push_str(&number(against.iso18571_score, &|v| words::decimals(v, 2)));
            let held = if against.held.iter().any(|name| name == "dynamic_crush_m") { "yes" } else { "no" };
            let class = if against.missed_crush_percent().is_some() { " class=\"no\"" } else { "" };
            out.push_str(&format!(
                "<td{class}>{held}</td><td>{}</td>",
                html(&capitalised(&run.name_of(&prediction.candidate)))
            ));
        }
        (LeftOut::NotPredicted(why), _) => {
            out.push_str(&format!("<td colspan=\"6\">not predicted: {}</td>", html(why)));
        }
        _ => out.push_str(&format!("<td colspan=\"6\">{ABSENT}</td>")),
    }
    out.push_str("</tr>\n");
}
