//! Every candidate: parameters, what they answer with, which is best. Folded.

use crumple_artifact::records::Certainty;
use crumple_drawing::escape::html;
use crumple_drawing::numbers::{ABSENT, MILLI, NBSP, decimals, digits_of_interval, signed, significant};

use crate::text::names::candidate_name;
use crate::text::parameters::{parameter, parameter_order};
use crate::{CandidateResult, Ranking, Run};

use super::uncertainty;

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    if run.candidates.is_empty() {
        return;
    }
    out.push_str(
        "<details><summary>Every candidate with its parameters and remarks</summary>\n\
         <div class=\"scroll\"><table class=\"candidates\">\n\
         <thead><tr><th scope=\"col\">Rank</th><th scope=\"col\">Model and method</th><th scope=\"col\">Parameters</th>\
         <th scope=\"col\"><abbr title=\"No parameter is negative: a passive structure.\">Physical</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"100 (1 − |x − x̂| / |x − mean x|) of the displacement over the \
         compared window.\">Fit, %</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Root mean square displacement error over the compared \
         window.\">RMSE, mm</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Corrected Akaike criterion of the displacement error over the \
         same window, at the same number of independent samples for all: lower is better, it charges for every \
         parameter.\">AICc</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Dynamic crush of the model minus that of the test.\">ΔC, \
         mm</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Time of dynamic crush of the model minus that of the \
         test.\">Δt<sub>m</sub>, ms</abbr></th>\
         </tr></thead>\n<tbody>\n",
    );
    let mut rows: Vec<&CandidateResult> = run.candidates.iter().collect();
    rows.sort_by_key(|candidate| ranking.place(&candidate.id).unwrap_or(usize::MAX));
    for candidate in rows {
        row(out, candidate, ranking);
    }
    out.push_str("</tbody>\n</table></div>\n");
    if let Some(supported) = ranking.best_of_matching(run) {
        let dual = supported.record.equivalent_to.as_deref().map_or_else(String::new, |other| {
            format!(" and its dual {}, which this sensor cannot tell from it", html(&candidate_name(other)))
        });
        let fit = supported.fit_percent();
        out.push_str(&format!(
            "<p class=\"caption\">Of the solutions of coefficient matching the simulation supports {}{dual}: fit {} \
             %{}.</p>\n",
            html(&candidate_name(&supported.id)),
            fit.map_or_else(|| ABSENT.to_owned(), |fit| decimals(fit, 2)),
            if supported.record.physical { "" } else { "; it is not a passive structure" },
        ));
    }
    out.push_str(match ranking.best {
        _ if run.recommendation.is_some() => {
            "<p class=\"caption\">Ranked by the fit of the displacement, the model measured as the record was; AICc \
             stands beside it, over the same window, for information. Highlighted is the model recommended for \
             predictions, which need not be the one that follows this record closest: the list above says why. A \
             dual gives exactly the same record on this sensor and so the same figures.</p>\n"
        }
        Some(_) => {
            "<p class=\"caption\">Ranked by the fit of the displacement, the model measured as the record was; AICc \
             stands beside it, over the same window, for information. Highlighted is the best that is physical, has no \
             parameter left on a bound of its search other than zero, the limit of what is physical, and a fit within \
             0.1 points of the best such candidate; of those the one with the fewest parameters left open by the \
             record, then the one with the fewest parameters. A dual gives exactly the same record on this sensor and \
             so the same figures.</p>\n"
        }
        None => {
            "<p class=\"caption\">No candidate is called the best: that takes a physical candidate without a parameter \
             on a bound that explains at least half of the displacement; zero is no such bound, but the limit of what \
             is physical.</p>\n"
        }
    });
    if run.candidates.iter().any(|candidate| candidate.record.uncertainty.is_some()) {
        out.push_str(
            "<p class=\"caption\">± is one standard deviation, from the misfit and the sensitivities at the fit; “95 \
             %” is the interval that holds the value in 95 of 100 such records if the model is true and mass, speed, \
             gain and the division of the mass are exact, “open” where the record does not bound it. It is far wider \
             than two standard deviations where the misfit is worth few independent samples (see the remarks), and not \
             symmetric. Profile, bootstrap and uncertain inputs, where asked for, are among a \
             candidate's remarks.</p>\n",
        );
    }
    out.push_str("</details>\n");
}

