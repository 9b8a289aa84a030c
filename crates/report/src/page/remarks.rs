//! What is missing, what the stages remarked, what the result can and cannot say, where it came from.

use crate::drawing::escape::html;
use crate::findings::ranking::none_recommended;
use crate::findings::{CandidateResult, Concern, Ranking, Run, is_of_another_candidate, short, warnings};
use crate::words;
use crumple_artifact::records::RemarkV1;
use crumple_stage::remarks_of_model;

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
        "<section class=\"missing\">\n<h2>Not in this report</h2>\n<ul>\n{items}</ul>\n</section>\n"
    ));
}

/// All concerns by their weight, then what is good to know by stage.
pub(super) fn write_notes(out: &mut String, run: &Run, ranking: &Ranking, concerns: &[Concern]) {
    if run.remarks.is_empty() && concerns.is_empty() {
        return;
    }
    out.push_str("<section id=\"notes\">\n<h2>Warnings and notes</h2>\n");
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
            1 => "<h3>1 warning</h3>\n".to_owned(),
            n => format!("<h3>{n} warnings, those first that change most of what is shown</h3>\n"),
        };
        for (head, concerns) in [("", diagnoses), (&count, first)].into_iter().filter(|(_, all)| !all.is_empty()) {
            out.push_str(&format!("{head}{}", list(&concerns)));
        }
        if !others.is_empty() {
            out.push_str(&format!(
                "<details><summary>{} of them on candidates that are neither recommended nor simplest nor \
                 closest</summary>\n{}</details>\n",
                others.len(),
                list(&others)
            ));
        }
    }
    // Each model lists its own.
    let identified = run.models.iter().filter_map(|model| model.identification.as_ref());
    let of_models: Vec<RemarkV1> = identified.flat_map(remarks_of_model).collect();
    let is_of_model = |remark: &RemarkV1| of_models.iter().any(|own| own.says_the_same(remark));
    let infos: Vec<&RemarkV1> = run.infos().filter(|remark| !is_of_model(remark)).collect();
    for of_stage in infos.chunk_by(|a, b| a.stage == b.stage) {
        let Some(RemarkV1 { stage, .. }) = of_stage.first() else { continue };
        let items: String = of_stage.iter().map(|remark| format!("<li>{}</li>\n", html(&remark.text))).collect();
        let list = format!("<ul class=\"notes\">\n{items}</ul>\n");
        out.push_str(&if of_stage.len() > OPEN_NOTES {
            let (stage, count) = (html(stage), of_stage.len());
            format!("<h3>{stage}</h3>\n<details><summary>{count} notes</summary>\n{list}</details>\n")
        } else {
            format!("<h3>{}</h3>\n{list}", html(stage))
        });
    }
    out.push_str("</section>\n");
}

