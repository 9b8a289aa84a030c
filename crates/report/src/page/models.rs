//! The table of identified models and their poles.

use crate::phrases::PHRASES;
use crate::phrases::words;
use std::f64::consts::TAU;

use crate::drawing::Figure;
use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::{Model, PoleStability, Run, is_of_a_failed_method};
use crate::phrases::words::fill;
use crumple_artifact::records::{ConcernV1, EvidenceV1, ModeV1, OtherPoleKindV1};

use crate::frame::{Column, table};
use crate::page::figures;

/// What the samples of a model between inputs and outputs are taken for, as the record says.
const BETWEEN: &str = "input-output";
/// Pole rows of a model that are open to view; the rest is folded.
const OPEN_ROWS: usize = 12;

pub(super) fn write(out: &mut String, run: &Run, concerns: &[ConcernV1], drawn: &[Figure]) {
    if run.models.is_empty() {
        return;
    }
    let texts = &PHRASES.identification;
    out.push_str(&format!("<section id=\"identification\">\n<h2>{}</h2>\n", texts.title));
    // Of a crash they are a way to the physical model, of any other record they are the result.
    if !run.is_generic() {
        let template = if run.models.len() == 1 { texts.one_model } else { texts.models };
        let count = fill(template, &[("count", run.models.len().to_string())]);
        out.push_str(&format!("<details><summary>{count}</summary>\n"));
    }
    figures::write(out, drawn, "h3");
    for model in &run.models {
        write_model(out, model);
    }
    write_failed_methods(out, concerns);
    if !run.is_generic() {
        out.push_str("</details>\n");
    }
    out.push_str("</section>\n");
}

/// Every method that gave no model, with its reason.
fn write_failed_methods(out: &mut String, concerns: &[ConcernV1]) {
    let failed = concerns.iter().filter(|concern| is_of_a_failed_method(concern));
    let items: String = failed.map(|concern| format!("<li>{}</li>", html(&concern.text))).collect();
    if !items.is_empty() {
        let title = PHRASES.identification.failed_methods;
        out.push_str(&format!("<h3>{title}</h3>\n<ul class=\"remarks\">{items}</ul>\n"));
    }
}

fn write_model(out: &mut String, model: &Model) {
    let texts = &PHRASES.identification;
    out.push_str(&format!("<h3><code>{}</code></h3>\n", html(&model.id)));
    if let Some(i) = &model.identification {
        let taken_for = [("channel", i.channel.clone()), ("what", i.treated_as.replace('-', " "))];
        // Between inputs and outputs a channel is what it is.
        let template = if i.treated_as == BETWEEN { texts.output } else { texts.channel_taken_for };
        let stretch = [("times", words::times(i.from_s, i.to_s)), ("count", i.samples.to_string())];
        let mut facts = vec![
            fill(texts.method, &[("method", &i.method)]),
            fill(texts.order, &[("order", i.order.to_string())]),
            fill(template, &taken_for),
            fill(texts.stretch, &stretch),
        ];
        if let (Some(rows), Some(columns)) = (i.hankel_rows, i.hankel_columns) {
            facts.push(fill(texts.hankel, &[("rows", rows.to_string()), ("columns", columns.to_string())]));
        }
        if let Some(fit) = i.fit_percent {
            facts.push(fill(texts.fit, &[("fit", format!("{} %", words::decimals(fit, 2)))]));
        }
        if let Some(fit) = model.unseen_fit_percent() {
            facts.push(fill(texts.unseen_fit, &[("fit", format!("{} %", words::decimals(fit, 2)))]));
        }
        out.push_str(&format!("<p>{}</p>\n", html(&format!("{}.", facts.join("; ")))));
        if !i.notes.is_empty() {
            let items: String = i.notes.iter().map(|text| format!("<li>{}</li>", html(text))).collect();
            out.push_str(&format!("<ul class=\"remarks\">{items}</ul>\n"));
        }
    }
    write_poles(out, model);
}

/// What the table of poles has of one pole, or of a conjugate pair.
struct PoleLine {
    pole: [f64; 2],
    stability: PoleStability,
    /// The cells after the pole.
    cells: [String; 4],
}

