//! The comparison of several runs as a page and as Markdown.

use std::collections::BTreeSet;

use crumple_diff::DiffError;

use crate::drawing::Figure;
use crate::drawing::escape::{address, html};
use crate::drawing::numbers::{ABSENT, NBSP};
use crate::findings::{HEAD, conclusion, markdown};

use super::compared_run::ComparedRun;
use super::expected::within;
use super::figure::figure;
use super::first_screen::command_again;
use super::numbers::number_rows;
use super::quantities::engineering;
use super::settings;
use super::table::{Row, to_html, to_lines, to_markdown};
use crate::frame::{FIGURES, framed};
use crate::page::figures;
use crate::page::key_numbers::KEY_NUMBERS;
use crate::words;

/// Heads the column of names of the key numbers.
const NUMBER: &str = "Number";

/// Heads the column of names of what the runs were made with.
const SETTING: &str = "Setting";

/// Heads the column of names of ratings.
pub const RATING: &str = "Rating";

/// Several runs beside each other.
#[derive(Debug)]
pub struct RunComparison<'a> {
    runs: &'a [ComparedRun],
    title: String,
    sections: Vec<Section>,
    said: Vec<Said>,
    figures: Vec<Figure>,
    /// What the first column of the table is that the figures stand before.
    figures_before: &'static str,
}

/// What a comparison comes to: a headline and what follows from it.
#[derive(Debug, Clone)]
pub struct Said {
    /// Of which run, where there are several of it.
    pub of: Option<String>,
    /// The headline, then the others.
    pub sentences: Vec<String>,
}

impl Said {
    /// The sentences, the first with the name of the run.
    pub fn lines(&self) -> Vec<String> {
        let name = self.of.as_ref().map_or_else(String::new, |of| format!("{of}: "));
        let first = self.sentences.first().map(|text| name + text);
        first.into_iter().chain(self.sentences.iter().skip(1).cloned()).collect()
    }
}

/// A table under a heading.
#[derive(Debug, Clone)]
pub struct Section {
    /// The heading.
    pub heading: String,
    /// What the first column is.
    pub of: &'static str,
    /// Heads of the others.
    pub columns: Vec<String>,
    /// The rows.
    pub rows: Vec<Row>,
}

impl<'a> RunComparison<'a> {
    /// Compares every run with the first, within the limits of the first. The same runs give the same bytes.
    ///
    /// Errors: a limit is none.
    pub fn new(runs: &'a [ComparedRun]) -> Result<Self, DiffError> {
        let limits = runs.first().map(|run| run.limits.clone()).unwrap_or_default();
        let [numbers, models, predictions] = number_rows(runs, &within(&engineering(), &limits)?);
        let made = settings::rows(runs);
        let sentences = vec![made_of(runs, &made), what_differs(&numbers, &models, !limits.is_empty())];
        let columns: Vec<String> = runs.iter().map(|run| run.name.clone()).collect();
        let tables = [
            (KEY_NUMBERS, NUMBER, numbers),
            ("Recommended models", "Of the model", models),
            ("Predictions of the recommended models", "Prediction", predictions),
            ("What the runs were made with", SETTING, made),
        ];
        let section = |(heading, of, rows): (&str, _, _)| Section {
            heading: heading.to_owned(),
            of,
            columns: columns.clone(),
            rows,
        };
        let sections = tables.into_iter().map(section).filter(|section| !section.rows.is_empty()).collect();
        let title = format!("{} runs compared", runs.len());
        Ok(Self {
            runs,
            title,
            sections,
            said: vec![Said { of: None, sentences }],
            figures: figure(runs).into_iter().collect(),
            figures_before: SETTING,
        })
    }

    /// The same page about a simulation and its test: what it comes to, its tables in front of what the runs were made
    /// with and in place of all others, its figures.
    #[must_use]
    pub fn of_simulations(
        mut self,
        title: String,
        said: Vec<Said>,
        sections: Vec<Section>,
        figures: Vec<Figure>,
    ) -> Self {
        self.sections.retain(|section| section.of == SETTING);
        self.sections.splice(0..0, sections.into_iter().filter(|section| !section.rows.is_empty()));
        Self { title, said, figures, figures_before: RATING, ..self }
    }

    /// What differs, in two sentences; of simulations in three each.
    pub fn sentences(&self) -> Vec<String> {
        self.said.iter().flat_map(Said::lines).collect()
    }

    /// The key numbers and what of the models and predictions differs, as lines of a terminal: a column a run.
    pub fn lines(&self) -> Vec<String> {
        let is_number = |of: &str| of == NUMBER;
        let rows = self
            .sections
            .iter()
            .filter(|section| section.of != SETTING)
            .flat_map(|section| section.rows.iter().filter(move |row| is_number(section.of) || row.differs()));
        let shown: Vec<&Row> = rows.collect();
        to_lines(self.sections.first().map(|section| &section.columns[..]).unwrap_or_default(), &shown)
    }

    /// All tables but what the runs were made with, each under its heading.
    pub fn tables_as_lines(&self) -> Vec<String> {
        let of_section = |section: &Section| {
            let rows: Vec<&Row> = section.rows.iter().collect();
            let heading = [String::new(), section.heading.clone()];
            heading.into_iter().chain(to_lines(&section.columns, &rows)).collect::<Vec<_>>()
        };
        self.sections.iter().filter(|section| section.of != SETTING).flat_map(of_section).collect()
    }

