//! The table of identified models and their poles.

use std::f64::consts::TAU;

use crumple_artifact::records::{EvidenceV1, ModeV1};
use crumple_drawing::Figure;
use crumple_drawing::escape::html;
use crumple_drawing::numbers::ABSENT;
use crumple_findings::{Model, Run};
use crumple_phrases::language::{Language, fill};

use crate::frame::heads::{Column, table};
use crate::frame::stage_words::words_of_stage;
use crate::page::figures;

/// Pole rows of a model that are open to view; the rest is folded.
const OPEN_ROWS: usize = 12;

pub(super) fn write(out: &mut String, run: &Run, drawn: &[Figure]) {
    if run.models.is_empty() {
        return;
    }
    let (language, texts) = (run.language, &run.language.phrases().identification);
    out.push_str(&format!("<section id=\"identification\">\n<h2>{}</h2>\n", texts.title));
    // Of a crash they are a way to the physical model, of any other record they are the result.
    if !run.is_generic() {
        let template = if run.models.len() == 1 { texts.one_model } else { texts.models };
        let count = fill(template, &[("count", run.models.len().to_string())]);
        out.push_str(&format!("<details><summary>{count}</summary>\n"));
    }
    figures::write(out, drawn, "h3", language);
    for model in &run.models {
        write_model(out, language, model);
    }
    if !run.is_generic() {
        out.push_str("</details>\n");
    }
    out.push_str("</section>\n");
}

fn write_model(out: &mut String, language: Language, model: &Model) {
    let texts = &language.phrases().identification;
    out.push_str(&format!("<h3><code>{}</code></h3>\n", html(&model.id)));
    if let Some(i) = &model.identification {
        let taken_for = [("channel", i.channel.clone()), ("what", i.treated_as.replace('-', " "))];
        let stretch = [("times", language.times(i.from_s, i.to_s)), ("count", i.samples.to_string())];
        let mut facts = vec![
            fill(texts.method, &[("method", &i.method)]),
            fill(texts.order, &[("order", i.order.to_string())]),
            fill(texts.channel_taken_for, &taken_for),
            fill(texts.stretch, &stretch),
        ];
        if let (Some(rows), Some(columns)) = (i.hankel_rows, i.hankel_columns) {
            facts.push(fill(texts.hankel, &[("rows", rows.to_string()), ("columns", columns.to_string())]));
        }
        if let Some(fit) = i.fit_percent {
            facts.push(fill(texts.fit, &[("fit", format!("{} %", language.decimals(fit, 2)))]));
        }
        out.push_str(&format!("<p>{}</p>\n", html(&format!("{}.", facts.join("; ")))));
        if !i.notes.is_empty() {
            let items: String =
                i.notes.iter().map(|text| format!("<li>{}</li>", words_of_stage(language, text))).collect();
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
    let deviations = |of: fn(&EvidenceV1) -> &[Option<f64>], mode: &ModeV1| {
        let place = model.modes.iter().position(|other| std::ptr::eq(other, mode))?;
        *of(model.evidence.as_ref()?).get(place)?
    };
    let with_deviation = |value: Option<f64>, deviation: Option<f64>, factor: f64| {
        let Some(value) = value else { return ABSENT.to_owned() };
        let deviation = deviation.map_or_else(String::new, |d| format!(" ± {}", language.significant(factor * d, 2)));
        format!("{}{deviation}", language.significant(factor * value, 4))
    };
    let mut has_deviations = false;
    for mode in lines {
        let frequency = deviations(|evidence| &evidence.frequency_deviations, mode);
        let damping = deviations(|evidence| &evidence.damping_deviations, mode);
        has_deviations |= frequency.or(damping).is_some();
        let unstable = if mode.re_per_s > 0.0 { texts.unstable } else { "" };
        let unstable =
            if unstable.is_empty() { String::new() } else { format!(" <span class=\"no\">{unstable}</span>") };
        let number = |value: Option<f64>, factor: f64| {
            value.map_or_else(|| ABSENT.to_owned(), |v| language.significant(factor * v, 4))
        };
        out.push_str(&format!(
            "<tr><td class=\"n\">{}{unstable}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td \
             class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
            pole(language, mode),
            with_deviation(Some(mode.natural_frequency_rad_per_s), frequency, 1.0 / TAU),
            with_deviation(mode.damping_ratio, damping, 100.0),
            number(mode.modal_amplitude_coherence, 1.0),
            number(mode.mode_singular_value, 1.0),
        ));
    }
    out.push_str("</tbody>\n</table></div>\n");
    let words = if has_deviations { texts.deviation } else { texts.no_deviation };
    out.push_str(&format!("<p class=\"caption\">{words}</p>\n"));
    if folded {
        out.push_str("</details>\n");
    }
}

fn pole(language: Language, mode: &ModeV1) -> String {
    let re = language.significant(mode.re_per_s, 5);
    if mode.im_rad_per_s == 0.0 {
        return re;
    }
    format!("{re} ± {}i", language.significant(mode.im_rad_per_s.abs(), 5))
}
