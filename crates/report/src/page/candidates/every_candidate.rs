//! Every candidate: parameters, what they answer with, which is best. Folded.

use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, MILLI, NBSP};
use crate::findings::{CandidateResult, Ranking, Run, ShownParameter, capitalised, parameter, parameter_order};
use crate::words;
use crumple_artifact::records::Certainty;

use crate::frame::{Column, table};

use super::{CRUSH_ERROR, TIME_ERROR, uncertainty};

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    if run.candidates.is_empty() {
        return;
    }
    let columns = [
        Column::text("Rank"),
        Column::text("Model and method"),
        Column::text("Parameters"),
        Column::text("Physical").means("No parameter is negative: a passive structure."),
        Column::number("Fit, %")
            .means("100 (1 − |x − x̂| / |x − mean x|) of the displacement over the compared window."),
        Column::number("RMSE").of("mm").means("Root mean square displacement error over the compared window."),
        CRUSH_ERROR,
        TIME_ERROR,
    ];
    let table = table("candidates", &columns);
    out.push_str(&format!("<details><summary>Every candidate with its parameters and remarks</summary>\n{table}"));
    let mut rows: Vec<&CandidateResult> = run.candidates.iter().collect();
    rows.sort_by_key(|candidate| ranking.place(&candidate.id).unwrap_or(usize::MAX));
    for candidate in rows {
        row(out, run, ranking, candidate);
    }
    out.push_str("</tbody>\n</table></div>\n");
    if let Some(supported) = ranking.best_of_matching(run) {
        let dual = supported.record.equivalent_to.as_deref();
        let name = |id: &str| html(&run.name_of(id));
        let dual = dual.map(|other| format!(" and its dual {}, which this sensor cannot tell from it", name(other)));
        let fit = supported.fit_percent().map_or_else(|| ABSENT.to_owned(), |fit| words::decimals(fit, 2));
        out.push_str(&format!(
            "<p class=\"caption\">Of the solutions of coefficient matching the simulation supports {}{}: fit {fit} \
             %{}.</p>\n",
            name(&supported.id),
            dual.unwrap_or_default(),
            if supported.record.physical { "" } else { "; it is not a passive structure" }
        ));
    }
    let order = match ranking.best {
        Some(_) => {
            "In the order of the choice: adequate models first, then by the evidence. Highlighted is the recommended \
             model: the list above says why."
        }
        None => "In the order of the displacement fit, the model measured as the record was. No model is recommended.",
    };
    out.push_str(&format!(
        "<p class=\"caption\">{order} A dual gives exactly the same record on this sensor and so the same \
         figures.</p>\n"
    ));
    if run.candidates.iter().any(|candidate| candidate.record.uncertainty.is_some()) {
        out.push_str(
            "<p class=\"caption\">± is one standard deviation, from the misfit and the sensitivities at the fit; “95 \
             %” is the interval that holds the value in 95 of 100 such records if the model is true and mass, gain and \
             the division of the mass are exact, with two masses or more the speed too, “open” where the record does \
             not bound it. It is far wider than two standard deviations where the misfit is worth few independent \
             samples (see the remarks), and not symmetric. Profile, bootstrap and uncertain inputs, where asked for, \
             are among a candidate's remarks.</p>\n",
        );
    }
    out.push_str("</details>\n");
}

