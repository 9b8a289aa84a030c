//! The life of a process: of a stage from its command line to its exit code, and of other programs.

use std::ffi::OsString;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context;
use clap::builder::PossibleValuesParser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Arg, Command, CommandFactory, FromArgMatches};
use crumple_artifact::records::{DiagnosisV1, NotesV1, RemarkV1, RemarksV1};
use crumple_artifact::{Artifact, InputDigest, OutputKind, Provenance, WriteError};
use crumple_signal::{About, ConcernContext, Kind, Note, Weight};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::artifacts::inputs::{Loaded, open};
use crate::artifacts::output::{Output, refuse_to_overwrite};
use crate::artifacts::remarks::{as_concerns, in_order, is_no_result, no_result, remarks_of};
use crate::command_line::args;
use crate::command_line::args::{Cli, SharedFlags, keep_budget};
use crate::command_line::left_out::{self, LeftOut};
use crate::command_line::pipeline::{canonical_json, hint_default_pipeline, merge};
use crate::error::{ExitStatus, MissingTopic, find_in_chain, render, status_of, tell_caller};
use crate::terminal::{be_quiet, columns, say, to_stdout, wrapped};
use crate::typed;
use crate::typed::Way;

// The outcome of work on several models of which none came to a result.

impl Output {
    /// No acceptable result, in the words of the first warning about a model, and how many more there are; `otherwise`
    /// without any. `remedy`: see [`Output::remedy`].
    pub fn no_result(&mut self, otherwise: &str, remedy: &str) -> Outcome {
        let is_of_a_model = |note: &&Note| {
            let bearing = note.bearing.as_ref().filter(|bearing| bearing.weight > Weight::None);
            matches!(bearing, Some(ConcernContext { about: About::Model(name), .. }) if !name.is_empty())
        };
        let texts: Vec<&str> = self.notes.iter().filter(is_of_a_model).map(|note| note.text.as_str()).collect();
        let reason = match texts[..] {
            [] => otherwise.to_owned(),
            [only] => only.to_owned(),
            [first, ..] => format!("{first}; {} more notes say why", texts.len() - 1),
        };
        self.remedy(remedy);
        Outcome::NoAcceptableResult(reason)
    }
}

// The life of a stage process.

/// How a computation ended that did not fail.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// There is a result.
    Done,
    /// There is none that can be accepted; what was found and the reason are written. Exit code 4.
    NoAcceptableResult(String),
}

/// One step of the pipeline.
pub trait Stage {
    /// Name of the stage: its pipeline table, its name in provenance; the binary is `crumple-<NAME>`.
    const NAME: &'static str;
    /// Digest of the sources of the program: `env!("CRUMPLE_BUILD")`, which its build script states.
    const BUILD: &'static str;
    /// One line for `--help`.
    const ABOUT: &'static str;
    /// Flags and pipeline keys: one struct whose fields are all optional.
    type Options: clap::Args + Serialize + DeserializeOwned + Default + Debug;
    /// Options with every default filled in. Goes into the provenance: only what changes the result belongs here.
    type Settings: Serialize;
    /// What the stage works on.
    type Input;

    /// The kinds of its remarks, by the modules that raise them.
    const REMARKS: &'static [&'static [&'static Kind]] = &[];

    /// Options and values that earlier versions had.
    const LEFT_OUT: &'static [LeftOut] = &[];

    /// Whether every error of [`run`](Self::run) says where in the input its cause stands.
    const NAMES_ITS_INPUTS: bool = false;

    /// Flags that the program takes before it becomes a stage; they stand in its help like all others.
    fn other_flags() -> Vec<Arg> {
        Vec::new()
    }
    /// Fills in the defaults and checks what can be checked without data.
    fn resolve(options: Self::Options) -> anyhow::Result<Self::Settings>;
    /// Reads the inputs.
    fn load(paths: &[PathBuf], settings: &Self::Settings) -> anyhow::Result<Loaded<Self::Input>>;
    /// The digests that [`load`](Self::load) would find, where they are to be had without holding the inputs: enough
    /// where an earlier output is of the same. `None`: [`load`](Self::load) finds them.
    fn digests(_paths: &[PathBuf]) -> Option<Vec<InputDigest>> {
        None
    }
    /// Computes.
    fn run(settings: &Self::Settings, input: &Self::Input, out: &mut Output) -> anyhow::Result<Outcome>;
}

/// How a program was called.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Call {
    /// Its name as a person typed it: `crumple-filter`, `crumple filter`.
    pub program: String,
    /// The words behind the name.
    pub words: Vec<OsString>,
    /// What hints go by.
    pub way: Way,
}

