//! The ordinary run of each record, or a run folder that is there.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use crumple_stage::{ExitStatus, Usage, say};

use crate::command::Pipeline;
use crate::command::own_program;
use crate::steps::StageExit;
use crate::steps::run_program;
use crate::together::files::{INTEGRATED, SOLVED};
use crate::together::options::TogetherOptions;

/// What a joint fit reads of a test.
const FILTERED: &str = "2-filter.mcap";

/// A test with its run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct TestRun {
    /// Name in the joint result: that of its record.
    pub(crate) name: String,
    /// Its run folder.
    pub(crate) folder: PathBuf,
    /// The record to run; `None`: the folder was given.
    record: Option<PathBuf>,
}

impl TestRun {
    /// The artifacts of a joint fit, each with the name of the test in front.
    pub(crate) fn named_artifacts(&self) -> impl Iterator<Item = String> {
        let path = |file: &str| format!("{}:{}", self.name, self.folder.join(file).display());
        [path(FILTERED), path(INTEGRATED)].into_iter()
    }

    /// The artifacts with which the test alone predicts.
    pub(crate) fn own_candidates(&self) -> [PathBuf; 2] {
        [self.folder.join(INTEGRATED), self.folder.join(SOLVED)]
    }
}

/// Which run each record has. Errors: two records of one name.
pub(crate) fn test_runs(records: &[PathBuf], options: &TogetherOptions) -> Result<Vec<TestRun>, Usage> {
    let pipeline = Pipeline::resolve(&options.pipeline, &options.project);
    let mut runs: Vec<TestRun> = Vec::new();
    let mut seen: BTreeMap<String, &Path> = BTreeMap::new();
    for record in records {
        let run = test_run(record, &pipeline, options)?;
        if let Some(other) = seen.insert(run.name.clone(), record) {
            let problem = format!("{} and {} have one name, {}", other.display(), record.display(), run.name);
            return Err(Usage::new(problem).hint("their results would share a folder: rename one of the files"));
        }
        runs.push(run);
    }
    Ok(runs)
}

fn test_run(record: &Path, pipeline: &Pipeline, options: &TogetherOptions) -> Result<TestRun, Usage> {
    let name_of = |path: &Path| path.file_name().map(|name| name.to_string_lossy().replace([':', '/'], "-"));
    let without_name = || Usage::new(format!("{} has no file name", record.display()));
    if record.join(INTEGRATED).is_file() {
        // A folder made by `just run` has the name of its pipeline.
        let last = Path::new(&pipeline.name).file_name();
        let of_record = if record.file_name() == last { record.parent() } else { Some(record) };
        let name = of_record.and_then(name_of).ok_or_else(without_name)?;
        return Ok(TestRun { name, folder: record.to_owned(), record: None });
    }
    let stem = record.file_stem().ok_or_else(without_name)?;
    let name = name_of(Path::new(stem)).ok_or_else(without_name)?;
    let folder = options.project.join("runs").join(stem).join(&pipeline.name);
    Ok(TestRun { name, folder, record: Some(record.to_owned()) })
}

/// Runs the records that no folder was given for. `Some`: the exit status of one that failed, which is named.
pub(crate) fn run_each(runs: &[TestRun], options: &TogetherOptions) -> anyhow::Result<Option<ExitStatus>> {
    for run in runs {
        let Some(record) = &run.record else { continue };
        let mut arguments: Vec<OsString> = vec!["--project".into(), options.project.clone().into()];
        arguments.extend(["--pipeline".into(), OsString::from(&options.pipeline)]);
        arguments.extend(["--flags".into(), options.flags.to_string().into(), "--".into(), record.into()]);
        let failed = match StageExit::of(run_program(&own_program("run"), &arguments)?) {
            StageExit::WithResult(_) if run.folder.join(INTEGRATED).is_file() => None,
            StageExit::WithResult(status) | StageExit::Failed(status) => Some(status),
            StageExit::Unforeseen(_) => Some(ExitStatus::Failure),
        };
        if let Some(status) = failed {
            say(format_args!("error: the run of {} failed; no joint result was written", record.display()));
            return Ok(Some(status));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    fn options(project: &Path) -> TogetherOptions {
        let project = project.to_str().unwrap();
        TogetherOptions::parse_from(["together", "--project", project, "--", "a", "b"])
    }

    #[test]
    fn a_record_and_its_run_folder_have_one_name() {
        let project = tempfile::tempdir().unwrap();
        let folder = project.path().join("runs/a/default");
        std::fs::create_dir_all(&folder).unwrap();
        let options = options(project.path());
        let runs = |records: &[PathBuf]| test_runs(records, &options);
        let [of_record] = &runs(&["x/a.csv".into()]).unwrap()[..] else { panic!() };
        assert_eq!((of_record.name.as_str(), &of_record.folder), ("a", &folder));
        std::fs::write(folder.join(INTEGRATED), "").unwrap();
        let [of_folder] = &runs(std::slice::from_ref(&folder)).unwrap()[..] else { panic!() };
        assert_eq!((of_folder.name.as_str(), of_folder.record.is_none()), ("a", true));
        let error = runs(&[folder, "a.EV5".into()]).unwrap_err();
        assert!(error.to_string().contains("have one name, a"), "{error}");
    }
}
