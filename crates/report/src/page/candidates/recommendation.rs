//! Which candidate is for what, and what spoke for each.

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::{CandidateResult, Run, Status, capitalised};
use crate::words;
use crumple_artifact::records::{PriorV1, RatedCandidateV1, RecommendationV1};

use crate::frame::{self, Column};
use crate::page::model_picture::{CLOSEST, RECOMMENDED};

/// The three roles, who has them and why.
pub(super) fn write_roles(out: &mut String, run: &Run, status: Option<Status>) {
    let Some(choice) = &run.recommendation else { return };
    let recommended = if status == Some(Status::DoNotUse) { "In doubt, not recommended" } else { RECOMMENDED };
    out.push_str("<ul>\n");
    for (name, id, because) in [
        (recommended, &choice.recommended, &choice.recommended_because),
        ("Simplest", &choice.simplest, &choice.simplest_because),
        (CLOSEST, &choice.closest, &choice.closest_because),
    ] {
        let model = id.as_deref().map_or_else(|| "none".to_owned(), |id| run.name_of(id));
        out.push_str(&format!("<li>{name}: <strong>{}</strong>, {}.</li>\n", html(&model), html(because)));
    }
    out.push_str("</ul>\n");
}

/// What spoke for each candidate, folded.
pub(super) fn write_evidence(out: &mut String, run: &Run) {
    let Some(choice) = run.recommendation.as_ref().filter(|choice| !choice.candidates.is_empty()) else { return };
    out.push_str("<details><summary>Evidence for every candidate</summary>\n");
    table(out, run, choice);
    out.push_str("</details>\n");
}

fn table(out: &mut String, run: &Run, choice: &RecommendationV1) {
    let mut columns = vec![
        Column::text("Model"),
        Column::text("Energy goes into"),
        Column::number("Determined"),
        Column::number("Fit, %"),
        Column::number("e"),
    ];
    columns.extend(has_force(choice).then_some(Column::number("Wall force, %").means(
        "Force on the wall: model less measured, root mean square over that of the measured, from contact to \
         separation, both filtered alike.",
    )));
    columns.push(Column::number("Δ score"));
    let stated = |prior: &PriorV1| (html(&prior.name), html(&format!("{} ({})", prior.statement, prior.source)));
    let priors: Vec<(String, String)> = choice.priors.iter().map(stated).collect();
    columns.extend(priors.iter().map(|(name, statement)| Column::number(name).means(statement)));
    columns.extend([Column::number("Δ with priors"), Column::text("Adequate")]);
    out.push_str(&frame::table("", &columns));
    for rated in &choice.candidates {
        row(out, run, choice, rated);
    }
    out.push_str("</tbody>\n</table></div>\n");
    let evidence = choice.evidence.as_ref().map(|evidence| {
        format!(
            "Evidence is minus twice the logarithm of the density that a model gives the {}{} before it is fitted to \
             it, over {} terms below 60 Hz of {} samples; a difference below 2 says nothing, above 10 it decides. ",
            words::metric(&evidence.quantity),
            if evidence.as_measured { ", the models filtered as the record was" } else { "" },
            words::decimals(evidence.effective_samples, 1),
            evidence.samples
        )
    });
    let priors: Vec<String> =
        choice.priors.iter().map(|p| format!("{}: {} ({})", p.name, p.statement, p.source)).collect();
    let priors = match priors.is_empty() {
        true => "none.".to_owned(),
        false => html(&format!("{}.", priors.join("; "))),
    };
    out.push_str(&format!(
        "<p class=\"caption\">{}Prior knowledge adds these terms: {priors}</p>\n",
        html(&evidence.unwrap_or_default())
    ));
}

/// Whether the record has the force on the wall.
fn has_force(choice: &RecommendationV1) -> bool {
    choice.candidates.iter().any(|rated| rated.force_misfit_percent.is_some())
}

fn row(out: &mut String, run: &Run, choice: &RecommendationV1, rated: &RatedCandidateV1) {
    let certainties = run.candidate(&rated.id).map(CandidateResult::certainties).filter(|known| known.parameters > 0);
    let determined = certainties.map_or_else(|| ABSENT.to_owned(), |known| known.counts());
    let number =
        |value: Option<f64>, digits: usize| value.map_or_else(|| ABSENT.to_owned(), |v| words::decimals(v, digits));
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
    let adequate =
        rated.not_adequate_because.as_deref().map_or_else(|| "yes".to_owned(), |why| format!("no: {}", html(why)));
    out.push_str(&format!(
        "<tr{}><td>{}</td><td>{}</td><td class=\"n\">{determined}</td><td class=\"n\">{}</td><td \
         class=\"n\">{}</td>{force}<td class=\"n\">{}</td>{terms}<td class=\"n\">{}</td><td>{adequate}</td></tr>\n",
        if choice.recommended.as_ref() == Some(&rated.id) { " class=\"best\"" } else { "" },
        html(&capitalised(&run.name_of(&rated.id))),
        html(match rated.class.as_str() {
            "plastic" => "plastic deformation",
            "damped" => "dampers",
            "elastic" => "springs",
            other => other,
        }),
        number(rated.fit_as_measured_percent, 2),
        number(rated.coefficient_of_restitution, 3),
        number(rated.aicc_difference, 1),
        number(rated.difference_with_priors, 1)
    ));
}
