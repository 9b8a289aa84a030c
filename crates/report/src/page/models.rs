//! The table of identified models and their poles.

use std::f64::consts::TAU;

use crumple_artifact::records::{EvidenceV1, ModeV1};
use crumple_drawing::Figure;
use crumple_drawing::escape::html;
use crumple_drawing::numbers::{ABSENT, decimals, significant, times};

use crate::page::figures;
use crate::{Model, Run};

/// Pole rows of a model that are open to view; the rest is folded.
const OPEN_ROWS: usize = 12;

pub(super) fn write(out: &mut String, run: &Run, drawn: &[Figure]) {
    if run.models.is_empty() {
        return;
    }
    out.push_str(&format!("<section id=\"identification\">\n<h2>{}</h2>\n", run.language.phrases().identification));
    // Of a crash they are a way to the physical model, of any other record they are the result.
    let count = run.models.len();
    if !run.is_generic() {
        let plural = if count == 1 { "" } else { "s" };
        out.push_str(&format!(
            "<details><summary>{count} identified model{plural}: poles, order, frequency response</summary>\n"
        ));
    }
    figures::write(out, drawn, "h3");
    for model in &run.models {
        write_model(out, model);
    }
    if !run.is_generic() {
        out.push_str("</details>\n");
    }
    out.push_str("</section>\n");
}

fn write_model(out: &mut String, model: &Model) {
    out.push_str(&format!("<h3><code>{}</code></h3>\n", html(&model.id)));
    if let Some(i) = &model.identification {
        let mut facts = vec![
            format!("method {}", i.method),
            format!("order {}", i.order),
            format!("channel {} taken for {}", i.channel, i.treated_as.replace('-', " ")),
            format!("{}, {} samples", times(i.from_s, i.to_s), i.samples),
        ];
        if let (Some(rows), Some(columns)) = (i.hankel_rows, i.hankel_columns) {
            facts.push(format!("Hankel matrix {rows} × {columns}"));
        }
        if let Some(fit) = i.fit_percent {
            facts.push(format!("fit {} %", decimals(fit, 2)));
        }
        out.push_str(&format!("<p>{}</p>\n", html(&format!("{}.", facts.join("; ")))));
        if !i.notes.is_empty() {
            let items: String = i.notes.iter().map(|text| format!("<li>{}</li>", html(text))).collect();
            out.push_str(&format!("<ul class=\"remarks\">{items}</ul>\n"));
        }
    }
    // A conjugate pair is one line; a pole without its partner, which a real model does not have, is its own.
    let lines: Vec<&ModeV1> = model
        .modes
        .iter()
        .filter(|mode| {
            let partner = |other: &ModeV1| other.re_per_s == mode.re_per_s && other.im_rad_per_s == -mode.im_rad_per_s;
            mode.im_rad_per_s >= 0.0 || !model.modes.iter().any(partner)
        })
        .collect();
    if lines.is_empty() {
        return;
    }
    let folded = lines.len() > OPEN_ROWS;
    if folded {
        out.push_str(&format!("<details><summary>{} poles and pairs</summary>\n", lines.len()));
    }
    out.push_str(
        "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\" class=\"n\">Pole, 1/s</th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Modulus of the pole over 2π.\">Natural frequency, Hz</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"−Re over the modulus; negative: unstable.\">Damping ratio, \
         %</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Modal amplitude coherence, 0 to 1: how well the mode follows its \
         own decay.\">Coherence</abbr></th>\
         <th scope=\"col\" class=\"n\"><abbr title=\"Mode singular value relative to the largest: the mode's share of \
         the response.\">Share</abbr></th>\
         </tr></thead>\n<tbody>\n",
    );
    let deviations = |of: fn(&EvidenceV1) -> &[Option<f64>], mode: &ModeV1| {
        let place = model.modes.iter().position(|other| std::ptr::eq(other, mode))?;
        *of(model.evidence.as_ref()?).get(place)?
    };
    let with_deviation = |value: Option<f64>, deviation: Option<f64>, factor: f64| {
        let Some(value) = value else { return ABSENT.to_owned() };
        let deviation = deviation.map_or_else(String::new, |d| format!(" ± {}", significant(factor * d, 2)));
        format!("{}{deviation}", significant(factor * value, 4))
    };
    let mut has_deviations = false;
    for mode in lines {
        let frequency = deviations(|evidence| &evidence.frequency_deviations, mode);
        let damping = deviations(|evidence| &evidence.damping_deviations, mode);
        has_deviations |= frequency.or(damping).is_some();
        let unstable = if mode.re_per_s > 0.0 { " <span class=\"no\">unstable</span>" } else { "" };
        let number =
            |value: Option<f64>, factor: f64| value.map_or_else(|| ABSENT.to_owned(), |v| significant(factor * v, 4));
        out.push_str(&format!(
            "<tr><td class=\"n\">{}{unstable}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td \
             class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
            pole(mode),
            with_deviation(Some(mode.natural_frequency_rad_per_s), frequency, 1.0 / TAU),
            with_deviation(mode.damping_ratio, damping, 100.0),
            number(mode.modal_amplitude_coherence, 1.0),
            number(mode.mode_singular_value, 1.0),
        ));
    }
    out.push_str("</tbody>\n</table></div>\n");
    let words = if has_deviations {
        "± one standard deviation, from the covariance of the fit."
    } else {
        "No uncertainty of these poles is known: the method gives none from one record."
    };
    out.push_str(&format!("<p class=\"caption\">{words}</p>\n"));
    if folded {
        out.push_str("</details>\n");
    }
}

fn pole(mode: &ModeV1) -> String {
    let re = significant(mode.re_per_s, 5);
    if mode.im_rad_per_s == 0.0 { re } else { format!("{re} ± {}i", significant(mode.im_rad_per_s.abs(), 5)) }
}
