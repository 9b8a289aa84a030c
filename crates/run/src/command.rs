//! The command line: options, the stages of a run, the pipeline file.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf, is_separator};

use anyhow::Context;
use clap::{Arg, ArgMatches, CommandFactory, FromArgMatches};
use crumple_stage::{Call, ChainStage, DisplayFlag, Usage, by_way, chain, is_shared_flag};

use crate::fail_on::FailOn;
use crate::names::{PIPELINE_OF_A_RUN, folder_of_record};
use crate::program::{Commands, NamedPrograms, Program};
use crate::words::{Words, request_for_information};

// The command line of `crumple-run`.

/// Runs the stages of a pipeline on a record, one after another, into one run folder.
///
/// Options of other stages than the first are --set STAGE.OPTION=VALUE. Results stand in runs/RECORD/PIPELINE.
///
/// Which stage reads and writes what stands in `pipelines/chain`. --stage filter=COMMAND, or CRUMPLE_FILTER in the
/// environment, is the command of the stage filter where it is not the program of the project, and so on; it is started
/// as `COMMAND INPUT... --pipeline FILE -o OUTPUT`. A stage whose result is up to date leaves it alone; all that was
/// made from an old result is removed before a new one appears.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-run",
    version,
    after_help = "A second run into the same folder waits for the first.\n\
                  Exit codes: 0 done, 1 a stage failed unforeseen, 2 usage, 3 record refused, 4 no acceptable result \
                  (the report shows the diagnosis)."
)]
pub struct Options {
    /// Folder with `runs/`, and with `pipelines/` where they are not those that are built in.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub(crate) project: PathBuf,

    /// Pipeline: a file below `pipelines/` without its ending, or the path of a file elsewhere.
    #[arg(long, value_name = "NAME|FILE", default_value = "default", allow_hyphen_values = true)]
    pub(crate) pipeline: String,

    /// Run folder [default: runs/NAME-OF-RECORD/NAME-OF-PIPELINE in the project].
    #[arg(short, long, value_name = "FOLDER", allow_hyphen_values = true)]
    pub(crate) out: Option<OsString>,

    /// Predict again in an existing run folder; flags of predict follow `--`.
    #[arg(long, value_name = "FOLDER", allow_hyphen_values = true, conflicts_with = "out")]
    pub(crate) again: Option<PathBuf>,

    /// Flags for every stage, as one would type them.
    #[arg(long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    pub(crate) flags: Words,

    /// Flags for the last stage alone.
    #[arg(long, value_name = "TEXT", default_value = "", allow_hyphen_values = true)]
    pub(crate) flags_of_last: Words,

    /// One option of a stage, over the pipeline: `filter.cfc=180`, `identify.methods=era,arx`. Several; it may stand
    /// behind the record too.
    #[arg(long, value_name = "STAGE.OPTION=VALUE", conflicts_with = "again")]
    pub(crate) set: Vec<String>,

    /// Ends with exit code 4 where the run remarks such a code (`CR203`), its record is `check` or `wrong`, or its
    /// status is `usable-with-care` or `do-not-use`; the graver word fails with the lighter one. For CI.
    #[arg(long, value_name = "CODE|WORD,...", value_delimiter = ',')]
    pub(crate) fail_on: Vec<FailOn>,

    /// Open the report when the run is over.
    #[arg(long)]
    pub(crate) open: bool,

    #[command(flatten)]
    pub(crate) display: DisplayFlag,

    #[command(flatten)]
    pub(crate) programs: NamedPrograms,

    #[command(flatten)]
    pub(crate) of_all: OfAllStages,

    /// The record, and flags of the stage that reads it: `crash.csv --mass 873kg --impact-speed 35km/h`.
    #[arg(required_unless_present = "again", value_name = "RECORD")]
    pub(crate) record: Vec<OsString>,
}

/// The same command line with the flags that a run hands to the stage that reads the record: for help, man page and
/// completion. [`sorted`] puts them behind `--`, so that none of them is read as one of the run.
#[derive(Debug)]
pub(crate) struct WithFlagsOfRecord<O>(pub(crate) O);

