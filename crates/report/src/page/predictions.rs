//! Impacts that were not made, as the models of the test predict them.

use crumple_artifact::records::PredictionV1;
use crumple_drawing::escape::html;
use crumple_drawing::numbers::{ABSENT, G_PER_M_PER_S2, KM_PER_H_PER_M_PER_S, MILLI, decimals};

use crate::Run;
use crate::text::names::candidate_name;

pub(super) fn write(out: &mut String, run: &Run) {
    if run.predictions.is_empty() {
        return;
    }
    out.push_str(
        "<section>\n<h2>Predictions</h2>\n<div class=\"scroll\"><table>\n<thead><tr>\
         <th scope=\"col\" class=\"n\">Speed, km/h</th><th scope=\"col\" class=\"n\">Mass, kg</th>\
         <th scope=\"col\">Model</th><th scope=\"col\" class=\"n\">Dynamic crush, mm</th>\
         <th scope=\"col\" class=\"n\">t<sub>m</sub>, ms</th><th scope=\"col\" class=\"n\">Δv, km/h</th>\
         <th scope=\"col\" class=\"n\">e</th><th scope=\"col\" class=\"n\">Peak (CFC 60), g</th>\
         <th scope=\"col\" class=\"n\">OLC, g</th><th scope=\"col\">Remarks</th></tr></thead>\n<tbody>\n",
    );
    for prediction in &run.predictions {
        row(out, prediction);
    }
    out.push_str(
        "</tbody>\n</table></div>\n<p class=\"caption\">The models of this test at other speeds and masses, against \
         the same wall where nothing else is said. In brackets the 90 % interval: of the parameters as measured, of \
         the inputs, of what adequate models differ by, of a rate effect that one test hardly shows, and of the force \
         beyond the tested crush. Not in it: a part that was not reached, another failure mode, another overlap. \
         Highlighted is the recommended model.</p>\n</section>\n",
    );
}

fn row(out: &mut String, prediction: &PredictionV1) {
    let cell = |value: Option<f64>, name: &str, factor: f64, digits: usize| {
        let Some(value) = value else { return format!("<td class=\"n\">{ABSENT}</td>") };
        let interval = prediction.intervals.iter().find(|interval| interval.name == name).map(|interval| {
            let (low, high) = (decimals(factor * interval.low, digits), decimals(factor * interval.high, digits));
            format!("<br><span title=\"{}\">[{low} to {high}]</span>", html(&interval.interval_by))
        });
        format!("<td class=\"n\">{}{}</td>", decimals(factor * value, digits), interval.unwrap_or_default())
    };
    let remarks: String = prediction.notes.iter().map(|note| format!("<li>{}</li>", html(note))).collect();
    let partner = partner(prediction);
    let names = if prediction.names.is_empty() { String::new() } else { format!(" ({})", prediction.names.join(", ")) };
    out.push_str(&format!(
        "<tr{}><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}{}{partner}</td>{}{}{}{}{}{}<td>{}</td></tr>\n",
        if prediction.recommended { " class=\"best\"" } else { "" },
        decimals(KM_PER_H_PER_M_PER_S * prediction.impact_speed_m_per_s, 1),
        decimals(prediction.mass_kg, 0),
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
                if prediction.extrapolates { "extrapolates" } else { "remarks" }
            )
        },
    ));
}

/// What the vehicle meets and what that makes of the other, and of the occupant; nothing at the wall without one.
fn partner(prediction: &PredictionV1) -> String {
    let number = |value: Option<f64>, factor: f64, digits: usize| {
        value.map_or_else(|| ABSENT.to_owned(), |value| decimals(factor * value, digits))
    };
    let mut lines = Vec::new();
    if let Some(both) = &prediction.collision {
        lines.push(format!(
            "against {}, {} kg, closing at {} km/h: common velocity {} km/h, mutual crush {} mm, of it the partner’s \
             {} mm; energy {} and {} kJ; partner’s Δv {} km/h",
            html(prediction.partner.as_deref().unwrap_or("a partner")),
            decimals(both.partner_mass_kg, 0),
            decimals(KM_PER_H_PER_M_PER_S * both.closing_speed_m_per_s, 1),
            number(both.common_velocity_m_per_s, KM_PER_H_PER_M_PER_S, 1),
            number(both.mutual_crush_m, MILLI, 0),
            number(both.partner_crush_m, MILLI, 0),
            number(both.absorbed_j, 1e-3, 1),
            number(both.partner_absorbed_j, 1e-3, 1),
            number(both.partner_delta_v_m_per_s, KM_PER_H_PER_M_PER_S, 1),
        ));
    }
    if let Some(occupant) = &prediction.occupant {
        lines.push(format!(
            "occupant: peak {} g, {} mm ahead of the compartment, ride-down {} %",
            decimals(G_PER_M_PER_S2 * occupant.peak_acceleration_m_per_s2, 1),
            decimals(MILLI * occupant.largest_excursion_m, 0),
            number(occupant.ride_down_share, 1e2, 0),
        ));
    }
    lines.iter().map(|line| format!("<br><small>{line}</small>")).collect()
}
