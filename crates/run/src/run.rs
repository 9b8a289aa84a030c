//! A run: all stages, one after another, into one folder.

use std::ffi::OsString;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::remove_in_order;
use crumple_stage::{
    ExitStatus, Usage, by_way, chain, hint_for_a_run, memory_limit_flag, refuse_not_to_be_allowed, say,
};

use crate::command::{Options, Pipeline, Stage, chain_of, dependents, stages_of};
use crate::fail_on::after_limits;
use crate::folder::content::{
    PipelineOfRun, folder_of_new_results, pipeline_before, refuse_files_of_others, refuse_links, state_of, sweep,
    written,
};
use crate::folder::lock::{LockedFolder, is_at};
use crate::messages::{
    say_what_changed, say_what_failed, say_what_is_replaced, say_which_stage_failed, suggest_stage_of_flag,
};
use crate::names::{PIPELINE_OF_A_RUN, place_of_record};
use crate::open_page::open_page;
use crate::program::{is_one_program, own_command, own_program};
use crate::steps::{StageExit, arguments, contradicts, install_outputs, run_program, say_who_wrote, start};
use crate::together::joint_run::{INTEGRATED, SOLVED};
use crate::words::Words;

/// The page of a run, in its folder.
const PAGE: &str = "report.html";

/// Runs all stages, or what the options ask for in place of a run, and opens the report where they ask for that.
pub fn run(mut options: Options) -> anyhow::Result<ExitStatus> {
    if let Some(limit) = memory_limit_flag() {
        options.flags.0.push(limit);
    }
    options.take_own()?;
    if options.again.is_none() {
        options.set.extend(options.display.as_set());
    }
    refuse_no_record(&options)?;
    if options.asks_for_information() {
        return information(&options);
    }
    let status = match options.again.as_ref().filter(|made| is_joint(made)) {
        Some(made) => predict_joint(made, &options)?,
        None => run_stages(&options)?,
    };
    if options.open && [ExitStatus::Done, ExitStatus::NoAcceptableResult].contains(&status) {
        let folder = match &options.again {
            Some(made) => made.clone(),
            None => pipeline_and_folder(&options)?.1,
        };
        open_page(&folder.join(PAGE));
    }
    Ok(status)
}