impl<O: CommandFactory> CommandFactory for WithFlagsOfRecord<O> {
    fn command() -> clap::Command {
        let own = O::command();
        let ingest = (crumple_ingest::PROGRAM.command)();
        let is_own = |arg: &Arg| own.get_arguments().any(|known| known.get_id() == arg.get_id());
        let is_handed_on = |long: &str| !is_shared_flag(&format!("--{long}"));
        let handed_on = ingest.get_arguments().filter(|arg| arg.get_long().is_some_and(is_handed_on) && !is_own(arg));
        let handed_on = handed_on.cloned().map(|arg| arg.help_heading("Flags of the record (handed to ingest)"));
        let handed_on: Vec<Arg> = handed_on.collect();
        own.args(handed_on)
    }

    fn command_for_update() -> clap::Command {
        Self::command()
    }
}

impl<O: FromArgMatches> FromArgMatches for WithFlagsOfRecord<O> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        O::from_arg_matches(matches).map(Self)
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        self.0.update_from_arg_matches(matches)
    }
}

/// Flags that every stage has and that stand without `--flags` too.
#[derive(Debug, clap::Args)]
pub(crate) struct OfAllStages {
    /// Compute even what is up to date.
    #[arg(long)]
    force: bool,

    /// No summary and no progress.
    #[arg(short, long)]
    quiet: bool,
}

impl OfAllStages {
    /// Hands them on.
    pub(crate) fn add_to(&self, flags: &mut Words) {
        let own = [("--force", self.force), ("-q", self.quiet)];
        flags.0.extend(own.iter().filter(|(_, is_given)| *is_given).map(|(flag, _)| (*flag).to_owned()));
    }
}

/// How a person has a run write into another folder.
pub(crate) fn elsewhere() -> &'static str {
    by_way("just out=DIR run RECORD", "crumple run RECORD --out DIR")
}

/// A call with its own flags first, then `--`, what is no flag, and the flags of stages; one that has `--` is that
/// already. `stage` is what its flags are told by; without it the word behind a flag belongs to it.
pub(crate) fn sorted<C: CommandFactory>(call: &Call, stage: Option<&clap::Command>) -> Call {
    const OF_ALL: [(&str, bool); 6] = [
        ("-h", false),
        ("--help", false),
        ("-V", false),
        ("--version", false),
        ("--generate", true),
        ("--memory-limit", true),
    ];
    let takes_value = |command: &clap::Command, flag: &str| {
        let is_meant = |arg: &&Arg| match flag.strip_prefix("--") {
            Some(long) => arg.get_long() == Some(long),
            None => arg.get_short().is_some_and(|short| flag.strip_prefix('-') == Some(short.encode_utf8(&mut [0; 4]))),
        };
        let arg = command.get_arguments().find(is_meant)?;
        Some(arg.get_action().takes_values() && !arg.is_require_equals_set())
    };
    let own = C::command();
    let (mut first, mut named, mut behind) = (Vec::new(), Vec::new(), Vec::new());
    let mut words = call.words.iter().cloned().peekable();
    while let Some(word) = words.next() {
        let text = word.to_string_lossy().into_owned();
        if text == "--" {
            return call.clone();
        }
        if !text.starts_with('-') {
            named.push(word);
            continue;
        }
        let flag = text.split('=').next().unwrap_or_default();
        let of_own =
            takes_value(&own, flag).or_else(|| OF_ALL.iter().find(|(name, _)| *name == flag).map(|(_, takes)| *takes));
        let takes = of_own.or_else(|| stage.and_then(|stage| takes_value(stage, flag)).or(stage.map(|_| false)));
        let into = if of_own.is_some() { &mut first } else { &mut behind };
        into.push(word);
        if takes.unwrap_or(true) && !text.contains('=') {
            into.extend(words.next_if(|next| of_own.is_some() || !next.as_encoded_bytes().starts_with(b"-")));
        }
    }
    if !named.is_empty() || !behind.is_empty() {
        first.push("--".into());
    }
    Call { words: [first, named, behind].concat(), ..call.clone() }
}

