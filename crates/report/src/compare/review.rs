//! What a reviewer asks of two results: what was done differently, what an engineer would notice of it, which model.

use std::collections::BTreeMap;

use crumple_diff::{Base, CompareSettings};

use crate::drawing::numbers::ABSENT;

use super::causes::{ArtifactChanges, Cause, CauseKind, causes, unexplained};
use super::expected::Expected;
use super::facts::{Fact, facts};
use super::quantities::{Group, Quantity, quantities, recommended};
use super::table::plain;

/// Two results beside each other.
#[derive(Debug)]
pub struct Review {
    /// What both are called: the record.
    pub name: String,
    /// What differs of what they were made with, gravest first.
    pub causes: Vec<Cause>,
    /// Stages whose results differ though record, settings, program and inputs are the same.
    pub unexplained: Vec<String>,
    /// Numbers that differ, those farthest beyond their limit first; then the key numbers that do not.
    pub rows: Vec<Quantity>,
    /// What differs beside the numbers.
    pub facts: Vec<Fact>,
    /// Artifacts that differ.
    pub artifacts: ArtifactChanges,
    /// How many numbers of each group there are.
    pub counts: BTreeMap<Group, usize>,
    /// Whether an earlier version accepted the run and kept less of it.
    pub is_earlier: bool,
    /// Whether both say how they were made.
    is_known: bool,
    /// Whether another content, and another way to make it, are differences by themselves.
    is_strict: [bool; 2],
    /// The recommended models.
    pub models: [Option<String>; 2],
}

impl Review {
    /// Compares; `place` finds the file and line that state a setting of the second.
    pub fn new(
        name: &str,
        [a, b]: [&Expected; 2],
        settings: &CompareSettings,
        place: impl Fn(&str, &str) -> Option<(String, usize)>,
    ) -> Self {
        let mut rows = quantities(&[&a.summary, &b.summary], settings);
        let mut counts = BTreeMap::new();
        rows.iter().for_each(|row| *counts.entry(row.group).or_insert(0) += 1);
        let is_one_model = a.summary.recommended == b.summary.recommended;
        let with_interval = rows.iter().filter(|row| row.group != Group::Parameter || is_one_model);
        let facts = facts([a, b], &with_interval.collect::<Vec<_>>(), settings);
        rows.retain(|row| row.group == Group::KeyNumber || row.differs(1));
        rows.sort_by(|x, y| y.beyond(1).total_cmp(&x.beyond(1)));
        let model = |side: &Expected| side.summary.recommended.as_deref().map(|id| side.summary.name_of(id));
        let mut models = [model(a), model(b)];
        // What tells a candidate from the others of its own run, its number, makes it no other model.
        let names =
            [a, b].map(|side| recommended(&side.summary).map(|model| model.parameters.keys().collect::<Vec<_>>()));
        if is_one_model && names[0] == names[1] {
            let [before, after] = &mut models;
            after.clone_from(before);
        }
        if models[0] != models[1] {
            // Parameters of two models stand beside nothing.
            rows.retain(|row| row.group != Group::Parameter);
            counts.remove(&Group::Parameter);
        }
        Self {
            name: name.to_owned(),
            causes: causes([a, b], place),
            unexplained: unexplained([a, b]),
            rows,
            facts,
            artifacts: ArtifactChanges::new([a, b]),
            counts,
            is_earlier: a.is_earlier() || b.is_earlier(),
            is_strict: [settings.tolerances.base == Base::Exact, settings.provenance],
            is_known: !a.stages.is_empty() && !b.stages.is_empty(),
            models,
        }
    }

    /// Numbers that differ.
    pub fn differing(&self) -> impl Iterator<Item = &Quantity> {
        self.rows.iter().filter(|row| row.differs(1))
    }

    /// Whether nothing that people decide by is beyond its limit, and no artifact is missing.
    pub fn is_same(&self) -> bool {
        let [_, by_provenance] = self.is_strict;
        self.differing().next().is_none()
            && self.facts.is_empty()
            && self.models[0] == self.models[1]
            && !self.artifacts_count()
            && (!by_provenance || self.causes.is_empty())
    }

