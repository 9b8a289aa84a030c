//! What two results were made with that is not the same: test, record, programs, options.

use std::collections::{BTreeMap, BTreeSet};

use crumple_stage::chain;
use serde::Serialize;
use serde_json::{Value, json};

use crate::drawing::numbers::ABSENT;
use crate::words;

use super::expected::Expected;
use super::settings::{limits_of, options_of, programs_of, settings_of};
use crate::findings::{StageRecord, TestSummary};

/// What two results were made with that is not the same.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Cause {
    /// What it is.
    pub kind: CauseKind,
    /// `test.mass_kg`, `record`, `filter` for a program, `filter.cfc` for a setting.
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
    Test,
    Record,
    Program,
    Pipeline,
    Setting,
    Limit,
}

/// What a limit of a pipeline is called among stages and their options.
pub const LIMITS: &str = "limits";

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} -> {}", self.name, self.from, self.to)?;
        self.place.as_ref().map_or(Ok(()), |(file, line)| write!(f, " ({file}:{line})"))
    }
}

fn cause(kind: CauseKind, name: &str, from: String, to: String) -> Cause {
    Cause { kind, name: name.to_owned(), from, to, place: None }
}

/// Options of `ingest` that state a field of the test, and the field.
const OF_TEST: [(&str, &str); 6] = [
    ("ingest.mass", "mass_kg"),
    ("ingest.impact_speed", "impact_speed_m_per_s"),
    ("ingest.channel", "channel"),
    ("ingest.vehicle", "vehicle"),
    ("ingest.barrier", "barrier"),
    ("ingest.time_zero", "time_zero_s"),
];

/// What an option is called among the causes: `filter.cfc`; one that states a field of the test as that field,
/// `test.mass_kg`.
pub fn name_of_cause(option: &str) -> String {
    let field = OF_TEST.iter().find(|(name, _)| *name == option).map(|(_, field)| *field);
    field.map_or_else(|| option.to_owned(), |field| format!("test.{field}"))
}

/// What the test was, in each run: mass, speed, contact, the channel of the pulse.
fn test_causes(sides: [&Expected; 2], place: &impl Fn(&str, &str) -> Option<(String, usize)>) -> Vec<Cause> {
    // Without a summary nothing is known of a test.
    let is_unknown = |side: &&Expected| json!(side.summary.test) == json!(TestSummary::default());
    if sides.iter().any(is_unknown) {
        return Vec::new();
    }
    let lacks_contact = sides.iter().any(|side| side.is_earlier() || side.stages.is_empty());
    let [before, after] = sides.map(|side| {
        let mut test = json!(side.summary.test);
        let contact = side.contact.as_ref().filter(|_| !lacks_contact);
        test["title"] = Value::Null;
        test["time_zero_s"] = json!(contact.map(|contact| contact.source_time_s));
        test["time_zero_rule"] = json!(contact.map(|contact| contact.rule.clone()));
        test
    });
    let shown = |value: &Value| match (value.as_f64(), value.as_str()) {
        (Some(number), _) => words::significant(number, 6),
        (_, Some(text)) => text.to_owned(),
        _ => ABSENT.to_owned(),
    };
    let fields = before.as_object().into_iter().flat_map(serde_json::Map::keys);
    let differs = |name: &str| before[name] != after[name];
    // Another contact is one cause, whatever rule it was found by.
    let is_said = |name: &str| name == "time_zero_rule" && differs("time_zero_s");
    let differing = fields.filter(|name| differs(name) && !is_said(name));
    differing
        .map(|name| Cause {
            place: place("test", name),
            ..cause(CauseKind::Test, &format!("test.{name}"), shown(&before[name]), shown(&after[name]))
        })
        .collect()
}

