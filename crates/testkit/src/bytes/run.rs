//! Runs the cases and compares digests of their results.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{fmt, fs, io};

use crumple_artifact::{Artifact, ContentDigest, blake3_text};
use serde_json::Value;

use crate::bytes::cases::{Case, Step, chain_files, phases, write_records};
use crate::places::{shared, workspace};

/// Stands where a digest makes no sense.
const NONE: &str = "-";

/// What a line says of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Digests {
    /// Of all bytes; of an artifact without the build of the program that wrote it.
    pub whole: String,
    /// Of the messages (artifacts), or of the value whatever its layout (JSON).
    pub content: String,
    /// The same with [`masked`] texts, and without schemas.
    pub masked: String,
}

impl Digests {
    /// Of what a process printed, and how it ended; only the exit code is left when texts are masked.
    pub fn of_process(code: Option<i32>, printed: &[u8]) -> Self {
        let whole = hex(printed);
        let code = code.map_or_else(|| "signal".to_owned(), |code| format!("exit-{code}"));
        Self { content: whole.clone(), whole, masked: code }
    }
}

fn hex(bytes: &[u8]) -> String {
    blake3_text(bytes).trim_start_matches("blake3:").to_owned()
}

/// Digests of an artifact (`.mcap`), of JSON (`.json`), or of any other file, of which only the bytes count.
///
/// # Errors
/// A file that cannot be read, in words.
fn digests_of_file(path: &Path) -> Result<Digests, String> {
    let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    let whole = hex(&bytes);
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("mcap") => {
            let artifact = Artifact::open(path).map_err(|error| error.to_string())?;
            let build = artifact.provenance().map_or("", |provenance| provenance.build.as_str());
            let whole = hex(&without_build(&bytes, build));
            let content = artifact.digest().trim_start_matches("blake3:").to_owned();
            Ok(Digests { whole, content, masked: masked_artifact(&artifact) })
        }
        Some("json") => {
            let value: Value =
                serde_json::from_slice(&bytes).map_err(|error| format!("{}: {error}", path.display()))?;
            let content = hex(value.to_string().as_bytes());
            Ok(Digests { whole, content, masked: hex(masked(value).to_string().as_bytes()) })
        }
        _ => Ok(Digests { content: whole.clone(), whole, masked: NONE.to_owned() }),
    }
}

/// The bytes of an artifact without the digest of the sources that its writer was built of, and without the checksums
/// that change with it.
fn without_build(bytes: &[u8], build: &str) -> Vec<u8> {
    // Opcodes of the MCAP specification.
    const FOOTER: u8 = 0x02;
    const METADATA: u8 = 0x0c;
    const DATA_END: u8 = 0x0f;
    let mut bytes = bytes.to_vec();
    let mut at = 8;
    while let Some(head) = bytes.get(at..at + 9) {
        let (opcode, length) = (head[0], head[1..].iter().rev().fold(0, |sum, byte| sum << 8 | usize::from(*byte)));
        let start = at + 9;
        let Some(body) = bytes.get_mut(start..start.saturating_add(length)) else { break };
        match opcode {
            FOOTER | DATA_END => {
                let end = body.len().saturating_sub(4);
                body[end..].fill(0);
            }
            METADATA if !build.is_empty() => {
                let place = body.windows(build.len()).position(|part| part == build.as_bytes());
                place.into_iter().for_each(|place| body[place..place + build.len()].fill(b'-'));
            }
            _ => {}
        }
        at = start + length;
    }
    bytes
}

/// A JSON value in which every string with a blank is empty: notes, reasons and definitions are sentences; ids, units,
/// names of models and methods have no blank. The number of texts in a list stays, and so do keys.
pub fn masked(value: Value) -> Value {
    match value {
        Value::String(text) if text.contains(char::is_whitespace) => Value::String(String::new()),
        Value::Array(items) => items.into_iter().map(masked).collect(),
        Value::Object(fields) => Value::Object(fields.into_iter().map(|(key, value)| (key, masked(value))).collect()),
        other => other,
    }
}

