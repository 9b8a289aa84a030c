//! The runs of a fleet: which there are, which are up to date, how they are started side by side, how each ended.

use std::collections::{BTreeSet, HashMap};
use std::env::consts::EXE_SUFFIX;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Context;
use crumple_stage::{REASON_FILE, Usage, say};
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};
use tempfile::NamedTempFile;

use crate::command::Pipeline;
use crate::fleet::command::{Options, combinations};
use crate::fleet::records::{Digests, Record};
use crate::program::{Commands, is_one_program, own_command};
use crate::steps::exit_code_of;

// What is known of runs that ended: one line each, added the moment a run ends.

/// Folder of the journals in that of a fleet.
const JOURNALS: &str = "journal";

/// Exit codes of a run with a result: done, and no acceptable result, which the report explains.
const WITH_RESULT: [i32; 2] = [0, 4];

/// Exit codes that come again as long as nothing changes: usage and a record that is refused.
const FINAL: [i32; 2] = [2, 3];

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct JournalEntry {
    /// Digest of all that its result depends on; empty: the record could not be read.
    pub(crate) key: String,
    /// Its folder below that of the fleet.
    pub(crate) folder: String,
    /// Exit code; 128 and the number of the signal that ended it.
    pub(crate) exit_code: i32,
    /// What was said of it, where there is no result or none that is acceptable.
    pub(crate) error: String,
    /// The reason among it, where a program of the project told it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) reason: Option<String>,
    /// Digest of `summary.json`, where there is a result.
    pub(crate) summary: Option<String>,
    /// Wall time, s: for the planning of larger fleets, in no table.
    pub(crate) seconds: f64,
}

impl JournalEntry {
    /// Whether there is a result in the run folder.
    pub(crate) fn has_result(&self) -> bool {
        WITH_RESULT.contains(&self.exit_code)
    }

    /// Whether it needs not be run again: the result is there as it was written, or there will be none.
    pub(crate) fn stands(&self, fleet: &Path) -> bool {
        if self.has_result() {
            let folder = fleet.join(&self.folder);
            // A later run into the folder by itself may have failed.
            let is_of_last = crumple_stage::Pipeline::failure_in(&folder).is_none();
            return is_of_last && self.summary.is_some() && self.summary == digest_of_summary(&folder);
        }
        FINAL.contains(&self.exit_code) && !self.key.is_empty()
    }
}

/// A line of a journal.
#[derive(Serialize, Deserialize)]
struct JournalLine {
    #[serde(flatten)]
    ended: JournalEntry,
    /// Start of the digest of the rest; empty in earlier journals.
    #[serde(default)]
    check: String,
}

impl JournalLine {
    fn new(ended: &JournalEntry) -> anyhow::Result<Self> {
        let check = blake3::hash(serde_json::to_string(ended)?.as_bytes()).to_hex()[..16].to_owned();
        Ok(Self { ended: ended.clone(), check })
    }

    /// The entry, if it is as it was written.
    fn read(line: &str) -> Option<JournalEntry> {
        let Self { ended, check } = serde_json::from_str(line).ok()?;
        (check.is_empty() || Self::new(&ended).ok()?.check == check).then_some(ended)
    }
}

/// Digest of the summary in a run folder.
pub(crate) fn digest_of_summary(folder: &Path) -> Option<String> {
    let bytes = fs::read(folder.join("summary.json")).ok()?;
    Some(blake3::hash(&bytes).to_hex().to_string())
}

/// The journal that is written now.
#[derive(Debug)]
pub(crate) struct Journal {
    file: File,
    path: PathBuf,
}

impl Journal {
    /// Opens the journal of this part of a fleet, `all` or `3-of-20`; what is in it stays.
    pub(crate) fn open(fleet: &Path, part: &str) -> anyhow::Result<Self> {
        let path = fleet.join(JOURNALS).join(format!("{part}.jsonl"));
        let open = || -> io::Result<File> {
            fs::create_dir_all(fleet.join(JOURNALS))?;
            let mut file = File::options().create(true).append(true).open(&path)?;
            // A line that a killed fleet did not finish must not swallow the next one.
            file.write_all(if file.metadata()?.len() > 0 { b"\n" } else { b"" })?;
            Ok(file)
        };
        let file = open().with_context(|| format!("cannot write {}", path.display()))?;
        Ok(Self { file, path })
    }

