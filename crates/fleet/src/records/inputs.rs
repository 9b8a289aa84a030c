//! What stands on the command line: folders, lists of paths, patterns, files.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_stage::{Refused, Usage};

use crate::records::folder::records_below;

/// Records of one word of the command line.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Meant {
    /// Each as a path, and as it is called in the tables.
    pub(crate) records: Vec<(PathBuf, String)>,
    /// Files of folders that are no records.
    pub(crate) others: Vec<PathBuf>,
}

/// The records that a word means: a folder with all below it; `@LIST`, or a text file that begins with the path of a
/// file: the paths in it, one a line; a pattern with `*`, `?` or `**`; else the file itself.
pub(crate) fn records_meant(word: &str) -> anyhow::Result<Meant> {
    if let Some(list) = word.strip_prefix('@') {
        return of_list(Path::new(list));
    }
    let path = Path::new(word);
    if path.is_dir() {
        let below = records_below(path)?;
        let records = below.records.into_iter().map(|record| {
            let identity = identity(&record, path);
            (record, identity)
        });
        return Ok(Meant { records: records.collect(), others: below.others });
    }
    if path.is_file() {
        let is_text = path.extension().is_some_and(|ending| ending == "txt" || ending == "lst");
        if is_text && paths_of_list(path)?.first().is_some_and(|first| first.exists()) {
            return of_list(path);
        }
        return Ok(Meant { records: vec![(path.to_owned(), file_name(path))], others: Vec::new() });
    }
    if word.contains(['*', '?', '[']) {
        return of_pattern(word);
    }
    Err(Refused::new(format!("{word}: no such file or folder"))
        .expected("a folder of records, a list of paths (@list.txt), a pattern ('tests/*.csv') or records")
        .hint("check the path")
        .into())
}

fn of_list(list: &Path) -> anyhow::Result<Meant> {
    let folder = list.parent().unwrap_or(Path::new(""));
    let records = paths_of_list(list)?.into_iter().map(|path| {
        let identity = identity(&path, folder);
        (path, identity)
    });
    Ok(Meant { records: records.collect(), others: Vec::new() })
}

/// Paths in a list are relative to its folder; empty lines and those with `#` are passed over.
fn paths_of_list(list: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let bytes = fs::read(list).map_err(|error| {
        Refused::new(format!("{}: {error}", list.display()))
            .expected("a list of paths, one a line")
            .hint("check the path")
    })?;
    let text = String::from_utf8_lossy(&bytes);
    let folder = list.parent().unwrap_or(Path::new(""));
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    Ok(lines.map(|line| folder.join(line)).collect())
}

fn of_pattern(pattern: &str) -> anyhow::Result<Meant> {
    let usage = || Usage::new(format!("{pattern} is no pattern of paths")).hint("for example 'tests/**/*.csv'");
    let paths = glob::glob(pattern).with_context(usage)?;
    let literal = pattern.split(['*', '?', '[']).next().unwrap_or_default();
    let folder = literal.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut records = Vec::new();
    for path in paths {
        let path = path.with_context(|| format!("cannot look for {pattern}"))?;
        if path.is_file() {
            let identity = identity(&path, Path::new(folder));
            records.push((path, identity));
        }
    }
    if records.is_empty() {
        return Err(Refused::new(format!("no file fits {pattern}"))
            .expected("a pattern that fits records")
            .hint("check it with ls")
            .into());
    }
    Ok(Meant { records, others: Vec::new() })
}

/// The path below a folder, as it is wherever that folder lies.
fn identity(path: &Path, folder: &Path) -> String {
    path.strip_prefix(folder).unwrap_or(path).to_string_lossy().into_owned()
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_lists_patterns_and_files_mean_the_same_records() {
        let root = tempfile::tempdir().unwrap();
        let tests = root.path().join("tests");
        fs::create_dir_all(tests.join("b")).unwrap();
        let table = "time_s,a\n0,1\n1,2\n2,3\n";
        fs::write(tests.join("a.csv"), table).unwrap();
        fs::write(tests.join("b/c.csv"), table).unwrap();
        fs::write(tests.join("list.txt"), "# two\na.csv\n\nb/c.csv\n").unwrap();
        fs::write(tests.join("table.txt"), table).unwrap();
        let word = |name: &str| tests.join(name).display().to_string();
        let identities = |word: &str| -> Vec<String> {
            records_meant(word).unwrap().records.into_iter().map(|(_, identity)| identity).collect()
        };
        for word in [word("list.txt"), format!("@{}", word("list.txt")), word("**/*.csv")] {
            assert_eq!(identities(&word), ["a.csv", "b/c.csv"], "{word}");
        }
        assert_eq!(identities(&tests.display().to_string()), ["a.csv", "b/c.csv", "table.txt"]);
        assert_eq!(identities(&word("table.txt")), ["table.txt"]);
        for missing in [word("none"), word("*.xyz"), format!("@{}", word("none.txt"))] {
            assert!(records_meant(&missing).is_err(), "{missing}");
        }
    }
}
