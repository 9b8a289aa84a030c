//! `crumple-diff`: two results, or two folders of runs, as a reviewer reads them.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crumple_artifact::OutputKind;
use crumple_diff::{
    Base, CompareSettings, Comparison, DiffError, FileReport, TextOptions, Tolerances, conclusion, parse_rules,
    write_text,
};
use crumple_stage::{
    Call, ExitStatus, Pipeline, Program, Usage, keep_budget, printable, program, refuse_to_overwrite,
    results_of_an_earlier_run, run_tool, say, to_stdout,
};

use super::compare::write;
use super::results::{Pair, Side, files, pairs, place_of};
use super::run_folders::FoundRun;
use crate::compare::compared::{Compared, Outcome, Trouble, TroubleKind};
use crate::compare::first_screen::shell_word;
use crate::compare::review::Review;
use crate::compare::review_files::{Commands, to_github, to_json, to_junit, to_markdown};
use crate::compare::why::Divided;

/// Lines on a terminal, but for `--all`.
const LINES: usize = 25;
/// Numbers whose change is divided, likewise: the key numbers, and what follows.
const DIVIDED: usize = 12;

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
    after_help = "Exit codes: 0 same, 1 different, 2 trouble (a run is missing or was refused, a file is truncated or \
        corrupted, or the command line is wrong)."
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

/// The program. Here 1 means "different" and every failure is 2, whatever its kind.
pub const DIFF: Program = Program::of_tool::<Args>("diff", |call| diff(call, None));

/// Divides the change between two run folders among its causes.
pub type Why = fn(&Path, &Path, &CompareSettings) -> anyhow::Result<Divided>;

/// The program, with what can run the chain again.
pub fn diff(call: &Call, why: Option<Why>) -> ExitStatus {
    run_tool(call, |args: Args| run(&args, why).map_err(trouble))
}

/// A path as a word of a shell.
fn word(path: &Path) -> String {
    shell_word(&path.display().to_string())
}

impl Args {
    /// The command without what it writes.
    fn again(&self) -> String {
        let mut words = vec![program("diff"), word(&self.a), word(&self.b)];
        let switches = [(self.rounding, "--rounding"), (self.exact, "--exact"), (self.bits, "--bits")];
        words.extend(switches.iter().filter(|(is_on, _)| *is_on).map(|(_, flag)| (*flag).to_owned()));
        for (flag, value) in [("--abs", self.abs), ("--rel", self.rel)] {
            words.extend(value.map(|value| format!("{flag} {value}")));
        }
        words.extend(self.tolerance.as_ref().map(|path| format!("--tolerance {}", word(path))));
        words.extend(self.provenance.then(|| "--provenance".to_owned()));
        words.join(" ")
    }
}

