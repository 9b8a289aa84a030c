//! Runs all cases in a folder and lists the digests of what they write.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::case::{Case, Step};
use super::digest::{Digests, digests_of_file};
use super::every_case::{chain_files, phases};
use super::made_records::write_records;
use crate::places::{shared, workspace};

/// Why there is no list.
#[derive(Debug)]
pub enum BytesError {
    /// A program that could not be started.
    Program(PathBuf, io::Error),
    /// A folder or file, and what was wrong with it.
    File(PathBuf, io::Error),
    /// An artifact or summary that cannot be read.
    Unreadable(String),
}

impl std::fmt::Display for BytesError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Program(path, error) => write!(f, "cannot start {}: {error}", path.display()),
            Self::File(path, error) => write!(f, "{}: {error}", path.display()),
            Self::Unreadable(problem) => f.write_str(problem),
        }
    }
}

impl std::error::Error for BytesError {}

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
