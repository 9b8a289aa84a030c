//! The records of a fleet: found in folders, lists and patterns, known by the content of their files, named.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_ingest::{Bundle, READERS, Reader, RecordDigests, is_ending_of_a_record};
use crumple_stage::{RefuseExt, Refused, Usage};
use rayon::prelude::*;

use crate::fleet::command::Batch;

// What a file in a folder is: a record, or something beside it.

/// Bytes of a file that its reader is recognised by.
const HEAD: u64 = 8192;

/// Endings of text files that are records if they hold rows of numbers.
const TABLES: [&str; 5] = ["txt", "dat", "asc", "prn", ""];

/// Name of the reader that takes any text.
const ANY_TEXT: &str = "csv";

/// What a file is.
#[derive(Clone, Copy)]
pub(crate) enum Contents {
    /// A record of a format that is recognised.
    Record(&'static Reader),
    /// A record by its ending: one that is empty or damaged is a row of the fleet.
    NamedRecord,
    /// No record.
    Other,
}

/// Looks into a file.
pub(crate) fn contents(path: &Path) -> io::Result<Contents> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    let ending = ending(path);
    let by_name = if is_ending_of_a_record(&ending) { Contents::NamedRecord } else { Contents::Other };
    if head.trim_ascii().is_empty() {
        return Ok(by_name);
    }
    Ok(match READERS.iter().copied().find(|reader| (reader.recognises)(&head)) {
        Some(reader) if reader.format != ANY_TEXT => Contents::Record(reader),
        Some(reader) if TABLES.contains(&ending.as_str()) && has_rows_of_numbers(&head) => Contents::Record(reader),
        _ => by_name,
    })
}

/// StageExit of a file name in small letters.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Whether three lines or more are two numbers or more each.
fn has_rows_of_numbers(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    let is_row = |line: &&str| {
        let cells = line.split([',', ';', '\t', ' ']).filter(|cell| !cell.is_empty());
        let numbers: Vec<bool> = cells.map(|cell| cell.trim().parse::<f64>().is_ok()).collect();
        numbers.len() > 1 && numbers.iter().all(|is_number| *is_number)
    };
    text.lines().filter(is_row).count() > 2
}

// The records below a folder.

/// What is below a folder.
#[derive(Debug, Default)]
pub(crate) struct Below {
    /// Files that stand for a record, in the order of their paths.
    pub(crate) records: Vec<PathBuf>,
    /// Files that are none.
    pub(crate) others: Vec<PathBuf>,
}

/// Looks through a folder and all folders below it. A file that belongs to a record (a channel of a test, a sidecar) is
/// none of its own; run folders and hidden files are passed over. A file or a folder that cannot be read stands for a
/// record, whose row says so.
pub(crate) fn records_below(folder: &Path) -> anyhow::Result<Below> {
    let mut below = Below::default();
    walk(folder, &mut BTreeSet::new(), &mut below)
        .refuse()
        .with_context(|| format!("cannot read the folder {}", folder.display()))?;
    below.records.sort();
    Ok(below)
}

fn walk(folder: &Path, companions: &mut BTreeSet<PathBuf>, below: &mut Below) -> io::Result<()> {
    let mut files = Vec::new();
    let mut folders = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let is_hidden = path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
        match path.is_dir() {
            _ if is_hidden => {}
            // A link to the folder that it is in, or to one above, has no records of its own.
            true if path.is_symlink() && fs::canonicalize(folder)?.starts_with(fs::canonicalize(&path)?) => {}
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
        let contents = contents(path).unwrap_or(Contents::NamedRecord);
        let Contents::Record(reader) = contents else {
            let list = if matches!(contents, Contents::Other) { &mut below.others } else { &mut below.records };
            list.push(path.clone());
            continue;
        };
        below.records.push(path.clone());
        let main = file_name(path);
        let mut places = files.clone();
        if reader.spans_folders {
            for channels in folders.iter().filter(|folder| file_name(folder).eq_ignore_ascii_case("channel")) {
                let channels = fs::read_dir(channels).into_iter().flatten().flatten();
                places.extend(channels.map(|entry| entry.path()));
            }
        }
        companions.extend(places.into_iter().filter(|p| p != path && (reader.companion)(&main, &file_name(p))));
    }
    for folder in folders {
        if walk(&folder, companions, below).is_err() {
            below.records.push(folder);
        }
    }
    Ok(())
}

