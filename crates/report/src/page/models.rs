//! The table of identified models and their poles.

use crate::words;
use std::f64::consts::TAU;

use crate::drawing::Figure;
use crate::drawing::escape::html;
use crate::drawing::numbers::{ABSENT, Rounding};
use crate::findings::{Concern, Model, ModelOutput, PoleStability, Run, is_of_a_failed_method};
use crumple_artifact::records::{
    EvidenceV1, IdentificationV1, ModeV1, NoiseModelV1, OtherPoleKindV1, RecommendedBecauseV1, SpreadV1,
};
use crumple_signal::{Note, Severity};

use crate::frame::{Column, table};
use crate::page::figures;

/// What the samples of a model between inputs and outputs are taken for, as the record says.
const BETWEEN: &str = "input-output";
/// Pole rows of a model that are open to view; the rest is folded.
const OPEN_ROWS: usize = 12;

pub(super) fn write(out: &mut String, run: &Run, concerns: &[Concern], drawn: &[Figure]) {
    if run.models.is_empty() {
        return;
    }
    out.push_str("<section id=\"identification\">\n<h2>Identification</h2>\n");
    // Of a crash they are a way to the physical model, of any other record they are the result.
    if !run.is_generic() {
        let (count, models) = (run.models.len(), if run.models.len() == 1 { "model" } else { "models" });
        out.push_str(&format!(
            "<details><summary>{count} identified {models}: poles, order, frequency response</summary>\n"
        ));
    }
    write_recommended(out, run);
    figures::write(out, drawn, "h3");
    for place in run.model_order() {
        write_model(out, &run.models[place]);
    }
    write_failed_methods(out, concerns);
    if !run.is_generic() {
        out.push_str("</details>\n");
    }
    out.push_str("</section>\n");
}

/// Which model of every output to use, and why.
fn write_recommended(out: &mut String, run: &Run) {
    for selection in &run.selections {
        let Some((id, because)) = selection.recommended.as_ref().zip(selection.recommended_because) else { continue };
        let because = match because {
            RecommendedBecauseV1::SmallestBic => "it has the smallest BIC of all".to_owned(),
            RecommendedBecauseV1::ValidatesBetter => {
                let other = selection.passed_over.as_deref().unwrap_or_default();
                format!(
                    "it follows unseen samples better than <code>{}</code>, which has the smallest BIC and a single \
                     state",
                    html(other)
                )
            }
        };
        let (model, output) = (html(id), html(&selection.output));
        out.push_str(&format!("<p>Use <code>{model}</code> for {output}: {because}.</p>\n"));
    }
}

/// Every method that gave no model, with its reason.
fn write_failed_methods(out: &mut String, concerns: &[Concern]) {
    let failed = concerns.iter().filter(|concern| is_of_a_failed_method(concern));
    let items: String = failed.map(|concern| format!("<li>{}</li>", html(&concern.text))).collect();
    if !items.is_empty() {
        out.push_str(&format!("<h3>Not identified</h3>\n<ul class=\"remarks\">{items}</ul>\n"));
    }
}

fn write_model(out: &mut String, model: &Model) {
    out.push_str(&format!("<h3><code>{}</code></h3>\n", html(&model.id)));
    let notes: Vec<Note> = model.identification.iter().flat_map(|i| &i.notes).map(|text| Note::parse(text)).collect();
    let list = |severity: Severity| -> String {
        let of_severity = notes.iter().filter(|note| note.severity == severity);
        of_severity.map(|note| format!("<li>{}</li>", html(&note.to_string()))).collect()
    };
    let warnings = list(Severity::Warning);
    if !warnings.is_empty() {
        out.push_str(&format!("<ul class=\"remarks\">{warnings}</ul>\n"));
    }
    if let Some(i) = &model.identification {
        out.push_str(&format!("<p>{}</p>\n", html(&format!("{}.", facts(model, i).join("; ")))));
    }
    write_outputs(out, model);
    write_form(out, model);
    write_poles(out, model);
    let infos = list(Severity::Info);
    if !infos.is_empty() {
        let count = notes.iter().filter(|n| n.severity == Severity::Info).count();
        out.push_str(&format!(
            "<details><summary>Notes on this model ({count})</summary>\n\
             <ul class=\"remarks\">{infos}</ul>\n</details>\n"
        ));
    }
}

