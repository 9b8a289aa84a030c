//! Instructions of whole runs, by stage, and of kernels: what the load of a machine cannot move.
//!
//! Counted by callgrind on one thread. A run is counted twice: in one process, and as the chain of stage programs, each
//! of which is a process with a count of its own. Counts hold for one compiler and one kind of processor: programs that
//! choose their vectors by the processor count others elsewhere.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::benchmark::{Figure, made_crash};
use crate::prediction_error::{KINDS, made};
use crate::workspace;

/// Above this ratio to what is accepted a stage, a run or a kernel has become slower. Ours.
const MOST: f64 = 1.03;
/// Counts of a stage below this are mostly the start of its process.
const LEAST: u64 = 20_000_000;
/// The fill and copy of the C library by one instruction a byte would count bytes.
const NO_STRING_INSTRUCTIONS: &str =
    "glibc.cpu.x86_rep_stosb_threshold=1000000000:glibc.cpu.x86_rep_movsb_threshold=1000000000";
/// The kind of made cars whose sensor rings, and the car that is counted.
const RINGING: (&str, usize) = ("local mode under the sensor", 1);

/// Instructions of a run of a record.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Count {
    /// `crumple run`.
    pub run: u64,
    /// Each stage as a program of its own.
    pub stages: BTreeMap<String, u64>,
}

/// Counts of whole runs by record, and of kernels by what they do.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Of whole runs, by record.
    pub runs: BTreeMap<String, Count>,
    /// Of one call of each kernel, by what it does.
    pub kernels: BTreeMap<String, u64>,
}

/// The line of docs/performance.md above its table.
pub const BEGIN: &str = "<!-- just instructions writes this table -->\n";
/// The line below it.
pub const END: &str = "<!-- end of the instructions -->";

/// The records that are counted, with the names of their files, written where they do not lie in the project.
fn records(folder: &Path) -> io::Result<Vec<(String, std::path::PathBuf)>> {
    let fixture = |name: &str| (format!("fixture {name}"), workspace().join("fixtures").join(name).join("crash.csv"));
    let mut records: Vec<_> = ["kelvin", "elastoplastic", "double", "noisy"].map(fixture).into();
    let (kind, number) = RINGING;
    let ringing = KINDS.iter().find(|known| known.name == kind).map(|kind| made(kind, number).0);
    let ringing = ringing.ok_or_else(|| io::Error::other(format!("no kind of made cars is called {kind}")))?;
    for (name, file, text) in
        [("one crash at 10 kHz", "made.csv", made_crash(1e4)), ("made car, its sensor rings", "ring.csv", ringing)]
    {
        let path = folder.join(file);
        fs::write(&path, text)?;
        records.push((name.to_owned(), path));
    }
    Ok(records)
}

/// Counts the runs of all records, or of those whose name holds one of these words, by the programs in `bin`.
///
/// # Errors
/// Valgrind is missing; a run fails.
pub fn runs(bin: &Path, wanted: &[String], folder: &Path) -> io::Result<BTreeMap<String, Count>> {
    fs::create_dir_all(folder)?;
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|word| name.contains(word.as_str()));
    let records: Vec<_> = records(folder)?.into_iter().filter(|(name, _)| is_wanted(name)).collect();
    if records.is_empty() {
        return Err(io::Error::other(format!("no record is called {}", wanted.join(" or "))));
    }
    let mut counts = BTreeMap::new();
    for (name, record) in records {
        let out = folder.join("out");
        let mut run = callgrind(folder)?;
        run.arg(bin.join("crumple")).arg("run").arg(&record).arg("-o").arg(out.join("run"));
        let run: u64 = counted(&mut run, folder)?.values().sum();
        let mut chain = callgrind(folder)?;
        chain.arg("--trace-children=yes").arg(bin.join("crumple-run")).arg("--project").arg(workspace());
        chain.arg("--pipeline").arg("default").arg("--out").arg(out.join("chain")).arg("--").arg(&record);
        chain.env("PATH", path_with(bin));
        let stages = counted(&mut chain, folder)?;
        counts.insert(name, Count { run, stages });
        fs::remove_dir_all(&out)?;
    }
    Ok(counts)
}