/// What differs of what two results were made with, gravest first.
pub fn causes([a, b]: [&Expected; 2], place: impl Fn(&str, &str) -> Option<(String, usize)>) -> Vec<Cause> {
    let mut all = test_causes([a, b], &place);
    // Of a side without artifacts nobody knows how it was made.
    if a.stages.is_empty() || b.stages.is_empty() {
        return all;
    }
    if a.record[1] != b.record[1] {
        all.push(cause(CauseKind::Record, "record", a.record(), b.record()));
    }
    // What was typed or set for the test is said as what it makes of it.
    let is_said = |name: &str| match name {
        "ingest.flags" => !all.is_empty(),
        option => all.iter().any(|cause| cause.name == name_of_cause(option)),
    };
    let mut settings = settings([a, b], &place);
    settings.retain(|cause| !is_said(&cause.name));
    let chain = |name: &str| {
        let stage = name.split('.').next().unwrap_or_default();
        b.stages.iter().chain(&a.stages).position(|record| record.stage == stage)
    };
    settings.sort_by_key(|cause| (cause.kind, chain(&cause.name)));
    let pipelines = [a, b].map(|side| side.summary.pipeline.clone().unwrap_or_default());
    let is_set = settings.iter().any(|cause| cause.kind == CauseKind::Setting);
    all.extend(settings);
    if pipelines[0] != pipelines[1] && is_set {
        let [from, to] = pipelines;
        all.push(cause(CauseKind::Pipeline, "pipeline", from, to));
    }
    all.extend(limits([a, b], &place));
    all.sort_by_key(|cause| cause.kind);
    all
}

/// The limits of both pipelines that are not the same. An earlier version kept none.
fn limits([a, b]: [&Expected; 2], place: &impl Fn(&str, &str) -> Option<(String, usize)>) -> Vec<Cause> {
    if a.is_earlier() || b.is_earlier() {
        return Vec::new();
    }
    let values = [a, b].map(|side| limits_of(&side.limits));
    // The longest: `/wave/*#x` holds `/wave/*`.
    let patterns = || b.limits.keys();
    let pattern = |name: &str| patterns().filter(|p| name.contains(p.as_str())).max_by_key(|p| p.len()).cloned();
    let limit = |(name, [from, to]): (String, [String; 2])| Cause {
        place: pattern(&name).and_then(|pattern| place(LIMITS, &pattern)),
        ..cause(CauseKind::Limit, &name, from, to)
    };
    differing(&values).into_iter().map(limit).collect()
}

/// Programs and options that differ. Options are called as a pipeline calls them, where both runs kept theirs and one
/// of the stage differs; else as the stage resolved them.
fn settings([a, b]: [&Expected; 2], place: &impl Fn(&str, &str) -> Option<(String, usize)>) -> Vec<Cause> {
    let stage_of = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
    let mut typed = differing(&[a, b].map(|side| options_of(&side.options)));
    // A stage that only one of both has is one cause, not each of its options.
    let is_optional = |stage: &&String| chain().any(|known| known.is_optional && known.name == **stage);
    let in_chain = |stage: &String| (stage.clone(), "in the chain".to_owned());
    let runs = [a, b].map(|side| side.options.keys().filter(is_optional).map(in_chain).collect());
    let left_out = differing(&runs);
    typed.retain(|(name, _)| left_out.iter().all(|(stage, _)| *stage != stage_of(name)));
    typed.extend(left_out);
    let with_typed: BTreeSet<String> = typed.iter().map(|(name, _)| stage_of(name)).collect();
    // Settings of a stage that another program stands in for are not its own.
    let lacks_settings = |side: &Expected, stage: &str| {
        let mut own = side.stages.iter().filter(|record| record.stage == stage);
        own.any(|record| ["", "{}", "null"].contains(&record.settings.as_str()))
    };
    let both_kept = !a.options.is_empty() && !b.options.is_empty();
    let resolved = differing(&[a, b].map(|side| settings_of(&side.stages))).into_iter().filter(|(name, _)| {
        let stage = stage_of(name);
        // An artifact that is gone states no options; where both kept theirs, these say what was asked.
        let [in_a, in_b] = [a, b].map(|side| side.stages.iter().any(|record| record.stage == stage));
        if both_kept && in_a != in_b {
            return false;
        }
        !with_typed.contains(&stage) && lacks_settings(a, &stage) == lacks_settings(b, &stage)
    });
    let programs = differing(&[a, b].map(|side| programs_of(&side.stages))).into_iter().filter(|(stage, _)| {
        let [in_a, in_b] = [a, b].map(|side| side.stages.iter().any(|record| record.stage == *stage));
        !both_kept || in_a == in_b
    });
    let programs = programs.map(|(stage, [from, to])| Cause {
        place: place(&stage, "program"),
        ..cause(CauseKind::Program, &stage, from, to)
    });
    let options = resolved.chain(typed.iter().filter(|_| both_kept).cloned()).map(|(name, [from, to])| {
        let (stage, key) = name.split_once('.').unwrap_or((&name, ""));
        Cause { place: place(stage, key), ..cause(CauseKind::Setting, &name, from, to) }
    });
    programs.chain(options).collect()
}