/// How a model was identified and why the search for it stopped.
fn facts(model: &Model, i: &IdentificationV1) -> Vec<String> {
    let mut facts = vec![
        format!("method {}", i.method),
        format!("order {}", i.order),
        match i.treated_as.as_str() {
            // Between inputs and outputs a channel is what it is.
            BETWEEN => format!("output {}", i.channel),
            other => format!("channel {} taken for {}", i.channel, other.replace('-', " ")),
        },
        format!("{}, {} samples", words::times(i.from_s, i.to_s), i.samples),
    ];
    if let (Some(rows), Some(columns)) = (i.hankel_rows, i.hankel_columns) {
        facts.push(format!("Hankel matrix {rows} × {columns}"));
    }
    if let Some(reason) = model.evidence.as_ref().and_then(|evidence| evidence.stop_reason.as_ref()) {
        facts.push(format!("search stopped: {}", reason.replace('-', " ")));
    }
    facts
}

/// Fit and validation of every output, and whether its errors are correlated.
fn write_outputs(out: &mut String, model: &Model) {
    if model.outputs.is_empty() {
        return;
    }
    type Measure = fn(&ModelOutput) -> Option<f64>;
    let known = |of: Measure| model.outputs.iter().any(|output| of(output).is_some());
    let columns: Vec<(Column<'_>, Measure, usize)> = [
        (
            Column::number("Fit, %")
                .means("Of the simulated output, with its start fitted, on the samples identified from."),
            (|o| o.fit_percent) as Measure,
            2,
        ),
        (
            Column::number("Unseen, %").means("Fit of the samples kept for validation, with the start fitted to them."),
            |o| o.evidence.as_ref()?.validation_restarted_fit_percent,
            2,
        ),
        (
            Column::number("Run on, %").means("The same from the state at the end of the samples identified from."),
            |o| o.evidence.as_ref()?.validation_fit_percent,
            2,
        ),
        (
            Column::number("Errors at lag one")
                .means("Autocorrelation of the errors of the simulation one sample apart; near 0: white."),
            |o| o.evidence.as_ref()?.residual_lag_one,
            3,
        ),
        (
            Column::number("Worth").means("Number of independent samples that the correlated errors are worth."),
            |o| o.evidence.as_ref()?.effective_samples,
            0,
        ),
    ]
    .into_iter()
    .filter(|(_, of, _)| known(*of))
    .collect();
    let heads: Vec<Column<'_>> =
        std::iter::once(Column::text("Output")).chain(columns.iter().map(|(column, ..)| *column)).collect();
    out.push_str(&table("", &heads));
    for output in &model.outputs {
        let cell = |(_, of, digits): &(Column<'_>, Measure, usize)| {
            let value = of(output).map_or(ABSENT.to_owned(), |x| words::decimals(x, *digits));
            format!("<td class=\"n\">{value}</td>")
        };
        let cells: String = columns.iter().map(cell).collect();
        out.push_str(&format!("<tr><td>{}</td>{cells}</tr>\n", html(&output.channel)));
    }
    out.push_str("</tbody>\n</table></div>\n");
    let evidence = || model.outputs.iter().filter_map(|output| output.evidence.as_ref());
    let is_correlated =
        |e: &&EvidenceV1| e.simulation_whiteness.zip(e.whiteness_limit).is_some_and(|(q, limit)| q > limit);
    if let Some(worst) = evidence().find(is_correlated) {
        let (count, all) = (evidence().filter(is_correlated).count(), evidence().count());
        let of_what = if all > 1 { format!("{count} of {all} outputs") } else { "the simulation".to_owned() };
        out.push_str(&format!(
            "<p class=\"caption\">The errors of {of_what} are correlated (Q {}, {} allowed): {}.</p>\n",
            words::significant(worst.simulation_whiteness.unwrap_or_default(), 3),
            words::significant(worst.whiteness_limit.unwrap_or_default(), 3),
            effect_of_correlation(worst)
        ));
    }
}