/// Records in file order with their texts masked, then the waves as they are.
fn masked_artifact(artifact: &Artifact) -> String {
    let mut digest = ContentDigest::default();
    for record in artifact.records() {
        let payload = match serde_json::from_slice::<Value>(&record.payload) {
            Ok(value) => masked(value).to_string().into_bytes(),
            Err(_) => record.payload.clone(),
        };
        digest.update(&record.topic, &record.schema, &record.encoding, record.log_time, &payload);
    }
    for (id, wave) in artifact.waves() {
        let sampled = &wave.sampled;
        let numbers = [sampled.t0_s(), sampled.dt_s()].into_iter().chain(sampled.samples().iter().copied());
        let payload: Vec<u8> = numbers.flat_map(f64::to_le_bytes).collect();
        digest.update(id, wave.quantity.name(), "wave", 0, &payload);
    }
    digest.text().trim_start_matches("blake3:").to_owned()
}

/// How a file differs between two lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Difference {
    /// The content is the same: provenance, schemas or layout differ.
    AroundContent,
    /// Only texts of the content differ.
    Texts,
    /// Numbers, names or the number of records differ; of a process, its exit code.
    Content,
    /// Only the first list has it.
    OnlyInFirst,
    /// Only the second list has it.
    OnlyInSecond,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AroundContent => "around the content",
            Self::Texts => "texts",
            Self::Content => "content",
            Self::OnlyInFirst => "only in the first",
            Self::OnlyInSecond => "only in the second",
        })
    }
}

/// Digests by file.
type LinesOfFolder<'a> = BTreeMap<&'a str, [&'a str; 3]>;

fn lines(list: &str) -> Result<LinesOfFolder<'_>, String> {
    list.lines()
        .filter(|line| !line.is_empty())
        .map(|line| {
            let mut parts = line.splitn(4, "  ");
            match [parts.next(), parts.next(), parts.next(), parts.next()] {
                [Some(whole), Some(content), Some(masked), Some(file)] => Ok((file, [whole, content, masked])),
                _ => Err(format!("no list of digests: {line:?}")),
            }
        })
        .collect()
}

/// The files that differ, by name.
///
/// # Errors
/// A line that is none of such a list.
pub fn compare<'a>(first: &'a str, second: &'a str) -> Result<Vec<(&'a str, Difference)>, String> {
    let (first, second) = (lines(first)?, lines(second)?);
    let mut differences = Vec::new();
    for (file, [whole, content, masked]) in &first {
        let difference = match second.get(file) {
            None => Difference::OnlyInFirst,
            Some(other) if other == &[*whole, *content, *masked] => continue,
            Some([_, _, other]) if other != masked => Difference::Content,
            Some([_, other, _]) if other != content => Difference::Texts,
            Some(_) => Difference::AroundContent,
        };
        differences.push((*file, difference));
    }
    let added = second.keys().filter(|file| !first.contains_key(*file));
    differences.extend(added.map(|file| (*file, Difference::OnlyInSecond)));
    differences.sort_unstable();
    Ok(differences)
}

/// Why there is no list.
#[derive(Debug, thiserror::Error)]
pub enum BytesError {
    /// A program that could not be started.
    #[error("cannot start {path}: {error}", path = .0.display(), error = .1)]
    Program(PathBuf, io::Error),
    /// A folder or file, and what was wrong with it.
    #[error("{path}: {error}", path = .0.display(), error = .1)]
    File(PathBuf, io::Error),
    /// An artifact or summary that cannot be read.
    #[error("{0}")]
    Unreadable(String),
}

/// Digests by file.
type Lines = BTreeMap<String, Digests>;

/// Runs every case with the programs of the folder `bin`, in `folder`, which is made empty and removed, and returns the
/// sorted list: digest of the whole file, of its content, of its masked content, its name.
///
/// # Errors
/// A program that is not there, a file that cannot be written, an artifact that cannot be read.
pub fn write_digests(bin: &Path, folder: &Path) -> Result<String, BytesError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        move |error| BytesError::File(path, error)
    };
    if folder.exists() {
        fs::remove_dir_all(folder).map_err(at(folder))?;
    }
    fs::create_dir_all(folder).map_err(at(folder))?;
    let bin = bin.canonicalize().map_err(at(bin))?;
    let (records, pipelines, files) = prepare(folder).map_err(at(folder))?;
    let mut lines = Lines::new();
    for phase in phases(&records, &pipelines, &files) {
        lines.extend(run_all(&phase, &bin, folder)?);
    }
    fs::remove_dir_all(folder).map_err(at(folder))?;
    let mut list = String::new();
    for (file, Digests { whole, content, masked }) in lines {
        let _infallible = writeln!(list, "{whole}  {content}  {masked}  {file}");
    }
    Ok(list)
}

