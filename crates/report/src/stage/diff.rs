//! `crumple-diff` and `crumple accept`: two results, or two folders of runs, as a reviewer reads them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crumple_artifact::records::TestV1;
use crumple_artifact::{Artifact, OutputKind, WAVE_PREFIX, refuse_named_pipe};
use crumple_diff::{
    Base, CompareSettings, Comparison, DiffError, FileReport, Side, TextOptions, Tolerances, compare_artifacts,
    compare_json, conclusion, open_candidates, parse_rules, write_text,
};
use crumple_stage::{
    Call, ExitStatus, Program, Usage, keep_budget, printable, program, refuse_to_overwrite, run_tool, to_stdout,
};

use super::compare::write;
use super::gather::stage_record;
use crate::Summary;
use crate::compare::first_screen::shell_word;
use crate::compare::review::{Expected, Review, line_of};
use crate::compare::review_files::{to_github, to_json, to_junit, to_markdown};
use crate::compare::why::Divided;

const SUMMARY: &str = "summary.json";
const PIPELINE: &str = "0-pipeline.toml";
/// Lines on a terminal, but for `--all`.
const LINES: usize = 25;

/// Compares two results: first what they were made with that differs, then the numbers that people ask for, then the
/// rest.
///
/// A result is an artifact, a run folder, a summary.json, or what `crumple accept` wrote; two folders that hold runs
/// are compared run by run. The same is what an engineer calls the same: times within 0.1 ms, lengths 1 mm, velocities
/// 0.01 m/s, all else 0.5 %. `--rounding` takes for the same what another processor computes from the same data (1e-9
/// relative; 1e-6 for what is identified, 1e-5 for what is fitted). All of it is in docs/diff.md.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-diff",
    version,
    after_help = "Exit codes: 0 same, 1 different, 2 trouble (a file is missing, truncated, corrupted, or the command \
        line is wrong)."
)]
struct Args {
    /// What was: an artifact, a run folder, a folder of runs, or expected/.
    a: PathBuf,
    /// What is.
    b: PathBuf,

    /// What an engineer calls the same [default].
    #[arg(long, conflicts_with_all = ["rounding", "exact", "bits"])]
    engineering: bool,
    /// The same computation on another processor.
    #[arg(long, conflicts_with_all = ["exact", "bits"])]
    rounding: bool,
    /// Every number equal.
    #[arg(long, conflicts_with_all = ["abs", "rel"])]
    exact: bool,
    /// As --exact, and -0.0 is not 0.0.
    #[arg(long, conflicts_with_all = ["abs", "rel"])]
    bits: bool,
    /// Absolute tolerance of every number, in its SI unit, instead of the table's.
    #[arg(long, value_name = "X", value_parser = tolerance)]
    abs: Option<f64>,
    /// Relative tolerance of every number, instead of the table's; samples: of the waveform's largest magnitude.
    #[arg(long, value_name = "X", value_parser = tolerance)]
    rel: Option<f64>,
    /// File of tolerances by topic, e.g. the line "/wave/*" = { abs = 1e-6, rel = 1e-6 }.
    #[arg(long, value_name = "FILE.toml")]
    tolerance: Option<PathBuf>,
    /// Another stage version, option or input is a difference by itself.
    #[arg(long)]
    provenance: bool,

    /// Show every difference.
    #[arg(long)]
    all: bool,
    /// The comparison as JSON, to a file or to stdout: a summary, then each topic by its largest difference (--all:
    /// every difference).
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    json: Option<PathBuf>,
    /// The comment for a merge request, as Markdown.
    #[arg(long, value_name = "FILE")]
    markdown: Option<PathBuf>,
    /// The comparison as tests of JUnit.
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Print annotations of GitHub, at the line of the cause.
    #[arg(long)]
    github: bool,
    /// Divide the change of every key number among its causes: the chain is run again with one cause at a time, at most
    /// 14 times. Needs two run folders and their records.
    #[arg(long)]
    why: bool,
    /// Print nothing; the exit code tells.
    #[arg(short, long)]
    quiet: bool,
}

/// Keeps the accepted numbers of runs: expected/RECORD.json, a small file each, for a repository.
#[derive(Debug, clap::Parser)]
#[command(name = "crumple-accept", version)]
struct AcceptArgs {
    /// Run folders, or folders of runs.
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,
    /// Folder to write to.
    #[arg(long, value_name = "FOLDER", default_value = "expected")]
    into: PathBuf,
}

