//! The summary of a joint run, with what each test says when it is left out.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_report::{Conclusion, JointAnswer, OF_SEVERAL_TESTS};
use crumple_signal::Display;
use crumple_signal::HALF_OF_90_PERCENT;
use crumple_stage::records::{
    AgainstTestV1, CandidateV1, DiagnosisV1, JointTestV1, PredictionV1, RecommendationV1, RemarkV1, TestsV2,
};
use crumple_stage::{Refused, by_way, errors_in_words, load_artifacts, say};
use serde::{Deserialize, Serialize};

use crate::together::joint_run::{PREDICTED, SOLVED, SUMMARY};

/// `summary.json` of a joint result.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct JointSummary {
    schema: String,
    pipeline: String,
    /// What to hold of all this; as in the summary of a run.
    verdict: Conclusion,
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
    /// What the joint stages and the report remark, strongest first.
    remarks: Vec<RemarkV1>,
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
pub(crate) fn write_summary(
    folder: &Path,
    pipeline: &str,
    held_out: &[HeldOutTest],
    display: Display,
) -> anyhow::Result<()> {
    let joint = load_artifacts(&[folder.join(SOLVED)])?.input;
    let tests: TestsV2 = joint.record_if("/tests")?.unwrap_or_default();
    let candidates: Vec<(String, CandidateV1)> = joint.records("/parameters/")?;
    let choice: RecommendationV1 = joint.record_if("/recommendation")?.unwrap_or_default();
    let predictions: Vec<(String, PredictionV1)> = match folder.join(PREDICTED) {
        path if path.is_file() => load_artifacts(&[path])?.input.records("/prediction/")?,
        _ => Vec::new(),
    };
    let mut leave_one_out = Vec::new();
    say(format_args!("{:<16} {}", "together", header()));
    for test in held_out {
        let left_out = test.left_out()?;
        say(format_args!("{:<16} {}", "together", line(&left_out)));
        leave_one_out.push(left_out);
    }
    let JointAnswer { verdict, remarks, screen } = JointAnswer::of_folder(folder, display)?;
    let summary = JointSummary {
        schema: OF_SEVERAL_TESTS.to_owned(),
        pipeline: pipeline.to_owned(),
        verdict,
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
        remarks,
    };
    let path = folder.join(SUMMARY);
    let text = serde_json::to_string_pretty(&summary)? + "\n";
    write_atomically(&path, OutputKind::Summary, |file| file.write_all(text.as_bytes()))
        .with_context(|| format!("cannot write {}", path.display()))?;
    screen.say();
    say(format_args!("{:<16} {}", "results", folder.display()));
    Ok(())
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
    let [crush, time, peak, restitution, score] = errors_in_words(against);
    let held = if against.held.iter().any(|name| name == "dynamic_crush_m") { "crush" } else { "-" };
    format!("{crush:>8} {time:>8} {peak:>8} {restitution:>8} {score:>9}  {held:<7}")
}

/// How the folders begin in which one test is left out.
const WITHOUT: &str = "without-";

/// A test that was left out.
#[derive(Debug)]
pub(crate) struct HeldOutTest {
    /// Its name.
    pub(crate) test: String,
    /// The tests that it was predicted from.
    pub(crate) from: Vec<String>,
    /// Where the prediction is.
    pub(crate) folder: PathBuf,
}

/// Where a test is left out.
pub(crate) fn folder_without(folder: &Path, test: &str) -> PathBuf {
    folder.join(format!("{WITHOUT}{test}"))
}

/// The tests of a joint result, each left out once. Refuses a folder whose tests were not all predicted.
pub(crate) fn left_out_of(folder: &Path) -> anyhow::Result<Vec<HeldOutTest>> {
    let tests: Option<TestsV2> = load_artifacts(&[folder.join(SOLVED)])?.input.record_if("/tests")?;
    let refused = |problem: String| {
        Refused::new(problem)
            .hint(format!("{} A.EV5 B.EV5 ... makes all of it again", by_way("just together", "crumple together")))
    };
    let nothing = || refused(format!("{} holds no model of several tests", folder.display()));
    let tests = tests.ok_or_else(nothing)?;
    if let Some(test) = tests.tests.iter().find(|test| !folder_without(folder, &test.name).is_dir()) {
        let problem = format!("in {} the test {} is not predicted from the others", folder.display(), test.name);
        return Err(refused(problem).into());
    }
    let names: Vec<&String> = tests.tests.iter().map(|test| &test.name).collect();
    let left = |name: &&String| HeldOutTest {
        test: (*name).clone(),
        from: names.iter().filter(|other| *other != name).map(|other| (*other).clone()).collect(),
        folder: folder_without(folder, name),
    };
    Ok(names.iter().map(left).collect())
}