/// What correlated errors do to the deviations of a model.
fn effect_of_correlation(evidence: &EvidenceV1) -> String {
    let has_spreads = evidence.frequency_spreads.iter().any(Option::is_some);
    let is_linearised = !evidence.frequency_deviations.is_empty() || !evidence.denominator_deviations.is_empty();
    match (&evidence.noise, evidence.effective_samples) {
        (Some(noise), _) if has_spreads && noise.is_white => match noise.model {
            NoiseModelV1::OutputError => {
                format!("intervals are drawn from noise of an autoregression of order {}", noise.ar_order)
            }
            NoiseModelV1::Arx => "intervals are drawn from noise that goes through the poles of the system".to_owned(),
        },
        (Some(noise), _) if !noise.is_white => {
            "no noise model explains them, deviations would be too small, and intervals are left out".to_owned()
        }
        (_, Some(effective)) if is_linearised => format!(
            "the deviations count as many independent samples as they are worth, {}",
            words::decimals(effective, 0)
        ),
        _ => "deviations that take them for white would be too small".to_owned(),
    }
}

/// Numerators of more paths are left to the artifact.
const MOST_NUMERATORS: usize = 4;

/// The polynomials of transfer functions with their deviations, or the sizes of a state space.
fn write_form(out: &mut String, model: &Model) {
    if !model.is_transfer_function() {
        let Some(states) = &model.state_space else { return };
        let sampled = match states.sample_time_s {
            0.0 => "continuous".to_owned(),
            dt_s => format!("sampled every {} s", words::significant(dt_s, 4)),
        };
        out.push_str(&format!(
            "<p>State space, {sampled}: states {}, inputs {}, outputs {}.</p>\n",
            states.a.len(),
            states.b.first().map_or(0, Vec::len),
            states.c.len()
        ));
        return;
    }
    let per_output = model.paths.len() / model.outputs.len().max(1);
    let mut lines = Vec::new();
    for (place, path) in model.paths.iter().enumerate().take(MOST_NUMERATORS) {
        let evidence = model.outputs.get(place / per_output.max(1)).and_then(|output| output.evidence.as_ref());
        let all = evidence.map_or(&[][..], |evidence| &evidence.numerator_deviations);
        let each = all.len() / per_output.max(1);
        let own = &all[(place % per_output.max(1)) * each..][..each];
        let name = match model.paths.len() {
            1 => "Numerator".to_owned(),
            _ => format!("Numerator from {} to {}", html(&path.input), html(&path.output)),
        };
        lines.push(format!("{name}: {}", polynomial(&path.numerator, own)));
    }
    if model.paths.len() > MOST_NUMERATORS {
        lines.push(format!("{} more numerators are in the artifact.", model.paths.len() - MOST_NUMERATORS));
    }
    if let Some(path) = model.paths.first() {
        let deviations = model.evidence.as_ref().map_or(&[][..], |evidence| &evidence.denominator_deviations);
        lines.push(format!("Denominator: {}", polynomial(&path.denominator, deviations)));
    }
    out.push_str(&format!("<p>{}</p>\n", lines.join("<br>\n")));
}