/// The program. Here 1 means "different" and every failure is 2, whatever its kind.
pub const DIFF: Program = Program::of_tool::<Args>("diff", |call| diff(call, None));

/// Divides the change between two run folders among its causes.
pub type Why = fn(&Path, &Path) -> anyhow::Result<Divided>;

/// The program, with what can run the chain again.
pub fn diff(call: &Call, why: Option<Why>) -> ExitStatus {
    run_tool(call, |args: Args| run(&args, why).map_err(trouble))
}

/// `crumple accept`.
pub const ACCEPT: Program =
    Program::of_tool::<AcceptArgs>("accept", |call| run_tool(call, |args: AcceptArgs| accept(&args).map_err(trouble)));

/// A path as a word of a shell.
fn word(path: &Path) -> String {
    shell_word(&path.display().to_string())
}

impl Args {
    /// The command that makes the Markdown again.
    fn again(&self) -> String {
        let mut words = vec![program("diff"), word(&self.a), word(&self.b)];
        let switches = [(self.rounding, "--rounding"), (self.exact, "--exact"), (self.bits, "--bits")];
        words.extend(switches.iter().filter(|(is_on, _)| *is_on).map(|(_, flag)| (*flag).to_owned()));
        for (flag, value) in [("--abs", self.abs), ("--rel", self.rel)] {
            words.extend(value.map(|value| format!("{flag} {value}")));
        }
        for (flag, path) in [("--tolerance", &self.tolerance), ("--markdown", &self.markdown)] {
            words.extend(path.as_ref().map(|path| format!("{flag} {}", word(path))));
        }
        words.join(" ")
    }
}