/// What two sides say of names that they do not say the same of.
fn differing(sides: &[BTreeMap<String, String>; 2]) -> Vec<(String, [String; 2])> {
    let names: BTreeSet<&String> = sides.iter().flat_map(BTreeMap::keys).collect();
    let values = |name: &String| {
        let value = |side: &BTreeMap<String, String>| side.get(name).cloned().unwrap_or_else(|| ABSENT.to_owned());
        (name.clone(), sides.each_ref().map(value))
    };
    names.into_iter().map(values).filter(|(_, [from, to])| from != to).collect()
}

/// Artifacts of two runs by their stages.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct ArtifactChanges {
    /// Those that only the first has.
    pub gone: Vec<String>,
    /// Those that only the second has.
    pub new: Vec<String>,
    /// Those with another content.
    pub differing: Vec<String>,
}

impl ArtifactChanges {
    /// Of two runs that state their artifacts; of a summary without any nothing is known.
    pub fn new([a, b]: [&Expected; 2]) -> Self {
        if a.is_summary_alone || b.is_summary_alone {
            return Self::default();
        }
        let only = |own: &Expected, other: &Expected| -> Vec<String> {
            let is_there = |stage: &str| other.stages.iter().any(|record| record.stage == stage);
            own.stages.iter().map(|record| record.stage.clone()).filter(|stage| !is_there(stage)).collect()
        };
        let pairs = a.stages.iter().filter_map(|x| Some((x, b.stages.iter().find(|y| y.stage == x.stage)?)));
        let differing = pairs.filter(|(x, y)| x.digest != y.digest).map(|(x, _)| x.stage.clone()).collect();
        Self { gone: only(a, b), new: only(b, a), differing }
    }
}

/// Stages whose content differs though their program, settings and inputs are the same.
pub fn unexplained([a, b]: [&Expected; 2]) -> Vec<String> {
    let same = a.record[1] == b.record[1];
    let pairs = a.stages.iter().filter_map(|x| Some((x, b.stages.iter().find(|y| y.stage == x.stage)?)));
    pairs
        .filter(|(x, y)| {
            let made = |record: &StageRecord| (record.made_by(), record.settings.clone(), record.inputs.clone());
            made(x) == made(y) && x.digest != y.digest && same
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
mod tests {
    use super::*;

    #[test]
    fn an_option_is_found_where_a_pipeline_file_states_it() {
        let text = "# a\n[filter]\ncfc = 180\n\n[identify]\ncfc = 2\nmax-order = 3\n[filter.zero_level]\nx = 1\n";
        assert_eq!(line_of(text, "filter", "cfc"), Some(3));
        assert_eq!(line_of(text, "identify", "max_order"), Some(7));
        assert_eq!(line_of(text, "filter", "zero_level.from_s"), Some(8));
        assert_eq!(line_of(text, "filter", "mode"), None);
    }
}
