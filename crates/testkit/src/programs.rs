//! Starts the programs as a user does: the whole pipeline through `just`, or one stage on prepared inputs.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::sync::Once;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::places::workspace;

/// Longest wait for something that a fleet is about to do.
const PATIENCE: Duration = Duration::from_secs(600);

/// `just out=<fleet> <recipe> <records>`.
pub fn just_fleet(recipe: &str, records: &Path, fleet: &Path) -> Command {
    let mut command = just();
    command.arg(format!("out={}", fleet.display())).arg(recipe).arg(records);
    command
}

/// Files that are in one of two fleets alone or not the same in both: tables, page, every file of every run.
pub fn different_files(a: &Path, b: &Path) -> Vec<PathBuf> {
    let [a, b] = [digests_of_files(a), digests_of_files(b)];
    let names = a.keys().chain(b.keys()).collect::<BTreeSet<_>>();
    names.into_iter().filter(|name| a.get(*name) != b.get(*name)).cloned().collect()
}

/// Digest of every file of a fleet by its path, but for the journals (how long a run took), Snakemake's own files, and
/// the lines of a pipeline file that let a later `just run` see at once that nothing has changed.
fn digests_of_files(fleet: &Path) -> BTreeMap<PathBuf, blake3::Hash> {
    let mut digests = BTreeMap::new();
    let mut folders = vec![fleet.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("a folder of the fleet can be read").flatten() {
            let path = entry.path();
            let name = path.strip_prefix(fleet).expect("it is below the fleet").to_owned();
            if path.is_dir() {
                if !["journal", ".snakemake"].map(Path::new).contains(&name.as_path()) {
                    folders.push(path);
                }
            } else {
                let bytes = std::fs::read(&path).expect("a file of the fleet can be read");
                let mut hasher = blake3::Hasher::new();
                let is_pipeline = path.ends_with("0-pipeline.toml");
                for line in bytes.split_inclusive(|byte| *byte == b'\n') {
                    let is_of_end = line.starts_with(b"state = ") || line.starts_with(b"exit_code = ");
                    if !(is_pipeline && is_of_end) {
                        hasher.update(line);
                    }
                }
                digests.insert(name, hasher.finalize());
            }
        }
    }
    digests
}

/// Run folders that a journal says have ended, in the order in which they did.
pub fn ended_runs(journal: &Path) -> Vec<String> {
    let text = std::fs::read(journal).unwrap_or_default();
    let folder = |line: &str| -> Option<String> {
        let ended: Value = serde_json::from_str(line).ok()?;
        Some(ended["folder"].as_str()?.to_owned())
    };
    String::from_utf8_lossy(&text).lines().filter_map(folder).collect()
}