/// The path of the environment with the programs in front.
fn path_with(bin: &Path) -> std::ffi::OsString {
    let before = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::iter::once(bin.to_owned()).chain(std::env::split_paths(&before));
    std::env::join_paths(paths).unwrap_or(before)
}

/// The ending of files of counts.
const COUNT_FILE: &str = "callgrind";

/// A command behind callgrind, one thread, a file for each process.
fn callgrind(folder: &Path) -> io::Result<Command> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == COUNT_FILE) {
            fs::remove_file(path)?;
        }
    }
    let mut command = Command::new("valgrind");
    command.arg("--tool=callgrind").arg(format!("--callgrind-out-file={}/%p.{COUNT_FILE}", folder.display()));
    command.env("RAYON_NUM_THREADS", "1").env("GLIBC_TUNABLES", NO_STRING_INSTRUCTIONS);
    Ok(command)
}

/// What a command and its children counted, by the name of the program without `crumple-`.
fn counted(command: &mut Command, folder: &Path) -> io::Result<BTreeMap<String, u64>> {
    let output = command.output().map_err(|error| io::Error::other(format!("valgrind does not start: {error}")))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(io::Error::other(format!("{command:?} ended with {}: {said}", output.status)));
    }
    let mut counts = BTreeMap::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == COUNT_FILE)
            && let Some((program, count)) = of_process(&fs::read_to_string(&path)?)
        {
            *counts.entry(program).or_default() += count;
        }
    }
    Ok(counts)
}

/// The program and the instructions of a process, from its file: `cmd:` and `summary:` (callgrind's format).
fn of_process(text: &str) -> Option<(String, u64)> {
    let value = |key: &str| text.lines().find_map(|line| line.strip_prefix(key)).map(str::trim);
    let program = Path::new(value("cmd:")?.split_whitespace().next()?).file_name()?.to_string_lossy().into_owned();
    let count = value("summary:").or_else(|| value("totals:"))?.parse().ok()?;
    Some((program.strip_prefix("crumple-").unwrap_or(&program).to_owned(), count))
}

/// Counts of the kernels that the benchmarks called: `figures.ndjson` of a folder says which call is of which kernel,
/// and callgrind wrote a file `PROCESS.CALL` behind each.
///
/// # Errors
/// A file that cannot be read, or that holds no count.
pub fn kernels(folder: &Path) -> io::Result<BTreeMap<String, u64>> {
    let mut counts = BTreeMap::new();
    for line in fs::read_to_string(folder.join("figures.ndjson"))?.lines() {
        let figure: Figure = serde_json::from_str(line)?;
        let Some((process, call)) = figure.call.filter(|_| figure.aim_s.is_some()) else { continue };
        let path = folder.join(format!("{process}.{call}"));
        let text =
            fs::read_to_string(&path).map_err(|error| io::Error::other(format!("{}: {error}", path.display())))?;
        let (_, count) =
            of_process(&text).ok_or_else(|| io::Error::other(format!("{} holds no count", path.display())))?;
        counts.insert(figure.work.trim().to_owned(), count);
    }
    Ok(counts)
}

/// What has become slower than it may, each in a line.
pub fn slower(counts: &Counts, accepted: &Counts) -> Vec<String> {
    let mut slower = Vec::new();
    for (record, count) in &counts.runs {
        let Some(before) = accepted.runs.get(record) else { continue };
        let stages = count.stages.iter().map(|(stage, now)| (stage.as_str(), *now, before.stages.get(stage).copied()));
        for (what, now, before) in stages.chain([("the whole run", count.run, Some(before.run))]) {
            let Some(before) = before.filter(|before| *before >= LEAST) else { continue };
            let ratio = now as f64 / before as f64;
            if ratio > MOST {
                slower.push(format!("{record}: {what} takes {ratio:.3} of what is accepted, at most {MOST} is"));
            }
        }
    }
    for (kernel, now) in &counts.kernels {
        let ratio = accepted.kernels.get(kernel).map_or(0.0, |before| *now as f64 / *before as f64);
        if ratio > MOST {
            slower.push(format!("{kernel} takes {ratio:.3} of what is accepted, at most {MOST} is"));
        }
    }
    slower
}