/// Every failure is of the same exit code.
pub fn trouble(error: anyhow::Error) -> anyhow::Error {
    if error.is::<Usage>() {
        return error;
    }
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
    let is_run = |folder: &&PathBuf| folder.join(Pipeline::OF_A_RUN).is_file();
    if let Some(other) = [&args.a, &args.b].into_iter().find(|folder| args.why && !is_run(folder)) {
        let problem = format!("{} is no run folder, so its change cannot be divided", other.display());
        return Err(Usage::new(problem).hint("two folders that crumple run made: runs/RECORD/PIPELINE").into());
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
    let pairs = pairs(&args.a, &args.b)?;
    let mut compared = Vec::new();
    let mut topics = BTreeSet::new();
    for pair in pairs {
        let name = pair.name.clone();
        let is_named = |run: &Option<FoundRun>, typed: &Path| run.as_ref().is_some_and(|run| run.path == typed);
        let is_one = is_named(&pair.before, &args.a) && is_named(&pair.after, &args.b);
        let outcome = match compare_pair(pair, args, &settings, &mut topics) {
            Ok(outcome) => outcome,
            Err(error) if is_one => return Err(error),
            Err(error) => Outcome::Trouble(unreadable(error)),
        };
        compared.push(Compared { name, outcome });
    }
    // Where nothing could be read, no topic is known.
    if compared.iter().any(|one| one.review().is_some()) {
        settings.tolerances.refuse_unmatched(topics.iter().map(String::as_str))?;
    }
    let is_same = compared.iter().all(Compared::is_same);
    let has_trouble = compared.iter().any(|one| one.trouble().is_some());
    let why = why.filter(|_| args.why && !is_same && !has_trouble);
    // What was compared is said and written whether its change can be divided or not.
    let divided = why.map(|why| why(&args.a, &args.b, &Side::read(&args.a)?.kept.within(&settings)?));
    let (divided, undivided) = match divided {
        Some(Err(error)) => (None, Some(error)),
        other => (other.transpose()?, None),
    };
    write_files(args, &compared, divided.as_ref())?;
    let says = !args.quiet && args.json.as_deref().is_none_or(|path| path != Path::new("-"));
    let mut text = if args.github { to_github(&compared) } else { String::new() };
    if says {
        let mut said = lines(&compared, args.all)?;
        let most = if args.all { usize::MAX } else { DIVIDED };
        said.extend(divided.iter().flat_map(|divided| divided.lines(most)));
        text += &said.join("\n");
        text.push('\n');
    }
    // A reader that closes the pipe still gets the exit code.
    to_stdout(printable(&text).as_bytes())?;
    if !args.quiet {
        for trouble in compared.iter().filter_map(Compared::trouble) {
            say(format_args!("error: {}\n  hint: {}", trouble.problem, trouble.hint));
        }
    }
    if let Some(error) = undivided {
        return Err(error);
    }
    Ok(match is_same {
        _ if has_trouble => ExitStatus::Usage,
        true => ExitStatus::Done,
        false => ExitStatus::Failure,
    })
}

/// Compares the results of one name. Errors: one of them cannot be read.
fn compare_pair(
    pair: Pair,
    args: &Args,
    settings: &CompareSettings,
    topics: &mut BTreeSet<String>,
) -> anyhow::Result<Outcome> {
    let Pair { name, before, after } = pair;
    let refused = [&before, &after].into_iter().flatten().find_map(|run| results_of_an_earlier_run(&run.path));
    if let Some(problem) = refused {
        let hint = "run the record again, and see why it ends".to_owned();
        return Ok(Outcome::Trouble(Trouble { kind: TroubleKind::Refused, problem, hint }));
    }
    let (before, after) = match (before, after) {
        (Some(before), Some(after)) => (before, after),
        (None, after) => {
            let place = after.map_or_else(|| args.b.clone(), |run| run.path);
            let problem = format!("{} is not in {}", place.display(), args.a.display());
            return Ok(Outcome::New { problem });
        }
        (_, None) => {
            let problem = format!("{} has no run {name}, which {} has", args.b.display(), args.a.display());
            let hint = "run the record, and see why it ends; or remove what was accepted of it".to_owned();
            return Ok(Outcome::Trouble(Trouble { kind: TroubleKind::Missing, problem, hint }));
        }
    };
    let [a, b] = [&before.path, &after.path];
    let sides = [Side::read(a)?, Side::read(b)?];
    let with_accepted = sides.iter().any(|side| side.is_kept);
    if with_accepted {
        sides.iter().try_for_each(Side::refuse_a_mixture)?;
    }
    // What was before says what the same is: a change does not widen its own limits.
    let settings = &sides[0].kept.within(settings)?;
    let review = Review::new(&name, [&sides[0].kept, &sides[1].kept], settings, |stage, key| place_of(b, stage, key));
    let files = if with_accepted {
        let same = review.is_same();
        vec![FileReport { name: "key numbers and recommended model".to_owned(), same, ..FileReport::default() }]
    } else {
        files(a, b, settings)?
    };
    topics.extend(sides.into_iter().flat_map(|side| side.topics));
    let comparison = Comparison::new(a.display().to_string(), b.display().to_string(), settings.provenance, files);
    Ok(Outcome::Reviewed(review, comparison))
}

/// An error of one record among several.
fn unreadable(error: anyhow::Error) -> Trouble {
    let hint = error.downcast_ref::<DiffError>().map_or("run the record again", DiffError::hint).to_owned();
    Trouble { kind: TroubleKind::Unreadable, problem: trouble(error).to_string(), hint }
}

/// Writes the files that are asked for.
fn write_files(args: &Args, compared: &[Compared], divided: Option<&Divided>) -> anyhow::Result<()> {
    if let Some(path) = &args.markdown {
        let again = args.again();
        let commands = Commands {
            all: format!("{again} --all"),
            again: format!("{again} --markdown {}", word(path)),
            accept: format!("crumple accept {}", word(&args.b)),
        };
        write(path, OutputKind::Markdown, &to_markdown(compared, &commands))?;
    }
    if let Some(path) = &args.junit {
        write(path, OutputKind::Junit, &to_junit(compared))?;
    }
    if let Some(path) = &args.json {
        let mut value = to_json(compared, args.all);
        if let Some(divided) = divided {
            value["why"] = serde_json::to_value(divided)?;
        }
        let text = serde_json::to_string_pretty(&value)? + "\n";
        match path.to_str() {
            // JSON spells such characters out itself.
            Some("-") => to_stdout(text.as_bytes())?,
            _ => write(path, OutputKind::Summary, &text)?,
        }
    }
    Ok(())
}

/// Whether it stands for what was accepted, of which there is no file.
fn is_kept(file: &FileReport) -> bool {
    file.topics.is_empty() && file.digests.is_none() && file.only_in.is_none()
}

/// How much is the same or not; of what was accepted the numbers alone are kept.
fn ending(review: &Review, comparison: &Comparison) -> String {
    match (comparison.files.iter().all(is_kept), comparison.same) {
        (false, true) => conclusion(comparison),
        (false, false) => format!("{}; every difference: --all", conclusion(comparison)),
        (true, true) => {
            let numbers: usize = review.counts.values().sum();
            let plural = if numbers == 1 { "" } else { "s" };
            let same = format!("same within the limits: {numbers} number{plural} and the recommended model");
            let causes = review.artifacts_line().filter(|_| !review.causes.is_empty()).map(|_| review.cause());
            [Some(same), review.artifacts_line(), causes, review.not_compared().map(str::to_owned)]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()
                .join("; ")
        }
        (true, false) => "different from what was accepted".to_owned(),
    }
}

/// What is printed: of one comparison at most [`LINES`], of several those that differ under their names.
fn lines(compared: &[Compared], all: bool) -> anyhow::Result<Vec<String>> {
    let several = compared.len() > 1;
    let mut lines = Vec::new();
    let mut same = Vec::new();
    for one in compared {
        let Some((review, comparison)) = one.review() else {
            lines.push(format!("{}: {}: {}", one.name, one.said_word(), one.problem().unwrap_or_default()));
            continue;
        };
        if comparison.same && !all {
            same.push((review.name.as_str(), ending(review, comparison)));
            let noted = several && (review.artifacts_line().is_some() || review.is_earlier);
            lines.extend(noted.then(|| format!("{}: {}", review.name, ending(review, comparison))));
            continue;
        }
        if several {
            lines.push(format!("{}:", review.name));
        }
        let most = if all { usize::MAX } else { LINES };
        let has_numbers = !review.counts.is_empty() || comparison.files.iter().all(is_kept);
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
