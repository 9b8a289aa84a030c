//! `--together`: the page of one model for several tests.

use std::path::{Path, PathBuf};

use crate::{Conclusion, LeftOut, Page, Ranking, Run, summary};
use crumple_artifact::OutputKind;
use crumple_artifact::records::{DiagnosisV1, PredictionV1, RemarkV1};
use crumple_signal::Display;
use crumple_stage::{ExitStatus, Refused, by_way, keep_budget, load_artifacts, refuse_to_overwrite, say};

use super::compare::write;
use super::console::Screen;
use super::gather::gather;

/// Joint candidates.
const SOLVED: &str = "5-parameter-solve.mcap";
/// Predictions.
const PREDICTED: &str = "7-predict.mcap";

/// What a joint result says first: the verdict, the remarks behind it, and the lines of the console.
pub struct JointAnswer {
    /// Status, sentences, and what the answer is good for.
    pub verdict: Conclusion,
    /// What the stages and the report remark, strongest first.
    pub remarks: Vec<RemarkV1>,
    /// As the terminal shows it.
    pub screen: Screen,
}

impl JointAnswer {
    /// Of the folder of a joint result, with a screen in these units. Refuses one that holds none.
    pub fn of_folder(folder: &Path, display: Display) -> anyhow::Result<Self> {
        let run = joint_run(folder)?;
        let ranking = Ranking::of_run(&run);
        let summary = summary(&run, &ranking);
        let screen = display.during(|| {
            let run = run.with_sentences_shown();
            Screen::of(&run, &ranking, &crate::summary(&run, &ranking), &folder.join("report.html"))
        });
        Ok(Self { verdict: summary.verdict, remarks: summary.remarks, screen })
    }
}

/// Reads the folder of a joint result, as `crumple-together` makes it, and writes its page.
pub fn together(folder: &Path, page: &Path, pipeline: Option<String>, quiet: bool) -> anyhow::Result<ExitStatus> {
    refuse_to_overwrite(page, OutputKind::Report, &artifacts(folder))?;
    let mut run = joint_run(folder)?.with_sentences_shown();
    run.pipeline = pipeline;
    let ranking = Ranking::of_run(&run);
    let mut html = Vec::new();
    Page::new(&run, &ranking).write_to(&mut html)?;
    write(page, OutputKind::Report, &String::from_utf8_lossy(&html))?;
    if !quiet {
        say(page.display());
    }
    Ok(ExitStatus::Done)
}

/// Those of a joint result that are there.
fn artifacts(folder: &Path) -> Vec<PathBuf> {
    [SOLVED, PREDICTED].map(|name| folder.join(name)).into_iter().filter(|path| path.is_file()).collect()
}

/// What the artifacts of a joint result say, and of each test what the others say of it.
fn joint_run(folder: &Path) -> anyhow::Result<Run> {
    let artifacts = artifacts(folder);
    keep_budget(&artifacts, ExitStatus::Refused);
    let no_model = || {
        Refused::new(format!("{} holds no model of several tests", folder.display())).hint(format!(
            "{} A.EV5 B.EV5 ... makes one, and says where it is",
            by_way("just together", "crumple together")
        ))
    };
    if artifacts.is_empty() {
        return Err(no_model().into());
    }
    let mut run = gather(&load_artifacts(&artifacts)?.input, None)?;
    let joint = run.joint.as_mut().ok_or_else(no_model)?;
    for test in &mut joint.tests {
        test.left_out = left_out(&folder.join(format!("without-{}", test.test.name)))?;
    }
    Ok(run)
}

/// What the others say of a test: in the folder in which it was left out.
fn left_out(folder: &Path) -> anyhow::Result<LeftOut> {
    let Some(path) = [PREDICTED, SOLVED].map(|name| folder.join(name)).into_iter().find(|path| path.is_file()) else {
        return Ok(LeftOut::NotTried);
    };
    let input = load_artifacts(&[path])?.input;
    if let Some(diagnosis) = input.record_if::<DiagnosisV1>("/diagnosis")? {
        return Ok(LeftOut::NotPredicted(diagnosis.reason));
    }
    let all = input.records::<PredictionV1>("/prediction/")?;
    let of_the_test = all.into_iter().map(|(_, prediction)| prediction).filter(|p| p.against.is_some());
    Ok(of_the_test
        .min_by_key(|prediction| !prediction.recommended)
        .map_or(LeftOut::NotTried, |prediction| LeftOut::Predicted(Box::new(prediction))))
}
