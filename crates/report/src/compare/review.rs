//! What a reviewer asks of two results: what was done differently, what an engineer would notice of it, which model.

use std::collections::{BTreeMap, BTreeSet};

use crumple_diff::CompareSettings;
use serde::{Deserialize, Serialize};

use crate::drawing::numbers::ABSENT;
use crate::findings::{StageRecord, Summary, candidate_name};

use super::quantities::{Group, Quantity, quantities, recommended};
use super::settings::settings_of;
use super::table::plain;

/// What is kept of an accepted run, small enough for a repository: `expected/<record>.json`.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Expected {
    /// `crumple.expected.v1`.
    pub schema: String,
    /// The record: its file's name and digest.
    pub record: [String; 2],
    /// Programs, settings and content digests of the artifacts.
    pub stages: Vec<StageRecord>,
    /// Key numbers, the recommended model, its predictions.
    pub summary: Summary,
}

impl Expected {
    /// The schema of such a file.
    pub const SCHEMA: &str = "crumple.expected.v1";

    /// Of a run: what a review compares, and nothing besides.
    pub fn new(record: [String; 2], stages: Vec<StageRecord>, summary: &Summary) -> Self {
        let wall = |id: &String| Some(id) == summary.recommended.as_ref();
        let kept = Summary {
            schema: summary.schema.clone(),
            pipeline: summary.pipeline.clone(),
            test: summary.test.clone(),
            key_numbers: summary.key_numbers.clone(),
            candidates: recommended(summary).cloned().into_iter().collect(),
            recommended: summary.recommended.clone(),
            predictions: summary.predictions.iter().filter(|made| wall(&made.candidate)).cloned().collect(),
            ..Summary::default()
        };
        Self { schema: Self::SCHEMA.to_owned(), record, stages, summary: kept }
    }

    fn record(&self) -> String {
        let [name, digest] = &self.record;
        let digest = digest.split_once(':').map_or(digest.as_str(), |(_, hex)| hex);
        format!("{name} ({})", digest.get(..8).unwrap_or(digest))
    }
}

/// What two results were made with that is not the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Cause {
    /// What it is.
    pub kind: CauseKind,
    /// `record`, `filter` for a program, `filter.cfc` for a setting.
    pub name: String,
    /// Before.
    pub from: String,
    /// After.
    pub to: String,
    /// File and line that state what it is after.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<(String, usize)>,
}

/// What a cause is, gravest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
#[allow(missing_docs, reason = "named after what they are")]
pub enum CauseKind {
    Record,
    Program,
    Pipeline,
    Setting,
}

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} -> {}", self.name, self.from, self.to)?;
        self.place.as_ref().map_or(Ok(()), |(file, line)| write!(f, " ({file}:{line})"))
    }
}

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
    /// How many numbers of each group there are.
    pub counts: BTreeMap<Group, usize>,
    /// Whether both say how they were made.
    is_known: bool,
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
        rows.retain(|row| row.group == Group::KeyNumber || row.differs(1));
        rows.sort_by(|x, y| y.differs(1).cmp(&x.differs(1)).then(y.beyond(1).total_cmp(&x.beyond(1))));
        let model = |side: &Expected| side.summary.recommended.as_deref().map(candidate_name);
        let models = [model(a), model(b)];
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
            counts,
            is_known: !a.stages.is_empty() && !b.stages.is_empty(),
            models,
        }
    }

    /// Numbers that differ.
    pub fn differing(&self) -> impl Iterator<Item = &Quantity> {
        self.rows.iter().filter(|row| row.differs(1))
    }

    /// Whether no number is beyond its limit and both recommend the same model.
    pub fn is_same(&self) -> bool {
        self.differing().next().is_none() && self.models[0] == self.models[1]
    }

    /// What was done differently, in one line.
    pub fn cause(&self) -> String {
        let follows = match (&self.causes[..], &self.unexplained[..]) {
            ([], _) if !self.is_known => return "how they were made is not known".to_owned(),
            ([], _) => return "no option, record or program differs: the numerics do".to_owned(),
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
        let texts =
            [(Group::KeyNumber, "key number"), (Group::Parameter, "parameter"), (Group::Prediction, "prediction")];
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
        let foot = format!("recommended model: {}", self.model());
        let heads = ["", "before", "after", "change", "limit"].map(str::to_owned);
        let room = most.saturating_sub(head.len() + 3);
        let rows = self.rows.iter().take(room).map(|row| {
            let mark = if row.differs(1) { "!" } else { "" };
            let or_absent = |text: Option<String>| text.unwrap_or_else(|| ABSENT.to_owned());
            let cells =
                [plain(&row.name), row.shown(0), row.shown(1), or_absent(row.change(1)), or_absent(row.limit(1))];
            (cells, mark)
        });
        let table: Vec<([String; 5], &str)> = std::iter::once((heads, "")).chain(rows).collect();
        let width = |k: usize| table.iter().map(|(row, _)| row[k].chars().count()).max().unwrap_or(0);
        let widths: [usize; 5] = std::array::from_fn(width);
        let line = |(cells, mark): &([String; 5], &str)| {
            let padded: Vec<String> = cells.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
            format!("{}  {mark}", padded.join("  ")).trim_end().to_owned()
        };
        if !self.rows.is_empty() {
            head.extend(table.iter().map(line));
        }
        let left = self.rows.len().saturating_sub(room);
        if left > 0 {
            head.push(format!("and {left} more: --all"));
        }
        head.push(foot);
        head
    }
}