    /// Whether an artifact is missing, or has another content where that counts.
    pub fn artifacts_count(&self) -> bool {
        let ArtifactChanges { gone, new, differing } = &self.artifacts;
        !gone.is_empty() || !new.is_empty() || (self.is_strict[0] && !differing.is_empty())
    }

    /// Which artifacts differ, in one line; `None`: none does, or only as the numbers of the table say anyway.
    pub fn artifacts_line(&self) -> Option<String> {
        if self.differing().next().is_some() && !self.artifacts_count() {
            return None;
        }
        let ArtifactChanges { gone, new, differing } = &self.artifacts;
        let of = |what: &str, stages: &[String]| (!stages.is_empty()).then(|| format!("{what}: {}", stages.join(", ")));
        let parts = [of("only before", gone), of("only after", new), of("other content", differing)];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| format!("artifacts differ; {}", parts.join("; ")))
    }

    /// That the record changed though it counts as the same, in one line; `None`: it did not change, or differs.
    pub fn changed_within(&self) -> Option<String> {
        let has_changed = !self.causes.is_empty() || self.artifacts != ArtifactChanges::default();
        let because = self.causes.first().map_or_else(String::new, |cause| format!(" ({cause})"));
        let text = format!("record {} changed{because}; every number is within its limit", self.name);
        (has_changed && self.is_same()).then_some(text)
    }

    /// What an earlier version did not keep of the accepted run, in one line.
    pub fn not_compared(&self) -> Option<&'static str> {
        self.is_earlier.then_some(
            "accepted by an earlier version, so not compared: status, warnings, contact, events, other metrics and \
             models; crumple accept keeps them",
        )
    }

    /// What was done differently, in one line.
    pub fn cause(&self) -> String {
        let follows = match (&self.causes[..], &self.unexplained[..]) {
            ([], _) if !self.is_known => return "how they were made is not known".to_owned(),
            ([], []) if self.artifacts == ArtifactChanges::default() && !self.is_same() => {
                return "no option, record, program or artifact differs: the summary does".to_owned();
            }
            ([], _) => return "no option, record or program differs: the numerics do".to_owned(),
            (causes, []) if causes.iter().all(|cause| cause.kind == CauseKind::Limit) => {
                "no option, record or program differs".to_owned()
            }
            (_, []) => "the rest follows".to_owned(),
            (_, stages) => format!("{} differs though all it is made from is the same", stages.join(", ")),
        };
        let more = match self.causes.len() - 1 {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        format!("{}{more}; {follows}", self.causes[0])
    }

    /// How many numbers differ, of each group.
    pub fn counted(&self) -> String {
        let texts = [
            (Group::KeyNumber, "key number"),
            (Group::Parameter, "parameter"),
            (Group::Prediction, "prediction"),
            (Group::PredictedDetail, "other predicted number"),
        ];
        let parts = texts.iter().filter_map(|(group, name)| {
            let all = *self.counts.get(group)?;
            let apart = self.differing().filter(|row| row.group == *group).count();
            Some(format!("{apart} of {all} {name}{}", if all == 1 { "" } else { "s" }))
        });
        let parts: Vec<String> = parts.collect();
        if parts.is_empty() {
            "no numbers to compare".to_owned()
        } else {
            format!("beyond the limit: {}", parts.join(", "))
        }
    }

    /// Which models are recommended, and whether the second's numbers lie in the intervals of the first.
    pub fn model(&self) -> String {
        let name = |model: &Option<String>| model.clone().unwrap_or_else(|| "none".to_owned());
        let [a, b] = &self.models;
        if a != b {
            return format!("{} -> {}", name(a), name(b));
        }
        let within: Vec<bool> = self
            .rows
            .iter()
            .filter(|row| row.group == Group::Parameter)
            .filter_map(|row| row.is_within_interval(1))
            .collect();
        let outside = within.iter().filter(|within| !**within).count();
        match (within.len(), outside) {
            (0, _) => format!("the same, {}", name(a)),
            (_, 0) => format!("the same, {}; its changes are smaller than its intervals", name(a)),
            (changed, outside) => {
                format!("the same, {}; {outside} of {changed} changed numbers leave their intervals", name(a))
            }
        }
    }

    /// What was done differently, a line each, at most six.
    pub fn head(&self) -> Vec<String> {
        let because = if self.causes.is_empty() { ":" } else { " because of" };
        let first = format!("different{because} {}", self.cause());
        let others = self.causes.iter().skip(1).take(5).map(|cause| format!("  and of {cause}"));
        std::iter::once(first).chain(others).collect()
    }

    /// The review as lines of a terminal, at most `most`: the cause first, then the table.
    pub fn lines(&self, most: usize) -> Vec<String> {
        let mut head = self.head();
        head.push(self.counted());
        head.extend(self.artifacts_line());
        head.extend(self.not_compared().map(str::to_owned));
        let foot = format!("recommended model: {}", self.model());
        let heads = ["", "before", "after", "change", "limit"].map(str::to_owned);
        let room = most.saturating_sub(head.len() + 3);
        let or_absent = |text: Option<String>| text.unwrap_or_else(|| ABSENT.to_owned());
        let of_row = |row: &Quantity| {
            [plain(&row.name), row.known(0), row.known(1), or_absent(row.change(1)), or_absent(row.limit(1))]
        };
        let of_fact = |fact: &Fact| {
            let [before, after] = fact.values.each_ref().map(|value| shortened(value));
            [fact.key.clone(), before, after, ABSENT.to_owned(), ABSENT.to_owned()]
        };
        let (loud, quiet): (Vec<&Quantity>, Vec<&Quantity>) = self.rows.iter().partition(|row| row.differs(1));
        let loud = loud.into_iter().map(|row| (of_row(row), "!"));
        let (grave, facts): (Vec<&Fact>, Vec<&Fact>) = self.facts.iter().partition(|fact| fact.is_grave());
        let [grave, facts] = [grave, facts].map(|facts| facts.into_iter().map(|fact| (of_fact(fact), "!")));
        let quiet = quiet.into_iter().map(|row| (of_row(row), ""));
        let all: Vec<_> = grave.chain(loud).chain(facts).chain(quiet).collect();
        let left = all.len().saturating_sub(room);
        let is_empty = all.is_empty();
        let table: Vec<([String; 5], &str)> = std::iter::once((heads, "")).chain(all.into_iter().take(room)).collect();
        let width = |k: usize| table.iter().map(|(row, _)| row[k].chars().count()).max().unwrap_or(0);
        let widths: [usize; 5] = std::array::from_fn(width);
        let line = |(cells, mark): &([String; 5], &str)| {
            let padded: Vec<String> = cells.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
            format!("{}  {mark}", padded.join("  ")).trim_end().to_owned()
        };
        if !is_empty {
            head.extend(table.iter().map(line));
        }
        if left > 0 {
            head.push(format!("and {left} more: --all"));
        }
        head.push(foot);
        head
    }
}

