//! What all checks of all runs come to.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use crate::truth::found::Found;
use crate::truth::known::Counts;
use crate::truth::remarks::{Explained, Raised};
use crate::truth::run::Made;
use crate::truth::{surfaces, values};

/// What all runs come to.
#[derive(Debug, Default)]
pub struct Net {
    /// By rule: how much was compared, what contradicts the truth, runs without anything to compare.
    asked: BTreeMap<String, [usize; 3]>,
    /// What contradicts the truth: rule or code of a remark, run, what is wrong.
    pub contradictions: BTreeSet<[String; 3]>,
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

    /// Holds a run against the truth.
    pub fn read(&mut self, made: &Made) {
        self.runs += 1;
        for (rule, found) in values::check(made).into_iter().chain(surfaces::check(made)) {
            self.take(rule, made, found);
        }
        for (code, found) in self.raised.check(made, &self.explained) {
            self.take(&code, made, found);
        }
    }

    fn take(&mut self, rule: &str, made: &Made, found: Found) {
        // Remarks have a table of their own.
        if !rule.starts_with("CR") {
            let own = [found.checked, found.wrong.len(), usize::from(found.checked == 0)];
            let asked = self.asked.entry(rule.to_owned()).or_default();
            asked.iter_mut().zip(own).for_each(|(asked, own)| *asked += own);
        }
        for (kind, quantity, holds) in found.counted {
            self.counts.add(kind, &quantity, holds);
        }
        let complaint = |because| [rule.to_owned(), made.name.clone(), because];
        self.contradictions.extend(found.wrong.into_iter().map(complaint));
    }

    /// Whether nothing contradicts the truth, and intervals hold it as often as they say.
    pub fn holds(&self) -> bool {
        self.contradictions.is_empty() && self.counts.too_low().is_empty()
    }

    /// The table: rules, intervals, contradictions, codes of remarks.
    pub fn table(&self) -> String {
        let mut out =
            format!("{} runs\n\n| rule | checked | contradicted | runs without |\n|---|---|---|---|\n", self.runs);
        for (rule, [checked, contradicted, without]) in &self.asked {
            let _infallible = writeln!(out, "| {rule} | {checked} | {contradicted} | {without} |");
        }
        out.push_str(&self.counts.table());
        for line in self.counts.too_low() {
            let _infallible = writeln!(out, "too low: {line}");
        }
        let _infallible = writeln!(out, "\n{} contradicted", self.contradictions.len());
        for [rule, run, because] in &self.contradictions {
            let _infallible = writeln!(out, "- {rule} ({run}): {because}");
        }
        out.push_str(&self.raised.table(&self.explained));
        out
    }
}