    /// Adds a run, in one write.
    pub(crate) fn add(&mut self, ended: &JournalEntry) -> anyhow::Result<()> {
        let mut line = serde_json::to_string(&JournalLine::new(ended)?)?;
        line.push('\n');
        self.file.write_all(line.as_bytes()).with_context(|| format!("cannot write {}", self.path.display()))
    }
}

/// The last known end of every run, by its folder and key. Lines that are cut off or damaged are passed over.
pub(crate) fn read_journals(fleet: &Path) -> anyhow::Result<HashMap<(String, String), JournalEntry>> {
    let mut known = HashMap::new();
    let Ok(entries) = fs::read_dir(fleet.join(JOURNALS)) else { return Ok(known) };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        let text = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        for line in String::from_utf8_lossy(&text).lines() {
            if let Some(ended) = JournalLine::read(line) {
                known.insert((ended.folder.clone(), ended.key.clone()), ended);
            }
        }
    }
    Ok(known)
}

// Which runs a fleet has.

/// One run of a record.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    /// The record.
    pub(crate) record: Record,
    /// Pipeline as it is typed.
    pub(crate) pipeline: String,
    /// Name of the pipeline.
    pub(crate) pipeline_name: String,
    /// Options set for it, `STAGE.KEY=VALUE`.
    pub(crate) settings: Vec<String>,
    /// Its folder below that of the fleet.
    pub(crate) folder: String,
    /// Digest of all that its result depends on; `None`: the record cannot be read.
    pub(crate) key: Option<String>,
}

impl Run {
    /// The options set for it, as one text.
    pub(crate) fn settings(&self) -> String {
        self.settings.join(",")
    }

    /// `blake3:<hex>` of the record; empty where it cannot be read.
    pub(crate) fn record_digest(&self) -> &str {
        self.record.digests.as_ref().map_or("", |digests| &digests.record)
    }
}

/// The runs of all records with all pipelines and settings, in the order of the tables: by digest of the record, name
/// of the pipeline, settings, name of the record.
pub(crate) fn plan(records: &[Record], options: &Options) -> anyhow::Result<Vec<Run>> {
    let programs = digest_of_programs(&options.programs.commands()?).context("cannot read the programs")?;
    let settings = combinations(&options.sweeps);
    // Other pipelines may be laid over it.
    let default = fs::read(options.project.join("pipelines/default.toml")).unwrap_or_default();
    let mut runs = Vec::new();
    for typed in options.pipelines() {
        let pipeline = Pipeline::resolve(typed, &options.project);
        let content = match fs::read(&pipeline.file) {
            Ok(content) => content,
            // One that is built in.
            Err(_) => crumple_stage::Pipeline::read(&pipeline.file, None)?.to_string().into_bytes(),
        };
        for settings in &settings {
            let (typed_settings, flags) = (settings.join("\n"), options.flags() + &options.report_flags(""));
            let setup = setup(&[&content, &default, typed_settings.as_bytes(), flags.as_bytes(), programs.as_bytes()]);
            let variant = [vec![pipeline.name.clone()], settings.clone()].concat().join(",");
            runs.extend(records.iter().map(|record| Run {
                record: record.clone(),
                pipeline: typed.clone(),
                pipeline_name: pipeline.name.clone(),
                settings: settings.clone(),
                folder: format!("runs/{}/{}", record.name, folder_name(&variant, &pipeline.name)),
                key: record.digests.as_ref().map(|digests| key(digests, setup)),
            }));
        }
    }
    runs.sort_by_cached_key(|run| {
        (run.record_digest().to_owned(), run.pipeline_name.clone(), run.settings(), run.record.identity.clone())
    });
    let mut folders: Vec<&str> = runs.iter().map(|run| run.folder.as_str()).collect();
    folders.sort_unstable();
    if let Some(pair) = folders.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Usage::new(format!("two runs would share the folder {}", pair[0]))
            .hint("name each pipeline and each value once")
            .into());
    }
    Ok(runs)
}

