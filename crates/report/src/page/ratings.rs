//! How alike the curves of model and test are, by the ratings of the trade.

use crate::drawing::escape::html;
use crate::drawing::numbers::ABSENT;
use crate::findings::{CandidateResult, Ranking, Run, capitalised};
use crate::page::{UNFOLDED, folded};
use crate::words;
use crumple_artifact::records::{RatingV1, SimulationV1};

use crate::frame::{Column, heads};

/// A column: its quantity, the definition's key, heading, and what to say of it.
type Rated = (&'static str, &'static str, &'static str, &'static str);

const COLUMNS: [Rated; 9] = [
    (
        "acceleration",
        "iso18571",
        "ISO/TS 18571",
        "0.4 corridor + 0.2 phase + 0.2 magnitude + 0.2 slope; 1 is equal. Sampled at 10 kHz only.",
    ),
    ("acceleration", "cora", "CORA", CORA),
    ("acceleration", "sprague-geers-m", "M", "Sprague-Geers magnitude: sqrt(I_cc/I_mm) − 1; 0 is equal."),
    ("acceleration", "sprague-geers-p", "P", "Sprague-Geers phase: acos(I_mc/sqrt(I_mm I_cc))/π; 0 is equal."),
    ("acceleration", "sprague-geers-c", "C", COMPREHENSIVE),
    ("acceleration", "theil-u1", "Theil U1", THEIL),
    ("displacement", "cora", "CORA", CORA),
    ("displacement", "sprague-geers-c", "C", COMPREHENSIVE),
    ("displacement", "theil-u1", "Theil U1", THEIL),
];

// What the ratings of both quantities are.
const CORA: &str = "0.5 corridor + 0.5 cross-correlation over the compared window; 1 is equal.";
const COMPREHENSIVE: &str = "Sprague-Geers comprehensive: sqrt(M² + P²); 0 is equal.";
const THEIL: &str = "Inequality |m − c|/(|m| + |c|), 0 to 1; 0 is equal.";

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
    let columns_of = |quantity: &str| COLUMNS.iter().filter(|column| column.0 == quantity).count() + 1;
    out.push_str(&format!(
        "<section id=\"ratings\">\n{}\
         <div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\" rowspan=\"2\">Model</th>\
         <th scope=\"colgroup\" colspan=\"{}\">Acceleration</th>\
         <th scope=\"colgroup\" colspan=\"{}\">Displacement</th></tr>\n<tr>",
        folded("Ratings: model against test"),
        columns_of("acceleration"),
        columns_of("displacement")
    ));
    let fit = heads(&[Column::number("Fit, %").means("100 (1 − |y − ŷ| / |y − mean y|).")]);
    for (index, (quantity, id, heading, what)) in COLUMNS.iter().enumerate() {
        out.push_str(&format!(
            "<th scope=\"col\" class=\"n\"><abbr tabindex=\"0\" title=\"{} [{id}{}]\">{heading}</abbr></th>",
            html(what),
            mark(&rows, quantity, id).map(|mark| format!(", mark {}", html(mark))).unwrap_or_default()
        ));
        if COLUMNS.get(index + 1).is_none_or(|next| next.0 != *quantity) {
            out.push_str(&fit);
        }
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for (candidate, simulation) in &rows {
        row(out, run, ranking, candidate, simulation);
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

fn row(out: &mut String, run: &Run, ranking: &Ranking, candidate: &CandidateResult, simulation: &SimulationV1) {
    let best = ranking.best.as_deref() == Some(&candidate.id);
    out.push_str(&format!(
        "<tr{}><td>{}</td>",
        if best { " class=\"best\"" } else { "" },
        html(&capitalised(&run.name_of(&candidate.id)))
    ));
    let percent = |fit: Option<f64>| {
        let shown = fit.map_or_else(|| ABSENT.to_owned(), |fit| words::decimals(fit, 2));
        format!("<td class=\"n\">{shown}</td>")
    };
    for (index, (quantity, id, ..)) in COLUMNS.iter().enumerate() {
        let rating = find(simulation, quantity, id);
        let shown = match rating.and_then(|rating| rating.value) {
            Some(value) if *id == "sprague-geers-m" => words::signed(value, 3),
            Some(value) => words::decimals(value, 3),
            None => ABSENT.to_owned(),
        };
        let note = rating.and_then(|rating| rating.note.as_deref()).filter(|_| *id != "cora");
        out.push_str(&match note {
            Some(note) => format!("<td class=\"n\"><abbr tabindex=\"0\" title=\"{}\">{shown}</abbr></td>", html(note)),
            None => format!("<td class=\"n\">{shown}</td>"),
        });
        if COLUMNS.get(index + 1).is_none_or(|next| next.0 != *quantity) {
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
    let (from_s, to_s) = rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), (_, simulation)| {
        (simulation.from_s.min(from), simulation.to_s.max(to))
    });
    let cora = rows.iter().find_map(|(_, simulation)| {
        let rating = simulation.ratings.iter().find(|rating| rating.definition_id == "cora")?;
        Some(format!(" CORA (mark {}) has {}.", html(&rating.mark), html(rating.note.as_deref()?)))
    });
    out.push_str(&format!(
        "<p class=\"caption\">Over {} after time zero. ISO/TS 18571 and CORA: 1 is equal; M, P, C (Sprague-Geers) and \
         Theil's U1: 0 is equal. Roadside practice accepts |M| and P up to 0.4.{} Marks: C checked, S after a \
         secondary source, M from memory, U uncertain.</p>\n",
        words::times(from_s, to_s),
        cora.unwrap_or_default()
    ));
}