impl Call {
    /// The call of this process.
    pub fn of_process() -> Self {
        let mut words = std::env::args_os();
        let program = words.next().unwrap_or_default();
        let name = Path::new(&program).file_stem().unwrap_or_default().to_string_lossy();
        Self { program: name.into_owned(), words: words.collect(), way: Way::Alone }
    }

    /// Whether a word begins so.
    pub fn has(&self, start: &str) -> bool {
        self.words.iter().any(|word| word.as_encoded_bytes().starts_with(start.as_bytes()))
    }
}

/// A program of the project. Several calls in one process, one after the other, do not know of each other.
#[derive(Debug, Clone, Copy)]
pub struct Program {
    /// `filter` of `crumple-filter`.
    pub name: &'static str,
    /// Its command line.
    pub command: fn() -> Command,
    /// Does what a call asks for.
    pub run: fn(&Call) -> ExitStatus,
    /// The kinds of its remarks, by the modules that raise them.
    pub remarks: &'static [&'static [&'static Kind]],
}

impl Program {
    /// That of a stage.
    pub const fn of_stage<S: Stage>() -> Self {
        Self { name: S::NAME, command: stage_command::<S>, run: run_stage::<S>, remarks: S::REMARKS }
    }

    /// That of any other: `run` is [`run_tool`] with what it does.
    pub const fn of_tool<C: CommandFactory>(name: &'static str, run: fn(&Call) -> ExitStatus) -> Self {
        Self { name, command: C::command, run, remarks: &[] }
    }

