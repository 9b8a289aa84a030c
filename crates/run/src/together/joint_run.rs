//! The joint stages into one folder.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use crumple_stage::{ExitStatus, say};

use crate::command::Pipeline;
use crate::command::Program;
use crate::folder::lock::LockedFolder;
use crate::folder::pipeline_of_run::PipelineOfRun;
use crate::steps::StageExit;
use crate::steps::start;
use crate::together::each_run::{TestRun, run_each, test_runs};
use crate::together::files::{PREDICTED, REPORT, SOLVED, SUMMARY};
use crate::together::leave_one_out::{HeldOutTest, folder_without, left_out_of, ratio_of, remove_of_others};
use crate::together::options::{Asked, TogetherOptions};
use crate::together::summary::write_summary;

/// Runs every record, fits one model to all of them, predicts every test from the others, and predicts with the model.
///
/// A record or program that fails ends it with its exit code, named; what stands in the folder is then that of an
/// earlier run or of the steps before, each file whole. Exit code 4: no acceptable joint model.
pub fn together(options: TogetherOptions) -> anyhow::Result<ExitStatus> {
    if let Some(made) = &options.again {
        return predict_again(made, &options);
    }
    let asked = Asked::read(&options.rest)?;
    let runs = test_runs(&asked.records, &options)?;
    if let Some(failed) = run_each(&runs, &options)? {
        return Ok(failed);
    }
    let names: Vec<&str> = runs.iter().map(|run| run.name.as_str()).collect();
    let name = asked.name.clone().unwrap_or_else(|| names.join("+"));
    let path = match options.out.is_empty() {
        true => options.project.join("runs/together").join(name),
        false => PathBuf::from(&options.out),
    };
    let folder = LockedFolder::lock(&path)?;
    let pipeline = Pipeline::resolve(&options.pipeline, &options.project);
    let (composed, given) = handed_on(&pipeline, &options, folder.path())?;
    let joint = JointRun { options: &options, pipeline: given.path(), folder: folder.path() };
    let status = joint.model(&runs, folder.path(), Vec::new())?;
    if status == ExitStatus::NoAcceptableResult {
        joint.page()?;
    }
    if status != ExitStatus::Done {
        return Ok(status);
    }
    remove_of_others(folder.path(), &names)?;
    for (k, run) in runs.iter().enumerate() {
        let others: Vec<&TestRun> = runs.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, run)| run).collect();
        let own = folder_without(folder.path(), &run.name);
        fs::create_dir_all(&own).with_context(|| format!("cannot make {}", own.display()))?;
        let (inputs, solved) = match others[..] {
            // What one test says alone is in its own run.
            [alone] => (alone.own_candidates().to_vec(), ExitStatus::Done),
            _ => {
                let of_others: Vec<TestRun> = others.iter().map(|other| (*other).clone()).collect();
                (vec![own.join(SOLVED)], joint.model(&of_others, &own, joint.quiet())?)
            }
        };
        let predicted = match solved {
            ExitStatus::Done => joint.prediction(&inputs, Some(&run.folder), &own, &joint.quiet())?,
            other => other,
        };
        if !matches!(predicted, ExitStatus::Done | ExitStatus::NoAcceptableResult) {
            say(format_args!("error: {} could not be predicted from the others", run.name));
            return Ok(predicted);
        }
    }
    let left_out = left_out_of(folder.path())?;
    let status = joint.joint_prediction(&left_out, &asked.flags)?;
    if matches!(status, ExitStatus::Done | ExitStatus::NoAcceptableResult) {
        write_summary(folder.path(), &pipeline.name, &left_out)?;
        joint.page()?;
        given.keep(folder.path(), &composed)?;
    }
    Ok(status)
}

/// The pipeline as the stages are given it, and its file in the folder.
fn handed_on(
    pipeline: &Pipeline,
    options: &TogetherOptions,
    folder: &Path,
) -> anyhow::Result<(crumple_stage::Pipeline, PipelineOfRun)> {
    let mut composed = pipeline.read(&options.project, &[])?;
    composed.note_run(&pipeline.name);
    let given = PipelineOfRun::write(folder, &composed, None)?;
    Ok((composed, given))
}