/// Names and paths of the records, paths of the pipelines and of the files to be read.
type Prepared = (Vec<(String, String)>, Vec<String>, Vec<String>);

/// Copies what the cases read into the folder, so that messages name it by the same path everywhere.
fn prepare(folder: &Path) -> io::Result<Prepared> {
    let mut records = Vec::new();
    fs::create_dir_all(folder.join("records"))?;
    for fixture in files_below(&workspace().join("fixtures"))? {
        let Some(name) = fixture.strip_suffix("/crash.csv") else { continue };
        let record = format!("records/{name}.csv");
        fs::copy(workspace().join("fixtures").join(&fixture), folder.join(&record))?;
        records.push((name.to_owned(), record));
    }
    write_records(&folder.join("records"))?;
    records.push(("two-sensors".to_owned(), "records/two-sensors.csv".to_owned()));
    records.push(("occupants".to_owned(), "records/occupants".to_owned()));

    let pipelines = copy_below(&workspace().join("pipelines"), folder, "pipelines")?;
    fs::create_dir_all(folder.join("chains"))?;
    for (path, content) in chain_files() {
        fs::write(folder.join(path), content)?;
    }
    let mut files = Vec::new();
    for (name, path) in [("data", "data"), ("hostile", "reference/hostile")] {
        if let Some(path) = shared(path) {
            files.extend(copy_below(&path, folder, &format!("reference/{name}"))?);
        }
    }
    let camry = "reference/data/nhtsa-v10146-camry-frontal/v10146.EV5".to_owned();
    if files.contains(&camry) {
        records.push(("camry".to_owned(), camry));
    }
    Ok((records, pipelines, files))
}

/// Copies a folder to `<to>/<name>` and returns the paths of the files relative to `to`.
fn copy_below(from: &Path, to: &Path, name: &str) -> io::Result<Vec<String>> {
    let mut copied = Vec::new();
    for file in files_below(from)? {
        let path = format!("{name}/{file}");
        let target = to.join(&path);
        fs::create_dir_all(target.parent().unwrap_or(to))?;
        fs::copy(from.join(&file), target)?;
        copied.push(path);
    }
    Ok(copied)
}

/// All files below a folder, sorted, relative to it.
fn files_below(folder: &Path) -> io::Result<Vec<String>> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(&next)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if let Ok(relative) = path.strip_prefix(folder) {
                files.push(relative.to_string_lossy().into_owned());
            }
        }
    }
    files.sort();
    Ok(files)
}

