//! The program: options, the files to compare, output, exit code.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::{
    Base, CompareSettings, Comparison, DiffError, FileReport, Side, TextOptions, Tolerances, compare_artifacts,
    compare_json, head, parse_rules, tolerated_parameters, write_text,
};
use anyhow::Context;
use crumple_artifact::{Artifact, refuse_named_pipe};
use crumple_stage::{ExitStatus, Program, Usage, keep_budget, printable, run_tool, to_stdout};

/// Compares two artifacts or two run folders by what they mean: waveforms sample by sample, records value by value,
/// within a tolerance.
///
/// Two folders are compared file by file: every *.mcap and summary.json. The default tolerance takes the same
/// computation on another processor for the same (1e-9 relative; 1e-6 for what is identified, 1e-5 for what is fitted);
/// --engineering takes for the same what an engineer would. All of it is in docs/diff.md.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-diff",
    version,
    after_help = "Exit codes: 0 same, 1 different, 2 trouble (a file is missing, truncated, corrupted, or the command \
        line is wrong)."
)]
struct Args {
    /// First artifact or run folder.
    a: PathBuf,
    /// Second artifact or run folder.
    b: PathBuf,

    /// Absolute tolerance of every number, in its SI unit, instead of the table's.
    #[arg(long, value_name = "X", value_parser = tolerance)]
    abs: Option<f64>,
    /// Relative tolerance of every number, instead of the table's; samples: of the waveform's largest magnitude.
    #[arg(long, value_name = "X", value_parser = tolerance)]
    rel: Option<f64>,
    /// File of tolerances by topic, e.g. the line "/wave/*" = { abs = 1e-6, rel = 1e-6 }.
    #[arg(long, value_name = "FILE.toml")]
    tolerance: Option<PathBuf>,
    /// What an engineer calls the same: times 0.1 ms, lengths 1 mm, velocities 0.01 m/s, all else 0.5 %.
    #[arg(long, conflicts_with_all = ["exact", "bits"])]
    engineering: bool,
    /// Every number equal.
    #[arg(long, conflicts_with_all = ["abs", "rel"])]
    exact: bool,
    /// As --exact, and -0.0 is not 0.0.
    #[arg(long, conflicts_with_all = ["abs", "rel"])]
    bits: bool,
    /// Another stage version, option or input is a difference too (otherwise it is told for information).
    #[arg(long)]
    provenance: bool,

    /// Show every difference, not five of a topic and three waveforms of a file.
    #[arg(long)]
    all: bool,
    /// Print the comparison as JSON, with every difference.
    #[arg(long)]
    json: bool,
    /// Print nothing; the exit code tells.
    #[arg(short, long)]
    quiet: bool,
}

/// The program. Here 1 means "different" and every failure is 2, whatever its kind.
pub const PROGRAM: Program =
    Program::of_tool::<Args>("diff", |call| run_tool(call, |args: Args| run(&args).map_err(trouble)));

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

fn run(args: &Args) -> anyhow::Result<ExitStatus> {
    keep_budget(&[args.a.clone(), args.b.clone()], ExitStatus::Usage);
    let settings = settings(args)?;
    let files = compare_paths(&args.a, &args.b, &settings)?;
    let (a, b) = (args.a.display().to_string(), args.b.display().to_string());
    let report = Comparison::new(a, b, settings.provenance, files);
    if !args.quiet {
        let mut text = Vec::new();
        print(args, &report, &mut text).context("cannot write to stdout")?;
        // JSON spells such characters out itself. A reader that closes the pipe still gets the exit code.
        let text = String::from_utf8_lossy(&text);
        to_stdout(if args.json { text } else { printable(&text).into_owned().into() }.as_bytes())?;
    }
    Ok(if report.same { ExitStatus::Done } else { ExitStatus::Failure })
}

