//! The table of candidates: one row a distinct curve.

use crumple_artifact::records::{PredictionV1, RatedCandidateV1};
use crumple_drawing::escape::html;
use crumple_drawing::numbers::{ABSENT, KM_PER_H_PER_M_PER_S, MILLI, NBSP, decimals, signed};

use crate::conclusions::distinct_curves::{DistinctCurve, SAME_CURVE, SAME_RESTITUTION, distinct_curves};
use crate::text::names::candidate_name;
use crate::{CandidateResult, Ranking, Run};

use super::bars;

/// Speeds of predictions with a column at most: the lowest and the highest.
const SPEEDS: usize = 2;

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    let curves = distinct_curves(run, ranking);
    if curves.is_empty() {
        return;
    }
    let speeds = speeds(run);
    let of_speed = |speed: &f64| {
        format!(
            "<th scope=\"col\" class=\"n\"><abbr title=\"Dynamic crush as predicted at this speed, same mass, same \
             wall; below it the 90 % interval.\">C at {}{NBSP}km/h, mm</abbr></th>",
            decimals(KM_PER_H_PER_M_PER_S * speed, 0)
        )
    };
    let has_evidence = run.recommendation.as_ref().is_some_and(|choice| !choice.candidates.is_empty());
    let evidence = if has_evidence {
        "<th scope=\"col\" class=\"n\"><abbr title=\"Corrected Akaike criterion with what is known beside the record, \
         above the lowest of the adequate models: below 2 says nothing, above 10 decides.\">Evidence \
         against</abbr></th>"
    } else {
        ""
    };
    out.push_str(&format!(
        "<div class=\"scroll\"><table class=\"candidates curves\">\n<thead><tr><th scope=\"col\">Model</th>\
         <th scope=\"col\" class=\"n\">Determined</th>{evidence}<th scope=\"col\" class=\"n\"><abbr title=\"Dynamic \
         crush of the model minus that of the test.\">ΔC, mm</abbr></th><th scope=\"col\" class=\"n\"><abbr \
         title=\"Time of dynamic crush of the model minus that of the test.\">Δt<sub>m</sub>, ms</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"100 (1 − |x − x̂| / |x − mean x|) of the displacement over the \
         compared window, the model measured as the record was.\">Fit, %</abbr></th>{}</tr></thead>\n<tbody>\n",
        speeds.iter().map(of_speed).collect::<String>()
    ));
    for curve in &curves {
        row(out, run, ranking, curve, &speeds, has_evidence);
    }
    out.push_str("</tbody>\n</table></div>\n");
    let of = run.candidates.len();
    let together = if curves.len() < of {
        format!(
            "{of} candidates, {} distinct curves: those in one row differ over the compared window by no more than \
             {}{NBSP}% of the largest displacement and velocity (root mean square), and in restitution by no more than \
             {}. ",
            curves.len(),
            decimals(1e2 * SAME_CURVE, 1),
            decimals(SAME_RESTITUTION, 2)
        )
    } else {
        String::new()
    };
    out.push_str(&format!(
        "<p class=\"caption\">{together}Highlighted is the model recommended for predictions. A bar is a 95 % interval \
         between a tenth and ten times the value; it fades where it goes on or is open.</p>\n"
    ));
}

/// The lowest and the highest speed at which this vehicle was predicted against the wall of the test, m/s.
fn speeds(run: &Run) -> Vec<f64> {
    let mut speeds: Vec<f64> = wall(run).map(|prediction| prediction.impact_speed_m_per_s).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    if speeds.len() > SPEEDS {
        speeds = vec![speeds[0], speeds[speeds.len() - 1]];
    }
    speeds
}

fn wall(run: &Run) -> impl Iterator<Item = &PredictionV1> {
    run.predictions.iter().filter(|prediction| prediction.partner.is_none() && prediction.collision.is_none())
}