fn row(out: &mut String, run: &Run, ranking: &Ranking, candidate: &CandidateResult) {
    let CandidateResult { id, record, simulation, .. } = candidate;
    let best = ranking.best.as_deref() == Some(id);
    let place = ranking.place(id).map_or_else(|| ABSENT.to_owned(), |place| place.to_string());
    let name = html(&capitalised(&run.name_of(id)));
    let mut about = format!("<strong>{name}</strong><br><code>{}</code>", html(id));
    if let Some(other) = &record.equivalent_to {
        let other = html(&run.name_of(other));
        about.push_str(&format!("<br><span class=\"dual\">dual of {other}: same record</span>"));
    }
    let mut remarks: Vec<String> = record.notes.iter().map(|note| html(note)).collect();
    let mut own: Vec<String> = Vec::new();
    if let Some(fit) = &record.fit {
        let [from, to] = [fit.from_s, fit.to_s].map(|time_s| words::decimals(MILLI * time_s, 1));
        own.push(format!(
            "Fitted to the {} of channel {} from {from} to {to} ms ({} samples); stopped: {}.",
            words::metric(&fit.quantity),
            fit.channel,
            fit.samples,
            fit.stop_reason.replace('-', " ")
        ));
        if !fit.active_bounds.is_empty() {
            let names: Vec<String> =
                fit.active_bounds.iter().map(|name| parameter(&candidate.record.model, name, 0.0).0).collect();
            own.push(format!("Reached the search limit: {}.", names.join(", ")));
        }
    }
    own.extend(how_well_known(candidate));
    own.extend(uncertainty::remarks(candidate));
    remarks.extend(own.iter().map(|text| html(text)));
    remarks.extend(simulation.iter().flat_map(|s| &s.notes).map(|note| html(note)));
    if !remarks.is_empty() {
        let items: String = remarks.iter().map(|text| format!("<li>{text}</li>")).collect();
        let (count, remarks) = (remarks.len(), if remarks.len() == 1 { "remark" } else { "remarks" });
        about.push_str(&format!("<details><summary>{count} {remarks}</summary><ul>{items}</ul></details>"));
    }
    let number = |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or_else(|| ABSENT.to_owned(), text);
    let simulation = simulation.as_ref();
    out.push_str(&format!(
        "<tr{}><td class=\"rank\">{}{place}</td><td>{about}</td><td class=\"parameters\">{}</td><td>{}</td>\
         <td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        if best { " class=\"best\"" } else { "" },
        if best { "<span class=\"star\" tabindex=\"0\" title=\"chosen\">★</span> " } else { "" },
        parameters(candidate),
        if record.physical { "yes" } else { "<span class=\"no\">no</span>" },
        number(candidate.fit_percent(), &|v| words::decimals(v, 2)),
        number(simulation.and_then(|s| s.rmse_displacement_m), &|v| words::cell(MILLI * v, 2, "mm")),
        number(simulation.and_then(|s| s.dynamic_crush_error_m), &|v| words::signed_cell(MILLI * v, 2, "mm")),
        number(simulation.and_then(|s| s.time_of_dynamic_crush_error_s), &|v| words::signed(MILLI * v, 2)),
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
            remarks.push(format!("Condition of the sensitivities: {}.", words::significant(condition, 3)));
        }
    }
    let Some(simulation) = &candidate.simulation else { return remarks };
    let others = simulation.other_sensors.iter().map(|other| {
        let fit = other.fit_percent.map(|fit| format!(", fit {} %", words::decimals(fit, 2)));
        format!(
            "Sensor {} on mass {}, which the fit did not use: {} root mean square{}.",
            other.channel,
            other.mass,
            words::quantity(MILLI * other.rmse_displacement_m, 2, "mm").replace(NBSP, " "),
            fit.unwrap_or_default()
        )
    });
    remarks.extend(others);
    remarks
}

/// `k = 321.9 ± 0.4 kN/m, 95 %: 321.1 to 322.7`, one parameter a line.
fn parameters(candidate: &CandidateResult) -> String {
    let mut names: Vec<&String> = candidate.record.parameters.keys().collect();
    names.sort_by_key(|name| parameter_order(&candidate.record.model, name));
    let lines: Vec<String> = names
        .into_iter()
        .map(|name| {
            let shown = ShownParameter::of(&candidate.record, name);
            let ShownParameter { symbol, value, unit, .. } = &shown;
            let on_bound = candidate.record.fit.as_ref().is_some_and(|fit| fit.active_bounds.contains(name));
            let no = |words: &str| format!(" <span class=\"no\">{words}</span>");
            let (deviation, doubt) = match (candidate.doubt(name), &shown.deviation) {
                (Some(doubt), _) => (String::new(), no(doubt)),
                (None, _) if candidate.record.certainty(name) == Some(Certainty::OrderOfMagnitude) => {
                    (String::new(), no("wide interval"))
                }
                (None, _) if on_bound => (String::new(), " (physical limit)".to_owned()),
                (None, Some(deviation)) => (format!("{NBSP}±{NBSP}{deviation}"), String::new()),
                (None, None) => (String::new(), String::new()),
            };
            let interval = if on_bound { String::new() } else { interval(&shown) };
            format!(
                "<span tabindex=\"0\" title=\"{}\">{} = {value}{deviation}{NBSP}{unit}{doubt}{interval}</span>",
                html(name),
                html(symbol)
            )
        })
        .collect();
    lines.join("<br>")
}

/// `; 95 %: 310 to 330`; an end that the record does not bound is "open".
fn interval(shown: &ShownParameter) -> String {
    match (&shown.ends, shown.interval()) {
        (Some([None, None]), _) => "; 95\u{a0}%: open".to_owned(),
        (_, Some(ends)) => format!("; 95\u{a0}%: {ends}"),
        (_, None) => String::new(),
    }
}
