//! Every candidate: parameters, what they answer with, which is best. Folded.

use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, MILLI, NBSP, digits_of_interval};
use crate::findings::{CandidateResult, Ranking, Run, candidate_name, parameter, parameter_order};
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;
use crumple_artifact::records::Certainty;

use crate::frame::{Column, table};

use super::uncertainty;

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    if run.candidates.is_empty() {
        return;
    }
    let texts = &PHRASES.candidates;
    let columns = [
        Column::text(texts.rank),
        Column::text(texts.model_and_method),
        Column::text(texts.parameters),
        Column::text(texts.physical).means(texts.physical_definition),
        Column::number(texts.fit).means(texts.fit_definition),
        Column::number(texts.rmse).means(texts.rmse_definition),
        Column::number(texts.crush_error).means(texts.crush_error_definition),
        Column::number(texts.time_error).means(texts.time_error_definition),
    ];
    let table = table("candidates", &columns);
    out.push_str(&format!("<details><summary>{}</summary>\n{table}", texts.every_candidate));
    let mut rows: Vec<&CandidateResult> = run.candidates.iter().collect();
    rows.sort_by_key(|candidate| ranking.place(&candidate.id).unwrap_or(usize::MAX));
    for candidate in rows {
        row(out, candidate, ranking);
    }
    out.push_str("</tbody>\n</table></div>\n");
    if let Some(supported) = ranking.best_of_matching(run) {
        let dual = supported.record.equivalent_to.as_deref();
        let dual = dual.map(|other| fill(texts.and_its_dual, &[("model", html(&candidate_name(other)))]));
        let fit = supported.fit_percent().map_or_else(|| ABSENT.to_owned(), |fit| words::decimals(fit, 2));
        let filled = [
            ("model", html(&candidate_name(&supported.id))),
            ("dual", dual.unwrap_or_default()),
            ("fit", format!("{fit} %")),
            ("physical", if supported.record.physical { "" } else { texts.it_is_not_passive }.to_owned()),
        ];
        out.push_str(&format!("<p class=\"caption\">{}</p>\n", fill(texts.matching_supported, &filled)));
    }
    let is_recommended = ranking.best.is_some();
    let ranked = if is_recommended { texts.ranked_recommended } else { texts.ranked_by_fit };
    let has_intervals = run.candidates.iter().any(|candidate| candidate.record.uncertainty.is_some());
    for caption in std::iter::once(ranked).chain(has_intervals.then_some(texts.intervals_caption)) {
        out.push_str(&format!("<p class=\"caption\">{caption}</p>\n"));
    }
    out.push_str("</details>\n");
}

fn row(out: &mut String, candidate: &CandidateResult, ranking: &Ranking) {
    let texts = &PHRASES.candidates;
    let CandidateResult { id, record, simulation, .. } = candidate;
    let best = ranking.best.as_deref() == Some(id);
    let place = ranking.place(id).map_or_else(|| ABSENT.to_owned(), |place| place.to_string());
    let mut about = format!("<strong>{}</strong><br><code>{}</code>", html(&candidate_name(id)), html(id));
    if let Some(other) = &record.equivalent_to {
        let dual = fill(texts.dual_of, &[("model", html(&candidate_name(other)))]);
        about.push_str(&format!("<br><span class=\"dual\">{dual}</span>"));
    }
    let mut remarks: Vec<String> = record.notes.iter().map(|note| html(note)).collect();
    let mut own: Vec<String> = Vec::new();
    if let Some(fit) = &record.fit {
        let filled = [
            ("quantity", words::metric(&fit.quantity)),
            ("channel", fit.channel.clone()),
            ("from", words::decimals(MILLI * fit.from_s, 1)),
            ("to", words::decimals(MILLI * fit.to_s, 1)),
            ("samples", fit.samples.to_string()),
            ("reason", fit.stop_reason.replace('-', " ")),
        ];
        own.push(fill(texts.fitted_to, &filled));
        if !fit.active_bounds.is_empty() {
            let names: Vec<String> =
                fit.active_bounds.iter().map(|name| parameter(&candidate.record.model, name, 0.0).0).collect();
            own.push(fill(texts.on_bounds, &[("names", names.join(", "))]));
        }
    }
    own.extend(how_well_known(candidate));
    own.extend(uncertainty::remarks(candidate));
    remarks.extend(own.iter().map(|text| html(text)));
    remarks.extend(simulation.iter().flat_map(|s| &s.notes).map(|note| html(note)));
    if !remarks.is_empty() {
        let items: String = remarks.iter().map(|text| format!("<li>{text}</li>")).collect();
        let template = if remarks.len() == 1 { texts.one_remark } else { texts.remarks };
        let count = fill(template, &[("count", remarks.len().to_string())]);
        about.push_str(&format!("<details><summary>{count}</summary><ul>{items}</ul></details>"));
    }
    let number = |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or_else(|| ABSENT.to_owned(), text);
    let simulation = simulation.as_ref();
    let star = format!("<span class=\"star\" tabindex=\"0\" title=\"{}\">★</span> ", texts.star);
    let no = format!("<span class=\"no\">{}</span>", PHRASES.page.no);
    out.push_str(&format!(
        "<tr{}><td class=\"rank\">{}{place}</td><td>{about}</td><td class=\"parameters\">{}</td><td>{}</td>\
         <td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
        if best { " class=\"best\"" } else { "" },
        if best { &star } else { "" },
        parameters(candidate),
        if record.physical { PHRASES.page.yes } else { &no },
        number(candidate.fit_percent(), &|v| words::decimals(v, 2)),
        number(simulation.and_then(|s| s.rmse_displacement_m), &|v| words::decimals(MILLI * v, 2)),
        number(simulation.and_then(|s| s.dynamic_crush_error_m), &|v| words::signed(MILLI * v, 2)),
        number(simulation.and_then(|s| s.time_of_dynamic_crush_error_s), &|v| words::signed(MILLI * v, 2)),
    ));
}

