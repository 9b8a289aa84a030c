//! What is missing, what the stages remarked, what the result can and cannot say, where it came from.

use crate::drawing::escape::html;
use crate::findings::{CandidateResult, Concern, Ranking, Run, is_of_another_candidate, short, warnings};
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;
use crumple_artifact::records::RemarkV1;

use crate::frame::{Column, table};
use crate::page::conclusion;

/// Good-to-know notes of a stage that are open to view; the rest is folded. Warnings never are.
const OPEN_NOTES: usize = 12;

pub(super) fn write_missing(out: &mut String, run: &Run) {
    if run.missing.is_empty() {
        return;
    }
    let items: String = run.missing.iter().map(|text| format!("<li>{}</li>\n", html(text))).collect();
    out.push_str(&format!(
        "<section class=\"missing\">\n<h2>{}</h2>\n<ul>\n{items}</ul>\n</section>\n",
        PHRASES.remarks.missing
    ));
}

/// All concerns by their weight, then what is good to know by stage.
pub(super) fn write_notes(out: &mut String, run: &Run, ranking: &Ranking, concerns: &[Concern]) {
    if run.remarks.is_empty() && concerns.is_empty() {
        return;
    }
    let texts = &PHRASES.remarks;
    out.push_str(&format!("<section id=\"notes\">\n<h2>{}</h2>\n", texts.notes_title));
    if !concerns.is_empty() {
        let list = |concerns: &[&Concern]| {
            let items: String = concerns.iter().map(|concern| conclusion::item(concern)).collect();
            format!("<ul class=\"notes warnings\">\n{items}</ul>\n")
        };
        let diagnoses: Vec<&Concern> = concerns.iter().filter(|c| c.is_no_result()).collect();
        let (others, first): (Vec<&Concern>, Vec<&Concern>) =
            warnings(concerns).partition(|concern| is_of_another_candidate(concern, run, ranking));
        let count = match others.len() + first.len() {
            0 => String::new(),
            1 => format!("<h3>{}</h3>\n", texts.one_warning),
            n => format!("<h3>{}</h3>\n", fill(texts.warnings, &[("count", n.to_string())])),
        };
        for (head, concerns) in [("", diagnoses), (&count, first)].into_iter().filter(|(_, all)| !all.is_empty()) {
            out.push_str(&format!("{head}{}", list(&concerns)));
        }
        if !others.is_empty() {
            let of_others = fill(texts.of_other_candidates, &[("count", others.len().to_string())]);
            out.push_str(&format!("<details><summary>{of_others}</summary>\n{}</details>\n", list(&others)));
        }
    }
    // Each model lists its own.
    let of_models = || run.models.iter().filter_map(|model| model.identification.as_ref()).flat_map(|i| &i.notes);
    let is_of_model = |remark: &RemarkV1| of_models().any(|text| *text == remark.text);
    let infos: Vec<&RemarkV1> = run.infos().filter(|remark| !is_of_model(remark)).collect();
    for of_stage in infos.chunk_by(|a, b| a.stage == b.stage) {
        let Some(RemarkV1 { stage, .. }) = of_stage.first() else { continue };
        let items: String = of_stage.iter().map(|remark| format!("<li>{}</li>\n", html(&remark.text))).collect();
        let list = format!("<ul class=\"notes\">\n{items}</ul>\n");
        out.push_str(&if of_stage.len() > OPEN_NOTES {
            let count = fill(texts.notes, &[("count", of_stage.len().to_string())]);
            format!("<h3>{}</h3>\n<details><summary>{count}</summary>\n{list}</details>\n", html(stage))
        } else {
            format!("<h3>{}</h3>\n{list}", html(stage))
        });
    }
    out.push_str("</section>\n");
}