/// What no flag is among the words of a call, the record or the run folder first.
pub(crate) fn named<C: CommandFactory>(call: &Call, stage: Option<&clap::Command>) -> Option<OsString> {
    sorted::<C>(call, stage).words.into_iter().skip_while(|word| word != "--").nth(1)
}

/// Flags that a run takes from among those of the first stage, and what stands behind each.
pub(crate) const OWN_BEHIND_RECORD: [(&str, &str); 2] = [("--set", "STAGE.OPTION=VALUE"), ("--stage", "STAGE=COMMAND")];

impl Options {
    /// Takes the options set, the programs named and `--open` behind `--` from among the flags of the first stage, and
    /// hands its own flags on.
    pub(crate) fn take_own(&mut self) -> Result<(), Usage> {
        self.of_all.add_to(&mut self.flags);
        let own = OWN_BEHIND_RECORD.into_iter().zip([&mut self.set, &mut self.programs.stage]);
        let mut own = own.skip(usize::from(self.again.is_some())).collect::<Vec<_>>();
        let mut words = std::mem::take(&mut self.record).into_iter();
        while let Some(word) = words.next() {
            let text = word.to_str().unwrap_or_default();
            let (flag, value) = text.split_once('=').map_or((text, None), |(flag, value)| (flag, Some(value)));
            match own.iter_mut().find(|((name, _), _)| *name == flag) {
                Some(((name, form), taken)) => {
                    let typed = value.map(str::to_owned).or_else(|| words.next()?.into_string().ok());
                    taken.push(typed.ok_or_else(|| Usage::new(format!("{name} needs {form} behind it")))?);
                }
                None if text == "--open" => self.open = true,
                None => self.record.push(word),
            }
        }
        Ok(())
    }

    /// Whether a flag for every stage keeps it quiet.
    pub(crate) fn is_quiet(&self) -> bool {
        self.flags.is_quiet()
    }

    /// The run folder: what `--out` says, else one below `runs/` by the names of record and pipeline.
    pub(crate) fn folder(&self, pipeline: &Pipeline) -> anyhow::Result<PathBuf> {
        let out = self.out.as_deref().filter(|out| !out.is_empty()).map(Path::new);
        if let Some(out) = out {
            // Stages must not take it for a flag.
            let looks_like_a_flag = out.as_os_str().as_encoded_bytes().starts_with(b"-");
            return Ok(if looks_like_a_flag { Path::new(".").join(out) } else { out.to_owned() });
        }
        let folder = self.record.first().and_then(|record| folder_of_record(&self.project, Path::new(record)));
        let folder = folder.with_context(|| {
            Usage::new("the record has no file name").hint(format!("say where to: {}", elsewhere()))
        })?;
        Ok(folder.join(&pipeline.name))
    }

    /// The flags of the first stage: all that stands behind the record.
    pub(crate) fn flags_of_the_first(&self) -> &[OsString] {
        if self.again.is_some() { &self.record } else { self.record.get(1..).unwrap_or_default() }
    }

    /// Whether they ask what the first stage prints about itself or the record.
    pub(crate) fn asks_for_information(&self) -> bool {
        request_for_information(self.flags_of_the_first().iter().map(|flag| flag.to_string_lossy())).is_some()
    }
}

// Which pipeline file is meant, and its name.

/// A pipeline file and the name that its run folders have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pipeline {
    /// The file.
    pub file: PathBuf,
    /// `default`, `papers/civic`.
    pub name: String,
}

impl Pipeline {
    /// The path of a file is that file; all else is a name below `pipelines/` of the project.
    pub fn resolve(text: &str, project: &Path) -> Self {
        let below = text.strip_prefix("pipelines/").unwrap_or(text);
        let name = below.strip_suffix(".toml").unwrap_or(below);
        let is_path = text.starts_with('.')
            || Path::new(text).is_absolute()
            || (text.ends_with(".toml") && Path::new(text).is_file());
        if !is_path {
            let file = project.join("pipelines").join(format!("{name}.toml"));
            return Self { file, name: name.to_owned() };
        }
        let last = name.rsplit(is_separator).next().unwrap_or(name);
        Self { file: PathBuf::from(text), name: if below == text { last } else { name }.to_owned() }
    }
}

