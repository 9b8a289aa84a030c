//! Fleets as a user makes them, and what they leave on the disk.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use crate::programs::pipeline::just;

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
        let ended: serde_json::Value = serde_json::from_str(line).ok()?;
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