/// Runs all stages. Exit code 4 of a stage (no acceptable result, diagnosis written) does not stop the run: the report
/// shows the diagnosis, and the last stage decides. Any other failure does.
fn run_stages(options: &Options) -> anyhow::Result<ExitStatus> {
    let (pipeline, path) = pipeline_and_folder(options)?;
    let composed = pipeline.read(&options.project, &options.set);
    let mut composed = composed.inspect_err(|_| note_usage_error(options, &path))?;
    composed.allowed().try_for_each(|code| refuse_not_to_be_allowed(&code))?;
    let (stages, left_out) = stages_of(options, &composed, &options.programs.commands()?)?;
    let outputs = || chain().flat_map(|stage| stage.outputs);
    note_run(&mut composed, options, &pipeline, &stages);
    let folder = locked(options, path)?;
    let path = folder.path();
    refuse_links(folder.path(), outputs().chain([PIPELINE_OF_A_RUN]))?;
    let before = pipeline_before(folder.path())?;
    if options.again.is_none() {
        refuse_files_of_others(folder.path(), outputs())?;
    }
    if folder.is_locked() {
        sweep(folder.path(), outputs().chain([PIPELINE_OF_A_RUN]))
            .with_context(|| format!("cannot remove what an earlier run left in {}", folder.path().display()))?;
    }
    let given = PipelineOfRun::write(folder.path(), &composed, before.as_ref())?;
    let run = Run { options, stages: &stages, composed: &composed, pipeline: given.path(), folder: &folder };
    if !given.is_unchanged()
        && (composed.is_set() || !pipeline.is_of(&options.project))
        && let Some(status) = run.check_options()?
    {
        return run.failed(status, before.as_ref());
    }
    if let Some(before) = before.as_ref().filter(|_| !options.is_quiet()) {
        say_what_changed(&composed, before);
    }
    let end_before = before.as_ref().and_then(crumple_stage::Pipeline::end).filter(|_| given.is_unchanged());
    remove_left_out(folder.path(), &left_out, &stages)?;

    let before_it = before.as_ref();
    let has_failed =
        |(_, code): (&str, u8)| ![ExitStatus::Done, ExitStatus::NoAcceptableResult].map(|s| s as u8).contains(&code);
    if options.again.is_some() && before_it.and_then(crumple_stage::Pipeline::end).is_some_and(has_failed) {
        say(format_args!("note: the last run into {} failed: these are results of the one before", path.display()));
    }
    let mut status = ExitStatus::Done;
    for (number, stage) in stages.iter().enumerate() {
        let before = File::open(run.folder.path().join(stage.output())).ok().filter(|_| number == 0);
        let looks_back = number == 0 && end_before.is_some();
        let (ending, state) = run.stage_and_state(number, stage, looks_back);
        let output = run.folder.path().join(stage.output());
        let is_kept = before.as_ref().is_some_and(|before| is_at(before, &output));
        match ending? {
            // The stage that is asked again has the answer; the report only shows it.
            StageExit::WithResult(_) if options.again.is_some() && status == ExitStatus::NoAcceptableResult => {}
            StageExit::WithResult(so_far) => status = so_far,
            StageExit::Failed(failure) => {
                if !stage.program.is_own {
                    say_which_stage_failed(stage.name, &stage.program, failure);
                } else if failure == ExitStatus::Refused {
                    say_who_wrote(&stage.inputs, &stages);
                }
                run.suggest_stage_of_flag(number, failure);
                return run.failed(failure, before_it);
            }
            StageExit::Contradicts => return run.failed(ExitStatus::Refused, before_it),
            StageExit::Unforeseen(failure) => {
                say_what_failed((stage.name, &stage.outputs), &stage.program, failure, Some(run.folder.path()));
                return run.failed(ExitStatus::Failure, before_it);
            }
        }
        // What the first stage left alone, all others made their results from.
        if is_kept
            && let Some((at_the_end, code)) = end_before
            && state.as_deref() == Some(at_the_end)
        {
            if !options.is_quiet() {
                say(format_args!("{:<16} up to date: {}", "run", run.folder.path().display()));
                run.answer_again()?;
            }
            let is_without = code == ExitStatus::NoAcceptableResult as u8;
            let status = if is_without { ExitStatus::NoAcceptableResult } else { status };
            return after_limits(run.folder.path(), &options.fail_on, status);
        }
        if let Some(before) = before.filter(|_| !is_kept) {
            say_what_is_replaced(before, &output, run.folder.path());
        }
    }
    if let Some(state) = run.state() {
        composed.note_end(&state, status as u8);
    }
    given.keep(folder.path(), &composed)?;
    after_limits(folder.path(), &options.fail_on, status)
}

/// Errors: no record stands in front of the flags.
fn refuse_no_record(options: &Options) -> Result<(), Usage> {
    if options.again.is_none() && options.record.first().is_none_or(|r| r.as_encoded_bytes().starts_with(b"-")) {
        let form = by_way("just run RECORD [flags of crumple-ingest]", "crumple run RECORD [flags of crumple ingest]");
        return Err(Usage::new(format!("the record comes first: {form}")));
    }
    Ok(())
}

/// Notes in the folder of a run that its next one had no pipeline to run: the results are those of the one before.
fn note_usage_error(options: &Options, path: &Path) {
    let has_run = matches!(pipeline_before(path), Ok(Some(_)));
    let Some(_lock) = has_run.then(|| LockedFolder::lock(path, true).ok()).flatten() else { return };
    let Ok(Some(mut noted)) = pipeline_before(path) else { return };
    if options.again.is_none() {
        noted.note_end(crumple_stage::Pipeline::FAILED, ExitStatus::Usage as u8);
        // Where it cannot be written, the error of the pipeline says enough.
        _ = written(path, &noted).map(|file| file.persist(path.join(PIPELINE_OF_A_RUN)));
    }
}

