//! Which candidate is for what, and what spoke for each.

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::{CandidateResult, Run, Status, candidate_name};
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;
use crumple_artifact::records::{PriorV1, RatedCandidateV1, RecommendationV1};

use crate::frame::{self, Column};

/// The three roles, who has them and why.
pub(super) fn write_roles(out: &mut String, run: &Run, status: Option<Status>) {
    let Some(choice) = &run.recommendation else { return };
    let texts = &PHRASES.candidates;
    let recommended = if status == Some(Status::DoNotUse) { texts.in_doubt } else { texts.recommended };
    out.push_str("<ul>\n");
    for (name, id, because) in [
        (recommended, &choice.recommended, &choice.recommended_because),
        (texts.simplest, &choice.simplest, &choice.simplest_because),
        (texts.closest, &choice.closest, &choice.closest_because),
    ] {
        let model = id.as_deref().map_or_else(|| texts.none.to_owned(), candidate_name);
        out.push_str(&format!("<li>{name}: <strong>{}</strong>, {}.</li>\n", html(&model), html(because)));
    }
    out.push_str("</ul>\n");
}

/// What spoke for each candidate, folded.
pub(super) fn write_evidence(out: &mut String, run: &Run) {
    let Some(choice) = run.recommendation.as_ref().filter(|choice| !choice.candidates.is_empty()) else { return };
    let title = PHRASES.candidates.evidence_of_all;
    out.push_str(&format!("<details><summary>{title}</summary>\n"));
    table(out, run, choice);
    out.push_str("</details>\n");
}

fn table(out: &mut String, run: &Run, choice: &RecommendationV1) {
    let texts = &PHRASES.candidates;
    let mut columns = vec![
        Column::text(texts.model),
        Column::text(texts.energy_goes_into),
        Column::number(texts.determined),
        Column::number(texts.fit),
        Column::number("e"),
    ];
    columns.extend(has_force(choice).then_some(Column::number(texts.wall_force).means(texts.wall_force_definition)));
    columns.push(Column::number("Δ score"));
    let stated = |prior: &PriorV1| (html(&prior.name), html(&format!("{} ({})", prior.statement, prior.source)));
    let priors: Vec<(String, String)> = choice.priors.iter().map(stated).collect();
    columns.extend(priors.iter().map(|(name, statement)| Column::number(name).means(statement)));
    columns.extend([Column::number(texts.with_priors), Column::text(texts.adequate)]);
    out.push_str(&frame::table("", &columns));
    for rated in &choice.candidates {
        row(out, run, choice, rated);
    }
    out.push_str("</tbody>\n</table></div>\n");
    let evidence = choice.evidence.as_ref().map(|evidence| {
        let filled = [
            ("quantity", words::metric(&evidence.quantity)),
            ("filtered", if evidence.as_measured { texts.filtered_alike } else { "" }.to_owned()),
            ("effective", words::decimals(evidence.effective_samples, 1)),
            ("samples", evidence.samples.to_string()),
        ];
        fill(texts.evidence_caption, &filled)
    });
    let priors: Vec<String> =
        choice.priors.iter().map(|p| format!("{}: {} ({})", p.name, p.statement, p.source)).collect();
    let priors = match priors.is_empty() {
        true => texts.no_priors.to_owned(),
        false => html(&format!("{}.", priors.join("; "))),
    };
    out.push_str(&format!(
        "<p class=\"caption\">{}{}</p>\n",
        html(&evidence.unwrap_or_default()),
        fill(texts.priors_caption, &[("priors", priors)])
    ));
}

/// Whether the record has the force on the wall.
fn has_force(choice: &RecommendationV1) -> bool {
    choice.candidates.iter().any(|rated| rated.force_misfit_percent.is_some())
}

fn row(out: &mut String, run: &Run, choice: &RecommendationV1, rated: &RatedCandidateV1) {
    let certainties = run.candidate(&rated.id).map(CandidateResult::certainties).filter(|known| known.parameters > 0);
    let texts = &PHRASES.candidates;
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
    let adequate = rated
        .not_adequate_because
        .as_deref()
        .map_or_else(|| PHRASES.page.yes.to_owned(), |why| fill(texts.no_because, &[("why", html(why))]));
    out.push_str(&format!(
        "<tr{}><td>{}</td><td>{}</td><td class=\"n\">{determined}</td><td class=\"n\">{}</td><td \
         class=\"n\">{}</td>{force}<td class=\"n\">{}</td>{terms}<td class=\"n\">{}</td><td>{}</td></tr>\n",
        if choice.recommended.as_ref() == Some(&rated.id) { " class=\"best\"" } else { "" },
        html(&candidate_name(&rated.id)),
        html(match rated.class.as_str() {
            "plastic" => texts.plastic,
            "damped" => texts.damped,
            "elastic" => texts.elastic,
            other => other,
        }),
        number(rated.fit_as_measured_percent, 2),
        number(rated.coefficient_of_restitution, 3),
        number(rated.aicc_difference, 1),
        number(rated.difference_with_priors, 1),
        adequate,
    ));
}
