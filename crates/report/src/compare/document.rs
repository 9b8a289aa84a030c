//! The comparison of several runs as a page and as Markdown.

use std::collections::BTreeSet;

use crumple_diff::DiffError;

use crate::phrases::PHRASES;

use crate::drawing::escape::{address, html};
use crate::drawing::numbers::ABSENT;
use crate::findings::{HEAD, conclusion, markdown};
use crate::phrases::RunTexts;
use crate::phrases::words::fill;

use super::compared_run::ComparedRun;
use super::expected::within;
use super::figure::figure;
use super::numbers::number_rows;
use super::quantities::engineering;
use super::settings;
use super::table::{Row, to_html, to_lines, to_markdown};
use crate::frame::{FIGURES, framed, words_of_figures};
use crate::page::figures;

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
    /// Compares every run with the first, within the limits of the first. The same runs give the same bytes.
    ///
    /// Errors: a limit is none.
    pub fn new(runs: &'a [ComparedRun]) -> Result<Self, DiffError> {
        let texts = &PHRASES.runs;
        let limits = runs.first().map(|run| run.limits.clone()).unwrap_or_default();
        let [numbers, models, predictions] = number_rows(runs, &within(&engineering(), &limits)?);
        let made = settings::rows(runs);
        let sentences = vec![made_of(runs, &made, texts), what_differs(&numbers, &models, !limits.is_empty(), texts)];
        let mut tables = vec![
            (texts.key_numbers, texts.number, numbers),
            (texts.recommended_models, texts.of_the_model, models),
            (texts.predictions, texts.prediction, predictions),
            (texts.made_with, texts.setting, made),
        ];
        tables.retain(|(_, _, rows)| !rows.is_empty());
        Ok(Self { runs, names: runs.iter().map(|run| run.name.clone()).collect(), tables, sentences })
    }

    /// What differs, in two sentences.
    pub fn sentences(&self) -> &[String] {
        &self.sentences
    }

    /// The key numbers and what of the models and predictions differs, as lines of a terminal: a column a run.
    pub fn lines(&self) -> Vec<String> {
        let texts = &PHRASES.runs;
        let is_number = |of: &str| of == texts.number;
        let rows = self
            .tables
            .iter()
            .filter(|(_, of, _)| *of != texts.setting)
            .flat_map(|(_, of, rows)| rows.iter().filter(move |row| is_number(of) || row.differs()));
        let shown: Vec<&Row> = rows.collect();
        to_lines(&self.names, &shown)
    }

    /// The page.
    pub fn to_html(&self) -> String {
        let drawn: Vec<_> = figure(self.runs).into_iter().collect();
        let texts = &PHRASES.runs;
        let title = self.title();
        let said: String = self.sentences.iter().map(|text| format!("<p>{}</p>\n", html(text))).collect();
        let mut body = format!(
            "<header>\n<p class=\"brand\">{}</p>\n<h1>{title}</h1>\n\
             <section class=\"verdict\" aria-label=\"{}\">\n{said}</section>\n</header>\n<main>\n",
            texts.comparison_brand, texts.what_differs
        );
        let mut figures_to_come = Some(&drawn);
        for (heading, of, rows) in &self.tables {
            // Figures go before the settings.
            if *of == texts.setting
                && let Some(drawn) = figures_to_come.take()
            {
                figures::write(&mut body, drawn, "h2");
            }
            let table = to_html(of, &self.names, rows);
            body.push_str(&format!("<section>\n<h2>{heading}</h2>\n{table}</section>\n"));
        }
        body.push_str(&format!("<section>\n<h2>{}</h2>\n", texts.what_each_says));
        for run in self.runs {
            let name = match &run.report {
                Some(report) => format!("<a href=\"{}\">{}</a>", address(report), html(&run.name)),
                None => html(&run.name),
            };
            let (said, concerns) = conclusion(&run.run, &run.ranking);
            let lines = std::iter::once(said.status_sentence).chain(said.sentences);
            let said: String = lines.map(|text| format!("<p>{}</p>\n", html(&text))).collect();
            let warnings = concerns.first().map_or_else(String::new, |first| {
                let template = if concerns.len() == 1 { texts.one_gravest } else { texts.gravest };
                let filled = [("count", concerns.len().to_string()), ("text", html(&first.text))];
                format!("<p class=\"caption\">{}</p>\n", fill(template, &filled))
            });
            body.push_str(&format!("<h3>{name}</h3>\n{said}{warnings}"));
        }
        body.push_str("</section>\n");
        body.push_str(&words_of_figures());
        body.push_str("</main>\n");
        let style = [include_str!("style.css"), &figures::toggle_rules(drawn.iter())].concat();
        framed(&title, &style, &body, FIGURES)
    }

    fn title(&self) -> String {
        fill(PHRASES.runs.compared, &[("count", self.runs.len().to_string())])
    }

    /// The tables as Markdown, for a merge request; `again` is the command that makes it.
    pub fn to_markdown(&self, again: &str) -> String {
        let mut text = format!("{HEAD}## {}\n\n", self.title());
        for sentence in &self.sentences {
            text.push_str(&format!("{}\n", markdown(sentence)));
        }
        for (heading, of, rows) in &self.tables {
            text.push_str(&format!("\n### {heading}\n\n{}", to_markdown(of, &self.names, rows)));
        }
        text.push_str(&format!("\n### {}\n\n```sh\n{again}\n```\n", PHRASES.runs.again));
        text
    }
}

/// `3 runs of one record; 2 settings differ: filter.cfc, filter.mode.`
fn made_of(runs: &[ComparedRun], made: &[Row], texts: &RunTexts) -> String {
    let records: BTreeSet<String> = runs.iter().map(settings::record_of).collect();
    let of = match records.len() {
        1 => texts.of_one_record.to_owned(),
        n => fill(texts.of_records, &[("count", n.to_string())]),
    };
    let settings: Vec<&str> =
        made.iter().filter(|row| row.name.contains('.') && row.differs()).map(|row| row.name.as_str()).collect();
    /// Settings that are named.
    const NAMED: usize = 6;
    let template = match settings.len() {
        0 => texts.same_settings,
        1 => texts.one_setting_differs,
        _ => texts.settings_differ,
    };
    let filled = [
        ("runs", runs.len().to_string()),
        ("records", of),
        ("count", settings.len().to_string()),
        ("names", settings[..settings.len().min(NAMED)].join(", ")),
        ("more", if settings.len() > NAMED { ", …" } else { "" }.to_owned()),
    ];
    fill(template, &filled)
}

/// Which numbers and parameters are apart by more than the tolerance, or than limits of the first run's own.
fn what_differs(numbers: &[Row], models: &[Row], has_own_limits: bool, texts: &RunTexts) -> String {
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
        (true, false) => parts.push(fill(texts.of_common_model, &[("names", of_models.join(", "))])),
        (false, _) if !models.is_empty() => {
            let mut names: Vec<&str> = models[0].cells.iter().map(|cell| cell.text.as_str()).collect();
            names.dedup();
            let names: Vec<&str> =
                names.into_iter().map(|name| if name == ABSENT { texts.no_model } else { name }).collect();
            parts.push(fill(texts.other_models, &[("names", names.join("; "))]));
        }
        _ => {}
    }
    let template = if parts.is_empty() { texts.nothing_differs } else { texts.differ };
    let tolerance = if has_own_limits { texts.own_limits } else { texts.tolerance };
    fill(template, &[("tolerance", tolerance), ("names", &parts.join("; "))])
}

/// The name without its unit.
fn symbol(name: &str) -> &str {
    name.split_once(", ").map_or(name, |(symbol, _)| symbol)
}