/// Digest of all that a run depends on.
fn key(digests: &Digests, setup: [u8; 32]) -> String {
    blake3::hash(&[*digests.input.as_bytes(), setup].concat()).to_hex().to_string()
}

/// Digest of what all records have in common.
fn setup(parts: &[&[u8]]) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    for part in parts {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    *hasher.finalize().as_bytes()
}

/// A pipeline may lie in a folder; values must not make more of them.
fn folder_name(variant: &str, pipeline: &str) -> String {
    let settings = variant.strip_prefix(pipeline).unwrap_or_default();
    format!("{pipeline}{}", settings.replace('/', "-"))
}

/// The path of a run in the folder of a fleet.
pub(crate) fn path_in(fleet: &Path, run: &Run) -> PathBuf {
    fleet.join(&run.folder)
}

// Runs side by side.

/// Runs at a time, where none is typed.
pub(crate) fn jobs(options: &Options) -> usize {
    options.jobs.map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from)
}

/// Runs these records, several at a time, and writes down the end of each as it comes. Returns the ends in the order of
/// the runs.
pub(crate) fn run_all(
    runs: &[&Run],
    fleet: &Path,
    options: &Options,
    journal: &mut Journal,
) -> anyhow::Result<Vec<JournalEntry>> {
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let mut ends: Vec<Option<JournalEntry>> = vec![None; runs.len()];
    let mut progress = Progress::new(runs.len(), options.quiet);
    let journal = Mutex::new(journal);
    thread::scope(|scope| -> anyhow::Result<()> {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..jobs(options).min(runs.len()) {
            let (sender, next, stop, journal) = (sender.clone(), &next, &stop, &journal);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(run) = runs.get(number) else { return };
                    // Written before the next is begun: a fleet that is killed loses no more than what is under way.
                    let written = run_record(run, fleet, options).and_then(|ended| {
                        journal.lock().unwrap_or_else(PoisonError::into_inner).add(&ended).map(|()| ended)
                    });
                    if sender.send((number, written)).is_err() {
                        return;
                    }
                }
            });
        }
        drop(sender);
        for (number, written) in receiver {
            let ended = written.inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
            progress.advance(ended.has_result());
            ends[number] = Some(ended);
        }
        Ok(())
    })?;
    Ok(ends.into_iter().flatten().collect())
}

// Which programs a run is made with.

/// Programs of the project that no run is made with.
const OTHERS: [&str; 7] = [
    "crumple-fleet",
    "crumple-study",
    "crumple-together",
    "crumple-diff",
    "crumple-artifact",
    "crumple-export",
    "crumple-view",
];

/// Digest of the programs of the stages: of their commands as typed, of every file that stands in one, and of the
/// programs of the project beside this one. A program that another one starts is not seen.
pub(crate) fn digest_of_programs(commands: &Commands) -> io::Result<String> {
    let commands: Vec<&str> = commands.typed().collect();
    let words = commands.iter().flat_map(|command| command.split(|c: char| c.is_whitespace() || "'\"\\".contains(c)));
    let mut files: BTreeSet<PathBuf> = words.map(PathBuf::from).filter(|path| path.is_file()).collect();
    let own = std::env::current_exe()?;
    for entry in own.parent().into_iter().filter_map(|folder| fs::read_dir(folder).ok()).flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let name = name.strip_suffix(EXE_SUFFIX).unwrap_or(&name);
        let is_of_a_run = name.starts_with("crumple-") && !name.contains('.') && !OTHERS.contains(&name);
        if is_of_a_run && entry.path().is_file() && !is_one_program() {
            files.insert(entry.path());
        }
    }
    files.extend(is_one_program().then_some(own));
    let mut hasher = blake3::Hasher::new();
    hasher.update(commands.join("\n").as_bytes());
    for path in files {
        hasher.update_reader(File::open(&path)?)?;
    }
    Ok(hasher.finalize().to_hex().to_string())
}

