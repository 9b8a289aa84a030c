//! One model for several tests: the runs of each, then the joint run.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use crumple_report::JointAnswer;
use crumple_stage::{DisplayFlag, ExitStatus, Usage, by_way, say};

use crate::command::{OfAllStages, Pipeline};
use crate::folder::content::{PipelineOfRun, sweep};
use crate::folder::lock::LockedFolder;
use crate::names::{PIPELINE_OF_A_RUN, folder_of_record};
use crate::program::{NamedPrograms, own_command};
use crate::steps::{StageExit, run_program, start};
use crate::together::summary::{HeldOutTest, folder_without, left_out_of, ratio_of, remove_of_others, write_summary};
use crate::words::Words;

/// Runs every record, fits one model to all of them, predicts every test from the others, and predicts with the model.
///
/// A record or program that fails ends it with its exit code, named; what stands in the folder is then that of an
/// earlier run or of the steps before, each file whole. Exit code 4: no acceptable joint model.
pub fn together(mut options: TogetherOptions) -> anyhow::Result<ExitStatus> {
    options.of_all.add_to(&mut options.flags);
    options.programs.commands()?.check()?;
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
    let folder = locked(&path, &options)?;
    let pipeline = Pipeline::resolve(&options.pipeline, &options.project);
    let (composed, given) = handed_on(&pipeline, &options, folder.path())?;
    let joint = JointRun { options: &options, pipeline: given.path(), folder: folder.path() };
    // The verdict says what was found.
    let status = joint.model(&runs, folder.path(), vec!["--no-summary".into()])?;
    if status == ExitStatus::NoAcceptableResult {
        joint.page()?;
        JointAnswer::of_folder(folder.path(), options.display.or_of(Some(&composed))?)?.screen.say();
    }
    if status != ExitStatus::Done {
        return Ok(status);
    }
    remove_of_others(folder.path(), &names)?;
    let quiet = || vec![OsString::from("-q")];
    for (k, run) in runs.iter().enumerate() {
        let others: Vec<&TestRun> = runs.iter().enumerate().filter(|(i, _)| *i != k).map(|(_, run)| run).collect();
        let own = folder_without(folder.path(), &run.name);
        fs::create_dir_all(&own).with_context(|| format!("cannot make {}", own.display()))?;
        let (inputs, solved) = match others[..] {
            // What one test says alone is in its own run.
            [alone] => (alone.own_candidates().to_vec(), ExitStatus::Done),
            _ => {
                let of_others: Vec<TestRun> = others.iter().map(|other| (*other).clone()).collect();
                (vec![own.join(SOLVED)], joint.model(&of_others, &own, quiet())?)
            }
        };
        let predicted = match solved {
            ExitStatus::Done => joint.prediction(&inputs, Some(&run.folder), &own, &quiet())?,
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
        write_summary(folder.path(), &pipeline.name, &left_out, options.display.or_of(Some(&composed))?)?;
        joint.page()?;
        given.keep(folder.path(), &composed)?;
    }
    Ok(status)
}

/// The folder, locked and without the temporary files of joint runs that were killed.
fn locked(path: &Path, options: &TogetherOptions) -> anyhow::Result<LockedFolder> {
    let folder = LockedFolder::lock(path, options.flags.is_quiet())?;
    if folder.is_locked() {
        sweep(path, [PIPELINE_OF_A_RUN, SOLVED, PREDICTED, REPORT, SUMMARY].into_iter())
            .with_context(|| format!("cannot remove what an earlier run left in {}", path.display()))?;
    }
    Ok(folder)
}

/// The pipeline as the stages are given it, and its file in the folder.
fn handed_on(
    pipeline: &Pipeline,
    options: &TogetherOptions,
    folder: &Path,
) -> anyhow::Result<(crumple_stage::Pipeline, PipelineOfRun)> {
    let set = Vec::from_iter(options.display.as_set());
    let mut composed = pipeline.read(&options.project, &set)?;
    composed.note_run(&pipeline.name);
    let given = PipelineOfRun::write(folder, &composed, None)?;
    Ok((composed, given))
}

/// Predicts with the joint candidates of a folder again, and writes its summary again.
fn predict_again(made: &Path, options: &TogetherOptions) -> anyhow::Result<ExitStatus> {
    let pipeline = Pipeline::of_run(made, &options.pipeline, &options.project);
    let folder = locked(made, options)?;
    let left_out = left_out_of(folder.path())?;
    let (composed, given) = handed_on(&pipeline, options, folder.path())?;
    let joint = JointRun { options, pipeline: given.path(), folder: folder.path() };
    let status = joint.joint_prediction(&left_out, &options.rest)?;
    if matches!(status, ExitStatus::Done | ExitStatus::NoAcceptableResult) {
        write_summary(folder.path(), &pipeline.name, &left_out, options.display.or_of(Some(&composed))?)?;
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

    fn step(&self, stage: &'static str, arguments: &[OsString]) -> anyhow::Result<ExitStatus> {
        let program = self.options.programs.commands()?.program(stage, &self.options.flags)?;
        Ok(start(&program, arguments, &self.options.flags)?.status_of(&program.file))
    }
}

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
fn test_runs(records: &[PathBuf], options: &TogetherOptions) -> Result<Vec<TestRun>, Usage> {
    let pipeline = Pipeline::resolve(&options.pipeline, &options.project);
    let mut runs: Vec<TestRun> = Vec::new();
    let mut seen: BTreeMap<String, &Path> = BTreeMap::new();
    for record in records {
        let run = test_run(record, &pipeline, options)?;
        if let Some(other) = seen.insert(run.name.clone(), record) {
            let problem = format!("{} and {} have one name, {}", other.display(), record.display(), run.name);
            return Err(Usage::new(problem).hint("run each of them first, which gives them folders of two names"));
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
    let of_record = folder_of_record(&options.project, record).ok_or_else(without_name)?;
    let name = name_of(&of_record).ok_or_else(without_name)?;
    Ok(TestRun { name, folder: of_record.join(&pipeline.name), record: Some(record.to_owned()) })
}

/// Runs the records that no folder was given for. `Some`: the exit status of one that failed, which is named.
fn run_each(runs: &[TestRun], options: &TogetherOptions) -> anyhow::Result<Option<ExitStatus>> {
    for run in runs {
        let Some(record) = &run.record else { continue };
        let mut arguments: Vec<OsString> = vec!["--project".into(), options.project.clone().into()];
        arguments.extend(["--pipeline".into(), OsString::from(&options.pipeline)]);
        arguments.extend(options.programs.arguments());
        arguments.extend(["--flags".into(), options.flags.to_string().into(), "--".into(), record.into()]);
        if let Some(status) = run_record(&run.folder, &arguments)? {
            say(format_args!("error: the run of {} failed; no joint result was written", record.display()));
            return Ok(Some(status));
        }
    }
    Ok(None)
}

/// Runs a record as `crumple run` does with these words. `Some`: the exit status of a run that has no motion.
pub(crate) fn run_record(folder: &Path, words: &[OsString]) -> anyhow::Result<Option<ExitStatus>> {
    Ok(match run_program(own_command("run").args(words))? {
        StageExit::WithResult(_) if folder.join(INTEGRATED).is_file() => None,
        StageExit::WithResult(status) | StageExit::Failed(status) => Some(status),
        StageExit::Contradicts => Some(ExitStatus::Refused),
        StageExit::Unforeseen(_) => Some(ExitStatus::Failure),
    })
}

/// Motion of a test.
pub(crate) const INTEGRATED: &str = "3-integrate.mcap";
/// Joint candidates.
pub(crate) const SOLVED: &str = "5-parameter-solve.mcap";
/// Predictions.
pub(crate) const PREDICTED: &str = "7-predict.mcap";
/// All of it for scripts.
pub(crate) const SUMMARY: &str = "summary.json";
/// What a person looks at.
const REPORT: &str = "report.html";

/// Fits one model to several tests, and predicts every test from the others.
///
/// Each record has its ordinary run first; then the joint fit, its
/// predictions, and for each test a fit to the others that predicts it: into one folder, with summary.json.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-together",
    version,
    after_help = "Exit codes: 0 done, 1 a program failed unforeseen, 2 usage, 3 a record refused, 4 no acceptable \
                  result (its diagnosis is written)."
)]
pub struct TogetherOptions {
    /// Folder with `pipelines/` and `runs/`.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub(crate) project: PathBuf,

    /// Pipeline: a file below `pipelines/` without its ending, or the path of a file elsewhere.
    #[arg(long, value_name = "NAME|FILE", default_value = "default", allow_hyphen_values = true)]
    pub(crate) pipeline: String,

    /// Folder of the joint result [default: runs/together/NAME in the project].
    #[arg(long, value_name = "FOLDER", default_value = "", allow_hyphen_values = true)]
    pub(crate) out: OsString,

    /// Flags for every stage, as one would type them.
    #[arg(long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    pub(crate) flags: Words,

    /// Predict again with the joint result in this folder; flags of predict follow `--`.
    #[arg(long, value_name = "FOLDER", allow_hyphen_values = true, conflicts_with = "out")]
    pub(crate) again: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) display: DisplayFlag,

    #[command(flatten)]
    pub(crate) programs: NamedPrograms,

    #[command(flatten)]
    pub(crate) of_all: OfAllStages,

    /// Records or run folders, then `--name NAME` and flags of the joint prediction, such as --speed 64km/h.
    #[arg(required_unless_present = "again", value_name = "RECORD")]
    pub(crate) rest: Vec<OsString>,
}

/// What stands behind `--`.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Asked {
    /// Records and run folders.
    pub(crate) records: Vec<PathBuf>,
    /// Name of the result.
    pub(crate) name: Option<String>,
    /// Flags of the joint prediction.
    pub(crate) flags: Vec<OsString>,
}