/// Removes what an earlier run into this folder left out and this one does not.
pub(crate) fn remove_of_others(folder: &Path, tests: &[&str]) -> anyhow::Result<()> {
    let entries = fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    for entry in entries {
        let path = entry.with_context(|| format!("cannot read {}", folder.display()))?.path();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let Some(test) = name.strip_prefix(WITHOUT).filter(|test| !tests.contains(test)) else { continue };
        for file in [PREDICTED, SOLVED] {
            let file = folder_without(folder, test).join(file);
            if file.exists() {
                fs::remove_file(&file).with_context(|| format!("cannot remove {}", file.display()))?;
            }
        }
        // One that holds something else stays.
        let _ = fs::remove_dir(&path);
    }
    Ok(())
}

/// By how much tests that were left out were missed: root mean square of the errors of their dynamic crush over the
/// standard deviations of those predictions. `None` where none was predicted.
pub(crate) fn ratio_of(left_out: &[HeldOutTest]) -> anyhow::Result<Option<f64>> {
    let mut squares = Vec::new();
    for left in left_out {
        let predictions = left.left_out()?.predictions;
        squares.extend(predictions.iter().find_map(in_deviations).map(|error| error * error));
    }
    Ok(Some((squares.iter().sum::<f64>() / squares.len() as f64).sqrt()).filter(|ratio| ratio.is_finite()))
}

/// The error of a predicted crush in standard deviations of it.
fn in_deviations(prediction: &PredictionV1) -> Option<f64> {
    let error_percent = prediction.against.as_ref()?.dynamic_crush_error_percent?;
    let predicted = prediction.dynamic_crush_m?;
    let interval = prediction.intervals.iter().find(|interval| interval.name == "dynamic_crush_m")?;
    let error_m = predicted - predicted / (1.0 + 0.01 * error_percent);
    let deviation_m = 0.5 * (interval.high - interval.low) / HALF_OF_90_PERCENT;
    Some(error_m / deviation_m).filter(|ratio| ratio.is_finite())
}

impl HeldOutTest {
    /// The predictions of the test itself, the recommended first, or why there is none.
    pub(crate) fn left_out(&self) -> anyhow::Result<LeftOut> {
        let predicted = self.folder.join(PREDICTED);
        let path = if predicted.is_file() { predicted } else { self.folder.join(SOLVED) };
        let input = load_artifacts(&[path])?.input;
        let mut left_out = LeftOut { test: self.test.clone(), from: self.from.clone(), ..LeftOut::default() };
        if let Some(diagnosis) = input.record_if::<DiagnosisV1>("/diagnosis")? {
            left_out.no_prediction_because = Some(diagnosis.reason);
            return Ok(left_out);
        }
        let all: Vec<(String, PredictionV1)> = input.records("/prediction/")?;
        left_out.predictions =
            all.into_iter().map(|(_, prediction)| prediction).filter(|p| p.against.is_some()).collect();
        left_out.predictions.sort_by_key(|prediction| !prediction.recommended);
        Ok(left_out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_stage::records::{AgainstTestV1, PredictedIntervalV1};

    #[test]
    fn an_error_is_counted_in_deviations_of_its_prediction() {
        let interval = PredictedIntervalV1 {
            name: "dynamic_crush_m".to_owned(),
            low: 0.55 - 0.02 * HALF_OF_90_PERCENT,
            high: 0.55 + 0.02 * HALF_OF_90_PERCENT,
            level: 0.9,
            interval_by: String::new(),
        };
        let against = AgainstTestV1 { dynamic_crush_error_percent: Some(10.0), ..AgainstTestV1::default() };
        let prediction = PredictionV1 {
            dynamic_crush_m: Some(0.55),
            intervals: vec![interval],
            against: Some(against),
            ..PredictionV1::default()
        };
        // 0.55 m predicted, 0.50 m measured, 20 mm known.
        assert!((in_deviations(&prediction).unwrap() - 2.5).abs() < 1e-12);
        assert_eq!(in_deviations(&PredictionV1 { against: None, ..prediction }), None);
    }
}