/// Rank, weakest direction and condition; the sensors that the fit did not use.
fn how_well_known(candidate: &CandidateResult) -> Vec<String> {
    let texts = &PHRASES.candidates;
    let mut remarks = Vec::new();
    if let Some(u) = &candidate.record.uncertainty {
        if let Some(rank) = u.rank {
            let filled = [("rank", rank.to_string()), ("order", u.order.len().to_string())];
            remarks.push(fill(texts.directions, &filled));
        }
        remarks.extend(u.weakest_direction.iter().map(|text| fill(texts.known_least, &[("what", text)])));
        if let Some(condition) = u.condition {
            remarks.push(fill(texts.condition, &[("value", words::significant(condition, 3))]));
        }
    }
    let Some(simulation) = &candidate.simulation else { return remarks };
    let others = simulation.other_sensors.iter().map(|other| {
        let fit = other.fit_percent.map(|fit| format!("{} %", words::decimals(fit, 2)));
        let filled = [
            ("channel", other.channel.clone()),
            ("mass", other.mass.to_string()),
            ("error", format!("{} mm", words::decimals(MILLI * other.rmse_displacement_m, 2))),
            ("fit", fit.map_or_else(String::new, |fit| fill(texts.sensor_fit, &[("fit", fit)]))),
        ];
        fill(texts.other_sensor, &filled)
    });
    remarks.extend(others);
    remarks
}

/// `k = 321.9 ± 0.4 kN/m, 95 %: 321.1 to 322.7`, one parameter a line.
fn parameters(candidate: &CandidateResult) -> String {
    let texts = &PHRASES.candidates;
    let deviations = candidate.record.uncertainty.as_ref().map(|u| &u.standard_deviation);
    let mut parameters: Vec<(&String, &f64)> = candidate.record.parameters.iter().collect();
    parameters.sort_by_key(|(name, _)| parameter_order(&candidate.record.model, name));
    let lines: Vec<String> = parameters
        .into_iter()
        .map(|(name, &value)| {
            let (symbol, shown, unit) = parameter(&candidate.record.model, name, value);
            let on_bound = candidate.record.fit.as_ref().is_some_and(|fit| fit.active_bounds.contains(name));
            let no = |words: &str| format!(" <span class=\"no\">{words}</span>");
            let (deviation, doubt) = match (candidate.doubt(name), deviations.and_then(|d| d.get(name))) {
                (Some(doubt), _) => (String::new(), no(doubt)),
                (None, _) if candidate.record.certainty(name) == Some(Certainty::OrderOfMagnitude) => {
                    (String::new(), no(texts.order_of_magnitude))
                }
                (None, _) if on_bound => (String::new(), texts.the_limit_of_physical.to_owned()),
                (None, Some(&d)) => {
                    let deviation = words::significant(parameter(&candidate.record.model, name, d).1, 2);
                    (format!("{NBSP}±{NBSP}{deviation}"), String::new())
                }
                (None, None) => (String::new(), String::new()),
            };
            let interval = if on_bound { String::new() } else { interval(candidate, name) };
            format!(
                "<span tabindex=\"0\" title=\"{}\">{} = {}{deviation}{NBSP}{unit}{doubt}{interval}</span>",
                html(name),
                html(&symbol),
                words::significant(shown, 4)
            )
        })
        .collect();
    lines.join("<br>")
}

/// `; 95 %: 310 to 330`; an end that the record does not bound is "open".
fn interval(candidate: &CandidateResult, name: &str) -> String {
    let texts = &PHRASES.candidates;
    let Some(u) = &candidate.record.uncertainty else { return String::new() };
    let (Some(low), Some(high)) = (u.interval_low.get(name), u.interval_high.get(name)) else { return String::new() };
    let digits = low.zip(*high).map_or(3, |(low, high)| digits_of_interval(low, high, 3));
    let shown = |x: f64| words::significant(parameter(&candidate.record.model, name, x).1, digits);
    let end = |end: &Option<f64>| end.map_or_else(|| texts.open.to_owned(), shown);
    match (low, high) {
        (None, None) => texts.interval_open.to_owned(),
        _ => fill(texts.interval_of, &[("low", end(low)), ("high", end(high))]),
    }
}