pub(super) fn write_limits(out: &mut String, run: &Run, ranking: &Ranking) {
    let texts = &PHRASES.remarks;
    let mut limits = Vec::new();
    // A fit that saw a second sensor has decided between the two.
    let one_sensor = |c: &CandidateResult| c.other_channels().next().is_none();
    if run
        .candidates
        .iter()
        .any(|c| one_sensor(c) && (c.record.model == "double-spring-mass-damper" || c.record.equivalent_to.is_some()))
    {
        limits.push(texts.one_sensor_dual.to_owned());
    }
    limits.extend(ranking.no_best().map(|reason| fill(texts.none_recommended, &[("reason", reason)])));
    let window = run.candidates.iter().find_map(|c| c.simulation.as_ref()).map(|s| (s.from_s, s.to_s));
    if run.is_generic() {
        limits.push(texts.generic_limit.to_owned());
    } else if !run.candidates.is_empty() || !run.models.is_empty() {
        let mut text = texts.linear_limit.to_owned();
        if let Some((from, to)) = window {
            let [from, to] = [from, to].map(|time_s| words::decimals(1e3 * time_s, 1));
            text.push_str(&fill(texts.compared_window, &[("from", from), ("to", to)]));
        }
        limits.push(text);
    }
    let others: std::collections::BTreeSet<&str> =
        run.candidates.iter().flat_map(CandidateResult::other_channels).map(|(channel, _)| channel).collect();
    if !run.is_generic() && run.joint.is_none() {
        let template = match others.len() {
            0 => texts.read_from_one,
            1 => texts.read_from_one_fitted_to_channel,
            _ => texts.read_from_one_fitted_to_channels,
        };
        let channels = Vec::from_iter(others).join(", ");
        limits.push(fill(template, &[("channels", channels)]) + texts.crush_is);
    }
    if let Some(ratio) = run.events.as_ref().and_then(|e| Some(e.centroid_time_s? / e.time_of_dynamic_crush_s?))
        && ratio > std::f64::consts::FRAC_2_PI
    {
        let bound = words::decimals(std::f64::consts::FRAC_2_PI, 3);
        limits.push(fill(texts.no_kelvin, &[("ratio", words::decimals(ratio, 3)), ("bound", bound)]));
    }
    if let Some(events) = run.events.as_ref().filter(|e| e.time_of_dynamic_crush_s.is_none()) {
        let end = match (events.end_of_event_s, &events.end_of_event_rule) {
            (Some(end_s), Some(rule)) => {
                let time = format!("{} ms", words::decimals(1e3 * end_s, 1));
                fill(texts.end_of_event, &[("time", &time), ("rule", rule)])
            }
            _ => String::new(),
        };
        limits.push(fill(texts.does_not_stop, &[("end", end)]));
    }
    let items: String = limits.iter().map(|text| format!("<li>{}</li>\n", html(text))).collect();
    out.push_str(&format!("<section>\n<h2>{}</h2>\n<ul class=\"limits\">\n{items}</ul>\n</section>\n", texts.limits));
}

pub(super) fn write_provenance(out: &mut String, run: &Run) {
    let texts = &PHRASES.remarks;
    out.push_str(&format!("<section class=\"provenance\">\n<h2>{}</h2>\n", texts.provenance));
    let source = &run.test.source;
    if !source.name.is_empty() && run.joint.is_none() {
        let digest =
            format!("<code tabindex=\"0\" title=\"{}\">{}</code>", html(&source.digest), html(short(&source.digest)));
        let filled = [
            ("name", html(&source.name)),
            ("format", html(&source.format)),
            ("digest", digest),
            ("pipeline", html(run.pipeline.as_deref().unwrap_or(texts.not_named))),
        ];
        out.push_str(&format!("<p>{}</p>\n", fill(texts.source, &filled)));
    }
    if !run.provenance.is_empty() {
        let columns = [texts.stage, texts.version, texts.content, texts.made_from, texts.settings].map(Column::text);
        out.push_str(&table("", &columns));
        for record in &run.provenance {
            let inputs: Vec<String> = record
                .inputs
                .iter()
                .map(|(kind, digest)| {
                    format!(
                        "{} <code tabindex=\"0\" title=\"{}\">{}</code>",
                        html(kind),
                        html(digest),
                        html(short(digest))
                    )
                })
                .collect();
            let settings = if record.settings.is_empty() || record.settings == "{}" {
                texts.none.to_owned()
            } else {
                format!(
                    "<details><summary>{}</summary><code>{}</code></details>",
                    texts.show,
                    html(&as_set(&record.settings))
                )
            };
            out.push_str(&format!(
                "<tr><td>{}</td><td>{}</td><td><code tabindex=\"0\" title=\"{}\">{}</code></td><td>{}</td>\
                 <td>{settings}</td></tr>\n",
                html(&record.stage),
                html(&record.made_by()),
                html(&record.digest),
                html(short(&record.digest)),
                inputs.join("<br>")
            ));
        }
        out.push_str("</tbody>\n</table></div>\n");
    }
    out.push_str(&format!(
        "<p class=\"caption\">{}</p>\n</section>\n",
        fill(texts.made_by, &[("version", env!("CARGO_PKG_VERSION"))])
    ));
}

/// The settings without those that were left open.
fn as_set(settings: &str) -> String {
    match serde_json::from_str::<serde_json::Map<String, serde_json::Value>>(settings) {
        Ok(mut all) => {
            all.retain(|_, value| !value.is_null());
            serde_json::Value::from(all).to_string()
        }
        Err(_) => settings.to_owned(),
    }
}