impl Asked {
    /// Records up to the first flag, then flags. Errors: fewer than two records, a name without value or with a slash.
    pub(crate) fn read(rest: &[OsString]) -> Result<Self, Usage> {
        let is_flag = |word: &OsString| word.as_encoded_bytes().starts_with(b"-");
        let count = rest.iter().take_while(|word| !is_flag(word)).count();
        let mut asked = Self { records: rest[..count].iter().map(PathBuf::from).collect(), ..Self::default() };
        let mut words = rest[count..].iter();
        while let Some(word) = words.next() {
            let text = word.to_string_lossy();
            let value = match text.strip_prefix("--name") {
                Some("") => words.next().map(|value| value.to_string_lossy().into_owned()),
                Some(value) if value.starts_with('=') => Some(value[1..].to_owned()),
                _ => {
                    asked.flags.push(word.clone());
                    continue;
                }
            };
            let name = value.filter(|name| !name.is_empty() && !name.contains('/') && !name.starts_with(['-', '.']));
            asked.name = Some(name.ok_or_else(|| Usage::new("--name needs a name without slashes"))?);
        }
        if asked.records.len() < 2 {
            return Err(Usage::new(format!(
                "{} record, and one model for several tests needs two",
                asked.records.len()
            ))
            .hint(format!(
                "{} A.EV5 B.EV5 ... [--name NAME]; records come first",
                by_way("just together", "crumple together")
            )));
        }
        Ok(asked)
    }
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
        fs::create_dir_all(&folder).unwrap();
        let options = options(project.path());
        let runs = |records: &[PathBuf]| test_runs(records, &options);
        let [of_record] = &runs(&["x/a.csv".into()]).unwrap()[..] else { panic!() };
        assert_eq!((of_record.name.as_str(), &of_record.folder), ("a", &folder));
        fs::write(folder.join(INTEGRATED), "").unwrap();
        let [of_folder] = &runs(std::slice::from_ref(&folder)).unwrap()[..] else { panic!() };
        assert_eq!((of_folder.name.as_str(), of_folder.record.is_none()), ("a", true));
        let error = runs(&[folder, "a.EV5".into()]).unwrap_err();
        assert!(error.to_string().contains("have one name, a"), "{error}");
    }

    fn read(words: &[&str]) -> Result<Asked, Usage> {
        Asked::read(&words.iter().map(OsString::from).collect::<Vec<_>>())
    }

    #[test]
    fn records_come_first_and_the_name_is_no_flag_of_a_stage() {
        let asked = read(&["a.csv", "b.csv", "--speed", "64km/h", "--name", "both", "--mass=9kg"]).unwrap();
        assert_eq!(asked.records, [PathBuf::from("a.csv"), PathBuf::from("b.csv")]);
        assert_eq!(asked.name.as_deref(), Some("both"));
        assert_eq!(asked.flags, ["--speed", "64km/h", "--mass=9kg"]);
        assert_eq!(read(&["a", "b", "--name=c"]).unwrap().name.as_deref(), Some("c"));
    }

    #[test]
    fn one_record_and_a_name_that_is_a_path_are_refused() {
        assert!(read(&["a.csv"]).unwrap_err().to_string().starts_with("1 record"));
        assert!(read(&["--name", "x", "a", "b"]).is_err());
        for name in ["", "a/b", "..", "-x"] {
            assert!(read(&["a", "b", "--name", name]).is_err(), "{name:?}");
        }
        assert!(read(&["a", "b", "--name"]).is_err());
    }
}