impl Pipeline {
    /// The file with what it is laid over, the default pipeline of the project, and with options set beside it.
    pub(crate) fn read(&self, project: &Path, set: &[String]) -> anyhow::Result<crumple_stage::Pipeline> {
        let default = Some(project.join("pipelines/default.toml")).filter(|path| path.is_file());
        let mut read = crumple_stage::Pipeline::read(&self.file, default.as_deref())?;
        set.iter().try_for_each(|typed| read.set(typed))?;
        Ok(read)
    }

    /// Whether it lies below `pipelines/` of the project.
    pub(crate) fn is_of(&self, project: &Path) -> bool {
        self.file.starts_with(project.join("pipelines"))
    }

    /// The pipeline of a run that was made: what it was run with, else that of its summary where the project has it,
    /// else what is typed.
    pub(crate) fn of_run(folder: &Path, typed: &str, project: &Path) -> Self {
        let file = folder.join(PIPELINE_OF_A_RUN);
        if let Some(name) = crumple_stage::Pipeline::read(&file, None).ok().as_ref().and_then(|made| made.name()) {
            return Self { name: name.to_owned(), file };
        }
        let summary = fs::read_to_string(folder.join("summary.json")).ok();
        let summary: Option<serde_json::Value> = summary.and_then(|text| serde_json::from_str(&text).ok());
        let name = summary.as_ref().and_then(|summary| summary["pipeline"].as_str());
        let made = name.map(|name| Self::resolve(name, project)).filter(|made| made.file.is_file());
        made.unwrap_or_else(|| Self::resolve(typed, project))
    }
}

// The stages of a run.

/// Stands for the record and the flags after it among the inputs of a stage.
pub(crate) const RECORD: &str = "RECORD";

/// The stage from which on a run is made again.
const FIRST_AGAIN: &str = "predict";

/// One stage of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stage {
    /// Its name in the chain.
    pub(crate) name: &'static str,
    /// Its program.
    pub(crate) program: Program,
    /// Names in the run folder, or [`RECORD`].
    pub(crate) inputs: Vec<&'static str>,
    /// Names in the run folder; the program is told the first.
    pub(crate) outputs: Vec<&'static str>,
}

impl Stage {
    /// Its output.
    pub(crate) fn output(&self) -> &'static str {
        self.outputs.first().copied().unwrap_or_default()
    }

    /// Whether it writes an artifact, not a report.
    pub(crate) fn writes_an_artifact(&self) -> bool {
        self.output().ends_with(".mcap")
    }
}

/// The lines of the chain from the first stage of the run on.
pub(crate) fn chain_of(options: &Options) -> impl Iterator<Item = ChainStage> {
    let again = options.again.is_some();
    chain().skip_while(move |stage| again && stage.name != FIRST_AGAIN)
}

/// The stages of the run, without what the others would have written among their inputs; and the outputs of the others.
/// Errors: a program that does not exist, or would only print.
pub(crate) fn stages_of(
    options: &Options,
    pipeline: &crumple_stage::Pipeline,
    commands: &Commands,
) -> anyhow::Result<(Vec<Stage>, Vec<&'static str>)> {
    let again = options.again.is_some();
    let in_use = |stage: &ChainStage| again || !stage.is_optional || pipeline.table(stage.name).is_some();
    let (used, others): (Vec<ChainStage>, Vec<ChainStage>) = chain_of(options).partition(in_use);
    let left_out: Vec<&str> = others.into_iter().flat_map(|stage| stage.outputs).collect();
    let with_program = |stage: ChainStage| -> anyhow::Result<Stage> {
        let program = commands.program(stage.name, &options.flags)?;
        let mut inputs: Vec<&str> = stage.inputs.into_iter().filter(|input| !left_out.contains(input)).collect();
        if again && stage.name == FIRST_AGAIN {
            inputs.push(RECORD);
        }
        Ok(Stage { name: stage.name, program, inputs, outputs: stage.outputs })
    };
    let mut stages = used.into_iter().map(with_program).collect::<anyhow::Result<Vec<Stage>>>()?;
    if let Some(last) = stages.last_mut() {
        last.program.flags.extend_from_slice(&options.flags_of_last);
    }
    if again {
        // Predictions are printed, and the report is written, in the units that are asked for now.
        stages.iter_mut().for_each(|stage| stage.program.flags.extend(options.display.words()));
    }
    Ok((stages, left_out))
}