/// Most characters of a text in a table of a terminal.
const OF_TEXT: usize = 40;

fn shortened(text: &str) -> String {
    let Some((end, _)) = text.char_indices().nth(OF_TEXT) else { return text.to_owned() };
    format!("{}…", text[..end].trim_end())
}

#[cfg(test)]
pub mod tests {
    use std::borrow::Cow;

    use super::super::quantities::engineering;
    use super::*;
    use crate::findings::{CandidateSummary, KeyNumber, StageRecord, Summary};

    /// A run with these key numbers and parameters of its recommended model, filtered with this class.
    pub fn made(cfc: u16, numbers: &[(&'static str, f64, &'static str)], stiffness: &[f64]) -> Expected {
        let number = |(name, value, unit): &(&'static str, f64, &'static str)| KeyNumber {
            name: Cow::Borrowed(*name),
            value: Some(*value),
            unit: Cow::Borrowed(*unit),
            ..KeyNumber::default()
        };
        let parameters =
            stiffness.iter().enumerate().map(|(k, value)| (format!("k{}_n_per_m", k + 1), *value)).collect();
        let id = "kelvin/direct-fit/1".to_owned();
        let summary = Summary {
            key_numbers: numbers.iter().map(number).collect(),
            candidates: vec![CandidateSummary {
                id: id.clone(),
                model: "kelvin".into(),
                parameters,
                ..Default::default()
            }],
            recommended: Some(id),
            ..Summary::default()
        };
        let stage = |stage: &str, settings: String, digest: String| StageRecord {
            stage: stage.into(),
            version: "0.2.0".into(),
            settings,
            digest,
            inputs: vec![("ingest".into(), format!("f{cfc}"))],
            program: None,
        };
        let stages = vec![
            stage("filter", format!(r#"{{"cfc":{cfc},"mode":"iso6487"}}"#), format!("f{cfc}")),
            stage("integrate", "{}".into(), format!("{numbers:?}")),
        ];
        Expected { record: ["crash.csv".into(), "blake3:0123456789".into()], stages, summary, ..Expected::default() }
    }

    /// The review of two runs, with nowhere a line that states an option.
    pub fn review(a: &Expected, b: &Expected) -> Review {
        Review::new("rigid", [a, b], &engineering(), |_, _| None)
    }

    #[test]
    fn the_cause_is_of_an_input_and_the_gravest_comes_first() {
        let a = made(60, &[("peak_acceleration", 175.0, "m/s^2")], &[]);
        let mut b = made(180, &[("peak_acceleration", 180.0, "m/s^2")], &[]);
        assert_eq!(review(&a, &b).cause(), "filter.cfc 60 -> 180; the rest follows");
        b.stages[0].version = "0.3.0".into();
        assert_eq!(review(&a, &b).cause(), "filter 0.2.0 -> 0.3.0, and 1 more; the rest follows");
        b.record[1] = "blake3:ffffffffff".into();
        assert_eq!(
            review(&a, &b).cause(),
            "record crash.csv (0123456789) -> crash.csv (ffffffffff), and 2 more; the rest follows"
        );
        b.summary.pipeline = Some("papers/civic".into());
        let kinds: Vec<CauseKind> = review(&a, &b).causes.into_iter().map(|cause| cause.kind).collect();
        assert_eq!(kinds, [CauseKind::Record, CauseKind::Program, CauseKind::Pipeline, CauseKind::Setting]);
        // All is the same but the result.
        let mut again = a.clone();
        again.stages[1].digest = "other".into();
        let found = review(&a, &again);
        assert_eq!(
            (found.cause(), found.unexplained),
            ("no option, record or program differs: the numerics do".to_owned(), vec!["integrate".to_owned()])
        );
    }

    #[test]
    fn what_is_farthest_beyond_its_limit_comes_first_and_what_is_within_stands_below() {
        // 0.1 % of the peak, 3 mm of crush where 1 mm is the same, 6 % of a stiffness where 0.5 % is.
        let numbers = |peak, crush| [("peak_acceleration", peak, "m/s^2"), ("dynamic_crush", crush, "m")];
        let (a, b) = (made(60, &numbers(175.0, 0.45), &[1e5]), made(180, &numbers(175.1, 0.453), &[1.06e5]));
        let found = review(&a, &b);
        let shown: Vec<(&str, bool)> = found.rows.iter().map(|row| (row.key.as_str(), row.differs(1))).collect();
        assert_eq!(shown, [("k1_n_per_m", true), ("dynamic_crush", true), ("peak_acceleration", false)]);
        assert!((found.rows[1].beyond(1) - 3.0).abs() < 1e-9);
        let lines: Vec<String> = found.lines(25).iter().map(|line| line.replace('\u{a0}', " ")).collect();
        insta::assert_snapshot!(lines.join("\n"), @"
        different because of filter.cfc 60 -> 180; the rest follows
        beyond the limit: 1 of 2 key numbers, 1 of 1 parameter
                         before      after       change   limit
        k1               100.0 kN/m  106.0 kN/m  +6.0 %   0.5 %  !
        Dynamic crush C  450 mm      453 mm      +3.0 mm  1 mm   !
        Peak             17.8 g      17.9 g      +0.1 %   0.5 %
        recommended model: the same, Kelvin model (fitted)
        ");
        assert!(found.lines(7).len() <= 7, "{:?}", found.lines(7));
        // One side only.
        let without = made(60, &[], &[1e5]);
        assert_eq!(review(&a, &without).rows[0].beyond(1), f64::INFINITY);
        assert!(review(&a, &a).is_same());
    }
}
