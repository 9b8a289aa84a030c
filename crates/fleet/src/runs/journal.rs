//! What is known of runs that ended: one line each, added the moment a run ends.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::{Deserialize, Serialize};

/// Folder of the journals in that of a fleet.
const JOURNALS: &str = "journal";
/// Exit codes of a run with a result: done, and no acceptable result, which the report explains.
const WITH_RESULT: [i32; 2] = [0, 4];
/// Exit codes that come again as long as nothing changes: usage and a record that is refused.
const FINAL: [i32; 2] = [2, 3];

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Ended {
    /// Digest of all that its result depends on; empty: the record could not be read.
    pub(crate) key: String,
    /// Its folder below that of the fleet.
    pub(crate) folder: String,
    /// Exit code; 128 and the number of the signal that ended it.
    pub(crate) exit_code: i32,
    /// What was said of it, where there is no result or none that is acceptable.
    pub(crate) error: String,
    /// Digest of `summary.json`, where there is a result.
    pub(crate) summary: Option<String>,
    /// Wall time, s: for the planning of larger fleets, in no table.
    pub(crate) seconds: f64,
}

impl Ended {
    /// Whether there is a result in the run folder.
    pub(crate) fn has_result(&self) -> bool {
        WITH_RESULT.contains(&self.exit_code)
    }

    /// Whether it needs not be run again: the result is there as it was written, or there will be none.
    pub(crate) fn stands(&self, fleet: &Path) -> bool {
        if self.has_result() {
            return self.summary.is_some() && self.summary == digest_of_summary(&fleet.join(&self.folder));
        }
        FINAL.contains(&self.exit_code) && !self.key.is_empty()
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
    pub(crate) fn add(&mut self, ended: &Ended) -> anyhow::Result<()> {
        let mut line = serde_json::to_string(ended)?;
        line.push('\n');
        self.file.write_all(line.as_bytes()).with_context(|| format!("cannot write {}", self.path.display()))
    }
}

/// The last known end of every run, by its folder and key. Lines that are cut off are passed over.
pub(crate) fn read_journals(fleet: &Path) -> anyhow::Result<HashMap<(String, String), Ended>> {
    let mut known = HashMap::new();
    let Ok(entries) = fs::read_dir(fleet.join(JOURNALS)) else { return Ok(known) };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    for path in paths {
        let text = fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        for line in String::from_utf8_lossy(&text).lines() {
            if let Ok(ended) = serde_json::from_str::<Ended>(line) {
                known.insert((ended.folder.clone(), ended.key.clone()), ended);
            }
        }
    }
    Ok(known)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(folder: &str, exit_code: i32) -> Ended {
        let folder = folder.to_owned();
        Ended { key: "k".to_owned(), folder, exit_code, error: String::new(), summary: None, seconds: 0.1 }
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
}