fn causes([a, b]: [&Expected; 2], place: impl Fn(&str, &str) -> Option<(String, usize)>) -> Vec<Cause> {
    let cause =
        |kind, name: &str, from: String, to: String| Cause { kind, name: name.to_owned(), from, to, place: None };
    let mut all = Vec::new();
    if a.record[1] != b.record[1] {
        all.push(cause(CauseKind::Record, "record", a.record(), b.record()));
    }
    let [before, after] = [a, b].map(|side| settings_of(&side.stages));
    let names: BTreeSet<&String> = before.keys().chain(after.keys()).collect();
    let chain = |name: &str| {
        let stage = name.split('.').next().unwrap_or_default();
        b.stages.iter().chain(&a.stages).position(|record| record.stage == stage)
    };
    let mut settings: Vec<Cause> = Vec::new();
    for name in names {
        let [from, to] = [&before, &after].map(|of| of.get(name).cloned().unwrap_or_else(|| ABSENT.to_owned()));
        // Settings of a stage that another program stands in for are not its own.
        let of_missing = |side: &Expected| {
            let mut own = side.stages.iter().filter(|record| name.split('.').next() == Some(record.stage.as_str()));
            own.any(|record| record.settings.is_empty() || record.settings == "{}" || record.settings == "null")
        };
        let is_version = name.ends_with(".version");
        if from == to || (!is_version && of_missing(a) != of_missing(b)) {
            continue;
        }
        match name.strip_suffix(".version") {
            Some(stage) => settings.push(cause(CauseKind::Program, stage, from, to)),
            None => {
                let (stage, key) = name.split_once('.').unwrap_or((name, ""));
                settings.push(Cause { place: place(stage, key), ..cause(CauseKind::Setting, name, from, to) });
            }
        }
    }
    settings.sort_by_key(|cause| (cause.kind, chain(&cause.name)));
    let pipelines = [a, b].map(|side| side.summary.pipeline.clone().unwrap_or_default());
    let is_set = settings.iter().any(|cause| cause.kind == CauseKind::Setting);
    all.extend(settings);
    if pipelines[0] != pipelines[1] && is_set {
        let [from, to] = pipelines;
        all.push(cause(CauseKind::Pipeline, "pipeline", from, to));
    }
    all.sort_by_key(|cause| cause.kind);
    all
}

/// Stages whose content differs though their program, settings and inputs are the same.
fn unexplained([a, b]: [&Expected; 2]) -> Vec<String> {
    let same = a.record[1] == b.record[1];
    let pairs = a.stages.iter().filter_map(|x| Some((x, b.stages.iter().find(|y| y.stage == x.stage)?)));
    pairs
        .filter(|(x, y)| {
            (&x.version, &x.settings, &x.inputs) == (&y.version, &y.settings, &y.inputs) && x.digest != y.digest && same
        })
        .map(|(x, _)| x.stage.clone())
        .collect()
}

/// The line of a pipeline file that states an option of a stage; a nested one by its first part.
pub fn line_of(text: &str, stage: &str, key: &str) -> Option<usize> {
    let first = key.split('.').next()?;
    let mut table = "";
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        if let Some(head) = line.strip_prefix('[') {
            table = head.trim_end_matches(']').trim();
        }
        let is_key = |name: &str| line.strip_prefix(name).is_some_and(|rest| rest.trim_start().starts_with('='));
        let in_stage = table == stage && (is_key(first) || is_key(&first.replace('_', "-")));
        if in_stage || table == format!("{stage}.{first}") {
            return Some(number + 1);
        }
    }
    None
}

#[cfg(test)]
pub mod tests {
    use std::borrow::Cow;

    use super::super::quantities::engineering;
    use super::*;
    use crate::findings::{CandidateSummary, KeyNumber};

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
            "record crash.csv (01234567) -> crash.csv (ffffffff), and 2 more; the rest follows"
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
        recommended model: the same, Kelvin, direct fit 1
        ");
        assert!(found.lines(7).len() <= 7, "{:?}", found.lines(7));
        // One side only.
        let without = made(60, &[], &[1e5]);
        assert_eq!(review(&a, &without).rows[0].beyond(1), f64::INFINITY);
        assert!(review(&a, &a).is_same());
    }

    #[test]
    fn an_option_is_found_where_a_pipeline_file_states_it() {
        let text = "# a\n[filter]\ncfc = 180\n\n[identify]\ncfc = 2\nmax-order = 3\n[filter.zero_level]\nx = 1\n";
        assert_eq!(line_of(text, "filter", "cfc"), Some(3));
        assert_eq!(line_of(text, "identify", "max_order"), Some(7));
        assert_eq!(line_of(text, "filter", "zero_level.from_s"), Some(8));
        assert_eq!(line_of(text, "filter", "mode"), None);
    }
}