/// Endings of files that describe a test, whose channels are in other files.
const FIRST: [&str; 4] = ["ev5", "mme", "chn", "tdm"];

/// Files that describe a test come before those of its channels.
fn order(path: &Path) -> usize {
    let ending = ending(path);
    FIRST.iter().position(|first| *first == ending).unwrap_or(FIRST.len())
}

/// Whether a record of this name has its channels in other files.
pub(crate) fn spans_files(path: &Path) -> bool {
    order(path) < FIRST.len()
}

fn is_run_folder(files: &[PathBuf]) -> bool {
    ["1-ingest.mcap", "summary.json"].iter().all(|name| files.iter().any(|path| path.ends_with(name)))
}

// What stands on the command line: folders, lists of paths, patterns, files.

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
    if pattern.split('/').skip_while(|part| !part.contains(['*', '?', '['])).any(|part| part == "..") {
        let problem = format!("{pattern} goes up behind a wildcard");
        return Err(Usage::new(problem).hint("name the folder above the wildcard: 'tests/**/*.csv'").into());
    }
    let paths = glob::glob(pattern).with_context(usage)?;
    let literal = pattern.split(['*', '?', '[']).next().unwrap_or_default();
    let folder = literal.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut records = Vec::new();
    for path in paths {
        let (path, is_read) = match path {
            Ok(path) => (path, true),
            Err(error) => (error.path().to_owned(), false),
        };
        if path.is_file() || !path.exists() || !is_read {
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

pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

// Names of the folders in which records are run.

/// The name of each record's folder: the stem of its file, as `just run` names it; where several share one (also on a
/// disk that knows no capitals), with the start of the digest of what the record is called.
pub(crate) fn names(identities: &[&str]) -> Vec<String> {
    let stems: Vec<String> = identities.iter().map(|identity| stem(identity)).collect();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for stem in &stems {
        *counts.entry(stem.to_lowercase()).or_default() += 1;
    }
    let name = |(stem, identity): (&String, &&str)| match counts.get(&stem.to_lowercase()) {
        Some(1) => stem.clone(),
        _ => format!("{stem}-{}", &blake3::hash(identity.as_bytes()).to_hex()[..8]),
    };
    stems.iter().zip(identities).map(name).collect()
}

fn stem(identity: &str) -> String {
    Path::new(identity).file_stem().map_or_else(|| "record".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

// A record of the fleet.

/// A record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Record {
    /// Where it is.
    pub(crate) path: PathBuf,
    /// What it is called in the tables: its path below what was typed.
    pub(crate) identity: String,
    /// Name of its folder among the runs.
    pub(crate) name: String,
    /// Its content; `None`: there is no file.
    pub(crate) digests: Option<Digests>,
}

/// What a record is, by its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Digests {
    /// `blake3:<hex>` of the record, as `crumple-ingest` states it; empty where its format is not known.
    pub(crate) record: String,
    /// Of all that a run reads: format, name, record and sidecar.
    pub(crate) input: blake3::Hash,
}

/// The records that are meant by the words of the command line, each once, or those of one part of the fleet, and the
/// other files in their folders. Only what is in the part is read: a fleet of many parts reads each record once.
pub(crate) fn records(words: &[String], batch: Option<Batch>) -> anyhow::Result<(Vec<Record>, Vec<PathBuf>)> {
    let mut others = Vec::new();
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    for word in words {
        let meant = records_meant(word)?;
        others.extend(meant.others);
        for (path, identity) in meant.records {
            if seen.insert(path.clone()) {
                // Of several folders the same path below each may be two records.
                let identity = if words.len() > 1 { path.to_string_lossy().into_owned() } else { identity };
                found.push((path, identity));
            }
        }
    }
    if found.is_empty() {
        return Err(Refused::new(format!("no record in {}", words.join(", ")))
            .expected("crash records as crumple-ingest reads them")
            .hint("crumple-ingest --list FILE says what it makes of a file")
            .into());
    }
    let names = names(&found.iter().map(|(_, identity)| identity.as_str()).collect::<Vec<_>>());
    let in_part = |((_, identity), _): &((PathBuf, String), String)| batch.is_none_or(|batch| batch.holds(identity));
    let records = found.into_par_iter().zip(names).filter(in_part).map(|((path, identity), name)| {
        let read = || Bundle::open(&path).ok().map(|bundle| bundle.digests());
        let digests = match Bundle::digests_at(&path).or_else(read) {
            Some(record) => Some(digests(record)),
            // It will be refused, and again as long as it is the same.
            None => digest_of_file(&path).ok(),
        };
        Record { path, identity, name, digests }
    });
    Ok((records.collect(), others))
}

fn digest_of_file(path: &Path) -> io::Result<Digests> {
    let input = blake3::Hasher::new().update_reader(File::open(path)?)?.finalize();
    Ok(Digests { record: String::new(), input })
}

fn digests(RecordDigests { format, name, record, sidecar }: RecordDigests) -> Digests {
    let mut hasher = blake3::Hasher::new();
    let sidecar = sidecar.as_deref().and_then(|digest| digest.strip_prefix("blake3:")).unwrap_or_default();
    for part in [format, &name, &record, sidecar] {
        hasher.update(part.as_bytes());
        hasher.update(&[0]);
    }
    Digests { record, input: hasher.finalize() }
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn a_table_is_told_from_a_text() {
        assert!(has_rows_of_numbers(b"t a\n0 1\n1e-3 2\n2e-3 3\n"));
        assert!(!has_rows_of_numbers(b"Read me.\n1 of 3\n2 of 3\n3 of 3\n"));
    }

    #[test]
    fn a_record_is_known_by_its_content_and_a_broken_one_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let is_record = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::write(&path, text).unwrap();
            !matches!(contents(&path).unwrap(), Contents::Other)
        };
        let table = "time_s,a\n0,1\n1,2\n2,3\n";
        for (name, text, expected) in [
            ("a.csv", table, true),
            ("empty.csv", "", true),
            ("words.csv", "nothing to see", true),
            ("a.txt", table, true),
            ("readme.txt", "nothing to see", false),
            ("readme.md", "nothing to see", false),
            ("empty", "", false),
        ] {
            assert_eq!(is_record(name, text), expected, "{name}");
        }
    }

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

    #[cfg(unix)]
    #[test]
    fn what_cannot_be_read_is_a_record_with_an_error() {
        let root = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink("nowhere", root.path().join("gone.csv")).unwrap();
        fs::write(root.path().join("a.csv"), "time_s,a\n0,1\n1,2\n2,3\n").unwrap();
        let found = |word: &str| {
            let word = format!("{}{word}", root.path().display());
            let (records, _) = records(&[word], None).unwrap();
            records.into_iter().map(|record| (record.identity, record.digests.is_some())).collect::<Vec<_>>()
        };
        let expected = [("a.csv".to_owned(), true), ("gone.csv".to_owned(), false)];
        assert_eq!(found(""), expected);
        assert_eq!(found("/*.csv"), expected);
        let error = of_pattern("p/*/../*/../*/x.csv").unwrap_err().to_string();
        assert_eq!(error, "p/*/../*/../*/x.csv goes up behind a wildcard");
    }

    #[test]
    fn records_of_one_stem_have_folders_of_their_own() {
        let names = names(&["a.csv", "x/b.csv", "y/b.csv", "B.EV5"]);
        assert_eq!(names[0], "a");
        let of_b: BTreeSet<&String> = names[1..].iter().collect();
        assert_eq!(of_b.len(), 3);
        assert!(names[1].starts_with("b-") && names[1].len() == 10, "{names:?}");
    }
}
