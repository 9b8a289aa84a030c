//! Every test predicted from the others: where it is, and what it says.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_stage::records::{DiagnosisV1, PredictionV1, TestsV1};
use crumple_stage::{Refused, load_artifacts};

use crate::together::files::{PREDICTED, SOLVED};
use crate::together::summary::LeftOut;

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
    let tests: Option<TestsV1> = load_artifacts(&[folder.join(SOLVED)])?.input.record_if("/tests")?;
    let refused = |problem: String| Refused::new(problem).hint("just together A.EV5 B.EV5 ... makes all of it again");
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

/// Half width of the 90 % intervals of a prediction in standard deviations.
const HALF_OF_90_PERCENT: f64 = 1.644_853_626_951_472_7;

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
    use crumple_stage::records::{AgainstTestV1, PredictedIntervalV1};

    use super::*;

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
