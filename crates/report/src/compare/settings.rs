//! What several runs were made from and with: record, pipeline, every setting of every stage that is not the same.

use std::collections::{BTreeMap, BTreeSet};

use crate::drawing::numbers::ABSENT;
use crate::findings::{StageRecord, record_name};
use serde_json::{Value, json};

use super::compared_run::ComparedRun;
use super::expected::Limits;
use super::table::Row;

/// The rows: record and pipeline always, then what differs.
pub fn rows(runs: &[ComparedRun]) -> Vec<Row> {
    let texts = |text: &dyn Fn(&ComparedRun) -> String| -> Vec<String> { runs.iter().map(text).collect() };
    let mut rows = vec![
        Row::of_texts("record", &texts(&|run| record_of(run))),
        Row::of_texts("pipeline", &texts(&|run| run.run.pipeline.clone().unwrap_or_else(|| ABSENT.to_owned()))),
    ];
    let made_with = |run: &ComparedRun| {
        let stages = &run.run.provenance;
        let programs = programs_of(stages).into_iter().map(|(stage, by)| (format!("{stage}.version"), by));
        programs.chain(settings_of(stages)).chain(limits_of(&run.limits)).collect()
    };
    let settings: Vec<BTreeMap<String, String>> = runs.iter().map(made_with).collect();
    let names: BTreeSet<&String> = settings.iter().flat_map(BTreeMap::keys).collect();
    let value = |settings: &BTreeMap<String, String>, name: &str| {
        settings.get(name).cloned().unwrap_or_else(|| ABSENT.to_owned())
    };
    let row = |name: &String| {
        let values: Vec<String> = settings.iter().map(|settings| value(settings, name)).collect();
        Row::of_texts(name.clone(), &values)
    };
    // In the order of the pipeline, not of the alphabet.
    let place = |name: &str| {
        let stage = name.split('.').next().unwrap_or_default();
        runs.iter().find_map(|run| run.run.provenance.iter().position(|record| record.stage == stage))
    };
    let mut differing: Vec<Row> = names.into_iter().map(row).filter(Row::differs).collect();
    differing.sort_by_key(|row| place(&row.name));
    rows.extend(differing);
    rows
}

/// The file and the first characters of its digest.
pub fn record_of(run: &ComparedRun) -> String {
    let source = &run.run.test.source;
    record_name(&source.name, &source.digest)
}

/// The version of every stage, or the program that stood for it.
pub fn programs_of(stages: &[StageRecord]) -> BTreeMap<String, String> {
    stages.iter().map(|record| (record.stage.clone(), record.made_by())).collect()
}

/// `stage.key.key` and the value of every setting.
pub fn settings_of(stages: &[StageRecord]) -> BTreeMap<String, String> {
    let mut settings = BTreeMap::new();
    for record in stages {
        if let Ok(value) = serde_json::from_str(&record.settings) {
            flatten(&record.stage, &value, &mut settings);
        }
    }
    settings
}

/// `stage.key.key` and the value of every option of a pipeline.
pub fn options_of(stages: &BTreeMap<String, Value>) -> BTreeMap<String, String> {
    let mut options = BTreeMap::new();
    stages.iter().for_each(|(stage, value)| flatten(stage, value, &mut options));
    options
}

/// `limits.PATTERN.abs` and the value of every limit of a pipeline.
pub fn limits_of(limits: &Limits) -> BTreeMap<String, String> {
    let mut flat = BTreeMap::new();
    flatten("limits", &json!(limits), &mut flat);
    flat
}

fn flatten(place: &str, value: &Value, settings: &mut BTreeMap<String, String>) {
    match value {
        Value::Object(members) => {
            members.iter().for_each(|(key, value)| flatten(&format!("{place}.{key}"), value, settings));
        }
        Value::Null => {}
        Value::String(text) => _ = settings.insert(place.to_owned(), text.clone()),
        other => _ = settings.insert(place.to_owned(), other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_named_by_stage_and_key() {
        let mut settings = BTreeMap::new();
        let value = serde_json::json!({"cfc": 60, "window": {"to_s": 0.1, "rule": "crush"}, "none": null, "l": [1, 2]});
        flatten("filter", &value, &mut settings);
        let pairs: Vec<String> = settings.iter().map(|(name, value)| format!("{name}={value}")).collect();
        assert_eq!(pairs, ["filter.cfc=60", "filter.l=[1,2]", "filter.window.rule=crush", "filter.window.to_s=0.1"]);
    }
}