/// Waits until something is there, while a fleet runs. Panics where the fleet ends first or nothing comes.
pub fn wait_for<T>(fleet: &mut Child, what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let started = Instant::now();
    loop {
        if let Some(thing) = look() {
            return thing;
        }
        let status = fleet.try_wait().expect("the fleet is a child");
        assert!(status.is_none(), "the fleet ended before {what}: {status:?}");
        assert!(started.elapsed() < PATIENCE, "no {what} in {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Path of a program, e.g. `crumple-filter`, in the profile that `CRUMPLE_PROFILE` names as the justfile reads it;
/// everything is built first (a no-op once built).
pub fn binary(name: &str) -> PathBuf {
    static BUILT: Once = Once::new();
    BUILT.call_once(|| {
        let output = just().arg("build").output().expect("just is installed (scripts/setup.sh)");
        assert!(output.status.success(), "just build: {}", String::from_utf8_lossy(&output.stderr));
    });
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| workspace().join("target"), PathBuf::from);
    let is_dev = std::env::var("CRUMPLE_PROFILE").is_ok_and(|profile| profile == "dev");
    target.join(if is_dev { "debug" } else { "release" }).join(name)
}

/// `just` in the workspace.
pub fn just() -> Command {
    let mut command = Command::new("just");
    // What a test runner states of this package makes cargo build dependencies again that ask for it.
    std::env::vars_os()
        .map(|(name, _)| name)
        .filter(|name| name.to_string_lossy().starts_with("CARGO_PKG_"))
        .for_each(|name| _ = command.env_remove(name));
    command.current_dir(workspace()).arg("--justfile").arg(workspace().join("justfile"));
    command
}

/// `just <variables> out=<folder> run <input> <args>`.
pub fn run(variables: &[&str], folder: &Path, input: &Path, args: &[&str]) -> Output {
    just()
        .args(variables)
        .arg(format!("out={}", folder.display()))
        .arg("run")
        .arg(input)
        .args(args)
        .output()
        .expect("just is installed (scripts/setup.sh)")
}

/// The same, and it must succeed; returns `summary.json`.
pub fn summary_of(variables: &[&str], folder: &Path, input: &Path, args: &[&str]) -> Value {
    let output = run(variables, folder, input, args);
    assert!(output.status.success(), "{}: {}", input.display(), String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(folder.join("summary.json")).expect("summary.json is written");
    serde_json::from_str(&text).expect("summary.json is JSON")
}

/// Exit code and standard error of a command.
pub fn code_and_error(command: &mut Command) -> (i32, String) {
    let output = command.output().expect("the binary starts");
    (output.status.code().unwrap_or(-1), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// A number inside a JSON value by a path of keys, e.g. `["events", "dynamic_crush_m"]`.
pub fn number(value: &Value, path: &[&str]) -> f64 {
    let number = path.iter().fold(value, |v, key| &v[*key]);
    number.as_f64().unwrap_or_else(|| panic!("{path:?} is {number}, a number is needed"))
}

/// The names of a run folder's artifacts in order.
pub const ARTIFACTS: [&str; 7] = [
    "1-ingest.mcap",
    "2-filter.mcap",
    "3-integrate.mcap",
    "4-identify.mcap",
    "5-parameter-solve.mcap",
    "6-simulate.mcap",
    "7-predict.mcap",
];

/// A program that makes one artifact of another.
#[derive(Debug, Clone, Copy)]
pub struct Program {
    /// Path of the executable: `env!("CARGO_BIN_EXE_...")`.
    pub exe: &'static str,
    /// Name of the artifact it writes, beside its input.
    pub output: &'static str,
}

impl Program {
    /// Runs it and returns what it said.
    pub fn run(&self, input: &Path, flags: &[&str]) -> Output {
        Command::new(self.exe)
            .arg(input)
            .arg("-o")
            .arg(input.with_file_name(self.output))
            .args(flags)
            .output()
            .unwrap_or_else(|error| panic!("{}: {error}", self.exe))
    }

    /// Runs it, fails the test with what it said unless it ended well, and returns the path of what it wrote.
    pub fn written(&self, input: &Path, flags: &[&str]) -> PathBuf {
        let output = self.run(input, flags);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        input.with_file_name(self.output)
    }
}

/// The programs in `bin`, each on one thread, started in `folder`.
#[derive(Debug, Clone, Copy)]
pub struct Steps<'a> {
    /// Where the programs are.
    pub bin: &'a Path,
    /// Where they read and write.
    pub folder: &'a Path,
    /// The pipeline that each is given; without one, their own defaults.
    pub pipeline: Option<&'a Path>,
}

/// Why a step could not be made.
#[derive(Debug, thiserror::Error)]
pub enum StepError {
    /// A program did not start, or a file could not be written.
    #[error("{path}: {error}", path = .0.display(), error = .1)]
    File(PathBuf, io::Error),
    /// A program ended badly on a good record.
    #[error("{0}")]
    Program(String),
}

impl Steps<'_> {
    /// Writes a file below the folder, made with all above it. Errors: it cannot be written.
    pub fn write(&self, name: &str, contents: &str) -> Result<(), StepError> {
        let path = self.folder.join(name);
        let parent = path.parent().unwrap_or(self.folder);
        std::fs::create_dir_all(parent).map_err(|error| StepError::File(parent.to_owned(), error))?;
        std::fs::write(&path, contents).map_err(|error| StepError::File(path, error))
    }

    /// Removes the folder. Errors: it stays.
    pub fn remove_folder(&self) -> Result<(), StepError> {
        std::fs::remove_dir_all(self.folder).map_err(|error| StepError::File(self.folder.to_owned(), error))
    }

    /// Runs `crumple-<program>`; what it prints. Errors: it does not start, or ends with another code than 0 or 4 (no
    /// acceptable result, which is an answer).
    pub fn run(&self, program: &str, arguments: &[&str]) -> Result<String, StepError> {
        let path = self.bin.join(format!("crumple-{program}"));
        let mut command = Command::new(&path);
        command.args(arguments).arg("-q").current_dir(self.folder).env("RAYON_NUM_THREADS", "1");
        if let Some(pipeline) = self.pipeline {
            command.arg("--pipeline").arg(pipeline);
        }
        let output = command.output().map_err(|error| StepError::File(path, error))?;
        match output.status.code() {
            Some(0 | 4) => Ok(String::from_utf8_lossy(&output.stdout).into_owned()),
            _ => Err(StepError::Program(format!(
                "crumple-{program} {} in {}: {}",
                arguments.join(" "),
                self.folder.display(),
                String::from_utf8_lossy(&output.stderr)
            ))),
        }
    }
}

/// Records below a topic in what a stage printed with `--json`: rest of the topic, data.
pub fn records(printed: &str, below: &str) -> impl Iterator<Item = (String, Value)> {
    printed.lines().filter_map(move |line| {
        let mut record: Value = serde_json::from_str(line).ok()?;
        let rest = record["topic"].as_str()?.strip_prefix(below)?.to_owned();
        Some((rest, record["data"].take()))
    })
}

/// Whether a test runner asks for the tests of this program; it is told the one name then. A program that lists none
/// is never run.
pub fn asked_for_tests(name: &str) -> bool {
    let asked = |flag: &str| std::env::args().any(|argument| argument == flag);
    if asked("--list") && !asked("--ignored") {
        println!("{name}: test");
    }
    asked("--list")
}