fn trouble(error: anyhow::Error) -> anyhow::Error {
    // An error that tells its cause in its own words does not tell it twice.
    let mut text = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !text.ends_with(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    let usage = Usage::new(text);
    match error.downcast_ref::<DiffError>() {
        Some(known) => usage.hint(known.hint()).into(),
        None => usage.into(),
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number such as 1e-9".to_owned())?;
    if value.is_finite() && value >= 0.0 { Ok(value) } else { Err("expected a number from 0".to_owned()) }
}

fn settings(args: &Args) -> Result<CompareSettings, DiffError> {
    let rules = match &args.tolerance {
        None => Vec::new(),
        Some(path) => {
            let text = fs::read_to_string(path).map_err(|source| DiffError::Io { path: path.clone(), source })?;
            parse_rules(&text)?
        }
    };
    let base = match (args.rounding, args.exact || args.bits) {
        (true, _) => Base::Computation,
        (_, true) => Base::Exact,
        _ => Base::Engineering,
    };
    Ok(CompareSettings {
        tolerances: Tolerances { base, abs: args.abs, rel: args.rel, rules, ..Tolerances::default() },
        bits: args.bits,
        provenance: args.provenance,
    })
}

fn run(args: &Args, why: Option<Why>) -> anyhow::Result<ExitStatus> {
    if args.why && why.is_none() {
        let problem = "--why runs the chain, which this program alone cannot";
        return Err(Usage::new(problem).hint("crumple diff A B --why").into());
    }
    let results = [args.a.clone(), args.b.clone()];
    let outputs = [
        (args.markdown.as_ref(), OutputKind::Markdown),
        (args.junit.as_ref(), OutputKind::Junit),
        (args.json.as_ref().filter(|path| path.as_path() != Path::new("-")), OutputKind::Summary),
    ];
    for (path, kind) in outputs {
        path.map_or(Ok(()), |path| refuse_to_overwrite(path, kind, &results))?;
    }
    keep_budget(&results, ExitStatus::Usage);
    let settings = settings(args)?;
    let mut compared = Vec::new();
    let mut topics = BTreeSet::new();
    for (name, a, b) in pairs(&args.a, &args.b)? {
        let [before, after] = [Read::of(&a)?, Read::of(&b)?];
        let own = b.join(PIPELINE);
        let place = |stage: &str, key: &str| place_of(&own, after.kept.summary.pipeline.as_deref(), stage, key);
        let review = Review::new(&name, [&before.kept, &after.kept], &settings, place);
        let files = if before.is_kept || after.is_kept {
            let same = review.is_same();
            vec![FileReport { name: "key numbers and recommended model".to_owned(), same, ..FileReport::default() }]
        } else {
            files(&a, &b, &settings)?
        };
        topics.extend(before.topics);
        topics.extend(after.topics);
        let comparison = Comparison::new(a.display().to_string(), b.display().to_string(), settings.provenance, files);
        compared.push((review, comparison));
    }
    settings.tolerances.refuse_unmatched(topics.iter().map(String::as_str))?;
    let same = compared.iter().all(|(_, comparison)| comparison.same);
    let reviews: Vec<&Review> = compared.iter().map(|(review, _)| review).collect();
    let why = why.filter(|_| args.why && !same);
    let divided = why.map(|why| why(&args.a, &args.b)).transpose()?;
    if let Some(path) = &args.markdown {
        let accept = format!("crumple accept {}", word(&args.b));
        write(path, OutputKind::Markdown, &to_markdown(&reviews, &args.again(), &accept))?;
    }
    if let Some(path) = &args.junit {
        write(path, OutputKind::Junit, &to_junit(&compared))?;
    }
    if let Some(path) = &args.json {
        let mut value = to_json(&compared, args.all);
        if let Some(divided) = &divided {
            value["why"] = serde_json::to_value(divided)?;
        }
        let text = serde_json::to_string_pretty(&value)? + "\n";
        match path.to_str() {
            // JSON spells such characters out itself.
            Some("-") => to_stdout(text.as_bytes())?,
            _ => write(path, OutputKind::Summary, &text)?,
        }
    }
    let says = !args.quiet && args.json.as_deref().is_none_or(|path| path != Path::new("-"));
    let mut text = if args.github { to_github(&reviews) } else { String::new() };
    if says {
        let mut said = lines(&compared, args.all)?;
        said.extend(divided.iter().flat_map(Divided::lines));
        text += &said.join("\n");
        text.push('\n');
    }
    // A reader that closes the pipe still gets the exit code.
    to_stdout(printable(&text).as_bytes())?;
    Ok(if same { ExitStatus::Done } else { ExitStatus::Failure })
}

/// How much is the same or not; of what was accepted the numbers alone are kept.
fn ending(review: &Review, comparison: &Comparison) -> String {
    let is_kept = |file: &FileReport| file.topics.is_empty() && file.digests.is_none() && file.only_in.is_none();
    match (comparison.files.iter().all(is_kept), comparison.same) {
        (false, true) => conclusion(comparison),
        (false, false) => format!("{}; every difference: --all", conclusion(comparison)),
        (true, true) => {
            let numbers: usize = review.counts.values().sum();
            format!(
                "same within the limits: {numbers} number{} and the recommended model",
                if numbers == 1 { "" } else { "s" }
            )
        }
        (true, false) => "different from what was accepted".to_owned(),
    }
}

/// What is printed: of one comparison at most [`LINES`], of several those that differ under their names.
fn lines(compared: &[(Review, Comparison)], all: bool) -> anyhow::Result<Vec<String>> {
    let several = compared.len() > 1;
    let mut lines = Vec::new();
    let mut same = Vec::new();
    for (review, comparison) in compared {
        if comparison.same && !all {
            same.push((review.name.as_str(), ending(review, comparison)));
            continue;
        }
        if several {
            lines.push(format!("{}:", review.name));
        }
        let most = if all { usize::MAX } else { LINES };
        let has_numbers = !review.counts.is_empty();
        let mut of_one = match (comparison.same, has_numbers) {
            (true, _) => Vec::new(),
            (_, true) => review.lines(most - 1),
            (_, false) => review.head(),
        };
        if all || !has_numbers {
            let mut text = Vec::new();
            write_text(comparison, TextOptions { all }, &mut text)?;
            of_one.extend(String::from_utf8_lossy(&text).lines().map(str::to_owned));
        } else {
            of_one.push(ending(review, comparison));
        }
        if of_one.len() > most {
            let last = of_one.pop();
            of_one.truncate(most - 2);
            of_one.push("and more: --all".to_owned());
            of_one.extend(last);
        }
        lines.extend(of_one);
    }
    match &same[..] {
        [] => {}
        [(_, text)] if !several => lines.push(text.clone()),
        several => {
            let names: Vec<&str> = several.iter().map(|(name, _)| *name).collect();
            lines.push(format!("the same: {}", names.join(", ")));
        }
    }
    Ok(lines)
}

// What is compared with what.

/// One side of a comparison.
struct Read {
    kept: Expected,
    topics: BTreeSet<String>,
    /// Whether it is nothing but what was accepted.
    is_kept: bool,
}

impl Read {
    fn of(path: &Path) -> anyhow::Result<Self> {
        if is_json(path) {
            let value = read_json(path)?;
            if value["schema"] == Expected::SCHEMA {
                let damaged = |source| DiffError::Json { path: path.to_owned(), source };
                let kept = serde_json::from_value(value).map_err(damaged)?;
                return Ok(Self { kept, topics: BTreeSet::new(), is_kept: true });
            }
            // Another summary than of this version has no numbers to show, and is compared value by value.
            let summary: Summary = serde_json::from_value(value).unwrap_or_default();
            let topics = BTreeSet::from([SUMMARY.to_owned()]);
            return Ok(Self { kept: Expected { summary, ..Expected::default() }, topics, is_kept: false });
        }
        let paths: Vec<PathBuf> = match path.is_dir() {
            true => results_in(path)?.into_iter().filter(|name| name != SUMMARY).map(|name| path.join(name)).collect(),
            false => vec![path.to_owned()],
        };
        let mut kept = Expected::default();
        let mut topics = BTreeSet::from([SUMMARY.to_owned()]);
        for path in &paths {
            let artifact = Artifact::open(path).map_err(DiffError::from)?;
            kept.stages.push(stage_record(&artifact));
            topics.extend(artifact.records().iter().map(|raw| raw.topic.clone()));
            topics.extend(artifact.waves().keys().map(|id| format!("{WAVE_PREFIX}{id}")));
            if let Some(test) = artifact.record::<TestV1>("/test").map_err(DiffError::from)? {
                kept.record = [test.source.name, test.source.digest];
            }
        }
        let of_run = path.join(SUMMARY);
        if of_run.is_file() {
            kept.summary = serde_json::from_value(read_json(&of_run)?).unwrap_or_default();
        }
        Ok(Self { kept, topics, is_kept: false })
    }
}

/// File and line that state an option: the pipeline in the project by the name of the run's, else the run's own.
fn place_of(own: &Path, pipeline: Option<&str>, stage: &str, key: &str) -> Option<(String, usize)> {
    let named = pipeline.map(|name| Path::new("pipelines").join(format!("{name}.toml")));
    let found = |path: &Path| {
        let line = line_of(&fs::read_to_string(path).ok()?, stage, key)?;
        Some((path.display().to_string(), line))
    };
    named.as_deref().and_then(found).or_else(|| found(own))
}

/// Pairs of results with a name each. Folders that hold runs are paired by the place of the runs in them, what was
/// accepted by the name of its file.
fn pairs(a: &Path, b: &Path) -> anyhow::Result<Vec<(String, PathBuf, PathBuf)>> {
    let is_kept = |path: &Path| is_json(path) && read_json(path).is_ok_and(|value| value["schema"] == Expected::SCHEMA);
    for path in [a, b] {
        fs::metadata(path).map_err(|source| DiffError::Io { path: path.to_owned(), source })?;
    }
    if kind(a) != kind(b) && !is_kept(a) && !is_kept(b) {
        return Err(DiffError::Kinds { a: a.into(), a_is: kind(a), b: b.into(), b_is: kind(b) }.into());
    }
    let is_one = |path: &Path| !path.is_dir() || results_in(path).is_ok();
    if is_one(a) && is_one(b) {
        return Ok(vec![(name_of(b), a.to_owned(), b.to_owned())]);
    }
    let [left, right] = [results_below(a)?, results_below(b)?];
    let mut paired = Vec::new();
    for (name, path) in &left {
        match right.iter().find(|(other, _)| other == name) {
            Some((_, other)) => paired.push((name.clone(), path.clone(), other.clone())),
            None => {
                let problem = format!("{} has no run {name}, which {} has", b.display(), a.display());
                return Err(Usage::new(problem).hint("run the record, or compare the runs one by one").into());
            }
        }
    }
    Ok(paired)
}

/// The record and the pipeline of a run, by the names of its folders: `crash`, `crash-civic`.
fn name_of(folder: &Path) -> String {
    let name = |path: &Path| path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let record = folder.parent().map(name).unwrap_or_default();
    match name(folder) {
        own if !folder.is_dir() || record.is_empty() => own,
        own if own == "default" => record,
        own => format!("{record}-{own}"),
    }
}

/// Run folders below a folder, and what was accepted in it, by name.
fn results_below(folder: &Path) -> anyhow::Result<Vec<(String, PathBuf)>> {
    if results_in(folder).is_ok() {
        return Ok(vec![(name_of(folder), folder.to_owned())]);
    }
    let io = |source| DiffError::Io { path: folder.to_owned(), source };
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(io)? {
        let path = entry.map_err(io)?.path();
        if path.is_dir() {
            found.extend(results_below(&path).unwrap_or_default());
        } else if is_json(&path) {
            found.push((name_of(&path), path));
        }
    }
    found.sort();
    if found.is_empty() { Err(DiffError::NotARun { path: folder.to_owned() }.into()) } else { Ok(found) }
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "json")
}

fn kind(path: &Path) -> &'static str {
    match (path.is_dir(), is_json(path)) {
        (true, _) => "a folder",
        (_, true) => "a JSON file",
        _ => "a file",
    }
}