    /// The `main` of the program by itself.
    pub fn main(&self) -> ExitCode {
        (self.run)(&Call::of_process()).into()
    }
}

fn stage_command<S: Stage>() -> Command {
    Cli::<S::Options>::command()
        .name(S::NAME)
        .version(env!("CARGO_PKG_VERSION"))
        .about(S::ABOUT)
        .args(S::other_flags())
        .after_help(
            "Values typed by a person carry their unit: 873kg, 35km/h, 0s.\n\
             Exit codes: 0 done, 1 unforeseen failure, 2 usage, 3 input refused, 4 no acceptable result \
             (its diagnosis is written).",
        )
}

/// Runs a stage.
pub fn run_stage<S: Stage>(call: &Call) -> ExitStatus {
    typed::begin(call.way);
    let words = call.words.iter().map(|word| word.to_string_lossy().into_owned());
    if let Err(error) = left_out::refuse(&left_out::typed(words), S::LEFT_OUT, "") {
        return finish(Err(Err(error.into())));
    }
    let parsed = parse::<Cli<S::Options>>(stage_command::<S>(), call);
    finish(parsed.map_err(Ok).and_then(|(cli, matches)| {
        merge(S::NAME, S::LEFT_OUT, cli.common.pipeline.as_deref(), &cli.options, &matches)
            .and_then(|options| execute::<S>(&cli.common, options))
            .map_err(Err)
    }))
}

fn execute<S: Stage>(common: &SharedFlags, options: S::Options) -> anyhow::Result<ExitStatus> {
    be_quiet(common.quiet);
    keep_budget(&common.inputs, ExitStatus::Refused);
    let sums_up = !common.quiet && !common.no_summary;
    let settings =
        S::resolve(options).map_err(|error| hint_default_pipeline(S::NAME, common.pipeline.as_deref(), error))?;
    if common.check_options {
        return Ok(ExitStatus::Done);
    }
    refuse_to_overwrite(&common.output, OutputKind::Artifact, &common.inputs)?;
    let config = canonical_json(&settings)?;
    let provenance_of = |digests: &[InputDigest]| {
        Provenance::new(S::NAME, env!("CARGO_PKG_VERSION"), config.clone(), digests.to_vec())
            .with_build(&format!("{}{TARGET}", S::BUILD))
    };
    let Loaded { input, digests, diagnosed } = match read::<S>(common, &settings, &provenance_of)? {
        Read::New(loaded) => loaded,
        Read::UpToDate(existing) => return tell_again(S::NAME, common, sums_up, &existing),
    };
    let provenance = provenance_of(&digests);

    let mut out = Output::new();
    let mut of_earlier_stages = Vec::new();
    let outcome = match S::run(&settings, &input, &mut out) {
        Ok(outcome) => outcome,
        Err(error) => match find_in_chain::<MissingTopic>(&error).and_then(|missing| diagnosed.reason_for(missing)) {
            // An earlier stage has said why there is nothing to work on: so this one has no acceptable result either.
            Some(reason) => {
                out = Output::new();
                of_earlier_stages.extend(diagnosed.without_result.iter().cloned());
                if let Some(test) = diagnosed.test.as_deref() {
                    out.put("/test", test)?;
                }
                Outcome::NoAcceptableResult(reason)
            }
            None if is_impossible(&error) => {
                out = Output::new();
                Outcome::NoAcceptableResult(format!(
                    "{error:#}; the numbers of the input are too large to compute with"
                ))
            }
            None if S::NAMES_ITS_INPUTS || find_in_chain::<MissingTopic>(&error).is_some() => return Err(error),
            None => return Err(name_the_inputs(error, &common.inputs)),
        },
    };
    let diagnosis = match &outcome {
        Outcome::NoAcceptableResult(reason) => Some((reason.clone(), false)),
        Outcome::Done => out.without.clone().map(|reason| (reason, true)),
    };
    let mut remarks = in_order(S::NAME, &out.notes);
    if let Some((reason, has_result)) = diagnosis {
        if of_earlier_stages.is_empty() {
            remarks.insert(0, no_result(S::NAME, &reason, out.remedy.take()));
        } else {
            remarks.splice(0..0, of_earlier_stages);
        }
        out.put("/diagnosis", &DiagnosisV1 { stage: S::NAME.to_owned(), reason, has_result })?;
    }
    let remedy = remedy_of(&remarks).map(str::to_owned);
    let of_before = as_concerns(&remarks);
    if !of_before.concerns.is_empty() {
        out.put("/concerns", &of_before)?;
    }
    if !out.notes.is_empty() {
        let notes = out.notes.to_texts();
        out.put("/notes", &NotesV1 { stage: S::NAME.to_owned(), notes })?;
    }
    if !remarks.is_empty() {
        out.put("/remarks", &RemarksV1 { remarks: remarks.clone() })?;
    }
    let mut progress = out.progress("writing", out.builder.samples());
    out.builder
        .write_replacing(&common.output, &common.dependents, &provenance, common.compress.into(), &mut |samples| {
            progress.advance(samples);
        })
        .with_context(|| format!("the result of {} is lost", S::NAME))?;
    drop(progress);
    if sums_up {
        for line in &out.summary {
            say(format_args!("{:<16} {line}", S::NAME));
        }
        if let Some(remedy) = out.without.as_ref().and(remedy.as_deref()) {
            say(format_args!("{:<16} hint: {remedy}", S::NAME));
        }
        // Of a remark that stands among the lines of what it is about there is no second.
        remarks.retain(|remark| remark.stage == S::NAME && !out.is_in_summary(remark));
        print_remarks(S::NAME, &remarks, &common.output);
    }
    if common.json {
        print_records(out.builder.records())?;
    }
    Ok(match outcome {
        Outcome::Done => ExitStatus::Done,
        Outcome::NoAcceptableResult(reason) => no_acceptable_result(common, S::NAME, &reason, remedy.as_deref()),
    })
}

/// Stands behind the digest of the sources where the last bits of a result are not those of a machine: in a browser.
const TARGET: &str = if cfg!(target_family = "wasm") { " wasm32" } else { "" };

/// What a stage finds on the disk.
enum Read<I> {
    /// Inputs to work on.
    New(Loaded<I>),
    /// The output of an earlier call, whole and of the same inputs.
    UpToDate(Artifact),
}

/// Reads the inputs and, beside them, the output of an earlier call.
fn read<S: Stage>(
    common: &SharedFlags,
    settings: &S::Settings,
    provenance_of: &dyn Fn(&[InputDigest]) -> Provenance,
) -> anyhow::Result<Read<S::Input>> {
    let (digests, existing) = std::thread::scope(|scope| {
        let open_existing = || open(&common.output).ok();
        let existing = (!common.force && common.output.exists())
            .then(|| std::thread::Builder::new().spawn_scoped(scope, open_existing));
        let digests = existing.as_ref().and_then(|_| S::digests(&common.inputs));
        let digests = digests.ok_or_else(|| S::load(&common.inputs, settings));
        let existing = existing.and_then(|reading| match reading {
            Ok(reading) => reading.join().ok().flatten(),
            // A browser has no threads.
            Err(_) => open_existing(),
        });
        (digests, existing)
    });
    let of_the_same = |digests: &[InputDigest]| {
        let provenance = provenance_of(digests);
        existing.filter(|existing| existing.provenance() == Some(&provenance))
    };
    Ok(match digests {
        Ok(digests) => match of_the_same(&digests) {
            Some(existing) => Read::UpToDate(existing),
            None => Read::New(S::load(&common.inputs, settings)?),
        },
        Err(loaded) => {
            let loaded = loaded?;
            of_the_same(&loaded.digests).map_or(Read::New(loaded), Read::UpToDate)
        }
    })
}

/// Says of an output that is up to date what was said when it was written.
fn tell_again(stage: &str, common: &SharedFlags, sums_up: bool, existing: &Artifact) -> anyhow::Result<ExitStatus> {
    if sums_up {
        say(format_args!("{stage:<16} up to date: {}", common.output.display()));
        print_remarks(stage, &remarks_of(existing).unwrap_or_default(), &common.output);
    }
    if common.json {
        print_records(existing.records().iter().map(|r| (r.topic.as_str(), r.schema.as_str(), r.payload.as_slice())))?;
    }
    Ok(match existing.record::<DiagnosisV1>("/diagnosis").ok().flatten() {
        Some(diagnosis) if !diagnosis.has_result => {
            let remarks = remarks_of(existing).unwrap_or_default();
            no_acceptable_result(common, stage, &diagnosis.reason, remedy_of(&remarks))
        }
        _ => ExitStatus::Done,
    })
}

/// Whether a result is no number of a crash: a stage that read finite numbers computed it of others that are too large.
fn is_impossible(error: &anyhow::Error) -> bool {
    matches!(find_in_chain::<WriteError>(error), Some(WriteError::Impossible { .. }))
}

/// Adds the inputs' names to an error.
fn name_the_inputs(error: anyhow::Error, inputs: &[PathBuf]) -> anyhow::Error {
    let names: Vec<String> = inputs.iter().map(|path| path.display().to_string()).collect();
    error.context(format!("cannot work on {}", names.join(", ")))
}

/// What to do for a result, where there is none.
fn remedy_of(remarks: &[RemarkV1]) -> Option<&str> {
    remarks.iter().filter(|remark| is_no_result(remark)).find_map(|remark| remark.remedy.as_deref())
}

fn no_acceptable_result(common: &SharedFlags, stage: &str, reason: &str, remedy: Option<&str>) -> ExitStatus {
    if common.no_summary {
        // The verdict of the run says it.
        return ExitStatus::NoAcceptableResult;
    }
    say(format_args!("{stage:<16} no acceptable result: {reason}"));
    if let Some(remedy) = remedy {
        say(format_args!("{stage:<16} hint: {remedy}"));
    }
    ExitStatus::NoAcceptableResult
}

/// Warnings in full with their codes, the number of the other remarks.
fn print_remarks(stage: &str, remarks: &[RemarkV1], output: &Path) {
    let said = remarks.iter().filter(|remark| !is_no_result(remark));
    let (warnings, others): (Vec<&RemarkV1>, Vec<&RemarkV1>) = said.partition(|remark| remark.is_warning());
    for warning in warnings {
        say(format_args!("{stage:<16} {}{}", warning.mark(), warning.with_code()));
    }
    let count = match others.len() {
        0 => return,
        1 => "1 note".to_owned(),
        more => format!("{more} notes"),
    };
    let notes = quoted(&std::env::current_exe().unwrap_or_default().with_file_name("crumple-artifact")) + " notes";
    let notes = typed::by_way(&notes, "crumple notes");
    say(format_args!("{stage:<16} {count}: {notes} {}", quoted(output)));
}

/// A path as a shell takes it.
fn quoted(path: &Path) -> String {
    let text = path.to_string_lossy();
    let plain = |c: char| c.is_alphanumeric() || "/._-+:=,@%~".contains(c);
    if text.chars().all(plain) { text.into_owned() } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

/// One JSON object a line: topic, schema, data.
fn print_records<'a>(records: impl Iterator<Item = (&'a str, &'a str, &'a [u8])>) -> anyhow::Result<()> {
    let mut lines = String::new();
    for (topic, schema, payload) in records {
        // The payload is JSON already; a record that is not (a foreign encoding) is left to crumple-artifact show.
        let Ok(data) = std::str::from_utf8(payload) else { continue };
        let topic = serde_json::Value::from(topic);
        let schema = serde_json::Value::from(schema);
        lines += &format!("{{\"topic\":{topic},\"schema\":{schema},\"data\":{data}}}\n");
    }
    to_stdout(lines.as_bytes())
}