// How far a fleet has come: a bar on a terminal, log lines elsewhere.

/// Time between log lines.
const LOG_EVERY: Duration = Duration::from_secs(10);

/// Progress of the runs.
#[derive(Debug)]
pub(crate) struct Progress {
    total: usize,
    done: usize,
    failed: usize,
    started: Instant,
    last_line: Instant,
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Progress {
    /// Of this many runs.
    pub(crate) fn new(total: usize, quiet: bool) -> Self {
        let bar = (!quiet && total > 0 && io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::new(total as u64);
            let style = "fleet {wide_bar} {pos} of {len}{msg}, {eta} left";
            ProgressStyle::with_template(style).map_or(bar.clone(), |style| bar.with_style(style))
        });
        let now = Instant::now();
        Self { total, done: 0, failed: 0, started: now, last_line: now, bar, quiet }
    }

    /// One more run has ended.
    pub(crate) fn advance(&mut self, has_result: bool) {
        self.done += 1;
        self.failed += usize::from(!has_result);
        if let Some(bar) = &self.bar {
            if self.failed > 0 {
                bar.set_message(format!(" ({} failed)", self.failed));
            }
            bar.set_position(self.done as u64);
        } else if !self.quiet && self.last_line.elapsed() >= LOG_EVERY {
            self.last_line = Instant::now();
            say(self.line());
        }
    }