/// `(0.63 ± 0.29) s + 0.98`, three significant digits; deviations belong to the last coefficients.
fn polynomial(coefficients: &[f64], deviations: &[f64]) -> String {
    let count = coefficients.len();
    let deviation_of = |k: usize| (k + deviations.len()).checked_sub(count).and_then(|k| deviations.get(k));
    let terms = coefficients.iter().enumerate().map(|(k, value)| {
        let number = words::significant(*value, 3);
        let number = match deviation_of(k) {
            Some(deviation) => format!("({number} ± {})", words::significant(*deviation, 3)),
            None => number,
        };
        let is_one = *value == 1.0 && deviation_of(k).is_none();
        match count - 1 - k {
            0 => number,
            1 => {
                if is_one {
                    "<i>s</i>".to_owned()
                } else {
                    format!("{number} <i>s</i>")
                }
            }
            power if is_one => format!("<i>s</i><sup>{power}</sup>"),
            power => format!("{number} <i>s</i><sup>{power}</sup>"),
        }
    });
    terms.collect::<Vec<_>>().join(" + ")
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
        out.push_str(&format!("<details><summary>{} poles and pairs</summary>\n", lines.len()));
    }
    let columns = [
        Column::number("Pole, 1/s"),
        Column::number("Natural frequency, Hz").means("Modulus of the pole over 2π."),
        Column::number("Damping ratio, %").means("−Re over the modulus; negative: unstable."),
        Column::number("Coherence")
            .means("Modal amplitude coherence, 0 to 1: how well the mode follows its own decay."),
        Column::number("Share").means("Mode singular value relative to the largest: the mode's share of the response."),
    ];
    let has_amplitudes = model.modes.iter().any(|mode| mode.modal_amplitude_coherence.is_some());
    let count = if has_amplitudes { columns.len() } else { columns.len() - 2 };
    out.push_str(&table("", &columns[..count]));
    for PoleLine { pole: [re, im], stability, cells } in lines {
        let word = match stability {
            PoleStability::Stable => "",
            PoleStability::Marginal => " marginal",
            PoleStability::Unstable => " <span class=\"no\">unstable</span>",
        };
        let im = if im == 0.0 { String::new() } else { format!(" ± {}i", words::significant(im.abs(), 5)) };
        let cells: String = cells[..count - 1].iter().map(|cell| format!("<td class=\"n\">{cell}</td>")).collect();
        out.push_str(&format!("<tr><td class=\"n\">{}{im}{word}</td>{cells}</tr>\n", words::significant(re, 5)));
    }
    out.push_str("</tbody>\n</table></div>\n");
    out.push_str(&format!("<p class=\"caption\">{uncertainty}</p>\n"));
    if folded {
        out.push_str("</details>\n");
    }
    write_zeros(out, model);
}

/// The zeros of a model of one path, with their deviations where these are known.
fn write_zeros(out: &mut String, model: &Model) {
    let Some(response) = &model.response else { return };
    let evidence = model.evidence.as_ref();
    let deviation = |deviations: &[Option<f64>], spreads: &[Option<SpreadV1>], place: usize| {
        let spread = spreads.get(place).and_then(Option::as_ref).map(|spread| spread.deviation);
        spread.or_else(|| deviations.get(place).copied().flatten())
    };
    let number = |value: f64, deviation: Option<f64>| {
        let deviation = deviation.map_or_else(String::new, |d| format!(" ± {}", words::significant(d, 3)));
        format!("{}{deviation}", words::significant(value, 3))
    };
    let zeros = response.zeros_re_per_s.iter().zip(&response.zeros_im_rad_per_s).enumerate();
    let all: Vec<String> = zeros
        .filter(|(_, (_, im))| **im >= 0.0)
        .map(|(place, (re, im))| {
            let known = evidence.map(|e| {
                let of_re = deviation(&e.zero_re_deviations, &e.zero_re_spreads, place);
                (of_re, deviation(&e.zero_im_deviations, &e.zero_im_spreads, place))
            });
            let (of_re, of_im) = known.unwrap_or_default();
            let (re, of_pair) = (number(*re, of_re), number(*im, of_im));
            if *im == 0.0 { re } else { format!("{re} with imaginary parts ±({of_pair})") }
        })
        .collect();
    if !all.is_empty() {
        out.push_str(&format!("<p>Zeros, 1/s: {}.</p>\n", all.join("; ")));
    }
}

