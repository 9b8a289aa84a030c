//! All rules, the grammar of their sentences, and which texts have neither a rule nor a reason to have none.

use std::collections::{BTreeMap, BTreeSet};

use crumple_report::phrases::named;

use super::remarks::REMARKS;
use super::rule::{Rule, Spot, holds, numbers_of_records, says};
use super::{choice, models, notes, page, status, vehicle};
use crate::truth::labels::{BELOW, ELSEWHERE, LABELS, NOT_OF_A_RUN};
use crate::truth::template::{Grammar, Place, Said, Template};

/// Rules by the names of their templates.
pub struct Registry {
    rules: BTreeMap<&'static str, Rule>,
    grammar: Grammar,
}

impl Default for Registry {
    fn default() -> Self {
        Self::new()
    }
}

impl Registry {
    /// All of them. A rule of a text that `phrases` has no more reads nothing.
    pub fn new() -> Self {
        let mut all = [vehicle::RULES, status::RULES, models::RULES, choice::RULES, notes::RULES, page::RULES].concat();
        all.extend(REMARKS.iter().map(|(template, text)| says(template, text, &[], numbers_of_records)));
        let texts: BTreeMap<String, &str> =
            named().map(|(subject, name, text)| (format!("{subject}.{name}"), text)).collect();
        let mut grammar = Grammar::default();
        for rule in &all {
            let text = if rule.text.is_empty() { texts.get(rule.template).copied() } else { Some(rule.text) };
            if let Some(text) = text {
                grammar.add(Template::new(rule.template.to_owned(), text), rule.places);
            }
        }
        for label in LABELS {
            if let Some(text) = texts.get(*label) {
                grammar.add(Template::new((*label).to_owned(), text), &[]);
            }
        }
        Self { rules: all.into_iter().map(|rule| (rule.template, rule)).collect(), grammar }
    }

    /// Texts of `phrases` that a run can print and that have neither a rule nor a reason; rules, labels and reasons of
    /// texts that `phrases` has no more.
    pub fn without_rule(&self) -> Vec<String> {
        let is_elsewhere = |subject: &str| ELSEWHERE.iter().chain(BELOW).any(|(other, _)| *other == subject);
        let reasons = || LABELS.iter().copied().chain(NOT_OF_A_RUN.iter().map(|(name, _)| *name));
        let all: Vec<(&str, String)> =
            named().map(|(subject, name, _)| (subject, format!("{subject}.{name}"))).collect();
        let texts = all.iter().filter(|(subject, _)| !is_elsewhere(subject)).map(|(_, name)| name.as_str());
        let without = texts.filter(|name| !self.rules.contains_key(name) && !reasons().any(|own| own == *name));
        let of_phrases = self.rules.values().filter(|rule| rule.text.is_empty()).map(|rule| rule.template);
        let left_over = of_phrases.chain(reasons()).filter(|name| !all.iter().any(|(_, own)| own == name));
        without.chain(left_over).map(str::to_owned).collect()
    }

    /// Names of the templates of these beginnings that may stand by themselves: none that fills a place of another.
    pub fn sentences(&self, beginnings: &[&str]) -> Vec<&'static str> {
        let of_places = self.rules.values().flat_map(|rule| rule.places).filter_map(|(_, place)| match place {
            Place::Said(names) => Some(*names),
            _ => None,
        });
        let parts: BTreeSet<&str> = of_places.flatten().copied().collect();
        let own = self.rules.keys().copied().filter(|name| beginnings.iter().any(|start| name.starts_with(start)));
        own.filter(|name| !parts.contains(name))
            .chain(LABELS.iter().copied().filter(|name| beginnings.iter().any(|start| name.starts_with(start))))
            .collect()
    }

    /// Every template with a rule that a run can print.
    pub fn templates(&self) -> impl Iterator<Item = &'static str> {
        self.rules.keys().copied().filter(|name| !NOT_OF_A_RUN.iter().any(|(own, _)| own == name))
    }

    /// A text by its templates; `None`: some of its words are of none.
    pub fn read(&self, text: &str, templates: &[&str]) -> Option<Vec<Said>> {
        let as_reason = || {
            let first = text.trim_start().chars().next()?.to_lowercase();
            let reason = first.chain(text.trim_start().chars().skip(1)).collect::<String>();
            let read = self.grammar.read(&reason, &[status::REASON_AS_SENTENCE])?;
            read.iter().all(|said| said.inner("reason").is_some()).then_some(read)
        };
        self.grammar.read(text, templates).or_else(as_reason)
    }

    /// What a sentence contradicts: its numbers those of the summary, then its own check.
    pub fn contradiction(&self, said: &Said, spot: &Spot<'_>) -> Option<String> {
        let rule = self.rules.get(said.template.as_str())?;
        let numbers = rule.places.iter().try_for_each(|(place, kind)| match (kind, said.number(place)) {
            (Place::At(pointer), Some(shown)) => {
                let own = spot.made.number(pointer);
                holds(own.is_some_and(|own| shown.is_of(own) || shown.is_of(-own)), || {
                    format!("{} is said, and {pointer} of the summary is {own:?}", said.text(place))
                })
            }
            _ => Ok(()),
        });
        numbers.and_then(|()| (rule.check)(said, spot)).err()
    }
}