/// The pipeline and the folder of the run.
fn pipeline_and_folder(options: &Options) -> anyhow::Result<(Pipeline, PathBuf)> {
    if let Some(made) = &options.again {
        return Ok((Pipeline::of_run(made, &options.pipeline, &options.project), folder_of_a_run(made)?));
    }
    let pipeline = Pipeline::resolve(&options.pipeline, &options.project);
    let path = options.folder(&pipeline)?;
    Ok((pipeline, path))
}

/// The folder of the run, locked. While this run waited, another one may have put another record there: then it is the
/// next one.
fn locked(options: &Options, mut path: PathBuf) -> anyhow::Result<LockedFolder> {
    loop {
        let folder = LockedFolder::lock(&path, options.is_quiet())?;
        match pipeline_and_folder(options)?.1 {
            now if now == path => return Ok(folder),
            now => path = now,
        }
    }
}

/// Notes what a run is of. One that is made again keeps what it was run with.
fn note_run(composed: &mut crumple_stage::Pipeline, options: &Options, pipeline: &Pipeline, stages: &[Stage]) {
    if options.again.is_none() || composed.name().is_none() {
        composed.note_run(&pipeline.name);
    }
    if let Some(record) = options.record.first().filter(|_| options.again.is_none()) {
        note_typed(composed, options, stages);
        composed.note_record(&place_of_record(&options.project, Path::new(record)));
    }
}

/// Notes flags typed for single stages, and programs from elsewhere: what a run depends on beside its pipeline.
fn note_typed(composed: &mut crumple_stage::Pipeline, options: &Options, stages: &[Stage]) {
    let changes_nothing = |word: &String| matches!(word.as_str(), "-q" | "--quiet" | "--force" | "--json");
    let mut note_flags = |stage: &str, words: &mut dyn Iterator<Item = String>| {
        let typed = Words(words.filter(|word| !changes_nothing(word)).collect());
        if !typed.is_empty() {
            composed.note_typed("flags", stage, &typed.to_string());
        }
    };
    let mut behind = Some(options.flags_of_the_first());
    for Stage { name, program, .. } in stages {
        let own = program.is_own.then_some(&program.flags).into_iter().flatten().cloned();
        let behind = behind.take().unwrap_or_default().iter().map(|word| word.to_string_lossy().into_owned());
        note_flags(name, &mut own.chain(behind));
    }
    note_flags("every stage", &mut options.flags.iter().cloned());
    for Stage { name, program, .. } in stages.iter().filter(|stage| !stage.program.is_own) {
        composed.note_typed("program", name, &program.typed);
        composed.note_files(name, program.files());
    }
}

/// The folder of a run that was made.
fn folder_of_a_run(made: &Path) -> Result<PathBuf, Usage> {
    let has_results = made.join("1-ingest.mcap").is_file() || made.join("summary.json").is_file();
    if has_results {
        return Ok(made.to_owned());
    }
    let problem = format!("{} is no folder of a run", made.display());
    Err(Usage::new(problem).hint(hint_for_a_run(made)))
}

/// Whether the folder is that of several tests with one model, which has no motion of its own.
fn is_joint(made: &Path) -> bool {
    let has = |file: &str| made.join(file).is_file();
    has(PIPELINE_OF_A_RUN) && has(SOLVED) && !has(INTEGRATED)
}

/// Predicts again with the joint result of a folder.
fn predict_joint(made: &Path, options: &Options) -> anyhow::Result<ExitStatus> {
    let mut arguments: Vec<OsString> = vec!["--again".into(), made.into(), "--project".into()];
    arguments.push(options.project.clone().into());
    arguments.extend(["--pipeline".into(), OsString::from(&options.pipeline)]);
    arguments.extend(options.display.words().into_iter().map(OsString::from));
    arguments.extend(options.programs.arguments());
    arguments.extend(["--flags".into(), options.flags.to_string().into(), "--".into()]);
    arguments.extend_from_slice(&options.record);
    let together = own_program("together");
    Ok(run_program(own_command("together").args(&arguments))?.status_of(&together))
}