fn files(a: &Path, b: &Path, settings: &CompareSettings) -> Result<Vec<FileReport>, DiffError> {
    let mut settings = settings.clone();
    // Of a run the fits come before what is made of them.
    let mut file = |name: &str, a: &Path, b: &Path| -> Result<FileReport, DiffError> {
        if is_json(a) {
            // The summary's tolerances apply under whatever name it was kept.
            return Ok(FileReport::json(name, compare_json(SUMMARY, &read_json(a)?, &read_json(b)?, &settings)));
        }
        let (a, b) = (Artifact::open(a)?, Artifact::open(b)?);
        settings.tolerances.open.extend(open_candidates(&a, &b)?);
        Ok(compare_artifacts(name, &a, &b, &settings)?)
    };
    if !a.is_dir() {
        return Ok(vec![file(&a.file_name().unwrap_or_default().to_string_lossy(), a, b)?]);
    }
    let (left, right) = (results_in(a)?, results_in(b)?);
    left.union(&right)
        .map(|name| match (left.contains(name), right.contains(name)) {
            (true, true) => file(name, &a.join(name), &b.join(name)),
            (true, false) => Ok(FileReport::missing(name, Side::A)),
            _ => Ok(FileReport::missing(name, Side::B)),
        })
        .collect()
}