fn row(out: &mut String, run: &Run, ranking: &Ranking, curve: &DistinctCurve, speeds: &[f64], has_evidence: bool) {
    let Some(candidate) = run.candidate(&curve.id) else { return };
    let best = ranking.best.as_deref() == Some(&candidate.id);
    let rated = run.recommendation.iter().flat_map(|choice| &choice.candidates).find(|rated| rated.id == candidate.id);
    let simulation = candidate.simulation.as_ref();
    let number = |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or_else(|| ABSENT.to_owned(), text);
    let certainties = candidate.certainties();
    let determined = certainties.words(run.language).map_or_else(
        || ABSENT.to_owned(),
        |words| format!("<span title=\"{words}\">{} of {}</span>", certainties.determined, certainties.parameters),
    );
    let evidence = if has_evidence {
        format!("<td class=\"n\">{}</td>", number(rated.and_then(|r| r.difference_with_priors), &|v| decimals(v, 1)))
    } else {
        String::new()
    };
    let predicted: String = speeds.iter().map(|speed| predicted_crush(run, curve, *speed)).collect();
    out.push_str(&format!(
        "<tr{}><td>{}{}</td><td class=\"n\">{determined}</td>{evidence}<td class=\"n\">{}</td><td class=\"n\">{}</td>\
         <td class=\"n\">{}</td>{predicted}</tr>\n",
        if best { " class=\"best\"" } else { "" },
        about(run, curve, candidate, rated),
        format_args!("<details><summary>parameters</summary>{}</details>", bars::table(candidate)),
        number(simulation.and_then(|s| s.dynamic_crush_error_m), &|v| signed(MILLI * v, 1)),
        number(simulation.and_then(|s| s.time_of_dynamic_crush_error_s), &|v| signed(MILLI * v, 1)),
        number(candidate.fit_percent(), &|v| decimals(v, 2)),
    ));
}

/// Name, why it is not adequate, and the candidates with the same curve.
fn about(run: &Run, curve: &DistinctCurve, candidate: &CandidateResult, rated: Option<&RatedCandidateV1>) -> String {
    let mut about = format!("<strong>{}</strong>", html(&candidate_name(&candidate.id)));
    let roles = run.recommendation.iter().flat_map(|choice| {
        [("simplest", &choice.simplest), ("closest", &choice.closest)]
            .into_iter()
            .filter(|(_, id)| id.as_ref().is_some_and(|id| *id == curve.id || curve.same_curve.contains(id)))
            .map(|(name, _)| name)
    });
    about.extend(roles.map(|role| format!(" <span class=\"badge\">{role}</span>")));
    if let Some(why) = rated.and_then(|rated| rated.not_adequate_because.as_deref()) {
        about.push_str(&format!("<br><span class=\"dual\">not adequate: {}</span>", html(why)));
    }
    if !candidate.record.physical {
        about.push_str("<br><span class=\"no\">not a passive structure</span>");
    }
    if !curve.same_curve.is_empty() {
        let names: String =
            curve.same_curve.iter().map(|id| format!("<li>{}</li>", html(&candidate_name(id)))).collect();
        about.push_str(&format!(
            "<details><summary>same curve: {} more</summary><ul>{names}</ul></details>",
            curve.same_curve.len()
        ));
    }
    about
}

/// The crush predicted by the candidate of a row, or by one with the same curve.
fn predicted_crush(run: &Run, curve: &DistinctCurve, speed: f64) -> String {
    let members = std::iter::once(&curve.id).chain(&curve.same_curve);
    let of_row = members
        .filter_map(|id| wall(run).find(|p| p.candidate == *id && p.impact_speed_m_per_s == speed))
        .find_map(|prediction| Some((prediction, prediction.dynamic_crush_m?)));
    let Some((prediction, crush)) = of_row else { return format!("<td class=\"n\">{ABSENT}</td>") };
    let interval = prediction.intervals.iter().find(|interval| interval.name == "dynamic_crush_m");
    let interval = interval.map_or_else(String::new, |interval| {
        let (low, high) = (decimals(MILLI * interval.low, 0), decimals(MILLI * interval.high, 0));
        format!("<br><span class=\"dual\" title=\"{}\">{low} to {high}</span>", html(&interval.interval_by))
    });
    format!("<td class=\"n\">{}{interval}</td>", decimals(MILLI * crush, 0))
}