/// Removes what stages that are left out wrote once, the reports made from it first.
fn remove_left_out(folder: &Path, left_out: &[&str], stages: &[Stage]) -> anyhow::Result<()> {
    let stale: Vec<PathBuf> = left_out.iter().map(|name| folder.join(name)).filter(|path| path.exists()).collect();
    if stale.is_empty() {
        return Ok(());
    }
    let reports = stages.iter().filter(|stage| !stage.writes_an_artifact()).flat_map(|stage| &stage.outputs);
    let files: Vec<PathBuf> = reports.map(|name| folder.join(name)).chain(stale).collect();
    remove_in_order(&files).with_context(|| format!("cannot remove stale results in {}", folder.display()))
}

/// What the first stage prints about itself or the record, in place of a run.
fn information(options: &Options) -> anyhow::Result<ExitStatus> {
    let Some(first) = chain_of(options).next() else { return Ok(ExitStatus::Done) };
    let program = options.programs.commands()?.program(first.name, &Words::default())?;
    Ok(match start(&program, &options.record, &[])? {
        StageExit::WithResult(status) => status,
        StageExit::Failed(failure) => {
            if !program.is_own {
                say_which_stage_failed(first.name, &program, failure);
            }
            failure
        }
        StageExit::Contradicts => ExitStatus::Refused,
        StageExit::Unforeseen(failure) => {
            say_what_failed((first.name, &first.outputs), &program, failure, None);
            ExitStatus::Failure
        }
    })
}

/// A run on its way.
struct Run<'a> {
    options: &'a Options,
    stages: &'a [Stage],
    composed: &'a crumple_stage::Pipeline,
    pipeline: &'a Path,
    folder: &'a LockedFolder,
}