/// Predicts with the joint candidates of a folder again, and writes its summary again.
fn predict_again(made: &Path, options: &TogetherOptions) -> anyhow::Result<ExitStatus> {
    let pipeline = Pipeline::of_run(made, &options.pipeline, &options.project);
    let folder = LockedFolder::lock(made)?;
    let left_out = left_out_of(folder.path())?;
    let (composed, given) = handed_on(&pipeline, options, folder.path())?;
    let joint = JointRun { options, pipeline: given.path(), folder: folder.path() };
    let status = joint.joint_prediction(&left_out, &options.rest)?;
    if matches!(status, ExitStatus::Done | ExitStatus::NoAcceptableResult) {
        write_summary(folder.path(), &pipeline.name, &left_out)?;
        joint.page()?;
        given.keep(folder.path(), &composed)?;
    }
    Ok(status)
}

/// The joint stages with what they share.
struct JointRun<'a> {
    options: &'a TogetherOptions,
    pipeline: &'a Path,
    folder: &'a Path,
}

impl JointRun<'_> {
    /// What keeps a stage quiet, where the flags of all stages do not: it may be said once.
    fn quiet(&self) -> Vec<OsString> {
        let is_said = self.options.flags.iter().any(|word| matches!(word.as_str(), "-q" | "--quiet"));
        if is_said { Vec::new() } else { vec!["-q".into()] }
    }

    /// Fits one model to these tests, into `own`.
    fn model(&self, runs: &[TestRun], own: &Path, flags: Vec<OsString>) -> anyhow::Result<ExitStatus> {
        let mut arguments: Vec<OsString> = runs.iter().flat_map(TestRun::named_artifacts).map(OsString::from).collect();
        let made_from_it = [self.folder.join(SUMMARY), self.folder.join(REPORT), own.join(PREDICTED)];
        arguments.extend(self.ending(&own.join(SOLVED), &made_from_it));
        arguments.extend(flags);
        self.step("parameter-solve", &arguments)
    }

    /// Predicts with the joint candidates; the intervals hold what the tests that were left out were missed by.
    fn joint_prediction(&self, left_out: &[HeldOutTest], flags: &[OsString]) -> anyhow::Result<ExitStatus> {
        let is_said = flags.iter().any(|flag| flag.to_string_lossy().starts_with("--left-out"));
        let ratio = ratio_of(left_out)?.filter(|_| !is_said);
        let ratio = ratio.map(|ratio| ["--left-out".into(), OsString::from(format!("{ratio:.3}"))]);
        let flags: Vec<OsString> = ratio.into_iter().flatten().chain(flags.iter().cloned()).collect();
        self.prediction(&[self.folder.join(SOLVED)], None, self.folder, &flags)
    }

    /// Predicts with the candidates of these artifacts, into `own`.
    fn prediction(
        &self,
        inputs: &[PathBuf],
        against: Option<&Path>,
        own: &Path,
        flags: &[OsString],
    ) -> anyhow::Result<ExitStatus> {
        let mut arguments: Vec<OsString> = inputs.iter().map(OsString::from).collect();
        arguments.extend(self.ending(&own.join(PREDICTED), &[self.folder.join(SUMMARY), self.folder.join(REPORT)]));
        arguments.extend(against.into_iter().flat_map(|folder| ["--against".into(), folder.as_os_str().to_owned()]));
        arguments.extend_from_slice(flags);
        self.step("predict", &arguments)
    }

    /// Writes the page of the folder.
    fn page(&self) -> anyhow::Result<()> {
        let mut arguments: Vec<OsString> = vec!["--together".into(), self.folder.into(), "--pipeline".into()];
        arguments.extend([self.pipeline.into(), "-o".into(), self.folder.join(REPORT).into()]);
        match self.step("report", &arguments)? {
            ExitStatus::Done => Ok(()),
            other => bail!(
                "the stage report did not write {}: exit code {}",
                self.folder.join(REPORT).display(),
                other as u8
            ),
        }
    }

    /// Pipeline, output, and what is made from it.
    fn ending(&self, output: &Path, made_from_it: &[PathBuf]) -> Vec<OsString> {
        let mut words: Vec<OsString> = vec!["--pipeline".into(), self.pipeline.into()];
        words.extend(["-o".into(), output.into()]);
        words.extend(made_from_it.iter().flat_map(|file| ["--dependent".into(), file.into()]));
        words
    }

    fn step(&self, stage: &str, arguments: &[OsString]) -> anyhow::Result<ExitStatus> {
        let program = Program::of_stage(stage, &self.options.flags)?;
        Ok(StageExit::of(start(&program, arguments, &self.options.flags)?).status_of(&program.file))
    }
}