// The shell of programs that read artifacts and write something else: report, diff, artifact.

/// Parses the command line, runs the program, prints its error with cause and hint, and returns its exit status.
pub fn run_tool<C: CommandFactory + FromArgMatches>(
    call: &Call,
    run: impl FnOnce(C) -> anyhow::Result<ExitStatus>,
) -> ExitStatus {
    finish(parse::<C>(C::command(), call).map_err(Ok).and_then(|(cli, _)| run(cli).map_err(Err)))
}

/// Flag that prints a completion script or the man page instead of running.
const GENERATE: &str = "generate";

/// Kind of it that is neither: the options for a form, one JSON object a line.
const OPTIONS: &str = "options";

const SHELLS: [(&str, clap_complete::Shell); 3] =
    [("bash", clap_complete::Shell::Bash), ("zsh", clap_complete::Shell::Zsh), ("fish", clap_complete::Shell::Fish)];

/// Parses a command line; `Err` is the exit status after help, version, a completion script or a usage error was
/// printed.
fn parse<C: FromArgMatches>(command: Command, call: &Call) -> Result<(C, clap::ArgMatches), ExitStatus> {
    typed::begin(call.way);
    be_quiet(false);
    let kinds = PossibleValuesParser::new(SHELLS.iter().map(|(name, _)| *name).chain(["man", OPTIONS]));
    let flag = Arg::new(GENERATE)
        .long(GENERATE)
        .value_name("KIND")
        .value_parser(kinds)
        .exclusive(true)
        .help_heading(None)
        .help("Print a completion script, the man page, or the options as JSON, and do nothing else");
    // Where a subcommand is needed, this flag is exclusive of it as well; behind one it is about that one.
    let is_generating = call.has("--generate");
    let (mut command, mut words, mut name) = (command, call.words.as_slice(), call.program.clone());
    if is_generating
        && let Some((Some(first), rest)) = words.split_first().map(|(first, rest)| (first.to_str(), rest))
        && let Some(subcommand) = command.find_subcommand(first)
    {
        (command, words, name) = (subcommand.clone(), rest, format!("{name}-{first}"));
    }
    let command = command.bin_name(&name).display_name(&name).no_binary_name(true);
    let command = match call.way {
        Way::InRun => command.override_usage("crumple run [OPTIONS] RECORD [FLAGS OF crumple ingest]"),
        _ => command,
    };
    let command = args::with_switches_said_twice(args::with_flag(command.arg(flag)));
    let is_short = call.words.iter().any(|word| word == "-h");
    let parser = if is_short { in_short(command.clone()) } else { command.clone() };
    let parser = if is_generating { parser.subcommand_required(false).arg_required_else_help(false) } else { parser };
    let longs: Vec<String> = parser.get_arguments().filter_map(|arg| arg.get_long().map(str::to_owned)).collect();
    let matches = parser.try_get_matches_from(words).and_then(|matches| match matches.get_one::<String>(GENERATE) {
        Some(kind) => Ok(Err(generate(command, kind))),
        None => {
            args::take(&matches);
            Ok(Ok((C::from_arg_matches(&matches)?, matches)))
        }
    });
    match matches {
        Ok(parsed) => parsed,
        Err(mut error) => {
            propose_the_whole(&mut error, &longs);
            let _ = error.print(); // A closed pipe while printing help is nobody's problem.
            Err(match error.kind() {
                ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => ExitStatus::Done,
                _ => ExitStatus::Usage,
            })
        }
    }
}