/// The table of the poles of a model: its modes, then the poles that are none.
fn write_poles(out: &mut String, model: &Model) {
    let texts = &PHRASES.identification;
    let (cells, uncertainty) = cells_of_poles(model);
    let poles: Vec<([f64; 2], PoleStability)> = model.poles().collect();
    // A conjugate pair is one line; a pole without its partner, which a real model does not have, is its own.
    let is_shown = |[re, im]: [f64; 2]| im >= 0.0 || !poles.iter().any(|(other, _)| *other == [re, -im]);
    let lines: Vec<PoleLine> = poles
        .iter()
        .zip(cells)
        .filter(|((pole, _), _)| is_shown(*pole))
        .map(|((pole, stability), cells)| PoleLine { pole: *pole, stability: *stability, cells })
        .collect();
    if lines.is_empty() {
        return;
    }
    let folded = lines.len() > OPEN_ROWS;
    if folded {
        let count = fill(texts.poles_and_pairs, &[("count", lines.len().to_string())]);
        out.push_str(&format!("<details><summary>{count}</summary>\n"));
    }
    let columns = [
        Column::number(texts.pole),
        Column::number(texts.natural_frequency).means(texts.natural_frequency_definition),
        Column::number(texts.damping_ratio).means(texts.damping_ratio_definition),
        Column::number(texts.coherence).means(texts.coherence_definition),
        Column::number(texts.share).means(texts.share_definition),
    ];
    out.push_str(&table("", &columns));
    for PoleLine { pole: [re, im], stability, cells } in lines {
        let word = match stability {
            PoleStability::Stable => String::new(),
            PoleStability::Marginal => format!(" {}", texts.marginal),
            PoleStability::Unstable => format!(" <span class=\"no\">{}</span>", texts.unstable),
        };
        let im = if im == 0.0 { String::new() } else { format!(" ± {}i", words::significant(im.abs(), 5)) };
        let cells: String = cells.iter().map(|cell| format!("<td class=\"n\">{cell}</td>")).collect();
        out.push_str(&format!("<tr><td class=\"n\">{}{im}{word}</td>{cells}</tr>\n", words::significant(re, 5)));
    }
    out.push_str("</tbody>\n</table></div>\n");
    out.push_str(&format!("<p class=\"caption\">{uncertainty}</p>\n"));
    if folded {
        out.push_str("</details>\n");
    }
}

/// Natural frequency, damping ratio, coherence and share of every pole, in the order of [`Model::poles`], and in words
/// where their uncertainty is from: the covariance of the fit, else the bootstrap, else nowhere.
fn cells_of_poles(model: &Model) -> (Vec<[String; 4]>, &'static str) {
    let texts = &PHRASES.identification;
    let number = |value: Option<f64>, deviation: Option<f64>, factor: f64| {
        let Some(value) = value else { return ABSENT.to_owned() };
        let deviation = deviation.map_or_else(String::new, |d| format!(" ± {}", words::significant(factor * d, 2)));
        format!("{}{deviation}", words::significant(factor * value, 4))
    };
    let evidence = model.evidence.as_ref();
    let by_covariance =
        |evidence: &EvidenceV1| [evidence.frequency_deviations.clone(), evidence.damping_deviations.clone()];
    let by_bootstrap = |evidence: &EvidenceV1| {
        [&evidence.frequency_spreads, &evidence.damping_spreads]
            .map(|spreads| spreads.iter().map(|spread| spread.as_ref().map(|spread| spread.deviation)).collect())
    };
    let is_known = |deviations: &[Vec<Option<f64>>; 2]| deviations.iter().flatten().any(Option::is_some);
    let sources = [(evidence.map(by_covariance), texts.deviation), (evidence.map(by_bootstrap), texts.spread)];
    let known = sources.into_iter().find_map(|(deviations, words)| Some((deviations.filter(is_known)?, words)));
    let ([frequency, damping], words) = known.unwrap_or(([Vec::new(), Vec::new()], texts.no_deviation));
    let deviation = |of_modes: &[Option<f64>], place: usize| of_modes.get(place).copied().flatten();
    let modes = model.modes.iter().enumerate().map(|(place, mode): (usize, &ModeV1)| {
        [
            number(Some(mode.natural_frequency_rad_per_s), deviation(&frequency, place), 1.0 / TAU),
            number(mode.damping_ratio, deviation(&damping, place), 100.0),
            number(mode.modal_amplitude_coherence, None, 1.0),
            number(mode.mode_singular_value, None, 1.0),
        ]
    });
    let others = model.other_poles.iter().map(|pole| {
        let why = match pole.kind {
            OtherPoleKindV1::Integrator => texts.integrator,
            OtherPoleKindV1::BeyondNyquist => texts.beyond_nyquist,
        };
        [why, ABSENT, ABSENT, ABSENT].map(str::to_owned)
    });
    (modes.chain(others).collect(), words)
}
