//! Release programs one after another in a folder, as the benchmarks run them on cars they make.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

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
#[derive(Debug)]
pub enum StepError {
    /// A program did not start, or a file could not be written.
    File(PathBuf, io::Error),
    /// A program ended badly on a good record.
    Program(String),
}

impl std::fmt::Display for StepError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Program(said) => f.write_str(said),
        }
    }
}

impl std::error::Error for StepError {}

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
