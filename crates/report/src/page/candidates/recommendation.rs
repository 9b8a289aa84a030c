//! Which candidate is for what, and what spoke for each.

use crumple_artifact::records::{RatedCandidateV1, RecommendationV1};
use crumple_drawing::escape::html;
use crumple_drawing::numbers::{ABSENT, decimals};

use crate::text::names::candidate_name;
use crate::{CandidateResult, Run};

/// The three roles, who has them and why.
pub(super) fn write_roles(out: &mut String, run: &Run) {
    let Some(choice) = &run.recommendation else { return };
    out.push_str("<ul>\n");
    for (name, id, because) in [
        ("Recommended for predictions", &choice.recommended, &choice.recommended_because),
        ("Simplest", &choice.simplest, &choice.simplest_because),
        ("Closest to the record", &choice.closest, &choice.closest_because),
    ] {
        let model = id.as_deref().map_or_else(|| "none".to_owned(), candidate_name);
        out.push_str(&format!("<li>{name}: <strong>{}</strong>, {}.</li>\n", html(&model), html(because)));
    }
    out.push_str("</ul>\n");
}

/// What spoke for each candidate, folded.
pub(super) fn write_evidence(out: &mut String, run: &Run) {
    let Some(choice) = run.recommendation.as_ref().filter(|choice| !choice.candidates.is_empty()) else { return };
    out.push_str("<details><summary>Evidence for and against every candidate</summary>\n");
    table(out, run, choice);
    out.push_str("</details>\n");
}

fn table(out: &mut String, run: &Run, choice: &RecommendationV1) {
    let priors: String = choice
        .priors
        .iter()
        .map(|prior| {
            let title = html(&format!("{} ({})", prior.statement, prior.source));
            format!("<th scope=\"col\" class=\"n\"><abbr title=\"{title}\">{}</abbr></th>", html(&prior.name))
        })
        .collect();
    let force = if has_force(choice) {
        "<th scope=\"col\" class=\"n\"><abbr title=\"Force on the wall: model less measured, root mean square over \
         that of the measured, from contact to separation, both filtered alike.\">Wall force, %</abbr></th>"
    } else {
        ""
    };
    out.push_str(&format!(
        "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">Model</th><th scope=\"col\">Energy goes into</th>\
         <th scope=\"col\" class=\"n\">Determined</th><th scope=\"col\" class=\"n\">Fit, %</th>\
         <th scope=\"col\" class=\"n\">e</th>{force}<th scope=\"col\" class=\"n\">ΔAICc</th>{priors}\
         <th scope=\"col\" class=\"n\">Δ with priors</th><th scope=\"col\">Adequate</th></tr></thead>\n<tbody>\n",
    ));
    for rated in &choice.candidates {
        row(out, run, choice, rated);
    }
    out.push_str("</tbody>\n</table></div>\n");
    let evidence = choice.evidence.as_ref().map_or_else(String::new, |evidence| {
        format!(
            "Evidence is the corrected Akaike criterion of the {}{}, over {} independent samples of {}; a difference \
             below 2 says nothing, above 10 it decides. ",
            evidence.quantity,
            if evidence.as_measured { ", the models filtered as the record was" } else { "" },
            decimals(evidence.effective_samples, 1),
            evidence.samples
        )
    });
    let priors: Vec<String> =
        choice.priors.iter().map(|p| format!("{}: {} ({})", p.name, p.statement, p.source)).collect();
    let priors = if priors.is_empty() { "none.".to_owned() } else { format!("{}.", priors.join("; ")) };
    out.push_str(&format!(
        "<p class=\"caption\">{}Prior knowledge adds the terms beside it, which a reader can take off: {}</p>\n",
        html(&evidence),
        html(&priors)
    ));
}

/// Whether the record has the force on the wall.
fn has_force(choice: &RecommendationV1) -> bool {
    choice.candidates.iter().any(|rated| rated.force_misfit_percent.is_some())
}

fn row(out: &mut String, run: &Run, choice: &RecommendationV1, rated: &RatedCandidateV1) {
    let certainties = run.candidate(&rated.id).map(CandidateResult::certainties).filter(|known| known.parameters > 0);
    let determined =
        certainties.map_or_else(|| ABSENT.to_owned(), |known| format!("{} of {}", known.determined, known.parameters));
    let number = |value: Option<f64>, digits: usize| value.map_or_else(|| ABSENT.to_owned(), |v| decimals(v, digits));
    let terms: String = choice
        .priors
        .iter()
        .map(|prior| {
            let term = rated.priors.iter().find(|term| term.name == prior.name).map(|term| term.term);
            format!("<td class=\"n\">{}</td>", number(term, 1))
        })
        .collect();
    let force = has_force(choice).then(|| format!("<td class=\"n\">{}</td>", number(rated.force_misfit_percent, 1)));
    let force = force.unwrap_or_default();
    let adequate = rated.not_adequate_because.as_deref().map_or_else(|| "yes".to_owned(), |why| format!("no: {why}"));
    out.push_str(&format!(
        "<tr{}><td>{}</td><td>{}</td><td class=\"n\">{determined}</td><td class=\"n\">{}</td><td \
         class=\"n\">{}</td>{force}<td class=\"n\">{}</td>{terms}<td class=\"n\">{}</td><td>{}</td></tr>\n",
        if choice.recommended.as_ref() == Some(&rated.id) { " class=\"best\"" } else { "" },
        html(&candidate_name(&rated.id)),
        html(match rated.class.as_str() {
            "plastic" => "plastic deformation",
            "damped" => "dampers",
            "elastic" => "springs",
            other => other,
        }),
        number(rated.fit_as_measured_percent, 2),
        number(rated.coefficient_of_restitution, 3),
        number(rated.aicc_difference, 1),
        number(rated.difference_with_priors, 1),
        html(&adequate),
    ));
}