/// For a flag that is one word of a longer one the longer one: `--speed` is nearer to `--impact-speed` than to
/// `--sheet`.
fn propose_the_whole(error: &mut clap::Error, longs: &[String]) {
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidArg) else { return };
    let word = typed.trim_start_matches('-').to_owned();
    let whole = longs.iter().find(|long| long.split('-').any(|part| part == word));
    if let Some(whole) = whole.filter(|_| error.kind() == ErrorKind::UnknownArgument) {
        error.insert(ContextKind::SuggestedArg, ContextValue::String(format!("--{whole}")));
    }
}

/// Most lines of the help that `-h` prints.
const SHORT: usize = 40;

/// The command as `-h` shows it: of each option the first sentence; those that are too many by name alone.
fn in_short(command: Command) -> Command {
    let is_too_long = |command: &Command| command.clone().render_help().to_string().lines().count() > SHORT;
    if !is_too_long(&command) {
        return command;
    }
    let end = |text: &str| text.match_indices(". ").map(|(at, _)| at).find(|at| !text[..*at].ends_with("e.g"));
    let first = |text: String| end(&text).map_or(text.clone(), |end| text[..end].to_owned());
    let mut command = command.mut_args(|arg| match arg.get_help().map(ToString::to_string).map(first) {
        Some(text) if arg.get_action().takes_values() => {
            arg.hide_default_value(true).hide_possible_values(true).help(text)
        }
        Some(text) => arg.help(text),
        None => arg,
    });
    let flags =
        |arg: &Arg| arg.get_long().filter(|_| !arg.is_hide_set()).map(|long| (arg.get_id().clone(), long.to_owned()));
    let mut shown: Vec<_> = command.get_arguments().filter_map(flags).collect();
    let mut named: Vec<String> = Vec::new();
    while is_too_long(&command) {
        let Some((id, long)) = shown.pop() else { break };
        named.insert(0, format!("--{long}"));
        let more = wrapped(&format!("More, which --help explains: {}", named.join(", ")), columns()).join("\n");
        command = command.mut_arg(id, |arg| arg.hide_short_help(true)).after_help(more);
    }
    command
}

