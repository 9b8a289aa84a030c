//! Finds and reads what is to be compared.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crumple_artifact::{Artifact, refuse_named_pipe};
use crumple_diff::{
    CompareSettings, Comparison, DiffError, FileReport, Side, compare_artifacts, compare_json, head,
    tolerated_parameters,
};

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
