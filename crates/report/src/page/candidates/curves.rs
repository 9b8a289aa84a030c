//! The table of candidates: one row a distinct curve.

use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, KM_PER_H_PER_M_PER_S, MILLI};
use crate::findings::{
    CandidateResult, DistinctCurve, Ranking, Run, SAME_CURVE, SAME_RESTITUTION, capitalised, distinct_curves,
};
use crate::words;
use crumple_artifact::records::{PredictionV1, RatedCandidateV1};
use crumple_signal::key_quantities::CRUSH;

use crate::frame::{Column, caption, table};

use super::{CRUSH_ERROR, TIME_ERROR, bars};

/// Speeds of predictions with a column at most: the lowest and the highest.
const SPEEDS: usize = 2;

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    let curves = distinct_curves(run, ranking);
    if curves.is_empty() {
        return;
    }
    let speeds = speeds(run);
    let has_evidence = run.recommendation.as_ref().is_some_and(|choice| !choice.candidates.is_empty());
    let of_speed = |speed: &f64| format!("C at {}", words::quantity(KM_PER_H_PER_M_PER_S * speed, 0, "km/h"));
    let at_speeds: Vec<String> = speeds.iter().map(of_speed).collect();
    let mut columns = vec![Column::text("Model"), Column::number("Determined")];
    if has_evidence {
        columns.push(Column::number("Evidence against").means(
            "Score of what the model foretells of the record, with what is known beside it, above the lowest of the \
             adequate models: below 2 says nothing, above 10 decides.",
        ));
    }
    if is_simulated(run) {
        columns.extend([
            CRUSH_ERROR,
            TIME_ERROR,
            Column::number("Fit, %").means(
                "100 (1 − |x − x̂| / |x − mean x|) of the displacement over the compared window, the model measured as \
                 the record was.",
            ),
        ]);
    }
    columns.extend(at_speeds.iter().map(|name| {
        Column::number(name)
            .of("mm")
            .means("Dynamic crush as predicted at this speed, same mass, same wall; below it the 90 % interval.")
    }));
    let of = run.candidates.len();
    out.push_str(&format!(
        "<details class=\"printed\"><summary>All distinct curves side by side: {} of {of} candidates</summary>\n{}",
        curves.len(),
        table("candidates curves", &columns)
    ));
    for curve in &curves {
        row(out, run, ranking, curve, &speeds, has_evidence);
    }
    out.push_str("</tbody>\n</table></div>\n");
    let together = if curves.len() < of {
        format!(
            "{of} candidates, {} distinct curves: those in one row differ over the compared window by no more than {} \
             of the largest displacement and velocity (root mean square), in restitution by no more than {}, and the \
             evidence does not tell their misfits apart. ",
            curves.len(),
            words::quantity(1e2 * SAME_CURVE, 1, "%"),
            words::decimals(SAME_RESTITUTION, 2)
        )
    } else {
        String::new()
    };
    out.push_str(&caption(&format!(
        "{together}Highlighted is the chosen model. A bar is a 95 % interval between a tenth and ten times the value; \
         it fades where it goes on or is open."
    )));
    out.push_str("</details>\n");
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
        number(simulation.and_then(|s| s.dynamic_crush_error_m), &|v| words::signed_cell(MILLI * v, 1, "mm")),
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
        format_args!("<details><summary>parameters</summary>{}</details>", bars::table(candidate)),
    ));
}

/// Name, why it is not adequate, and the candidates with the same curve.
fn about(run: &Run, curve: &DistinctCurve, candidate: &CandidateResult, rated: Option<&RatedCandidateV1>) -> String {
    let choice = run.recommendation.as_ref();
    let roles = [
        ("simplest", choice.and_then(|choice| choice.simplest.as_ref())),
        ("closest", choice.and_then(|choice| choice.closest.as_ref())),
    ];
    // A badge stands beside the candidate that the choice names, also where that shares its row.
    let badges = |id: &String| -> String {
        let own = roles.iter().filter(|(_, named)| *named == Some(id));
        own.map(|(role, _)| format!(" <span class=\"badge\">{role}</span>")).collect()
    };
    let name = |id: &str| html(&capitalised(&run.name_of(id)));
    let mut about = format!("<strong>{}</strong>{}", name(&candidate.id), badges(&candidate.id));
    if let Some(why) = rated.and_then(|rated| rated.not_adequate_because.as_deref()) {
        about.push_str(&format!("<br><span class=\"dual\">not adequate: {}</span>", html(why)));
    }
    if !candidate.record.physical {
        about.push_str("<br><span class=\"no\">not a passive structure</span>");
    }
    if !curve.same_curve.is_empty() {
        let item = |id: &String| format!("<li>{}{}</li>", name(id), badges(id));
        let names: String = curve.same_curve.iter().map(item).collect();
        let count = curve.same_curve.len();
        about.push_str(&format!("<details><summary>same curve: {count} more</summary><ul>{names}</ul></details>"));
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
    let known = interval.map(|interval| (interval.low, interval.high));
    let interval = interval.map_or_else(String::new, |interval| {
        let ends = words::ends((interval.low, interval.high), known, CRUSH.shown());
        format!("<br><span class=\"dual\" tabindex=\"0\" title=\"{}\">{ends}</span>", html(&interval.interval_by))
    });
    let (factor, places, _) = CRUSH.shown();
    format!("<td class=\"n\">{}{interval}</td>", words::rounded(crush, known, (factor, places, "")))
}