fn print(args: &Args, report: &Comparison, mut stdout: &mut Vec<u8>) -> io::Result<()> {
    if args.json {
        serde_json::to_writer_pretty(&mut stdout, report)?;
        writeln!(stdout)
    } else {
        if !report.same {
            for line in head_of(&args.a, &args.b, report) {
                writeln!(stdout, "{line}")?;
            }
        }
        write_text(report, TextOptions { all: args.all }, stdout)
    }
}

fn settings(args: &Args) -> Result<CompareSettings, DiffError> {
    let rules = match &args.tolerance {
        None => Vec::new(),
        Some(path) => {
            let text = fs::read_to_string(path).map_err(|source| DiffError::Io { path: path.clone(), source })?;
            parse_rules(&text)?
        }
    };
    let base = match (args.engineering, args.exact || args.bits) {
        (true, _) => Base::Engineering,
        (_, true) => Base::Exact,
        _ => Base::Computation,
    };
    Ok(CompareSettings {
        tolerances: Tolerances { base, abs: args.abs, rel: args.rel, rules },
        bits: args.bits,
        provenance: args.provenance,
    })
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "expected a number such as 1e-9".to_owned())?;
    if value.is_finite() && value >= 0.0 { Ok(value) } else { Err("expected a number from 0".to_owned()) }
}

// Finds and reads what is to be compared.

const SUMMARY: &str = "summary.json";

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Folder,
    Json,
    Artifact,
}

impl Kind {
    fn of_path(path: &Path) -> Result<Self, DiffError> {
        let metadata = fs::metadata(path).map_err(|source| DiffError::Io { path: path.to_owned(), source })?;
        Ok(if metadata.is_dir() {
            Self::Folder
        } else if path.extension().is_some_and(|extension| extension == "json") {
            Self::Json
        } else {
            Self::Artifact
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Folder => "a folder",
            Self::Json => "a JSON file",
            Self::Artifact => "a file",
        }
    }
}

/// Compares two files or two folders.
pub fn compare_paths(a: &Path, b: &Path, settings: &CompareSettings) -> Result<Vec<FileReport>, DiffError> {
    let (kind_a, kind_b) = (Kind::of_path(a)?, Kind::of_path(b)?);
    if kind_a != kind_b {
        return Err(DiffError::Kinds { a: a.into(), a_is: kind_a.name(), b: b.into(), b_is: kind_b.name() });
    }
    match kind_a {
        Kind::Folder => compare_folders(a, b, settings),
        _ => compare_files(&name(a), a, b, settings).map(|report| vec![report]),
    }
}

/// What people want to know first of two runs that differ; empty where there are no two summaries.
pub fn head_of(a: &Path, b: &Path, report: &Comparison) -> Vec<String> {
    let summary = |path: &Path| {
        let path = if path.is_dir() { path.join(SUMMARY) } else { path.to_owned() };
        path.extension().is_some_and(|extension| extension == "json").then(|| read_json(&path).ok())?
    };
    match (summary(a), summary(b)) {
        (Some(a), Some(b)) => {
            let mut lines = head(&a, &b);
            lines.extend(tolerated_parameters(&a, &b, report));
            lines
        }
        _ => Vec::new(),
    }
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn compare_files(name: &str, a: &Path, b: &Path, settings: &CompareSettings) -> Result<FileReport, DiffError> {
    if Kind::of_path(a)? == Kind::Json {
        // The summary's tolerances apply under whatever name it was kept.
        let topic = compare_json(SUMMARY, &read_json(a)?, &read_json(b)?, settings);
        return Ok(FileReport::json(name, topic));
    }
    Ok(compare_artifacts(name, &Artifact::open(a)?, &Artifact::open(b)?, settings)?)
}

fn compare_folders(a: &Path, b: &Path, settings: &CompareSettings) -> Result<Vec<FileReport>, DiffError> {
    let (left, right) = (results_in(a)?, results_in(b)?);
    left.union(&right)
        .map(|name| match (left.contains(name), right.contains(name)) {
            (true, true) => compare_files(name, &a.join(name), &b.join(name), settings),
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