/// Names of what is made from the output of a stage, directly or not, in the order in which it is to be removed: the
/// report first, which says the most, then the artifacts from the last one on.
pub(crate) fn dependents(stages: &[Stage], number: usize) -> impl Iterator<Item = &'static str> {
    stages.iter().skip(number + 1).rev().flat_map(|later| later.outputs.iter().copied())
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn names_lie_below_the_project_and_paths_anywhere() {
        let resolved = |text: &str| {
            let pipeline = Pipeline::resolve(text, Path::new("/project"));
            (pipeline.file.to_str().unwrap().to_owned(), pipeline.name)
        };
        let pair = |file: &str, name: &str| (file.to_owned(), name.to_owned());
        assert_eq!(resolved("default"), pair("/project/pipelines/default.toml", "default"));
        assert_eq!(resolved("papers/civic"), pair("/project/pipelines/papers/civic.toml", "papers/civic"));
        assert_eq!(
            resolved("pipelines/papers/civic.toml"),
            pair("/project/pipelines/papers/civic.toml", "papers/civic")
        );
        assert_eq!(resolved("none.toml"), pair("/project/pipelines/none.toml", "none"));
        assert_eq!(resolved("./my own.toml"), pair("./my own.toml", "my own"));
        assert_eq!(resolved("/else/where/p.toml"), pair("/else/where/p.toml", "p"));
    }

    #[test]
    fn the_pipeline_of_a_run_is_in_its_folder_or_named_by_its_summary() {
        let project = tempfile::tempdir().unwrap();
        let folder = project.path().join("pipelines");
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("a.toml"), "[predict]\n").unwrap();
        fs::write(folder.join("b.toml"), "base = 'none'\n[ingest]\n").unwrap();
        let has = |name: &str, set: &[String]| {
            let read = Pipeline::resolve(name, project.path()).read(project.path(), set);
            read.map(|pipeline| pipeline.table("predict").is_some()).ok()
        };
        assert_eq!([has("a", &[]), has("b", &[]), has("missing", &[])], [Some(true), Some(false), None]);
        assert_eq!(has("a", &["predict=false".to_owned()]), Some(false));
        let of_run = || Pipeline::of_run(project.path(), "a", project.path()).name;
        assert_eq!(of_run(), "a");
        fs::write(project.path().join("summary.json"), "{\"pipeline\": \"b\"}").unwrap();
        assert_eq!(of_run(), "b");
        fs::write(project.path().join("summary.json"), "{\"pipeline\": \"elsewhere\"}").unwrap();
        assert_eq!(of_run(), "a");
        fs::write(project.path().join(PIPELINE_OF_A_RUN), "[run]\nname = 'mine'\n").unwrap();
        assert_eq!(of_run(), "mine");
    }

    #[test]
    fn flags_of_a_run_stand_before_the_record_and_those_of_ingest_behind_it() {
        let words = |text: &str| {
            let words = text.split(' ').map(OsString::from).collect();
            let call = Call { program: String::new(), words, way: crumple_stage::Way::Within };
            let ingest = (crumple_ingest::PROGRAM.command)();
            let sorted = sorted::<Options>(&call, Some(&ingest)).words;
            sorted.iter().map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
        };
        for (typed, sorted) in [
            ("crash.csv", "-- crash.csv"),
            ("--mass 873kg crash.csv -q --set filter.cfc=60", "-q --set filter.cfc=60 -- crash.csv --mass 873kg"),
            ("crash.csv --allow-missing -o x --mass=9kg", "-o x -- crash.csv --allow-missing --mass=9kg"),
            ("--allow-missing crash.csv --no-such x", "-- crash.csv x --allow-missing --no-such"),
            ("--pipeline p -- crash.csv --force", "--pipeline p -- crash.csv --force"),
            ("-h", "-h"),
        ] {
            assert_eq!(words(typed), sorted);
        }
    }
}
