//! The sentences of a run, each with where it stands and which templates may have made it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use crumple_signal::key_quantities::KeyQuantity;

use crate::truth::known::{Counts, check_numbers};
use crate::truth::remarks::{Explained, Raised};
use crate::truth::rules::{Registry, Spot, Surface};
use crate::truth::run::{Block, Made, plain};

/// A text that has to be read.
#[derive(Debug, Clone)]
pub struct Sentence {
    /// Where it stands.
    pub surface: Surface,
    /// What it is about there: a card, a candidate, a stage.
    pub key: String,
    /// The text.
    pub text: String,
    /// What may have made it.
    pub templates: Vec<&'static str>,
}

/// Labels of lines of the console, and the key number that each is.
const LINES: [(&str, &str); 12] = [
    ("dynamic crush", "dynamic_crush"),
    ("motion over ground", "dynamic_crush"),
    ("time of crush", "time_of_dynamic_crush"),
    ("delta-v", "delta_v"),
    ("restitution", "coefficient_of_restitution"),
    ("peak", "peak_acceleration"),
    ("OLC", "olc"),
    ("stroke", "stroke"),
    ("maximum delta-v", "maximum_delta_v"),
    ("lateral delta-v", "maximum_lateral_delta_v"),
    ("EES", "recorded_ees"),
    ("crush", "recorded_crush"),
];

/// All of them.
pub fn sentences(registry: &Registry, made: &Made) -> Vec<Sentence> {
    let mut all = Vec::new();
    let conclusion = registry.sentences(&["conclusion."]);
    let notes = registry.sentences(&["note.", "conclusion.", "remarks."]);
    let mut add = |surface: Surface, key: &str, text: &str, templates: &[&'static str]| {
        let (key, text) = (key.to_owned(), without_code(&plain(text)).to_owned());
        if !text.is_empty() {
            all.push(Sentence { surface, key, text, templates: templates.to_vec() });
        }
    };
    add(Surface::Top, "", &status(made), &conclusion);
    for sentence in made.list("/verdict/sentences").iter().filter_map(|sentence| sentence.as_str()) {
        add(Surface::Top, "", sentence, &conclusion);
    }
    for concern in made.list("/concerns") {
        let stage = concern["stage"].as_str().unwrap_or_default();
        add(Surface::Summary, stage, concern["text"].as_str().unwrap_or_default(), &notes);
    }
    for note in made.list("/notes").iter().filter_map(|note| note.as_str()) {
        let (stage, text) = note.split_once(": ").unwrap_or(("", note));
        add(Surface::Summary, stage, text.strip_prefix("warning: ").unwrap_or(text), &notes);
    }
    for name in ["recommended", "simplest", "closest"] {
        let key = made.text(&format!("/{name}")).to_owned();
        add(
            Surface::Summary,
            &key,
            made.text(&format!("/{name}_because")),
            &registry.sentences(&["because.", "remarks.", "note."]),
        );
    }
    for missing in made.list("/missing").iter().filter_map(|missing| missing.as_str()) {
        add(Surface::Summary, "", missing, &registry.sentences(&["remarks."]));
    }
    of_page(registry, made, &mut add);
    of_console(registry, made, &mut add);
    all
}

/// A warning without its code, which the list of remarks has.
fn without_code(text: &str) -> &str {
    match text.strip_suffix(']').and_then(|text| text.rsplit_once(" [CR")) {
        Some((sentence, code)) if code.len() == 3 => sentence,
        _ => text,
    }
}

/// What a model is that is folded.
const ROLES: &[&str] = &["model.closest", "model.closest_alone", "model.recommended", "model.in_doubt"];

/// Columns of the table of other speeds.
const COLUMNS: usize = 5;

/// `usable with care: the crush at 40 km/h is predicted to ±16 %.`
fn status(made: &Made) -> String {
    match (made.text("/verdict/status").replace('-', " "), made.text("/verdict/status_because")) {
        (_, "") => made.text("/verdict/status_sentence").to_owned(),
        (status, because) => format!("{status}: {because}."),
    }
}

type Add<'a> = dyn FnMut(Surface, &str, &str, &[&'static str]) + 'a;

