//! How alike the curves of model and test are, by the ratings of the trade.

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::{CandidateResult, Ranking, Run, candidate_name};
use crate::page::{UNFOLDED, folded};
use crate::phrases::HowWellTexts;
use crate::phrases::PHRASES;
use crate::phrases::words;
use crate::phrases::words::fill;
use crumple_artifact::records::{RatingV1, SimulationV1};

use crate::frame::{Column, heads};
use crate::page::how_well::grade;

/// A column: its quantity, the definition's key, heading, and what to say of it.
type Rated = (&'static str, &'static str, &'static str, &'static str);

const fn columns(texts: &HowWellTexts) -> [Rated; 9] {
    [
        ("acceleration", "iso18571", "ISO/TS 18571", texts.standard_definition),
        ("acceleration", "cora", "CORA", texts.cora_definition),
        ("acceleration", "sprague-geers-m", "M", texts.m_definition),
        ("acceleration", "sprague-geers-p", "P", texts.p_definition),
        ("acceleration", "sprague-geers-c", "C", texts.c_definition),
        ("acceleration", "theil-u1", "Theil U1", texts.theil_definition),
        ("displacement", "cora", "CORA", texts.cora_definition),
        ("displacement", "sprague-geers-c", "C", texts.c_definition),
        ("displacement", "theil-u1", "Theil U1", texts.theil_definition),
    ]
}

pub(super) fn write(out: &mut String, run: &Run, ranking: &Ranking) {
    let mut rows: Vec<(&CandidateResult, &SimulationV1)> = run
        .candidates
        .iter()
        .filter_map(|candidate| Some((candidate, candidate.simulation.as_ref().filter(|s| !s.ratings.is_empty())?)))
        .collect();
    if rows.is_empty() {
        return;
    }
    rows.sort_by_key(|(candidate, _)| ranking.place(&candidate.id).unwrap_or(usize::MAX));
    let texts = &PHRASES.how_well;
    let columns = columns(texts);
    let columns_of = |quantity: &str| columns.iter().filter(|column| column.0 == quantity).count() + 1;
    out.push_str(&format!(
        "<section>\n{}<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\" rowspan=\"2\">{}</th>\
         <th scope=\"colgroup\" colspan=\"{}\">{}</th><th scope=\"colgroup\" colspan=\"{}\">{}</th></tr>\n<tr>",
        folded(texts.ratings),
        texts.model,
        columns_of("acceleration"),
        texts.acceleration,
        columns_of("displacement"),
        texts.displacement
    ));
    let fit = heads(&[Column::number(texts.fit).means(texts.fit_definition)]);
    for (index, (quantity, id, heading, what)) in columns.iter().enumerate() {
        out.push_str(&format!(
            "<th scope=\"col\" class=\"n\"><abbr tabindex=\"0\" title=\"{} [{id}{}]\">{heading}</abbr></th>",
            html(what),
            mark(&rows, quantity, id).map_or_else(String::new, |mark| fill(texts.mark, &[("mark", html(mark))]))
        ));
        if columns.get(index + 1).is_none_or(|next| next.0 != *quantity) {
            out.push_str(&fit);
        }
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for (candidate, simulation) in &rows {
        row(out, candidate, simulation, ranking);
    }
    out.push_str("</tbody>\n</table></div>\n");
    caption(out, &rows);
    out.push_str(UNFOLDED);
}

fn find<'a>(simulation: &'a SimulationV1, quantity: &str, id: &str) -> Option<&'a RatingV1> {
    simulation.ratings.iter().find(|rating| rating.quantity == quantity && rating.definition_id == id)
}

/// The letter of the first candidate that has the rating: a definition has one mark.
fn mark<'a>(rows: &[(&CandidateResult, &'a SimulationV1)], quantity: &str, id: &str) -> Option<&'a str> {
    rows.iter().find_map(|(_, simulation)| find(simulation, quantity, id)).map(|rating| rating.mark.as_str())
}

fn row(out: &mut String, candidate: &CandidateResult, simulation: &SimulationV1, ranking: &Ranking) {
    let columns = columns(&PHRASES.how_well);
    let best = ranking.best.as_deref() == Some(&candidate.id);
    out.push_str(&format!(
        "<tr{}><td>{}</td>",
        if best { " class=\"best\"" } else { "" },
        html(&candidate_name(&candidate.id))
    ));
    let percent = |fit: Option<f64>| {
        let shown = fit.map_or_else(|| ABSENT.to_owned(), |fit| words::decimals(fit, 2));
        format!("<td class=\"n\">{shown}</td>")
    };
    for (index, (quantity, id, ..)) in columns.iter().enumerate() {
        let rating = find(simulation, quantity, id);
        let shown = match rating.and_then(|rating| rating.value) {
            Some(value) if *id == "sprague-geers-m" => words::signed(value, 3),
            Some(value) => words::decimals(value, 3),
            None => ABSENT.to_owned(),
        };
        let note = rating.and_then(|rating| rating.note.as_deref()).filter(|_| *id != "cora");
        let note = note.map(grade);
        out.push_str(&match note {
            Some(note) => format!("<td class=\"n\"><abbr tabindex=\"0\" title=\"{}\">{shown}</abbr></td>", html(note)),
            None => format!("<td class=\"n\">{shown}</td>"),
        });
        if columns.get(index + 1).is_none_or(|next| next.0 != *quantity) {
            let acceleration = *quantity == "acceleration";
            out.push_str(&percent(if acceleration {
                simulation.fit_acceleration_percent
            } else {
                simulation.fit_percent
            }));
        }
    }
    out.push_str("</tr>\n");
}

/// The window and what CORA's published formulas leave to the one who computes them.
fn caption(out: &mut String, rows: &[(&CandidateResult, &SimulationV1)]) {
    let texts = &PHRASES.how_well;
    let (from_s, to_s) = rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), (_, simulation)| {
        (simulation.from_s.min(from), simulation.to_s.max(to))
    });
    let cora = rows.iter().find_map(|(_, simulation)| {
        let rating = simulation.ratings.iter().find(|rating| rating.definition_id == "cora")?;
        Some(fill(texts.cora_has, &[("mark", html(&rating.mark)), ("note", html(rating.note.as_deref()?))]))
    });
    let filled = [("times", words::times(from_s, to_s)), ("cora", cora.unwrap_or_default())];
    out.push_str(&format!("<p class=\"caption\">{}</p>\n", fill(texts.ratings_caption, &filled)));
}
