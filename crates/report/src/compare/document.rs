//! The comparison of several runs as a page and as Markdown.

use std::collections::BTreeSet;

use crumple_drawing::escape::{address, html};
use crumple_drawing::numbers::ABSENT;

use super::compared_run::ComparedRun;
use super::figure::figure;
use super::numbers::{TOLERANCE, key_number_rows, model_rows, prediction_rows};
use super::settings;
use super::table::{Row, to_html, to_markdown};
use crate::conclusions::conclusion::conclusion;
use crate::frame::framed::{FIGURES, framed};
use crate::page::figures;
use crate::text::markdown::{HEAD, markdown};

/// Several runs beside each other.
#[derive(Debug)]
pub struct RunComparison<'a> {
    runs: &'a [ComparedRun],
    names: Vec<String>,
    /// Heading, what the first column is, rows.
    tables: Vec<(&'static str, &'static str, Vec<Row>)>,
    sentences: Vec<String>,
}

impl<'a> RunComparison<'a> {
    /// Compares every run with the first. The same runs give the same bytes.
    pub fn new(runs: &'a [ComparedRun]) -> Self {
        let (numbers, models, made) = (key_number_rows(runs), model_rows(runs), settings::rows(runs));
        let sentences = vec![made_of(runs, &made), what_differs(&numbers, &models)];
        let mut tables = vec![
            ("Key numbers", "Number", numbers),
            ("Recommended models", "Of the model", models),
            ("Predictions of the recommended models", "Prediction", prediction_rows(runs)),
            ("What the runs were made with", "Setting", made),
        ];
        tables.retain(|(_, _, rows)| !rows.is_empty());
        Self { runs, names: runs.iter().map(|run| run.name.clone()).collect(), tables, sentences }
    }

    /// What differs, in two sentences.
    pub fn sentences(&self) -> &[String] {
        &self.sentences
    }

    /// The page.
    pub fn to_html(&self) -> String {
        let drawn: Vec<_> = figure(self.runs).into_iter().collect();
        let title = format!("{} runs compared", self.runs.len());
        let said: String = self.sentences.iter().map(|text| format!("<p>{}</p>\n", html(text))).collect();
        let mut body = format!(
            "<header>\n<p class=\"brand\">Crumple · comparison of runs</p>\n<h1>{title}</h1>\n\
             <section class=\"verdict\" aria-label=\"What differs\">\n{said}</section>\n</header>\n<main>\n"
        );
        let mut figures_to_come = Some(&drawn);
        for (heading, of, rows) in &self.tables {
            // Figures go before the settings.
            if *of == "Setting"
                && let Some(drawn) = figures_to_come.take()
            {
                figures::write(&mut body, drawn, "h2");
            }
            body.push_str(&format!("<section>\n<h2>{heading}</h2>\n{}</section>\n", to_html(of, &self.names, rows)));
        }
        body.push_str("<section>\n<h2>What each run says</h2>\n");
        for run in self.runs {
            let name = match &run.report {
                Some(report) => format!("<a href=\"{}\">{}</a>", address(report), html(&run.name)),
                None => html(&run.name),
            };
            let (said, concerns) = conclusion(&run.run, &run.ranking);
            let said: String = said.sentences.iter().map(|text| format!("<p>{}</p>\n", html(text))).collect();
            let warnings = match concerns.first() {
                Some(first) => {
                    format!(
                        "<p class=\"caption\">{} warnings, the gravest: {}</p>\n",
                        concerns.len(),
                        html(&first.text)
                    )
                }
                None => String::new(),
            };
            body.push_str(&format!("<h3>{name}</h3>\n{said}{warnings}"));
        }
        body.push_str("</section>\n</main>\n");
        let style = [include_str!("style.css"), &figures::toggle_rules(drawn.iter())].concat();
        framed(&title, &style, &body, FIGURES)
    }

    /// The tables as Markdown, for a merge request.
    pub fn to_markdown(&self) -> String {
        let mut text = format!("{HEAD}## {} runs compared\n\n", self.runs.len());
        for sentence in &self.sentences {
            text.push_str(&format!("{}\n", markdown(sentence)));
        }
        for (heading, of, rows) in &self.tables {
            text.push_str(&format!("\n### {heading}\n\n{}", to_markdown(of, &self.names, rows)));
        }
        text
    }
}

/// `3 runs of one record; 2 settings differ: filter.cfc, filter.mode.`
fn made_of(runs: &[ComparedRun], made: &[Row]) -> String {
    let records: BTreeSet<String> = runs.iter().map(settings::record_of).collect();
    let of = if records.len() == 1 { "one record".to_owned() } else { format!("{} records", records.len()) };
    let settings: Vec<&str> =
        made.iter().filter(|row| row.name.contains('.') && row.differs()).map(|row| row.name.as_str()).collect();
    /// Settings that are named.
    const NAMED: usize = 6;
    let more = if settings.len() > NAMED { ", …" } else { "" };
    match settings.len() {
        0 => format!("{} runs of {of}, made with the same settings.", runs.len()),
        n => format!(
            "{} runs of {of}; {n} {}: {}{more}.",
            runs.len(),
            if n == 1 { "setting differs" } else { "settings differ" },
            settings[..n.min(NAMED)].join(", ")
        ),
    }
}

/// Which numbers and parameters are apart by more than the tolerance.
fn what_differs(numbers: &[Row], models: &[Row]) -> String {
    let differing = |rows: &[Row]| -> Vec<String> {
        rows.iter().filter(|row| row.differs()).map(|row| symbol(&row.name).to_owned()).collect()
    };
    let (numbers, of_models) = (differing(numbers), differing(models));
    let mut parts = Vec::new();
    if !numbers.is_empty() {
        parts.push(numbers.join(", "));
    }
    let one_model = models.first().is_some_and(|row| !row.differs());
    match (one_model, of_models.is_empty()) {
        (true, false) => parts.push(format!("of the model that all recommend: {}", of_models.join(", "))),
        (false, _) if !models.is_empty() => {
            let mut names: Vec<&str> = models[0].cells.iter().map(|cell| cell.text.as_str()).collect();
            names.dedup();
            let names: Vec<&str> = names.into_iter().map(|name| if name == ABSENT { "none" } else { name }).collect();
            parts.push(format!("the recommended model ({})", names.join("; ")));
        }
        _ => {}
    }
    if parts.is_empty() {
        format!("Nothing differs beyond what an engineer calls the same ({TOLERANCE}).")
    } else {
        format!("More than an engineer calls the same ({TOLERANCE}) differ: {}.", parts.join("; "))
    }
}

/// The name without its unit.
fn symbol(name: &str) -> &str {
    name.split_once(", ").map_or(name, |(symbol, _)| symbol)
}