fn of_page(registry: &Registry, made: &Made, add: &mut Add<'_>) {
    let (mut fact, mut candidate, mut row) = (String::new(), String::new(), Vec::new());
    let page = Surface::Page;
    for Block { section, element, key, text } in &made.page {
        match (section.as_str(), element.as_str()) {
            // The title is that of the record.
            (_, "h1") => {}
            ("header", "dt") => fact.clone_from(text),
            (section, "dd") if section == "header" || section.starts_with("verdict") => {
                let template = match fact.as_str() {
                    "Test mass" => ["page.mass", "page.not_known"],
                    "Impact speed" => ["page.speed", "page.not_known"],
                    "Sampling" => ["page.samples", "page.not_known"],
                    _ => ["page.words", "page.not_known"],
                };
                add(page, &fact, text, &template);
            }
            (section, "p") if section.starts_with("verdict") => {
                add(page, "", text, &registry.sentences(&["conclusion."]));
            }
            (section, "dt") if section.starts_with("verdict") => fact.clone_from(text),
            (_, "p") if key.starts_with("status") => add(page, "", text, &["conclusion.status"]),
            ("other-speeds", "td") => {
                row.push(text.as_str());
                if row.len() == COLUMNS {
                    add(page, "", &row.join(" | "), &["page.prediction", "page.prediction-bare"]);
                    row.clear();
                }
            }
            ("other-speeds", _) => {}
            ("before-use", "li") => add(page, "", text, &["page.about"]),
            ("before-use", _) => {
                let counted = ["conclusion.more", "conclusion.one_more"];
                // Without a model the caption of the numbers stands here.
                let own = registry.sentences(&["conclusion.", "numbers.inputs"]);
                add(page, "", text, &[own, counted.to_vec()].concat());
            }
            ("model", "summary") => add(page, &candidate, text, ROLES),
            ("model", "h3") => {
                let name = text.split_once(": ").map_or("", |(_, name)| name);
                let own = made.candidate_named(name).and_then(|candidate| candidate["id"].as_str());
                candidate = own.unwrap_or_default().to_owned();
                add(page, &candidate, text, &["page.model-head"]);
            }
            ("model", _) => {
                add(page, &candidate, text, &registry.sentences(&["model.", "page.determined", "numbers.inputs"]));
            }
            ("numbers", "dd") => {
                let is_number = |c: char| c.is_ascii_digit() || "-≥–—".contains(c);
                let is_value = key.is_empty() || text.starts_with(is_number);
                let lines = ["numbers.", "page.card-"];
                let mut templates = registry.sentences(&lines);
                templates.retain(|name| is_value || *name != "page.card-value");
                templates.extend(registry.sentences(&["note."]));
                add(page, key, text, &templates);
            }
            // The title of a card claims nothing.
            ("numbers", _) if KeyQuantity::of(key).is_some_and(|known| known.title == text) => {}
            ("numbers", _) => {
                add(page, key, text, &registry.sentences(&["numbers.", "page.card-olc", "page.card-hic"]));
            }
            _ => add(page, section, text, &registry.sentences(&["page.", "numbers.", "predictions."])),
        }
    }
}

fn of_console(registry: &Registry, made: &Made, add: &mut Add<'_>) {
    // The sentences of the verdict come first, broken into lines; behind them lines with labels.
    let sentences = made.list("/verdict/sentences").iter().filter_map(|s| s.as_str().map(plain));
    let top = std::iter::once(plain(&status(made)))
        .chain(sentences)
        .filter(|text| !text.is_empty())
        .collect::<Vec<_>>()
        .join(" ");
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let mut left = words(&top);
    let mut items: Vec<(String, String)> = Vec::new();
    for line in &made.console {
        let own = words(line);
        // The word of the status is printed in capitals.
        let is_next = left.len() >= own.len() && left.iter().zip(&own).all(|(a, b)| a.eq_ignore_ascii_case(b));
        if !left.is_empty() && is_next {
            left.drain(..own.len());
            continue;
        }
        let first = line.trim_start().split([' ', '.']).next().unwrap_or_default();
        let behind = &line.trim_start()[first.len()..];
        let is_numbered =
            first.parse::<u16>().is_ok() && (behind.starts_with(". ") || behind.starts_with(" more warn"));
        match line.split_once("  ") {
            Some((label, text)) if !label.is_empty() => items.push((label.to_owned(), text.trim().to_owned())),
            _ if line.starts_with(' ') && !is_numbered => {
                if let Some((_, text)) = items.last_mut() {
                    text.push(' ');
                    text.push_str(line.trim());
                }
            }
            _ => items.push((String::new(), line.trim().to_owned())),
        }
    }
    add(Surface::Console, "left", &left.join(" "), &[]);
    for (label, text) in items {
        let key = LINES.iter().find(|(own, _)| *own == label).map(|(_, key)| *key);
        let has = |key: &str| made.list("/key_numbers").iter().any(|number| number["name"] == key);
        match (label.as_str(), key) {
            // The change that a recorder kept stands under the same label.
            ("delta-v", _) if has("maximum_delta_v") => {
                add(Surface::Console, "maximum_delta_v", &text, &["console.number"]);
            }
            (_, Some(key)) => add(Surface::Console, key, &text, &["console.number"]),
            ("recommended" | "model in doubt", _) => add(Surface::Console, &label, &text, &["console.model"]),
            // What the summary has of them is held against the truth.
            ("report" | "run" | "record" | "good for", _) => {}
            ("not in it", _) => add(Surface::Console, &label, &text, &registry.sentences(&["remarks."])),
            ("not identified", _) => add(Surface::Console, &label, &text, &registry.sentences(&["note."])),
            ("warnings" | "", _) => add(Surface::Console, &label, &text, &["console.warning", "console.more"]),
            _ => add(Surface::Console, &label, &text, &registry.sentences(&["console.stage-"])),
        }
    }
}

