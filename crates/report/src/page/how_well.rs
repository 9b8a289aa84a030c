//! How well the recommended model and the closest follow the acceleration: rating in parts, residual, wall force.

use crumple_artifact::records::ResidualV1;

use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, G_PER_M_PER_S2, MILLI};
use crate::findings::{CandidateResult, Ranking, Run, capitalised};
use crate::words;

use crate::frame::{Column, heads};

/// Parts of ISO/TS 18571 and the rating itself, in the order of their columns.
const PARTS: [&str; 5] = ["iso18571-corridor", "iso18571-phase", "iso18571-magnitude", "iso18571-slope", "iso18571"];

pub(super) fn write<'a>(out: &mut String, run: &'a Run, ranking: &Ranking) {
    let closest = run.recommendation.as_ref().and_then(|choice| choice.closest.as_deref());
    let mut ids: Vec<&str> = ranking.best.as_deref().into_iter().chain(closest).collect();
    ids.dedup();
    let shown: Vec<&'a CandidateResult> = ids.into_iter().filter_map(|id| run.candidate(id)).collect();
    let left = |candidate: &&'a CandidateResult| candidate.simulation.as_ref()?.residual.as_ref();
    let residuals: Vec<Option<&ResidualV1>> = shown.iter().map(left).collect();
    let rated = |candidate: &&CandidateResult| candidate.simulation.iter().any(|s| !s.ratings.is_empty());
    if !shown.iter().any(rated) && residuals.iter().all(Option::is_none) {
        return;
    }
    let columns = [
        Column::number("Corridor"),
        Column::number("Phase"),
        Column::number("Magnitude"),
        Column::number("Slope"),
        Column::number("Rating"),
        Column::text("Grade"),
        Column::number("rms, g"),
        Column::number("of the test, %"),
        Column::number("lags beyond limits, %"),
    ];
    out.push_str(&format!(
        "<section id=\"how-well\" aria-labelledby=\"how-well-title\">\n<h2 id=\"how-well-title\">How well</h2>\n\
         <div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\" rowspan=\"2\">Model</th>\
         <th scope=\"colgroup\" colspan=\"6\">Acceleration by ISO/TS 18571</th>\
         <th scope=\"colgroup\" colspan=\"3\">Residual of the acceleration</th>\
         <th scope=\"col\" rowspan=\"2\" class=\"n\">Wall force off by, %</th></tr>\n<tr>{}</tr></thead>\n<tbody>\n",
        heads(&columns)
    ));
    for (candidate, residual) in shown.iter().zip(&residuals) {
        row(out, run, ranking, candidate, *residual);
    }
    out.push_str("</tbody>\n</table></div>\n<div class=\"models\">\n");
    for (number, (candidate, residual)) in shown.iter().zip(&residuals).enumerate() {
        if let Some(residual) = residual {
            autocorrelation(out, number + 1, &run.name_of(&candidate.id), residual);
        }
    }
    out.push_str("</div>\n");
    let window = shown.iter().find_map(|candidate| candidate.simulation.as_ref());
    let over = window.map(|s| format!("Over {} after time zero. ", words::times(s.from_s, s.to_s))).unwrap_or_default();
    out.push_str(&format!(
        "<p class=\"caption\">{over}1 is equal in every part; the rating is 0.4 corridor + 0.2 phase + 0.2 magnitude + \
         0.2 slope (ISO/TS 18571:2014), in words excellent above 0.94, good above 0.80, fair above 0.58, else poor. \
         Residual: filtered test minus the model’s own motion. Of noise one lag in twenty lies beyond the limits; more \
         says that the model misses a part of the pulse.</p>\n</section>\n"
    ));
}

