//! `summary.json` of a joint result, and the table of every test predicted from the others.

use std::fs;
use std::io::Write;
use std::path::Path;

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_report::OF_SEVERAL_TESTS;
use crumple_stage::records::{AgainstTestV1, CandidateV1, JointTestV1, PredictionV1, RecommendationV1, TestsV1};
use crumple_stage::{load_artifacts, say};
use serde::{Deserialize, Serialize};

use crate::together::files::{PREDICTED, SOLVED, SUMMARY};
use crate::together::leave_one_out::HeldOutTest;

/// `summary.json` of a joint result.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct JointSummary {
    schema: String,
    pipeline: String,
    tests: Vec<JointTestV1>,
    rate_factor: String,
    candidates: Vec<JointCandidate>,
    pub(crate) recommended: Option<String>,
    recommended_because: String,
    simplest: Option<String>,
    simplest_because: String,
    closest: Option<String>,
    closest_because: String,
    pub(crate) leave_one_out: Vec<LeftOut>,
    predictions: Vec<PredictionV1>,
}

/// A candidate with its id.
#[derive(Debug, Serialize, Deserialize)]
struct JointCandidate {
    id: String,
    #[serde(flatten)]
    record: CandidateV1,
}

/// A test predicted from the others, or why it is not.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct LeftOut {
    pub(crate) test: String,
    pub(crate) from: Vec<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(crate) predictions: Vec<PredictionV1>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) no_prediction_because: Option<String>,
}

impl JointSummary {
    /// Reads that of a folder.
    pub(crate) fn read(folder: &Path) -> anyhow::Result<Self> {
        let path = folder.join(SUMMARY);
        let bytes = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        serde_json::from_slice(&bytes).with_context(|| format!("{} is no joint summary", path.display()))
    }

    /// A parameter of the joint Kelvin model.
    pub(crate) fn kelvin(&self, name: &str) -> Option<f64> {
        let kelvin = self.candidates.iter().find(|candidate| candidate.record.model == "kelvin")?;
        kelvin.record.parameters.get(name).copied()
    }
}

/// Writes `summary.json` in one piece, and says the table.
pub(crate) fn write_summary(folder: &Path, pipeline: &str, held_out: &[HeldOutTest]) -> anyhow::Result<()> {
    let joint = load_artifacts(&[folder.join(SOLVED)])?.input;
    let tests: TestsV1 = joint.record_if("/tests")?.unwrap_or_default();
    let candidates: Vec<(String, CandidateV1)> = joint.records("/parameters/")?;
    let choice: RecommendationV1 = joint.record_if("/recommendation")?.unwrap_or_default();
    let predictions: Vec<(String, PredictionV1)> = match folder.join(PREDICTED) {
        path if path.is_file() => load_artifacts(&[path])?.input.records("/prediction/")?,
        _ => Vec::new(),
    };
    let (mut leave_one_out, mut missed) = (Vec::new(), Vec::new());
    say(format_args!("{:<16} {}", "together", header()));
    for test in held_out {
        let left_out = test.left_out()?;
        say(format_args!("{:<16} {}", "together", line(&left_out)));
        missed.extend(missed_crush(&left_out));
        leave_one_out.push(left_out);
    }
    let summary = JointSummary {
        schema: OF_SEVERAL_TESTS.to_owned(),
        pipeline: pipeline.to_owned(),
        tests: tests.tests,
        rate_factor: tests.rate_factor,
        candidates: candidates.into_iter().map(|(id, record)| JointCandidate { id, record }).collect(),
        recommended: choice.recommended,
        recommended_because: choice.recommended_because,
        simplest: choice.simplest,
        simplest_because: choice.simplest_because,
        closest: choice.closest,
        closest_because: choice.closest_because,
        leave_one_out,
        predictions: predictions.into_iter().map(|(_, prediction)| prediction).collect(),
    };
    let path = folder.join(SUMMARY);
    let text = serde_json::to_string_pretty(&summary)? + "\n";
    write_atomically(&path, OutputKind::Summary, |file| file.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))?;
    if !missed.is_empty() {
        say(format_args!(
            "{:<16} warning: the crush of {} is outside of its 90 % interval: these tests may not be of one structure; \
             predictions of the joint model may be off by as much",
            "together",
            missed.join(" and that of ")
        ));
    }
    say(format_args!("{:<16} {}", "results", folder.display()));
    Ok(())
}

/// `ka (-23.3 %)` where the others predict another crush than this test has, by the prediction that stands in the
/// table.
fn missed_crush(LeftOut { test, predictions, .. }: &LeftOut) -> Option<String> {
    let against = predictions.iter().find_map(|prediction| prediction.against.as_ref())?;
    Some(format!("{test} ({:+.1} %)", against.missed_crush_percent()?))
}

fn header() -> String {
    format!(
        "{:<24} {:>8} {:>8} {:>8} {:>8} {:>9}  {:<7} by",
        "left out", "crush", "time", "peak", "e", "ISO 18571", "held"
    )
}

/// One line of the table: errors of the recommended candidate, of the closest where none is recommended.
fn line(left_out: &LeftOut) -> String {
    let name = format!("{:<24}", left_out.test);
    if let Some(reason) = &left_out.no_prediction_because {
        return format!("{name} not predicted: {reason}");
    }
    let Some((prediction, against)) = left_out.predictions.iter().find_map(|p| Some((p, p.against.as_ref()?))) else {
        return format!("{name} not predicted: none of the candidates could");
    };
    let suffix = if prediction.recommended { "" } else { " (none is recommended)" };
    format!("{name} {}  {}{suffix}", errors(against), prediction.candidate)
}

fn errors(against: &AgainstTestV1) -> String {
    let percent = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:+.1} %"));
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:+.3}"));
    let score = against.iso18571_score.map_or_else(|| "-".to_owned(), |score| format!("{score:.3}"));
    let held = if against.held.iter().any(|name| name == "dynamic_crush_m") { "crush" } else { "-" };
    format!(
        "{:>8} {:>8} {:>8} {:>8} {score:>9}  {held:<7}",
        percent(against.dynamic_crush_error_percent),
        percent(against.time_of_dynamic_crush_error_percent),
        percent(against.peak_acceleration_error_percent),
        number(against.coefficient_of_restitution_error),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crush_that_the_others_miss_is_named_by_the_prediction_of_the_table() {
        let prediction = |error: Option<f64>, held: bool| PredictionV1 {
            against: error.map(|percent| AgainstTestV1 {
                dynamic_crush_error_percent: Some(percent),
                held: if held { vec!["dynamic_crush_m".to_owned()] } else { Vec::new() },
                ..AgainstTestV1::default()
            }),
            ..PredictionV1::default()
        };
        let missed = |predictions: &[PredictionV1]| {
            missed_crush(&LeftOut { test: "a".to_owned(), predictions: predictions.to_vec(), ..LeftOut::default() })
        };
        assert_eq!(missed(&[prediction(None, false), prediction(Some(-23.3), false)]).unwrap(), "a (-23.3 %)");
        // What another candidate misses is not what is recommended.
        assert_eq!(missed(&[prediction(Some(1.0), true), prediction(Some(-23.3), false)]), None);
        assert_eq!(missed(&[prediction(Some(8.0), true)]), None);
        assert_eq!(missed(&[prediction(Some(2.0), false)]), None);
    }
}