/// Runs cases at once, as many as there are processors, each process on one thread unless
/// `RAYON_NUM_THREADS` says otherwise: the bytes do not depend on either.
fn run_all(cases: &[Case], bin: &Path, folder: &Path) -> Result<Lines, BytesError> {
    let next = AtomicUsize::new(0);
    let lines = Mutex::new(Ok(Lines::new()));
    let work = || {
        while let Some(case) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
            let result = run_case(case, bin, folder);
            let mut all = lines.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            match (result, &mut *all) {
                (Ok(of_case), Ok(all)) => all.extend(of_case),
                (Err(error), Ok(_)) => *all = Err(error),
                (_, Err(_)) => return,
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(work);
        }
    });
    lines.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn run_case(case: &Case, bin: &Path, folder: &Path) -> Result<Lines, BytesError> {
    let home = folder.join(&case.name);
    let at = |error| BytesError::File(home.clone(), error);
    fs::create_dir_all(&home).map_err(at)?;
    // Cases run beside each other already.
    let threads = std::env::var_os("RAYON_NUM_THREADS").unwrap_or_else(|| "1".into());
    let mut lines = Lines::new();
    for Step { program, arguments } in &case.steps {
        let path = bin.join(format!("crumple-{program}"));
        let output = Command::new(&path)
            .args(arguments)
            .current_dir(folder)
            .env("RAYON_NUM_THREADS", &threads)
            .env_remove("COLUMNS")
            .output()
            .map_err(|error| BytesError::Program(path, error))?;
        let printed = [output.stdout, output.stderr].concat();
        lines.insert(format!("{}/{program}", case.name), Digests::of_process(output.status.code(), &printed));
    }
    for file in files_below(&home).map_err(at)? {
        let digests = digests_of_file(&home.join(&file)).map_err(BytesError::Unreadable)?;
        lines.insert(format!("{}/{file}", case.name), digests);
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;
    use crumple_artifact::records::NotesV1;
    use crumple_artifact::{ArtifactBuilder, Compression, Provenance};
    use crumple_signal::{QuantityKind, Sampled};
    use serde_json::json;

    fn artifact_of(build: &str, note: &str, settings: &str, sample: f64) -> Digests {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.mcap");
        let mut builder = ArtifactBuilder::new();
        builder.put("/notes", &NotesV1 { stage: "filter".to_owned(), notes: vec![note.to_owned()] }).unwrap();
        let wave = Sampled::new(0.0, 1e-3, vec![0.0, sample, 2.0]).unwrap();
        builder.wave("a", QuantityKind::Acceleration, wave).unwrap();
        let provenance = Provenance::new("filter", "0", settings.to_owned(), vec![]).with_build(build);
        builder.write(&path, &provenance, Compression::None).unwrap();
        digests_of_file(&path).unwrap()
    }

    fn artifact(note: &str, settings: &str, sample: f64) -> Digests {
        artifact_of("0123456789abcdef", note, settings, sample)
    }

    #[test]
    fn the_build_of_the_program_is_not_part_of_any_digest() {
        let first = artifact("a text", "{}", 1.0);
        assert_eq!(first, artifact_of("fedcba9876543210", "a text", "{}", 1.0));
        assert_ne!(first.whole, artifact_of("", "a text", "{}", 1.0).whole, "whether there is one counts");
    }

    #[test]
    fn settings_texts_and_numbers_of_an_artifact_are_told_apart() {
        let first = artifact("the first text", "{}", 1.0);
        assert_eq!(first, artifact("the first text", "{}", 1.0));
        let other_settings = artifact("the first text", "{\"a\":1}", 1.0);
        assert_ne!(first.whole, other_settings.whole);
        assert_eq!((&first.content, &first.masked), (&other_settings.content, &other_settings.masked));
        let other_text = artifact("the other text", "{}", 1.0);
        assert_ne!(first.content, other_text.content);
        assert_eq!(first.masked, other_text.masked);
        let other_sample = artifact("the first text", "{}", f64::from_bits(1.0_f64.to_bits() + 1));
        assert_ne!(first.masked, other_sample.masked);
    }

    #[test]
    fn texts_are_masked_and_names_and_numbers_are_not() {
        let value =
            json!({"model": "kelvin", "notes": ["one text", "a second text"], "m_kg": 873.0, "of": {"a": "b c"}});
        let expected = json!({"model": "kelvin", "notes": ["", ""], "m_kg": 873.0, "of": {"a": ""}});
        assert_eq!(masked(value), expected);
    }

    #[test]
    fn the_layout_of_json_is_of_the_whole_file_only() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        fs::write(&path, "{\"a\": 1}").unwrap();
        let spaced = digests_of_file(&path).unwrap();
        fs::write(&path, "{\"a\":1}").unwrap();
        let dense = digests_of_file(&path).unwrap();
        assert_ne!(spaced.whole, dense.whole);
        assert_eq!(spaced.content, dense.content);
    }

    #[test]
    fn every_kind_of_difference_is_named() {
        let first = "a  b  c  one\na  b  c  two\na  b  c  three\na  b  c  four\na  b  c  five\n";
        let second = "a  b  c  one\nx  b  c  two\nx  y  c  three\nx  y  z  four\na  b  c  six\n";
        let expected = [
            ("five", Difference::OnlyInFirst),
            ("four", Difference::Content),
            ("six", Difference::OnlyInSecond),
            ("three", Difference::Texts),
            ("two", Difference::AroundContent),
        ];
        assert_eq!(compare(first, second).unwrap(), expected);
        assert_eq!(compare(first, first).unwrap(), []);
        assert!(compare("a b c", first).is_err());
    }
}
