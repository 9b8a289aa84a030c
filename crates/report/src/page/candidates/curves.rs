//! The table of candidates: one row a distinct curve.

use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, KM_PER_H_PER_M_PER_S, MILLI};
use crate::findings::{
    CandidateResult, DistinctCurve, Ranking, Run, SAME_CURVE, SAME_RESTITUTION, candidate_name, distinct_curves,
};
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;
use crumple_artifact::records::{PredictionV1, RatedCandidateV1};

use crate::frame::{Column, table};

use super::bars;

/// Speeds of predictions with a column at most: the lowest and the highest.
const SPEEDS: usize = 2;

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    let curves = distinct_curves(run, ranking);
    if curves.is_empty() {
        return;
    }
    let speeds = speeds(run);
    let texts = &PHRASES.candidates;
    let has_evidence = run.recommendation.as_ref().is_some_and(|choice| !choice.candidates.is_empty());
    let of_speed =
        |speed: &f64| fill(texts.crush_at, &[("speed", words::quantity(KM_PER_H_PER_M_PER_S * speed, 0, "km/h"))]);
    let at_speeds: Vec<String> = speeds.iter().map(of_speed).collect();
    let mut columns = vec![Column::text(texts.model), Column::number(texts.determined)];
    if has_evidence {
        columns.push(Column::number(texts.evidence_against).means(texts.evidence_definition));
    }
    if is_simulated(run) {
        columns.extend([
            Column::number(texts.crush_error).means(texts.crush_error_definition),
            Column::number(texts.time_error).means(texts.time_error_definition),
            Column::number(texts.fit).means(texts.fit_as_measured_definition),
        ]);
    }
    columns.extend(at_speeds.iter().map(|name| Column::number(name).means(texts.crush_at_definition)));
    out.push_str(&table("candidates curves", &columns));
    for curve in &curves {
        row(out, run, ranking, curve, &speeds, has_evidence);
    }
    out.push_str("</tbody>\n</table></div>\n");
    let of = run.candidates.len();
    let together = if curves.len() < of {
        let filled = [
            ("candidates", of.to_string()),
            ("curves", curves.len().to_string()),
            ("share", words::quantity(1e2 * SAME_CURVE, 1, "%")),
            ("restitution", words::decimals(SAME_RESTITUTION, 2)),
        ];
        fill(texts.distinct_curves, &filled)
    } else {
        String::new()
    };
    out.push_str(&format!("<p class=\"caption\">{together}{}</p>\n", texts.bars_caption));
}

/// Whether the candidates were compared with one test.
fn is_simulated(run: &Run) -> bool {
    run.candidates.iter().any(|candidate| candidate.simulation.is_some())
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
    let texts = &PHRASES.candidates;
    let best = ranking.best.as_deref() == Some(&candidate.id);
    let rated = run.rated(&candidate.id);
    let simulation = candidate.simulation.as_ref();
    let number = |value: Option<f64>, text: &dyn Fn(f64) -> String| value.map_or_else(|| ABSENT.to_owned(), text);
    let certainties = candidate.certainties();
    let determined = certainties.words().map_or_else(
        || ABSENT.to_owned(),
        |words| format!("<span tabindex=\"0\" title=\"{words}\">{}</span>", certainties.counts()),
    );
    let evidence = if has_evidence {
        format!(
            "<td class=\"n\">{}</td>",
            number(rated.and_then(|r| r.difference_with_priors), &|v| words::decimals(v, 1))
        )
    } else {
        String::new()
    };
    let errors: String = [
        number(simulation.and_then(|s| s.dynamic_crush_error_m), &|v| words::signed(MILLI * v, 1)),
        number(simulation.and_then(|s| s.time_of_dynamic_crush_error_s), &|v| words::signed(MILLI * v, 1)),
        number(candidate.fit_percent(), &|v| words::decimals(v, 2)),
    ]
    .iter()
    .filter(|_| is_simulated(run))
    .map(|text| format!("<td class=\"n\">{text}</td>"))
    .collect();
    let predicted: String = speeds.iter().map(|speed| predicted_crush(run, curve, *speed)).collect();
    out.push_str(&format!(
        "<tr{}><td>{}{}</td><td class=\"n\">{determined}</td>{evidence}{errors}{predicted}</tr>\n",
        if best { " class=\"best\"" } else { "" },
        about(run, curve, candidate, rated),
        format_args!("<details><summary>{}</summary>{}</details>", texts.parameters_of_row, bars::table(candidate)),
    ));
}

/// Name, why it is not adequate, and the candidates with the same curve.
fn about(run: &Run, curve: &DistinctCurve, candidate: &CandidateResult, rated: Option<&RatedCandidateV1>) -> String {
    let texts = &PHRASES.candidates;
    let choice = run.recommendation.as_ref();
    let roles = [
        (texts.badge_simplest, choice.and_then(|choice| choice.simplest.as_ref())),
        (texts.badge_closest, choice.and_then(|choice| choice.closest.as_ref())),
    ];
    // A badge stands beside the candidate that the choice names, also where that shares its row.
    let badges = |id: &String| -> String {
        let own = roles.iter().filter(|(_, named)| *named == Some(id));
        own.map(|(role, _)| format!(" <span class=\"badge\">{role}</span>")).collect()
    };
    let mut about = format!("<strong>{}</strong>{}", html(&candidate_name(&candidate.id)), badges(&candidate.id));
    if let Some(why) = rated.and_then(|rated| rated.not_adequate_because.as_deref()) {
        let why = fill(texts.not_adequate, &[("why", html(why))]);
        about.push_str(&format!("<br><span class=\"dual\">{why}</span>"));
    }
    if !candidate.record.physical {
        about.push_str(&format!("<br><span class=\"no\">{}</span>", texts.not_passive));
    }
    if !curve.same_curve.is_empty() {
        let name = |id: &String| format!("<li>{}{}</li>", html(&candidate_name(id)), badges(id));
        let names: String = curve.same_curve.iter().map(name).collect();
        let count = fill(texts.same_curve, &[("count", curve.same_curve.len().to_string())]);
        about.push_str(&format!("<details><summary>{count}</summary><ul>{names}</ul></details>"));
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
        let [low, high] = [interval.low, interval.high].map(|end| words::decimals(MILLI * end, 0));
        let ends = words::between(&low, &high);
        format!("<br><span class=\"dual\" tabindex=\"0\" title=\"{}\">{ends}</span>", html(&interval.interval_by))
    });
    format!("<td class=\"n\">{}{interval}</td>", words::decimals(MILLI * crush, 0))
}