impl Run<'_> {
    /// The state of the folder after a whole run, where every stage is a program of the project and leaves alone what
    /// is up to date. Others are always run.
    fn state(&self) -> Option<String> {
        let is_asked = |words: &[String]| words.iter().any(|word| matches!(word.as_str(), "--force" | "--json"));
        let always = is_asked(&self.options.flags) || self.stages.iter().any(|stage| is_asked(&stage.program.flags));
        if always || self.options.again.is_some() || !self.stages.iter().all(|stage| stage.program.is_own) {
            return None;
        }
        let programs: Vec<PathBuf> = self.stages.iter().map(|stage| own_program(stage.name)).collect();
        let outputs = self.stages.iter().flat_map(|stage| stage.outputs.iter().copied());
        state_of(self.folder.path(), outputs, &programs).ok()
    }

    /// Runs a stage, and meanwhile finds the state that the folder had before it, where that is asked for.
    fn stage_and_state(
        &self,
        number: usize,
        stage: &Stage,
        looks_back: bool,
    ) -> (anyhow::Result<StageExit>, Option<String>) {
        std::thread::scope(|scope| {
            let state = looks_back.then(|| scope.spawn(|| self.state()));
            let ending = self.stage(number, stage);
            (ending, state.and_then(|reading| reading.join().ok().flatten()))
        })
    }

    /// Has the programs of the project check their options before anything runs. `Some`: how the first that refuses
    /// them ended; it has said why.
    fn check_options(&self) -> anyhow::Result<Option<ExitStatus>> {
        for (number, stage) in self.stages.iter().enumerate().filter(|(_, stage)| stage.program.is_own) {
            let mut arguments = self.arguments(stage, &self.folder.path().join(stage.output()));
            arguments.push("--check-options".into());
            if let StageExit::Failed(failure) = start(&stage.program, &arguments, &self.options.flags)? {
                self.suggest_stage_of_flag(number, failure);
                return Ok(Some(failure));
            }
        }
        Ok(None)
    }

    /// Where the first stage does not know its flags: whose they may be.
    fn suggest_stage_of_flag(&self, number: usize, failure: ExitStatus) {
        if number == 0 && failure == ExitStatus::Usage {
            suggest_stage_of_flag(self.options.flags_of_the_first(), self.composed);
        }
    }

    /// Runs one stage. Where it ends with a result, this stands in the run folder.
    fn stage(&self, number: usize, stage: &Stage) -> anyhow::Result<StageExit> {
        let folder = self.folder.path();
        let dependents: Vec<PathBuf> = dependents(self.stages, number).map(|name| folder.join(name)).collect();
        if stage.program.is_own {
            let output = folder.join(stage.output());
            let mut arguments = self.arguments(stage, &output);
            for dependent in dependents {
                arguments.extend(["--dependent".into(), dependent.into()]);
            }
            // The report sums the run up, so that it is said once. What a stage is asked again for, it says itself.
            if self.options.again.is_none() && stage.writes_an_artifact() {
                arguments.push("--no-summary".into());
            }
            // Asked again, it answers, also where the answer is there.
            if self.options.again.is_some() && number == 0 && !self.is_forced() {
                arguments.push("--force".into());
            }
            if is_one_program() && !stage.writes_an_artifact() {
                arguments.push("--answer".into());
            }
            return Ok(start(&stage.program, &arguments, &self.options.flags)?.checked(folder, &stage.outputs));
        }
        let new = folder_of_new_results(folder);
        let written: Vec<PathBuf> = stage.outputs.iter().map(|name| new.join(name)).collect();
        // A killed run may have left files in it that the sweep does not know. Those stay.
        let is_fresh = !new.is_dir();
        if is_fresh {
            fs::create_dir(&new).with_context(|| format!("cannot make {}", new.display()))?;
        } else if let Some(old) = written.iter().find(|path| path.exists()) {
            // Only without a lock: with one it was swept. It must not pass for what the stage writes now.
            let problem = format!("{} is that of another run", old.display());
            return Err(Usage::new(problem).hint("remove it once no other run works in this folder").into());
        }
        let output = new.join(stage.output());
        let ending = start(&stage.program, &self.arguments(stage, &output), &self.options.flags)?;
        let mut ending = ending.checked(&new, &stage.outputs);
        let is_new = matches!(ending, StageExit::WithResult(_)) && stage.writes_an_artifact();
        if is_new && contradicts(stage, &new, folder, self.composed) {
            ending = StageExit::Contradicts;
        }
        if matches!(ending, StageExit::WithResult(_)) {
            install_outputs(&new, folder, &stage.outputs, &dependents)
                .with_context(|| format!("the result of {} cannot be moved to {}", stage.name, folder.display()))?;
        }
        let removed = if is_fresh { fs::remove_dir_all(&new) } else { remove_in_order(&written) };
        removed.with_context(|| format!("cannot remove {}", new.display()))?;
        Ok(ending)
    }

    /// Has the report say on standard output what it said when it was written.
    fn answer_again(&self) -> anyhow::Result<()> {
        if let Some(report) = self.stages.last().filter(|_| is_one_program()) {
            let mut arguments = self.arguments(report, &self.folder.path().join(report.output()));
            arguments.push("--answer-again".into());
            start(&report.program, &arguments, &self.options.flags)?;
        }
        Ok(())
    }

    /// Whether a flag makes stages compute what is up to date.
    fn is_forced(&self) -> bool {
        self.options.flags.iter().any(|word| word == "--force") || self.options.record.iter().any(|w| w == "--force")
    }

    fn arguments(&self, stage: &Stage, output: &Path) -> Vec<OsString> {
        arguments(stage, self.folder, &self.options.record, self.pipeline.as_os_str(), output.into())
    }

    /// The exit status of a run that failed; a report from before is named as that, here and by who predicts with it.
    fn failed(&self, status: ExitStatus, before: Option<&crumple_stage::Pipeline>) -> anyhow::Result<ExitStatus> {
        let has_artifact = self.stages.iter().any(|stage| self.folder.path().join(stage.output()).is_file());
        let noted = before.or_else(|| has_artifact.then_some(self.composed));
        if let Some(mut noted) = noted.filter(|_| self.options.again.is_none()).cloned() {
            noted.note_end(crumple_stage::Pipeline::FAILED, status as u8);
            written(self.folder.path(), &noted)?.persist(self.folder.path().join(PIPELINE_OF_A_RUN))?;
        }
        let report = self.stages.last().map(|stage| self.folder.path().join(stage.output()));
        if report.is_some_and(|report| report.exists()) {
            say(format_args!("note: the report in {} is that of an earlier run", self.folder.path().display()));
        }
        Ok(status)
    }
}
