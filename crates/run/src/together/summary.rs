//! `summary.json` of a joint result, and the table of every test predicted from the others.

use std::fs;
use std::path::Path;

use anyhow::Context;
use crumple_stage::records::{AgainstTestV1, CandidateV1, PredictionV1, RecommendationV1, TestsV1};
use crumple_stage::{load_artifacts, say};
use serde_json::{Map, Value, json};

use crate::together::files::{PREDICTED, SOLVED, SUMMARY};
use crate::together::leave_one_out::Left;

/// Writes `summary.json` in one piece, and says the table.
pub(crate) fn write_summary(folder: &Path, pipeline: &str, left_out: &[Left]) -> anyhow::Result<()> {
    let joint = load_artifacts(&[folder.join(SOLVED)])?.input;
    let tests: TestsV1 = joint.record_if("/tests")?.unwrap_or_default();
    let candidates: Vec<(String, CandidateV1)> = joint.records("/parameters/")?;
    let choice: RecommendationV1 = joint.record_if("/recommendation")?.unwrap_or_default();
    let predictions: Vec<(String, PredictionV1)> = match folder.join(PREDICTED) {
        path if path.is_file() => load_artifacts(&[path])?.input.records("/prediction/")?,
        _ => Vec::new(),
    };
    let (mut rows, mut missed) = (Vec::new(), Vec::new());
    say(format_args!("{:<16} {}", "together", header()));
    for left in left_out {
        let predicted = left.predictions()?;
        say(format_args!("{:<16} {}", "together", line(left, &predicted)));
        missed.extend(predicted.iter().find_map(|predictions| missed_crush(&left.test, predictions)));
        rows.push(row(left, predicted)?);
    }
    let candidates =
        candidates.into_iter().map(|(id, candidate)| with_id(&id, &candidate)).collect::<Result<Vec<_>, _>>()?;
    let predictions: Vec<PredictionV1> = predictions.into_iter().map(|(_, prediction)| prediction).collect();
    let summary = json!({
        "schema": "crumple.together.v1",
        "pipeline": pipeline,
        "tests": tests.tests,
        "rate_factor": tests.rate_factor,
        "candidates": candidates,
        "recommended": choice.recommended,
        "recommended_because": choice.recommended_because,
        "simplest": choice.simplest,
        "simplest_because": choice.simplest_because,
        "closest": choice.closest,
        "closest_because": choice.closest_because,
        "leave_one_out": rows,
        "predictions": predictions,
    });
    let new = folder.join(".summary.json.new");
    let mut text = serde_json::to_string_pretty(&summary)?;
    text.push('\n');
    fs::write(&new, text).with_context(|| format!("cannot write {}", new.display()))?;
    let path = folder.join(SUMMARY);
    fs::rename(&new, &path).with_context(|| format!("cannot write {}", path.display()))?;
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
fn missed_crush(test: &str, predictions: &[PredictionV1]) -> Option<String> {
    let against = predictions.iter().find_map(|prediction| prediction.against.as_ref())?;
    Some(format!("{test} ({:+.1} %)", against.missed_crush_percent()?))
}

fn with_id(id: &str, candidate: &CandidateV1) -> Result<Value, serde_json::Error> {
    let mut value = serde_json::to_value(candidate)?;
    if let Value::Object(fields) = &mut value {
        fields.insert("id".to_owned(), id.into());
    }
    Ok(value)
}

/// One test in `leave_one_out`.
fn row(left: &Left, predicted: Result<Vec<PredictionV1>, String>) -> Result<Value, serde_json::Error> {
    let mut fields = Map::new();
    fields.insert("test".to_owned(), left.test.clone().into());
    fields.insert("from".to_owned(), left.from.clone().into());
    match predicted {
        Ok(predictions) => fields.insert("predictions".to_owned(), serde_json::to_value(predictions)?),
        Err(reason) => fields.insert("no_prediction_because".to_owned(), reason.into()),
    };
    Ok(Value::Object(fields))
}

fn header() -> String {
    format!(
        "{:<24} {:>8} {:>8} {:>8} {:>8} {:>9}  {:<7} by",
        "left out", "crush", "time", "peak", "e", "ISO 18571", "held"
    )
}

/// One line of the table: errors of the recommended candidate, of the closest where none is recommended.
fn line(left: &Left, predicted: &Result<Vec<PredictionV1>, String>) -> String {
    let name = format!("{:<24}", left.test);
    let predictions = match predicted {
        Ok(predictions) => predictions,
        Err(reason) => return format!("{name} not predicted: {reason}"),
    };
    let Some((prediction, against)) = predictions.iter().find_map(|p| Some((p, p.against.as_ref()?))) else {
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
        let missed = |predictions: &[PredictionV1]| missed_crush("a", predictions);
        assert_eq!(missed(&[prediction(None, false), prediction(Some(-23.3), false)]).unwrap(), "a (-23.3 %)");
        // What another candidate misses is not what is recommended.
        assert_eq!(missed(&[prediction(Some(1.0), true), prediction(Some(-23.3), false)]), None);
        assert_eq!(missed(&[prediction(Some(8.0), true)]), None);
        assert_eq!(missed(&[prediction(Some(2.0), false)]), None);
    }
}
