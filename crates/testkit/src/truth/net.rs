//! All runs read, sentence by sentence: what is said how often and where, what contradicts the truth, what no rule
//! reads.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::counts::Counts;
use super::numbers_of_runs::check_numbers;
use super::rules::{Registry, Spot, Surface};
use super::run::Made;
use super::sentences::sentences;

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
    runs: usize,
}

impl Net {
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
            for said in all.iter().flat_map(super::template::Said::all) {
                let (times, contradicted, surfaces) = self.seen.entry(said.template.clone()).or_default();
                *times += 1;
                surfaces.insert(sentence.surface);
                if let Some(because) = registry.contradiction(said, &spot) {
                    *contradicted += 1;
                    self.contradictions.insert(complaint(&said.template, because));
                }
            }
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
        let not_seen = self.not_seen(registry);
        let _infallible = writeln!(out, "\n{} templates printed by no run: {}", not_seen.len(), not_seen.join(", "));
        out
    }
}