pub(super) fn write_limits(out: &mut String, run: &Run, ranking: &Ranking) {
    let mut limits = Vec::new();
    // A fit that saw a second sensor has decided between the two.
    let one_sensor = |c: &CandidateResult| c.other_channels().next().is_none();
    if run
        .candidates
        .iter()
        .any(|c| one_sensor(c) && (c.record.model == "double-spring-mass-damper" || c.record.equivalent_to.is_some()))
    {
        limits.push(
            "One compartment accelerometer cannot tell a double-mass parameter set from its dual: both give exactly \
             the same record, so the fit cannot choose between them. A second sensor on the front, on the engine or \
             the firewall, decides."
                .to_owned(),
        );
    }
    limits.extend(ranking.no_best().map(none_recommended));
    let window = run.candidates.iter().find_map(|c| c.simulation.as_ref()).map(|s| (s.from_s, s.to_s));
    if run.is_generic() {
        limits.push(
            "A model describes the record it was fitted to, over the amplitudes and frequencies that its input \
             excited; what it predicts elsewhere is extrapolation."
                .to_owned(),
        );
    } else if !run.candidates.is_empty() || !run.models.is_empty() {
        let mut text = "A linear model of a crash is a model of the loading phase: a structure that has been crushed \
                        does not spring back as it came."
            .to_owned();
        if let Some((from, to)) = window {
            let [from, to] = [from, to].map(|time_s| words::decimals(1e3 * time_s, 1));
            text.push_str(&format!(
                " Models are compared with the test from {from} to {to} ms after time zero; what they do later is \
                 extrapolation."
            ));
        }
        limits.push(text);
    }
    let others: std::collections::BTreeSet<&str> =
        run.candidates.iter().flat_map(CandidateResult::other_channels).map(|(channel, _)| channel).collect();
    if !run.is_generic() && run.joint.is_none() {
        let channel = if others.len() == 1 { "channel" } else { "channels" };
        let read_from_one = if others.is_empty() {
            "All results come from one sensor and treat the vehicle as a rigid body.".to_owned()
        } else {
            format!(
                "Crush and events are read from one sensor (models of several masses were fitted to {channel} {} too), \
                 with the vehicle taken for a body that moves as one.",
                Vec::from_iter(others).join(", ")
            )
        };
        limits.push(format!(
            "{read_from_one} Crush is the displacement of that sensor, double-integrated: an error of its zero level \
             grows with the square of time. It is dynamic crush; the crush that remains after the test cannot be had \
             from an accelerometer."
        ));
    }
    if let Some(ratio) = run.events.as_ref().and_then(|e| Some(e.centroid_time_s? / e.time_of_dynamic_crush_s?))
        && ratio > std::f64::consts::FRAC_2_PI
    {
        let bound = words::decimals(std::f64::consts::FRAC_2_PI, 3);
        limits.push(format!(
            "t_c/t_m is {}, above 2/π = {bound}: no Kelvin model with damping has such a pulse, and one labelled as \
             undamped is a reduction to the nearest that exists.",
            words::decimals(ratio, 3)
        ));
    }
    if let Some(events) = run.events.as_ref().filter(|e| e.time_of_dynamic_crush_s.is_none()) {
        let end = match (events.end_of_event_s, &events.end_of_event_rule) {
            (Some(end_s), Some(rule)) => {
                let time = format!("{} ms", words::decimals(1e3 * end_s, 1));
                format!(" Its change is counted, and models are fitted, up to the end of the event at {time} ({rule}).")
            }
            _ => String::new(),
        };
        limits.push(format!(
            "The velocity does not reach zero within the record. This is a valid result: the vehicle was still moving \
             forward when the record ended, so dynamic crush, restitution and all that builds on them are absent.{end}"
        ));
    }
    let items: String = limits.iter().map(|text| format!("<li>{}</li>\n", html(text))).collect();
    out.push_str(&format!(
        "<section id=\"limits\">\n\
         <h2>What this can and cannot say</h2>\n<ul class=\"limits\">\n{items}</ul>\n</section>\n"
    ));
}

pub(super) fn write_provenance(out: &mut String, run: &Run) {
    out.push_str("<section class=\"provenance\" id=\"provenance\">\n<h2>Provenance</h2>\n");
    let source = &run.test.source;
    if !source.name.is_empty() && run.joint.is_none() {
        let digest =
            format!("<code tabindex=\"0\" title=\"{}\">{}</code>", html(&source.digest), html(short(&source.digest)));
        out.push_str(&format!(
            "<p>Record: {} ({}), {digest}. Pipeline: {}.</p>\n",
            html(&source.name),
            html(&source.format),
            html(run.pipeline.as_deref().unwrap_or("not named"))
        ));
    }
    if !run.provenance.is_empty() {
        let columns = ["Stage", "Version", "Content", "Made from", "Settings"].map(Column::text);
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
                "none".to_owned()
            } else {
                format!("<details><summary>show</summary><code>{}</code></details>", html(&as_set(&record.settings)))
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
        "<p class=\"caption\">Made by crumple-report {}. Full numbers are in summary.json and in the artifacts.</p>\n\
         </section>\n",
        env!("CARGO_PKG_VERSION")
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