fn row(out: &mut String, candidate: &CandidateResult, ranking: &Ranking) {
    let CandidateResult { id, record, simulation, .. } = candidate;
    let best = ranking.best.as_deref() == Some(id);
    let place = ranking.place(id).map_or_else(|| ABSENT.to_owned(), |place| place.to_string());
    let mut about = format!("<strong>{}</strong><br><code>{}</code>", html(&candidate_name(id)), html(id));
    if let Some(other) = &record.equivalent_to {
        about.push_str(&format!(
            "<br><span class=\"dual\">dual of {}: same record</span>",
            html(&candidate_name(other))
        ));
    }
    let mut remarks: Vec<String> = record.notes.clone();
    if let Some(fit) = &record.fit {
        remarks.push(format!(
            "Fitted to the {} of channel {} from {} to {} ms ({} samples); stopped: {}.",
            fit.quantity,
            fit.channel,
            decimals(MILLI * fit.from_s, 1),
            decimals(MILLI * fit.to_s, 1),
            fit.samples,
            fit.stop_reason.replace('-', " ")
        ));
        if !fit.active_bounds.is_empty() {
            let names: Vec<String> =
                fit.active_bounds.iter().map(|name| parameter(&candidate.record.model, name, 0.0).0).collect();
            remarks.push(format!("On a bound of the search: {}.", names.join(", ")));
        }
    }
    remarks.extend(how_well_known(candidate));
    remarks.extend(uncertainty::remarks(candidate));
    remarks.extend(simulation.iter().flat_map(|s| s.notes.iter().cloned()));
    if !remarks.is_empty() {
        let items: String = remarks.iter().map(|text| format!("<li>{}</li>", html(text))).collect();
        about.push_str(&format!(
            "<details><summary>{} remark{}</summary><ul>{items}</ul></details>",
            remarks.len(),
            if remarks.len() == 1 { "" } else { "s" }
        ));
    }
    let number = |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or_else(|| ABSENT.to_owned(), text);
    let simulation = simulation.as_ref();
    out.push_str(&format!(
        "<tr{}><td class=\"rank\">{}{place}</td><td>{about}</td><td class=\"parameters\">{}</td><td>{}</td>\
         <td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td \
         class=\"n\">{}</td></tr>\n",
        if best { " class=\"best\"" } else { "" },
        if best { "<span class=\"star\" title=\"recommended for predictions\">★</span> " } else { "" },
        parameters(candidate),
        if record.physical { "yes" } else { "<span class=\"no\">no</span>" },
        number(candidate.fit_percent(), &|v| decimals(v, 2)),
        number(simulation.and_then(|s| s.rmse_displacement_m), &|v| decimals(MILLI * v, 2)),
        number(simulation.and_then(|s| s.aicc), &|v| decimals(v, 1)),
        number(simulation.and_then(|s| s.dynamic_crush_error_m), &|v| signed(MILLI * v, 2)),
        number(simulation.and_then(|s| s.time_of_dynamic_crush_error_s), &|v| signed(MILLI * v, 2)),
    ));
}

/// Rank, weakest direction and condition; the sensors that the fit did not use.
fn how_well_known(candidate: &CandidateResult) -> Vec<String> {
    let mut remarks = Vec::new();
    if let Some(u) = &candidate.record.uncertainty {
        if let Some(rank) = u.rank {
            remarks.push(format!(
                "Independent directions in the parameters that the waves respond to: {rank} of {}; how well each \
                 parameter is known, its interval says.",
                u.order.len()
            ));
        }
        remarks.extend(u.weakest_direction.iter().map(|text| format!("Known least: {text}.")));
        if let Some(condition) = u.condition {
            remarks.push(format!("Condition of the sensitivities: {}.", significant(condition, 3)));
        }
    }
    let Some(simulation) = &candidate.simulation else { return remarks };
    if let (Some(p), Some(samples)) = (simulation.fitted_parameters, simulation.effective_samples) {
        let few = if simulation.aicc.is_some() { "" } else { ": too few for an AICc" };
        remarks.push(format!("{p} parameters, {} independent samples in the window{few}.", significant(samples, 3)));
    }
    let others = simulation.other_sensors.iter().map(|other| {
        format!(
            "Sensor {} on mass {}, which the fit did not use: {} mm root mean square{}.",
            other.channel,
            other.mass,
            decimals(MILLI * other.rmse_displacement_m, 2),
            other.fit_percent.map_or_else(String::new, |fit| format!(", fit {} %", decimals(fit, 2)))
        )
    });
    remarks.extend(others);
    remarks
}

/// `k = 321.9 ± 0.4 kN/m, 95 %: 321.1 to 322.7`, one parameter a line.
fn parameters(candidate: &CandidateResult) -> String {
    let deviations = candidate.record.uncertainty.as_ref().map(|u| &u.standard_deviation);
    let mut parameters: Vec<(&String, &f64)> = candidate.record.parameters.iter().collect();
    parameters.sort_by_key(|(name, _)| parameter_order(&candidate.record.model, name));
    let lines: Vec<String> = parameters
        .into_iter()
        .map(|(name, &value)| {
            let (symbol, shown, unit) = parameter(&candidate.record.model, name, value);
            let on_bound = candidate.record.fit.as_ref().is_some_and(|fit| fit.active_bounds.contains(name));
            let (deviation, doubt) = match (candidate.record.doubt(name), deviations.and_then(|d| d.get(name))) {
                (Some(doubt), _) => (String::new(), format!(" <span class=\"no\">{doubt}</span>")),
                (None, _) if candidate.record.certainty(name) == Some(Certainty::OrderOfMagnitude) => {
                    (String::new(), " <span class=\"no\">to an order of magnitude</span>".to_owned())
                }
                (None, _) if on_bound => (String::new(), " (the limit of what is physical)".to_owned()),
                (None, Some(&d)) => (
                    format!("{NBSP}±{NBSP}{}", significant(parameter(&candidate.record.model, name, d).1, 2)),
                    String::new(),
                ),
                (None, None) => (String::new(), String::new()),
            };
            let interval = if on_bound { String::new() } else { interval(candidate, name) };
            format!(
                "<span title=\"{}\">{} = {}{deviation}{NBSP}{unit}{doubt}{interval}</span>",
                html(name),
                html(&symbol),
                significant(shown, 4)
            )
        })
        .collect();
    lines.join("<br>")
}

/// `, 95 %: 310 to 330`; an end that the record does not bound is "open".
fn interval(candidate: &CandidateResult, name: &str) -> String {
    let Some(u) = &candidate.record.uncertainty else { return String::new() };
    let (Some(low), Some(high)) = (u.interval_low.get(name), u.interval_high.get(name)) else { return String::new() };
    let digits = low.zip(*high).map_or(3, |(low, high)| digits_of_interval(low, high, 3));
    let end = |end: &Option<f64>| {
        end.map_or_else(|| "open".to_owned(), |x| significant(parameter(&candidate.record.model, name, x).1, digits))
    };
    match (low, high) {
        (None, None) => "; 95\u{a0}%: open".to_owned(),
        _ => format!("; 95{NBSP}%: {} to {}", end(low), end(high)),
    }
}