    fn line(&self) -> String {
        let elapsed = self.started.elapsed();
        let left = elapsed.mul_f64((self.total - self.done) as f64 / self.done.max(1) as f64);
        format!(
            "fleet: {} of {} runs, {} failed, {:.1} a second, {} left",
            self.done,
            self.total,
            self.failed,
            self.done as f64 / elapsed.as_secs_f64().max(1e-3),
            in_words(left)
        )
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A time as people say it.
pub(crate) fn in_words(time: Duration) -> String {
    match time.as_secs() {
        seconds @ 0..90 => format!("{seconds} s"),
        seconds @ 90..5400 => format!("{} min", seconds.div_ceil(60)),
        seconds => format!("{:.1} h", seconds as f64 / 3600.0),
    }
}

// One run, from its start to its end.

/// Longest text that is kept of what a run said.
const LONGEST: usize = 2_000;

/// Runs a record and waits for its end. Whatever ends it, that is a result; an error is one of this program.
pub(crate) fn run_record(run: &Run, fleet: &Path, options: &Options) -> anyhow::Result<JournalEntry> {
    let folder = path_in(fleet, run);
    // What stands in the folder may be of other programs, which the stages do not look at.
    let force = if folder.exists() { " --force" } else { "" };
    let mut arguments: Vec<OsString> = vec!["--project".into(), options.project.clone().into()];
    arguments.extend(["--pipeline".into(), OsString::from(&run.pipeline)]);
    arguments.extend(["--out".into(), OsString::from(&folder)]);
    arguments.extend(["--flags".into(), format!("{} -q{force}", options.flags()).into()]);
    let of_report = options.report_flags(&run.folder);
    if !of_report.is_empty() {
        arguments.extend(["--flags-of-last".into(), of_report.into()]);
    }
    arguments.extend(run.settings.iter().flat_map(|setting| ["--set".into(), OsString::from(setting)]));
    arguments.extend(options.programs.arguments());
    arguments.extend(["--".into(), OsString::from(&run.record.path)]);
    let mut command = own_command("run");
    // Runs side by side keep the cores busy; threads of one run would only be in each other's way.
    if options.jobs != Some(1) {
        command.env("RAYON_NUM_THREADS", "1");
    }
    let told = NamedTempFile::new().context("cannot make a file for the reason of a run without a result")?;
    command.env(REASON_FILE, told.path());
    let started = Instant::now();
    let output = command
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .output()
        .with_context(|| format!("cannot start {}", command.get_program().display()))?;
    let exit_code = exit_code_of(output.status);
    let said = String::from_utf8_lossy(&output.stderr);
    let reason = fs::read_to_string(told.path()).ok().filter(|reason| !reason.is_empty());
    let mut ended = JournalEntry {
        key: run.key.clone().unwrap_or_default(),
        folder: run.folder.clone(),
        exit_code,
        error: if exit_code == 0 { String::new() } else { without_places(&said, run, &folder, &options.project) },
        reason: reason.map(|reason| without_places(&reason, run, &folder, &options.project)),
        summary: None,
        seconds: (started.elapsed().as_secs_f64() * 1e3).round() / 1e3,
    };
    if ended.has_result() {
        ended.summary = digest_of_summary(&folder);
    }
    Ok(ended)
}

/// What a run said, without the folders that it was made in: the same wherever a fleet lies.
fn without_places(said: &str, run: &Run, folder: &Path, project: &Path) -> String {
    let mut text = said.replace(&run.record.path.display().to_string(), &run.record.identity);
    for (place, short) in [(folder, run.folder.as_str()), (project, ".")] {
        let place = place.display().to_string();
        if place.len() > 1 {
            text = text.replace(&place, short);
        }
    }
    let end = text.char_indices().nth(LONGEST).map_or(text.len(), |(at, _)| at);
    text[..end].trim().to_owned()
}

#[cfg(test)]
mod tests {

    use super::*;

    fn ended(folder: &str, exit_code: i32) -> JournalEntry {
        let folder = folder.to_owned();
        JournalEntry {
            key: "k".to_owned(),
            folder,
            exit_code,
            error: String::new(),
            reason: None,
            summary: None,
            seconds: 0.1,
        }
    }

    #[test]
    fn a_line_that_was_cut_off_costs_that_line_alone() {
        let fleet = tempfile::tempdir().unwrap();
        Journal::open(fleet.path(), "all").unwrap().add(&ended("a", 0)).unwrap();
        let path = fleet.path().join("journal/all.jsonl");
        let mut file = File::options().append(true).open(&path).unwrap();
        file.write_all(b"{\"key\": \"k\", \"fol").unwrap();
        Journal::open(fleet.path(), "all").unwrap().add(&ended("b", 3)).unwrap();
        Journal::open(fleet.path(), "2-of-2").unwrap().add(&ended("a", 4)).unwrap();
        let known = read_journals(fleet.path()).unwrap();
        assert_eq!(known.len(), 2);
        assert_eq!(known[&("b".to_owned(), "k".to_owned())].exit_code, 3);
    }

    #[test]
    fn a_damaged_line_is_not_believed_and_one_without_a_checksum_is() {
        let line = serde_json::to_string(&JournalLine::new(&ended("a", 3)).unwrap()).unwrap();
        assert_eq!(JournalLine::read(&line), Some(ended("a", 3)));
        assert_eq!(JournalLine::read(&line.replace(":3,", ":2,")), None);
        assert_eq!(JournalLine::read(&serde_json::to_string(&ended("a", 3)).unwrap()), Some(ended("a", 3)));
    }

    #[test]
    fn a_result_stands_while_it_is_as_written_and_an_unforeseen_failure_never() {
        let fleet = tempfile::tempdir().unwrap();
        fs::create_dir(fleet.path().join("a")).unwrap();
        fs::write(fleet.path().join("a/summary.json"), "{}").unwrap();
        let mut done = ended("a", 0);
        assert!(!done.stands(fleet.path()));
        done.summary = digest_of_summary(&fleet.path().join("a"));
        assert!(done.stands(fleet.path()));
        fs::write(fleet.path().join("a/summary.json"), "{ }").unwrap();
        assert!(!done.stands(fleet.path()));
        let stands = [1, 2, 3, 137].map(|code| ended("b", code).stands(fleet.path()));
        assert_eq!(stands, [false, true, true, false]);
    }

    #[test]
    fn times_are_said_in_the_unit_that_fits() {
        let said = [59, 119, 7200].map(|seconds| in_words(Duration::from_secs(seconds)));
        assert_eq!(said, ["59 s", "2 min", "2.0 h"]);
    }
}
