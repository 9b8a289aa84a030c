//! The table of candidates: parameters, what they answer with, which is best.

use crate::escape::html;
use crate::people::{ABSENT, MILLI, NBSP, candidate_name, decimals, parameter, parameter_order, signed, significant};
use crate::{Candidate, Ranking, Run};

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    if run.candidates.is_empty() {
        return;
    }
    out.push_str(
        "<section>\n<h2>Candidates: physical parameters</h2>\n<div class=\"scroll\"><table class=\"candidates\">\n\
         <thead><tr><th scope=\"col\">Rank</th><th scope=\"col\">Model and method</th><th scope=\"col\">Parameters</th>\
         <th scope=\"col\"><abbr title=\"No parameter is negative: a passive structure.\">Physical</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"100 (1 − |x − x̂| / |x − mean x|) of the displacement over the compared window.\">Fit, %</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Root mean square displacement error over the compared window.\">RMSE, mm</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Dynamic crush of the model minus that of the test.\">ΔC, mm</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Time of dynamic crush of the model minus that of the test.\">Δt<sub>m</sub>, ms</abbr></th>\
         </tr></thead>\n<tbody>\n",
    );
    let mut rows: Vec<&Candidate> = run.candidates.iter().collect();
    rows.sort_by_key(|candidate| ranking.place(&candidate.id).unwrap_or(usize::MAX));
    for candidate in rows {
        row(out, candidate, ranking);
    }
    out.push_str("</tbody>\n</table></div>\n");
    if let Some(supported) = ranking.best_of_matching(run) {
        let dual = supported.record.equivalent_to.as_deref().map_or_else(String::new, |other| {
            format!(" and its dual {}, which this sensor cannot tell from it", html(&candidate_name(other)))
        });
        let fit = supported.simulation.as_ref().and_then(|s| s.fit_percent);
        out.push_str(&format!(
            "<p class=\"caption\">Of the solutions of coefficient matching the simulation supports {}{dual}: fit {} %{}.</p>\n",
            html(&candidate_name(&supported.id)),
            fit.map_or_else(|| ABSENT.to_owned(), |fit| decimals(fit, 2)),
            if supported.record.physical { "" } else { "; it is not a passive structure" },
        ));
    }
    out.push_str(match ranking.best {
        Some(_) => {
            "<p class=\"caption\">Ranked by the fit of the displacement; highlighted is the best that is physical, has no parameter on a bound of \
             its search and no more parameters than it needs. A dual gives exactly the same record on this sensor and so the same figures.</p>\n</section>\n"
        }
        None => {
            "<p class=\"caption\">None is called the best: that takes a physical candidate without a parameter on a bound that explains at least half of \
             the displacement.</p>\n</section>\n"
        }
    });
}

fn row(out: &mut String, candidate: &Candidate, ranking: &Ranking) {
    let Candidate { id, record, simulation, .. } = candidate;
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
            remarks.push(format!("On a bound: {}.", fit.active_bounds.join(", ")));
        }
    }
    if let Some(condition) = record.uncertainty.as_ref().and_then(|u| u.condition) {
        remarks.push(format!("Condition of the sensitivities: {}.", significant(condition, 3)));
    }
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
         <td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        if best { " class=\"best\"" } else { "" },
        if best { "<span class=\"star\" title=\"best physical candidate\">★</span> " } else { "" },
        parameters(candidate),
        if record.physical { "yes" } else { "<span class=\"no\">no</span>" },
        number(simulation.and_then(|s| s.fit_percent), &|v| decimals(v, 2)),
        number(simulation.and_then(|s| s.rmse_displacement_m), &|v| decimals(MILLI * v, 2)),
        number(simulation.and_then(|s| s.dynamic_crush_error_m), &|v| signed(MILLI * v, 2)),
        number(simulation.and_then(|s| s.time_of_dynamic_crush_error_s), &|v| signed(MILLI * v, 2)),
    ));
}

/// `k = 321.9 ± 0.4 kN/m`, one parameter a line.
fn parameters(candidate: &Candidate) -> String {
    let deviations = candidate.record.uncertainty.as_ref().map(|u| &u.standard_deviation);
    let mut parameters: Vec<(&String, &f64)> = candidate.record.parameters.iter().collect();
    parameters.sort_by_key(|(name, _)| parameter_order(name));
    let lines: Vec<String> = parameters
        .into_iter()
        .map(|(name, &value)| {
            let (symbol, shown, unit) = parameter(name, value);
            let on_bound = candidate.record.fit.as_ref().is_some_and(|fit| fit.active_bounds.contains(name));
            let (deviation, doubt) = match deviations.and_then(|d| d.get(name)) {
                _ if on_bound => (String::new(), " <span class=\"no\">on a bound</span>"),
                // A standard deviation as large as the value says that the record does not determine it.
                Some(&d) if d >= value.abs() => (String::new(), " <span class=\"no\">not determined</span>"),
                Some(&d) => (format!("{NBSP}±{NBSP}{}", significant(parameter(name, d).1, 2)), ""),
                None => (String::new(), ""),
            };
            format!(
                "<span title=\"{}\">{} = {}{deviation}{NBSP}{unit}{doubt}</span>",
                html(name),
                html(&symbol),
                significant(shown, 4)
            )
        })
        .collect();
    lines.join("<br>")
}