/// Natural frequency, damping ratio, coherence and share of every pole, in the order of [`Model::poles`], and in words
/// where their uncertainty is from: the bootstrap, else the covariance of the fit, else nowhere.
fn cells_of_poles(model: &Model) -> (Vec<[String; 4]>, &'static str) {
    let number = |value: Option<f64>, deviation: Option<f64>, factor: f64, ends: Option<[f64; 2]>| {
        let Some(value) = value else { return ABSENT.to_owned() };
        let Some(deviation) = deviation.map(|d| factor * d).filter(|d| *d > 0.0 && d.is_finite()) else {
            return words::significant(factor * value, 4);
        };
        // Two digits of the deviation.
        let rounding = Rounding::of_interval(-deviation, deviation).unwrap_or(Rounding::WITHOUT_INTERVAL);
        let ends = ends.map_or_else(String::new, |ends| {
            let [low, high] = ends.map(|end| rounding.show(factor * end));
            format!(" ({})", words::between(&low, &high))
        });
        format!("{} ± {}{ends}", rounding.show(factor * value), rounding.show(deviation))
    };
    let evidence = model.evidence.as_ref();
    let by_covariance =
        |evidence: &EvidenceV1| [evidence.frequency_deviations.clone(), evidence.damping_deviations.clone()];
    let by_bootstrap = |evidence: &EvidenceV1| {
        [&evidence.frequency_spreads, &evidence.damping_spreads]
            .map(|spreads| spreads.iter().map(|spread| spread.as_ref().map(|spread| spread.deviation)).collect())
    };
    let is_known = |deviations: &[Vec<Option<f64>>; 2]| deviations.iter().flatten().any(Option::is_some);
    let sources = [
        (evidence.map(by_bootstrap), "± one standard deviation, and the 90 % interval, from the bootstrap."),
        (evidence.map(by_covariance), "± one standard deviation, from the covariance of the linearised fit."),
    ];
    let known = sources.into_iter().find_map(|(deviations, words)| Some((deviations.filter(is_known)?, words)));
    let ([frequency, damping], words) =
        known.unwrap_or(([Vec::new(), Vec::new()], "No uncertainty of these poles is known."));
    let deviation = |of_modes: &[Option<f64>], place: usize| of_modes.get(place).copied().flatten();
    let ends = |spreads: fn(&EvidenceV1) -> &[Option<SpreadV1>], place: usize| {
        let spread = spreads(evidence?).get(place)?.as_ref()?;
        Some([spread.lower, spread.upper])
    };
    let modes = model.modes.iter().enumerate().map(|(place, mode): (usize, &ModeV1)| {
        let frequency_ends = ends(|evidence| &evidence.frequency_spreads, place);
        let damping_ends = ends(|evidence| &evidence.damping_spreads, place);
        [
            number(Some(mode.natural_frequency_rad_per_s), deviation(&frequency, place), 1.0 / TAU, frequency_ends),
            number(mode.damping_ratio, deviation(&damping, place), 100.0, damping_ends),
            number(mode.modal_amplitude_coherence, None, 1.0, None),
            number(mode.mode_singular_value, None, 1.0, None),
        ]
    });
    let others = model.other_poles.iter().map(|pole| {
        let why = match pole.kind {
            OtherPoleKindV1::Integrator => "no mode: near zero",
            OtherPoleKindV1::BeyondNyquist => "no mode: beyond the sampling",
            OtherPoleKindV1::Cancelled => "no mode: a zero cancels it",
            OtherPoleKindV1::Harmonic => "no mode: a machine that runs",
        };
        [why, ABSENT, ABSENT, ABSENT].map(str::to_owned)
    });
    (modes.chain(others).collect(), words)
}
