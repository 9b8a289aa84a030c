//! What is missing, what the stages remarked, what the result can and cannot say, where it came from.

use crumple_artifact::records::ConcernV1;
use crumple_drawing::escape::html;
use crumple_drawing::numbers::decimals;
use crumple_signal::Severity;

use crate::page::conclusion;
use crate::results::ranking::AS_GOOD_PERCENT;
use crate::text::names::candidate_name;
use crate::text::parameters::parameter;
use crate::{CandidateResult, Ranking, Run, StageNote};

/// Good-to-know notes of a stage that are open to view; the rest is folded. Warnings never are.
const OPEN_NOTES: usize = 12;
/// Characters of a digest that are shown.
const DIGEST_SHOWN: usize = 12;

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
pub(super) fn write_notes(out: &mut String, run: &Run, concerns: &[ConcernV1]) {
    if run.notes.is_empty() && concerns.is_empty() {
        return;
    }
    out.push_str("<section id=\"notes\">\n<h2>Warnings and notes</h2>\n");
    if !concerns.is_empty() {
        let phrases = run.language.phrases();
        let items: String = concerns
            .iter()
            .map(|concern| format!("<li class=\"warning\">{}</li>\n", conclusion::item(concern, phrases)))
            .collect();
        let count = match concerns.len() {
            1 => "1 warning".to_owned(),
            n => format!("{n} warnings, those first that change most of what is shown"),
        };
        out.push_str(&format!("<h3>{count}</h3>\n<ul class=\"notes\">\n{items}</ul>\n"));
    }
    let infos: Vec<&StageNote> = run.notes.iter().filter(|n| n.note.severity == Severity::Info).collect();
    for of_stage in infos.chunk_by(|a, b| a.stage == b.stage) {
        let Some(StageNote { stage, .. }) = of_stage.first() else { continue };
        let items: String = of_stage.iter().map(|n| format!("<li>{}</li>\n", html(&n.note.text))).collect();
        let list = format!("<ul class=\"notes\">\n{items}</ul>\n");
        out.push_str(&if of_stage.len() > OPEN_NOTES {
            let count = of_stage.len();
            format!("<h3>{}</h3>\n<details><summary>{count} notes</summary>\n{list}</details>\n", html(stage))
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
    limits.extend(about_the_best(run, ranking));
    let window = run.candidates.iter().find_map(|c| c.simulation.as_ref()).map(|s| (s.from_s, s.to_s));
    if run.is_generic() {
        limits.push(
            "A model describes the record it was fitted to, over the amplitudes and frequencies that its input \
             excited; what it predicts elsewhere is extrapolation."
                .to_owned(),
        );
    } else if !run.candidates.is_empty() || !run.models.is_empty() {
        let mut text =
            "A linear model of a crash is a model of the loading phase: a structure that has been crushed does not \
                        spring back as it came."
                .to_owned();
        if let Some((from, to)) = window {
            text.push_str(&format!(
                " Models are compared with the test from {} to {} ms after time zero; what they do later is \
                 extrapolation.",
                decimals(1e3 * from, 1),
                decimals(1e3 * to, 1)
            ));
        }
        limits.push(text);
    }
    let others: std::collections::BTreeSet<&str> =
        run.candidates.iter().flat_map(CandidateResult::other_channels).map(|(channel, _)| channel).collect();
    let who = if others.is_empty() {
        "Everything here is read from one sensor".to_owned()
    } else {
        let (word, list) = (if others.len() == 1 { "channel" } else { "channels" }, Vec::from_iter(others).join(", "));
        format!("Crush and events are read from one sensor (models of several masses were fitted to {word} {list} too)")
    };
    if !run.is_generic() {
        limits.push(format!(
            "{who}, with the vehicle taken for a body that moves as one. Crush is the displacement of that sensor, \
         double-integrated: an error of its zero level grows with the square of time. It is dynamic crush; the crush \
         that remains after the test cannot be had from an accelerometer."
        ));
    }
    if let Some(ratio) = run.events.as_ref().and_then(|e| Some(e.centroid_time_s? / e.time_of_dynamic_crush_s?))
        && ratio > std::f64::consts::FRAC_2_PI
    {
        limits.push(format!(
            "t_c/t_m is {}, above 2/π = 0.637: no Kelvin model with damping has such a pulse, and one labelled as \
                 undamped is a reduction to the nearest that exists.",
            decimals(ratio, 3)
        ));
    }
    if let Some(events) = run.events.as_ref().filter(|e| e.time_of_dynamic_crush_s.is_none()) {
        let end = match (events.end_of_event_s, &events.end_of_event_rule) {
            (Some(end_s), Some(rule)) => format!(
                " Its change is counted, and models are fitted, up to the end of the event at {} ms ({rule}).",
                decimals(1e3 * end_s, 1)
            ),
            _ => String::new(),
        };
        limits.push(format!(
            "The velocity does not reach zero within the record. This is a valid result: the vehicle was still moving \
             forward when the record ended, so dynamic crush, restitution and all that builds on them are absent.{end}"
        ));
    }
    let items: String = limits.iter().map(|text| format!("<li>{}</li>\n", html(text))).collect();
    out.push_str(&format!(
        "<section>\n<h2>What this can and cannot say</h2>\n<ul class=\"limits\">\n{items}</ul>\n</section>\n"
    ));
}

/// Why a closer fit is not called the best: undetermined parameters, or more of them than the record gives reason for.
fn about_the_best(run: &Run, ranking: &Ranking) -> Vec<String> {
    if let Some(reason) = ranking.no_best.as_deref().filter(|_| !ranking.order.is_empty()) {
        return vec![format!("No model is recommended: {reason}.")];
    }
    if run.recommendation.is_some() {
        // The table of the choice says it.
        return Vec::new();
    }
    let fit = CandidateResult::fit_percent;
    let best = ranking.best.as_deref().and_then(|id| run.candidate(id));
    let closest = ranking.order.iter().filter_map(|id| run.candidate(id)).find(|c| c.record.physical);
    let Some(closest) = closest.filter(|c| best.is_none_or(|best| fit(c) > fit(best))) else { return Vec::new() };
    let on_bound = closest.record.fit.as_ref().map(|fit| fit.active_bounds.as_slice()).unwrap_or_default();
    let name = candidate_name(&closest.id);
    if !on_bound.is_empty() {
        let symbols: Vec<String> = on_bound.iter().map(|name| parameter(&closest.record.model, name, 0.0).0).collect();
        return vec![format!(
            "{name} fits closest but is not called the best: {} stopped on a bound of the search, so the record does \
             not determine these values.",
            symbols.join(", ")
        )];
    }
    let open = CandidateResult::left_open;
    match best {
        Some(best) if closest.divides_by_formula() && !best.divides_by_formula() => vec![format!(
            "{name} fits no more than {AS_GOOD_PERCENT} percentage points better and its masses were looked for with a \
             sensor on the last one alone, which does not decide their division."
        )],
        Some(best) if open(closest) > open(best) => vec![format!(
            "{name} fits no more than {AS_GOOD_PERCENT} percentage points better, and this record leaves {} of its \
             parameters undetermined instead of {}.",
            open(closest),
            open(best)
        )],
        Some(best) if closest.record.parameters.len() > best.record.parameters.len() => vec![format!(
            "{name} fits no more than {AS_GOOD_PERCENT} percentage points better with {} parameters instead of {}: \
             this record gives no reason for the larger model.",
            closest.record.parameters.len(),
            best.record.parameters.len()
        )],
        _ => Vec::new(),
    }
}

pub(super) fn write_provenance(out: &mut String, run: &Run) {
    out.push_str("<section class=\"provenance\">\n<h2>Provenance</h2>\n");
    let source = &run.test.source;
    if !source.name.is_empty() {
        out.push_str(&format!(
            "<p>Record: {} ({}), <code title=\"{}\">{}</code>. Pipeline: {}.</p>\n",
            html(&source.name),
            html(&source.format),
            html(&source.digest),
            html(short(&source.digest)),
            html(run.pipeline.as_deref().unwrap_or("not named"))
        ));
    }
    if !run.provenance.is_empty() {
        out.push_str(
            "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">Stage</th><th scope=\"col\">Version</th><th \
             scope=\"col\">Content</th>\
             <th scope=\"col\">Made from</th><th scope=\"col\">Settings</th></tr></thead>\n<tbody>\n",
        );
        for record in &run.provenance {
            let inputs: Vec<String> = record
                .inputs
                .iter()
                .map(|(kind, digest)| {
                    format!("{} <code title=\"{}\">{}</code>", html(kind), html(digest), html(short(digest)))
                })
                .collect();
            let settings = if record.settings.is_empty() || record.settings == "{}" {
                "none".to_owned()
            } else {
                format!("<details><summary>show</summary><code>{}</code></details>", html(&record.settings))
            };
            out.push_str(&format!(
                "<tr><td>{}</td><td>{}</td><td><code title=\"{}\">{}</code></td><td>{}</td><td>{settings}</td></tr>\n",
                html(&record.stage),
                html(&record.version),
                html(&record.digest),
                html(short(&record.digest)),
                inputs.join("<br>")
            ));
        }
        out.push_str("</tbody>\n</table></div>\n");
    }
    out.push_str(&format!(
        "<p class=\"caption\">Made by crumple-report {}. Full numbers are in summary.json and in the \
         artifacts.</p>\n</section>\n",
        env!("CARGO_PKG_VERSION")
    ));
}

/// The first characters of a digest without its algorithm.
fn short(digest: &str) -> &str {
    let hex = digest.split_once(':').map_or(digest, |(_, hex)| hex);
    hex.get(..DIGEST_SHOWN).unwrap_or(hex)
}
