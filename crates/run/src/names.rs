//! Which record a run folder is of, and what it is called.

use std::fs;
use std::path::{Path, PathBuf, is_separator};

/// The pipeline of a run in its folder.
pub(crate) const PIPELINE_OF_A_RUN: &str = crumple_stage::Pipeline::OF_A_RUN;

/// What a record is called wherever its project lies: its path below that, elsewhere its folder and its name.
pub(crate) fn place_of_record(project: &Path, record: &Path) -> String {
    let whole = |path: &Path| path.canonicalize().or_else(|_| std::path::absolute(path)).unwrap_or_default();
    let (project, record) = (whole(project), whole(record));
    let below = record.strip_prefix(&project);
    let kept = if below.is_ok() { usize::MAX } else { 2 };
    let parts = below.unwrap_or(&record).iter().rev().take(kept).map(|part| part.to_string_lossy().into_owned());
    let mut parts: Vec<String> = parts.filter(|part| !part.starts_with(is_separator)).collect();
    parts.reverse();
    parts.join("/")
}

/// The folder of all runs of a record: its stem. Where runs of another record are in it, the folder's name stands in
/// front, and a number behind where that is taken too.
pub(crate) fn folder_of_record(project: &Path, record: &Path) -> Option<PathBuf> {
    // The current folder has its name from where it lies.
    let whole = if record.file_stem().is_some() { std::path::absolute(record) } else { record.canonicalize() }.ok()?;
    let (stem, place) = (whole.file_stem()?, place_of_record(project, record));
    let mut longer = whole.parent().and_then(Path::file_name).unwrap_or_default().to_owned();
    longer.push("-");
    longer.push(stem);
    let numbered = (2..).map(|number| {
        let mut name = longer.clone();
        name.push(format!("-{number}"));
        name
    });
    let mut free = None;
    for (tried, name) in [stem.to_owned(), longer.clone()].into_iter().chain(numbered).enumerate() {
        let folder = project.join("runs").join(name);
        let records = records_of_runs(&folder, 3);
        if records.contains(&place) {
            return Some(folder);
        }
        let (is_there, is_free) = (folder.exists(), records.is_empty());
        free = free.or(is_free.then_some(folder));
        if tried > 0 && !is_there && free.is_some() {
            break;
        }
    }
    free
}

/// The records that the runs in a folder note, a pipeline's name being at most so many folders.
fn records_of_runs(folder: &Path, depth: usize) -> Vec<String> {
    let own = crumple_stage::Pipeline::read(&folder.join(PIPELINE_OF_A_RUN), None).ok();
    let mut records: Vec<String> = own.iter().filter_map(|run| run.record().map(str::to_owned)).collect();
    let below = fs::read_dir(folder).into_iter().flatten().flatten().filter(|_| depth > 0);
    records.extend(
        below.filter(|entry| entry.path().is_dir()).flat_map(|entry| records_of_runs(&entry.path(), depth - 1)),
    );
    records
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_of_one_name_have_folders_of_their_own_and_keep_them() {
        let root = tempfile::tempdir().unwrap();
        let project = root.path().join("project");
        let place = |record: &str| place_of_record(&project, &root.path().join(record));
        let folder = |record: &str| {
            let found = folder_of_record(&project, &root.path().join(record)).unwrap();
            found.strip_prefix(project.join("runs")).unwrap().to_str().unwrap().to_owned()
        };
        let note = |folder: &str, record: &str| {
            let folder = project.join("runs").join(folder);
            fs::create_dir_all(&folder).unwrap();
            let text = format!("base = 'none'\n[run]\nrecord = '{}'\n", place(record));
            fs::write(folder.join(PIPELINE_OF_A_RUN), text).unwrap();
        };
        let [a, b, other_b] = ["project/a/crash.csv", "project/b/crash.csv", "x/b/crash.csv"];
        for record in [a, b, other_b] {
            let record = root.path().join(record);
            fs::create_dir_all(record.parent().unwrap()).unwrap();
            fs::write(record, "").unwrap();
        }
        assert_eq!([place(a), place(other_b)], ["a/crash.csv", "b/crash.csv"]);
        assert_eq!([folder(a), folder(b)], ["crash", "crash"]);
        note("crash/papers/civic", a);
        assert_eq!([folder(a), folder(b)], ["crash", "b-crash"]);
        note("b-crash/default", b);
        let c = "project/c/b/crash.csv";
        assert_eq!([folder(a), folder(b), folder(c)], ["crash", "b-crash", "b-crash-2"]);
        // What is gone makes room; what a record has, it keeps.
        fs::remove_dir_all(project.join("runs/crash")).unwrap();
        assert_eq!([folder(a), folder(b)], ["crash", "b-crash"]);
    }
}