fn results_in(folder: &Path) -> Result<BTreeSet<String>, DiffError> {
    let io = |source| DiffError::Io { path: folder.to_owned(), source };
    let mut names = BTreeSet::new();
    for entry in fs::read_dir(folder).map_err(io)? {
        let name = entry.map_err(io)?.file_name().to_string_lossy().into_owned();
        // A stage that was killed may leave a hidden temporary file.
        if !name.starts_with('.') && (name.ends_with(".mcap") || name == SUMMARY) {
            names.insert(name);
        }
    }
    if names.is_empty() { Err(DiffError::NotARun { path: folder.to_owned() }) } else { Ok(names) }
}

fn read_json(path: &Path) -> Result<serde_json::Value, DiffError> {
    let text = refuse_named_pipe(path)
        .and_then(|()| fs::read(path))
        .map_err(|source| DiffError::Io { path: path.to_owned(), source })?;
    serde_json::from_slice(&text).map_err(|source| DiffError::Json { path: path.to_owned(), source })
}

// What is accepted.

fn accept(args: &AcceptArgs) -> anyhow::Result<ExitStatus> {
    keep_budget(&args.runs, ExitStatus::Usage);
    let mut text = String::new();
    for run in &args.runs {
        for (name, folder) in results_below(run)? {
            let Read { kept, is_kept, .. } = Read::of(&folder)?;
            if is_kept || kept.stages.is_empty() {
                let problem = format!("{} is no run folder", folder.display());
                return Err(Usage::new(problem).hint("accept takes the folders that crumple run made").into());
            }
            if kept.summary.key_numbers.is_empty() && kept.summary.recommended.is_none() {
                let problem = format!("{} has no {SUMMARY} with results", folder.display());
                return Err(Usage::new(problem).hint("run the record again, and look at its report").into());
            }
            let kept = Expected::new(kept.record.clone(), kept.stages, &kept.summary);
            let json = serde_json::to_string_pretty(&kept)? + "\n";
            let path = args.into.join(format!("{name}.json"));
            let is_there = fs::read_to_string(&path).is_ok_and(|old| old == json);
            if !is_there {
                write(&path, OutputKind::Summary, &json)?;
            }
            text += &format!("{}{}\n", path.display(), if is_there { ", as it was" } else { "" });
        }
    }
    to_stdout(printable(&text).as_bytes())?;
    Ok(ExitStatus::Done)
}