fn row(out: &mut String, run: &Run, ranking: &Ranking, candidate: &CandidateResult, residual: Option<&ResidualV1>) {
    let simulation = candidate.simulation.as_ref();
    let of_acceleration = |id: &str| {
        let mut ratings = simulation.into_iter().flat_map(|simulation| &simulation.ratings);
        ratings.find(|rating| rating.quantity == "acceleration" && rating.definition_id == id)
    };
    let number = |value: Option<f64>, digits: usize| {
        let shown = value.map_or_else(|| ABSENT.to_owned(), |value| words::decimals(value, digits));
        format!("<td class=\"n\">{shown}</td>")
    };
    let parts: String = PARTS.iter().map(|id| number(of_acceleration(id).and_then(|rating| rating.value), 2)).collect();
    let rating = of_acceleration("iso18571");
    let grade = rating.and_then(|rating| rating.note.as_deref()).unwrap_or(ABSENT);
    out.push_str(&format!(
        "<tr{}><td>{}</td>{parts}<td>{}</td>{}{}{}{}</tr>\n",
        if ranking.best.as_deref() == Some(&candidate.id) { " class=\"best\"" } else { "" },
        html(&capitalised(&run.name_of(&candidate.id))),
        html(grade),
        number(residual.map(|residual| G_PER_M_PER_S2 * residual.rms_m_per_s2), 2),
        number(residual.map(|residual| 1e2 * residual.share_of_test), 0),
        number(residual.map(|residual| 1e2 * residual.share_outside), 0),
        number(simulation.and_then(|simulation| simulation.force_misfit_percent), 1),
    ));
}

/// The autocorrelation of a residual with its limits, as a picture.
fn autocorrelation(out: &mut String, number: usize, name: &str, residual: &ResidualV1) {
    const WIDTH: f64 = 350.0;
    const HEIGHT: f64 = 130.0;
    const LEFT: f64 = 34.0;
    const TOP: f64 = 8.0;
    const BOTTOM: f64 = 100.0;
    let last = residual.autocorrelation.len().saturating_sub(1).max(1) as f64;
    let x = |lag: f64| LEFT + (WIDTH - LEFT - 8.0) * lag / last;
    let y = |r: f64| TOP + (BOTTOM - TOP) * (1.0 - r) / 2.0;
    // No finer than the picture shows.
    let step = (residual.autocorrelation.len() / 300).max(1);
    let points: Vec<String> = residual
        .autocorrelation
        .iter()
        .enumerate()
        .step_by(step)
        .map(|(lag, r)| format!("{:.1} {:.1}", x(lag as f64), y(*r)))
        .collect();
    let name = html(name);
    let longest = format!("{} ms", words::decimals(MILLI * residual.lag_s * last, 0));
    let share = format!("{} %", words::decimals(1e2 * residual.share_outside, 0));
    let title = format!(
        "Autocorrelation of the residual of {name}: {share} of the lags up to {longest} lie beyond the limits of noise"
    );
    out.push_str(&format!(
        "<figure class=\"model\">\n<svg class=\"model-picture\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" \
         aria-labelledby=\"residual-{number}\">\n<title id=\"residual-{number}\">{title}</title>\n\
         <rect class=\"band\" x=\"{LEFT}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\"/>\n\
         <path class=\"ground\" d=\"M{LEFT} {:.1}H{:.1}\"/>\n<path class=\"spring\" d=\"M{}\"/>\n\
         <text class=\"interval\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">1</text>\n\
         <text class=\"interval\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">0</text>\n\
         <text class=\"interval\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">−1</text>\n\
         <text class=\"interval\" x=\"{:.1}\" y=\"124\" text-anchor=\"end\">lag, up to {longest}</text>\n</svg>\n\
         <figcaption>Autocorrelation of the residual, {name}; shaded: 95\u{a0}% of noise</figcaption>\n</figure>\n",
        y(residual.limit),
        x(last) - LEFT,
        y(-residual.limit) - y(residual.limit),
        y(0.0),
        x(last),
        points.join("L"),
        LEFT - 5.0,
        y(1.0) + 8.0,
        LEFT - 5.0,
        y(0.0) + 4.0,
        LEFT - 5.0,
        y(-1.0),
        x(last),
    ));
}
