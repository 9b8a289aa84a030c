//! The records below a folder.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_stage::RefuseExt;

use crate::records::contents::{Contents, contents, ending};

/// What is below a folder.
#[derive(Debug, Default)]
pub(crate) struct Below {
    /// Files that stand for a record, in the order of their paths.
    pub(crate) records: Vec<PathBuf>,
    /// Files that are none.
    pub(crate) others: Vec<PathBuf>,
}

/// Looks through a folder and all folders below it. A file that belongs to a record (a channel of a test, a sidecar) is
/// none of its own; run folders and hidden files are passed over.
pub(crate) fn records_below(folder: &Path) -> anyhow::Result<Below> {
    let mut below = Below::default();
    walk(folder, &mut BTreeSet::new(), &mut below)?;
    below.records.sort();
    Ok(below)
}

fn walk(folder: &Path, companions: &mut BTreeSet<PathBuf>, below: &mut Below) -> anyhow::Result<()> {
    let cannot_read = || format!("cannot read the folder {}", folder.display());
    let mut files = Vec::new();
    let mut folders = Vec::new();
    for entry in fs::read_dir(folder).refuse().with_context(cannot_read)? {
        let path = entry.with_context(cannot_read)?.path();
        let is_hidden = path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        match path.is_dir() {
            _ if is_hidden => {}
            true => folders.push(path),
            false => files.push(path),
        }
    }
    if is_run_folder(&files) {
        return Ok(());
    }
    files.sort_by_cached_key(|path| (order(path), path.clone()));
    folders.sort();
    for path in &files {
        if companions.contains(path) || ending(path) == "toml" {
            continue;
        }
        let contents = contents(path).refuse().with_context(|| format!("cannot read {}", path.display()))?;
        let Contents::Record(reader) = contents else {
            let list = if matches!(contents, Contents::Other) { &mut below.others } else { &mut below.records };
            list.push(path.clone());
            continue;
        };
        below.records.push(path.clone());
        let main = file_name(path);
        let mut places = files.clone();
        if reader.spans_folders() {
            for channels in folders.iter().filter(|folder| file_name(folder).eq_ignore_ascii_case("channel")) {
                places.extend(fs::read_dir(channels).with_context(cannot_read)?.flatten().map(|entry| entry.path()));
            }
        }
        companions.extend(places.into_iter().filter(|p| p != path && reader.companion(&main, &file_name(p))));
    }
    folders.iter().try_for_each(|folder| walk(folder, companions, below))
}

/// Files that describe a test come before those of its channels.
fn order(path: &Path) -> usize {
    const FIRST: [&str; 4] = ["ev5", "mme", "chn", "tdm"];
    let ending = ending(path);
    FIRST.iter().position(|first| *first == ending).unwrap_or(FIRST.len())
}

fn is_run_folder(files: &[PathBuf]) -> bool {
    ["1-ingest.mcap", "summary.json"].iter().all(|name| files.iter().any(|path| path.ends_with(name)))
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sidecars_channels_results_and_texts_are_no_records() {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        let table = "time_s,a\n0,1\n1,2\n2,3\n";
        for name in ["b/crash.csv", "a.csv", ".hidden.csv", "runs/a/default/x.csv"] {
            write(name, table);
        }
        write("a.csv.toml", "mass = \"900 kg\"\n");
        write("README.md", "words");
        write("runs/a/default/1-ingest.mcap", "");
        write("runs/a/default/summary.json", "{}");
        let below = records_below(root.path()).unwrap();
        let names = |paths: &[PathBuf]| -> Vec<String> {
            paths.iter().map(|p| p.strip_prefix(root.path()).unwrap().display().to_string()).collect()
        };
        assert_eq!(names(&below.records), ["a.csv", "b/crash.csv"]);
        assert_eq!(names(&below.others), ["README.md"]);
    }
}