    /// The page.
    pub fn to_html(&self) -> String {
        let (drawn, title) = (&self.figures, html(&self.title));
        let paragraph = |text: &String| format!("<p>{}</p>\n", html(text));
        let block = |said: &Said| {
            let lines: String = said.lines().iter().map(paragraph).collect();
            format!("<section class=\"verdict\" aria-label=\"What differs\">\n{lines}</section>\n")
        };
        let said: String = self.said.iter().map(block).collect();
        let mut body = format!(
            "<header>\n<p class=\"brand\">Crumple · comparison of runs</p>\n<h1>{title}</h1>\n\
             {said}</header>\n<main>\n"
        );
        let mut figures_to_come = Some(drawn);
        for Section { heading, of, columns, rows } in &self.sections {
            if *of == self.figures_before
                && let Some(drawn) = figures_to_come.take()
            {
                figures::write(&mut body, drawn, "h2");
            }
            let (heading, table) = (html(heading), to_html(of, columns, rows));
            body.push_str(&format!("<section>\n<h2>{heading}</h2>\n{table}</section>\n"));
        }
        if let Some(drawn) = figures_to_come {
            figures::write(&mut body, drawn, "h2");
        }
        body.push_str("<section>\n<h2>What each run says</h2>\n");
        for run in self.runs {
            let name = match &run.report {
                Some(report) => format!("<a href=\"{}\">{}</a>", address(report), html(&run.name)),
                None => html(&run.name),
            };
            let (said, concerns) = conclusion(&run.run, &run.ranking);
            let lines = std::iter::once(said.status_sentence).chain(said.sentences);
            let said: String = lines.map(|text| format!("<p>{}</p>\n", html(&text))).collect();
            let warnings = concerns.first().map_or_else(String::new, |first| {
                let counted = match concerns.len() {
                    1 => "1 warning".to_owned(),
                    n => format!("{n} warnings, the gravest"),
                };
                format!("<p class=\"caption\">{counted}: {}</p>\n", html(&first.text))
            });
            body.push_str(&format!("<h3>{name}</h3>\n{said}{warnings}"));
        }
        body.push_str("</section>\n");
        body.push_str("</main>\n");
        let style = [include_str!("style.css"), &figures::toggle_rules(drawn.iter())].concat();
        framed(&self.title, &style, &body, FIGURES)
    }

    /// The tables as Markdown, for a merge request; `again` is the command that makes it.
    pub fn to_markdown(&self, again: &str) -> String {
        let mut text = format!("{HEAD}## {}\n\n", markdown(&self.title));
        for said in &self.said {
            for (k, line) in said.lines().iter().enumerate() {
                let line = markdown(line);
                text.push_str(&if k == 0 { format!("**{line}**\n\n") } else { format!("- {line}\n") });
            }
            text.push('\n');
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
        for Section { heading, of, columns, rows } in &self.sections {
            text.push_str(&format!("\n### {}\n\n{}", markdown(heading), to_markdown(of, columns, rows)));
        }
        text + &command_again(again)
    }
}

/// `3 runs of one record; 2 settings differ: filter.cfc, filter.mode.`
fn made_of(runs: &[ComparedRun], made: &[Row]) -> String {
    let records: BTreeSet<String> = runs.iter().map(settings::record_of).collect();
    let records = match records.len() {
        1 => "one record".to_owned(),
        n => format!("{n} records"),
    };
    let settings: Vec<&str> =
        made.iter().filter(|row| row.name.contains('.') && row.differs()).map(|row| row.name.as_str()).collect();
    /// Settings that are named.
    const NAMED: usize = 6;
    let differ = match settings.len() {
        0 => return format!("{} runs of {records}, made with the same settings.", runs.len()),
        1 => "1 setting differs".to_owned(),
        n => format!("{n} settings differ"),
    };
    let names = settings[..settings.len().min(NAMED)].join(", ");
    let more = if settings.len() > NAMED { ", …" } else { "" };
    format!("{} runs of {records}; {differ}: {names}{more}.", runs.len())
}

/// Which numbers and parameters are apart by more than the tolerance, or than limits of the first run's own.
fn what_differs(numbers: &[Row], models: &[Row], has_own_limits: bool) -> String {
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
    let [length, speed] =
        [(1.0, "mm"), (0.01, "m/s")].map(|(most, unit)| words::significant_quantity(most, 1, unit).replace(NBSP, " "));
    let tolerance = match has_own_limits {
        true => format!("the limits that the first run's pipeline states, else 0.1 ms, {length}, {speed}, 0.5 %"),
        false => format!("0.1 ms, {length}, {speed}, else 0.5 %"),
    };
    match parts.is_empty() {
        true => format!("Nothing differs by more than {tolerance}."),
        false => format!("These differ by more than {tolerance}: {}.", parts.join("; ")),
    }
}

/// The name without its unit.
fn symbol(name: &str) -> &str {
    name.split_once(", ").map_or(name, |(symbol, _)| symbol)
}
