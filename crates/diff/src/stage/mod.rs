//! The program: options, the files to compare, output, exit code.

mod inputs;

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use crumple_diff::{Base, CompareSettings, Comparison, DiffError, TextOptions, Tolerances, parse_rules, write_text};
use crumple_stage::{ExitStatus, Usage, keep_budget, printable, to_stdout, tool_main};

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

/// Parses the command line, compares and prints.
pub fn main() -> ExitCode {
    // Here 1 means "different" and every failure is 2, whatever its kind.
    tool_main(|args: Args| run(&args).map_err(trouble))
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

fn run(args: &Args) -> anyhow::Result<ExitStatus> {
    keep_budget(&[args.a.clone(), args.b.clone()], ExitStatus::Usage);
    let settings = settings(args)?;
    let files = inputs::compare_paths(&args.a, &args.b, &settings)?;
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
            for line in inputs::head_of(&args.a, &args.b, report) {
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
            let text = std::fs::read_to_string(path).map_err(|source| DiffError::Io { path: path.clone(), source })?;
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