/// The table: millions of instructions, each with its ratio to what is accepted.
pub fn table(counts: &Counts, accepted: &Counts) -> String {
    let mut stages: Vec<&str> = Vec::new();
    for stage in ["ingest", "filter", "integrate", "identify", "parameter-solve", "simulate", "predict", "report"] {
        if counts.runs.values().any(|count| count.stages.contains_key(stage)) {
            stages.push(stage);
        }
    }
    let mut text = format!("| record | whole run | {} |\n|---|--:|", stages.join(" | "));
    text += &"--:|".repeat(stages.len());
    text.push('\n');
    let cell = |now: Option<u64>, before: Option<u64>| match (now, before) {
        (None, _) => String::new(),
        (Some(now), None) => millions(now),
        (Some(now), Some(before)) => format!("{} ({:.2})", millions(now), now as f64 / before.max(1) as f64),
    };
    for (record, count) in &counts.runs {
        let before = accepted.runs.get(record);
        let of_stage = |stage: &&str| {
            cell(count.stages.get(*stage).copied(), before.and_then(|before| before.stages.get(*stage).copied()))
        };
        let whole = cell(Some(count.run), before.map(|before| before.run));
        let cells: Vec<String> = stages.iter().map(of_stage).collect();
        text += &format!("| {record} | {whole} | {} |\n", cells.join(" | "));
    }
    if !counts.kernels.is_empty() {
        text += "\n| kernel | instructions |\n|---|--:|\n";
    }
    for (kernel, now) in &counts.kernels {
        text += &format!("| {kernel} | {} |\n", cell(Some(*now), accepted.kernels.get(kernel).copied()));
    }
    text
}

/// Millions with three digits at least.
fn millions(count: u64) -> String {
    let millions = 1e-6 * count as f64;
    let decimals = if millions < 1.0 { 3 } else { usize::from(millions < 100.0) };
    format!("{millions:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(run: u64, solve: u64) -> Count {
        Count { run, stages: BTreeMap::from([("parameter-solve".to_owned(), solve), ("filter".to_owned(), 5_000_000)]) }
    }

    #[test]
    fn a_process_has_a_program_and_a_count() {
        let text = "version: 1\ncreator: callgrind\npid: 7\ncmd: /a/crumple-filter 1.mcap -o 2.mcap\nevents: Ir\n\
                    summary: 7340032\n";
        assert_eq!(of_process(text), Some(("filter".to_owned(), 7_340_032)));
        assert_eq!(of_process("cmd: /bin/crumple run\ntotals: 12\n"), Some(("crumple".to_owned(), 12)));
        assert_eq!(of_process("cmd: x\n"), None);
    }

    #[test]
    fn a_stage_that_is_slower_is_named_with_its_record() {
        let of = |name: &str, run, solve, kernel| Counts {
            runs: BTreeMap::from([(name.to_owned(), count(run, solve))]),
            kernels: BTreeMap::from([("ERA".to_owned(), kernel)]),
        };
        let accepted = of("kelvin", 1_000_000_000, 600_000_000, 1_000_000);
        let now = |run, solve| of("kelvin", run, solve, 1_020_000);
        assert!(slower(&now(1_029_000_000, 617_000_000), &accepted).is_empty());
        let found = slower(&now(1_040_000_000, 640_000_000), &accepted);
        assert!(found.len() == 2 && found[0].starts_with("kelvin: parameter-solve takes 1.067"), "{found:?}");
        // What was not accepted yet, and what is mostly the start of a process, is not judged.
        assert!(slower(&of("new", 9, 9, 9), &accepted).is_empty());
        assert!(slower(&of("new", 9, 9, 1_040_000), &accepted)[0].starts_with("ERA takes 1.040"));
        let table = table(&now(1_040_000_000, 640_000_000), &accepted);
        assert!(table.contains("| kelvin | 1040 (1.04) | 5.0 (1.00) | 640 (1.07) |"), "{table}");
        assert!(table.ends_with("| ERA | 1.0 (1.02) |\n"), "{table}");
    }
}