/// A sentence that does not hold, or that no rule reads.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Complaint {
    /// Template, or the stage of a sentence that no template reads.
    pub template: String,
    /// The run.
    pub run: String,
    /// Where it stands.
    pub surface: &'static str,
    /// The sentence.
    pub text: String,
    /// What is wrong with it.
    pub because: String,
}

/// What was read.
#[derive(Debug, Default)]
pub struct Net {
    seen: BTreeMap<String, (usize, usize, BTreeSet<Surface>)>,
    /// Sentences that contradict the truth.
    pub contradictions: BTreeSet<Complaint>,
    /// Sentences that no rule reads.
    pub unread: BTreeSet<Complaint>,
    /// How often intervals held the truth.
    pub counts: Counts,
    explained: Explained,
    raised: Raised,
    runs: usize,
}

impl Net {
    /// Nothing read yet; what is explained of every code.
    pub fn new(explained: Explained) -> Self {
        Self { explained, ..Self::default() }
    }

    /// Reads a run.
    pub fn read(&mut self, registry: &Registry, made: &Made) {
        self.runs += 1;
        for sentence in sentences(registry, made) {
            let spot = Spot { made, surface: sentence.surface, key: &sentence.key };
            let complaint = |template: &str, because: String| Complaint {
                template: template.to_owned(),
                run: made.name.clone(),
                surface: sentence.surface.name(),
                text: sentence.text.clone(),
                because,
            };
            let Some(all) = registry.read(&sentence.text, &sentence.templates) else {
                self.unread.insert(complaint(&sentence.key, "no template reads it".to_owned()));
                continue;
            };
            for said in all.iter().flat_map(crate::truth::template::Said::all) {
                let (times, contradicted, surfaces) = self.seen.entry(said.template.clone()).or_default();
                *times += 1;
                surfaces.insert(sentence.surface);
                if let Some(because) = registry.contradiction(said, &spot) {
                    *contradicted += 1;
                    self.contradictions.insert(complaint(&said.template, because));
                }
            }
        }
        for (text, because) in self.raised.add(&made.name, made.list("/remarks"), &self.explained) {
            self.contradictions.insert(Complaint {
                template: "remark".to_owned(),
                run: made.name.clone(),
                surface: Surface::Summary.name(),
                text,
                because,
            });
        }
        for (number, because) in check_numbers(made, &mut self.counts) {
            self.contradictions.insert(Complaint {
                template: format!("number {number}"),
                run: made.name.clone(),
                surface: Surface::Summary.name(),
                text: String::new(),
                because,
            });
        }
    }

    /// Templates with a rule that no run printed.
    pub fn not_seen(&self, registry: &Registry) -> Vec<&'static str> {
        registry.templates().filter(|name| !self.seen.contains_key(*name)).collect()
    }

    /// The table: template, times seen, times contradicted, surfaces; then intervals, contradictions, sentences that no
    /// rule reads, templates that no run printed.
    pub fn table(&self, registry: &Registry) -> String {
        let mut out =
            format!("{} runs\n\n| template | seen | contradicted | surfaces |\n|---|---|---|---|\n", self.runs);
        for (name, (times, contradicted, surfaces)) in &self.seen {
            let surfaces: Vec<&str> = surfaces.iter().map(|surface| surface.name()).collect();
            let _infallible = writeln!(out, "| {name} | {times} | {contradicted} | {} |", surfaces.join(", "));
        }
        out.push_str(&self.counts.table());
        for (title, complaints) in [("contradicted", &self.contradictions), ("read by no rule", &self.unread)] {
            let _infallible = writeln!(out, "\n{} {title}", complaints.len());
            for Complaint { template, run, surface, text, because } in complaints {
                let _infallible = writeln!(out, "- {template} ({run}, {surface}): {because}: {text:?}");
            }
        }
        out.push_str(&self.raised.table(&self.explained));
        let not_seen = self.not_seen(registry);
        let _infallible = writeln!(out, "\n{} templates printed by no run: {}", not_seen.len(), not_seen.join(", "));
        out
    }
}