/// An option by its key in a pipeline, with what it takes, as a line of JSON.
fn option_line(arg: &Arg) -> Option<String> {
    let values: Vec<String> = arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
    let option = serde_json::json!({
        "key": arg.get_id().as_str(),
        "flag": format!("--{}", arg.get_long()?),
        "about": arg.get_help()?.to_string(),
        "values": values,
        "many": arg.get_value_delimiter().is_some(),
    });
    Some(format!("{option}\n"))
}

/// Prints the completion script of a shell, the man page, or the options.
fn generate(mut command: Command, kind: &str) -> ExitStatus {
    let name = command.get_bin_name().unwrap_or_else(|| command.get_name()).to_owned();
    let mut text = Vec::new();
    match SHELLS.iter().find(|(shell, _)| *shell == kind) {
        Some((_, shell)) => clap_complete::generate(*shell, &mut command, name, &mut text),
        None if kind == OPTIONS => {
            text.extend(command.get_arguments().filter_map(option_line).collect::<String>().bytes());
        }
        None => {
            if clap_mangen::Man::new(command.name(name.leak() as &str)).render(&mut text).is_err() {
                return ExitStatus::Failure;
            }
        }
    }
    match to_stdout(&text) {
        Ok(()) => ExitStatus::Done,
        Err(error) => {
            say(render(&error));
            ExitStatus::Failure
        }
    }
}

fn finish(result: Result<ExitStatus, Result<ExitStatus, anyhow::Error>>) -> ExitStatus {
    match result {
        Ok(status) | Err(Ok(status)) => status,
        Err(Err(error)) => {
            say(render(&error));
            tell_caller(&error);
            status_of(&error)
        }
    }
}
