//! Run folders on the command line: which there are below a folder, what each is called, where one page leads to
//! another. The one rule of `accept`, `diff` and `index`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use crumple_artifact::refuse_named_pipe;
use crumple_diff::DiffError;
use crumple_stage::{Pipeline, Usage};
use serde_json::Value;

use crate::OF_SEVERAL_TESTS;
use crate::compare::expected::Expected;

pub const SUMMARY: &str = "summary.json";
/// The folder of all runs of a project.
const OF_RUNS: &str = "runs";

/// A run, or what was accepted of one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FoundRun {
    /// What it is called in `expected/`, without the ending.
    pub name: String,
    /// Its folder, or the file that was accepted.
    pub path: PathBuf,
    /// Whether it is what was accepted.
    pub is_kept: bool,
    /// Whether it is a model of several tests, which is no run of a record.
    pub is_joint: bool,
}

impl FoundRun {
    /// What lies at a path; `None`: neither a run nor what was accepted.
    fn at(path: &Path) -> Result<Option<Self>, DiffError> {
        if path.is_dir() {
            if results_in(path).is_err() && Pipeline::failure_in(path).is_none() {
                return Ok(None);
            }
            let summary = read_json(&path.join(SUMMARY)).unwrap_or_default();
            let is_joint = summary["schema"] == OF_SEVERAL_TESTS;
            return Ok(Some(Self { name: name_of(path), path: path.to_owned(), is_kept: false, is_joint }));
        }
        // What cannot be read may be what was accepted: whoever reads it says what is wrong.
        if !is_json(path) || read_json(path).is_ok_and(|value| !Expected::is_schema(&value["schema"])) {
            return Ok(None);
        }
        let (path, name) = (path.to_owned(), name_of(path));
        Ok(Some(Self { name, path, is_kept: true, is_joint: false }))
    }
}

/// All runs at and below these paths, and all that was accepted, by name.
///
/// Errors: nothing is there; two folders have one name, so that nobody knows which of both is meant.
pub fn runs_below(paths: &[PathBuf]) -> anyhow::Result<Vec<FoundRun>> {
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    for path in paths {
        let before = (seen.len(), found.len());
        search(path, &mut seen, &mut found)?;
        if seen.len() > before.0 && found.len() == before.1 {
            return Err(DiffError::NotARun { path: path.clone() }.into());
        }
    }
    found.sort_by(|a: &FoundRun, b| (&a.name, &a.path).cmp(&(&b.name, &b.path)));
    refuse_two_of_a_name(&found)?;
    Ok(found)
}

/// Goes down to the runs. A folder is looked at once, whatever links lead to it.
fn search(path: &Path, seen: &mut BTreeSet<PathBuf>, found: &mut Vec<FoundRun>) -> Result<(), DiffError> {
    let io = |source| DiffError::Io { path: path.to_owned(), source };
    if !seen.insert(path.canonicalize().map_err(io)?) {
        return Ok(());
    }
    if let Some(run) = FoundRun::at(path)? {
        found.push(run);
        return Ok(());
    }
    if !path.is_dir() {
        return Ok(());
    }
    let entries: Vec<_> = fs::read_dir(path).and_then(Iterator::collect).map_err(io)?;
    // A run is called by its own folder, not by a link to it.
    let is_link = |entry: &fs::DirEntry| entry.file_type().is_ok_and(|kind| kind.is_symlink());
    let mut entries: Vec<(bool, PathBuf)> = entries.iter().map(|entry| (is_link(entry), entry.path())).collect();
    entries.sort();
    for (is_link, below) in entries {
        let is_hidden = below.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        // A link that leads nowhere is no run.
        if !is_hidden && (below.is_dir() || is_json(&below)) && (!is_link || below.exists()) {
            search(&below, seen, found)?;
        }
    }
    Ok(())
}

/// Errors: two folders of one name. The runs are in the order of their names.
fn refuse_two_of_a_name(found: &[FoundRun]) -> Result<(), Usage> {
    let Some(pair) = found.windows(2).find(|pair| pair[0].name == pair[1].name) else { return Ok(()) };
    let [a, b] = [&pair[0], &pair[1]].map(|run| run.path.display());
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    found.iter().for_each(|run| *counts.entry(&run.name).or_default() += 1);
    let more = match counts.values().filter(|count| **count > 1).count() - 1 {
        0 => String::new(),
        more => format!("; {more} more with two folders"),
    };
    let problem = format!("{a} and {b} are both the record {}{more}", pair[0].name);
    Err(Usage::new(problem).hint("name the folder of one of them; a fleet has its runs in runs/fleet/NAME/runs"))
}

/// What a run is called: its record, and behind it the pipeline and its settings where these are not the default;
/// `crash`, `crash-papers-civic`. What was accepted is called by its file.
pub fn name_of(path: &Path) -> String {
    if !path.is_dir() {
        return path.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    }
    let noted = Pipeline::read(&path.join(Pipeline::OF_A_RUN), None).ok();
    let pipeline = noted.as_ref().and_then(Pipeline::name).unwrap_or("default");
    // The folder of a pipeline is below that of its record: `runs/crash/papers/civic,filter.cfc=180`.
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let goes_up = path.components().any(|part| part == Component::ParentDir);
    let whole = if goes_up { path.canonicalize().unwrap_or(whole) } else { whole };
    let parts = |path: &Path| -> Vec<String> {
        let named = path.components().filter(|part| matches!(part, Component::Normal(_)));
        named.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let (whole, typed) = (parts(&whole), parts(path));
    let depth = pipeline.split('/').count();
    if let Some((record, variant)) = whole.split_at_checked(whole.len().saturating_sub(depth))
        && let Some(record) = record.last()
    {
        let variant = variant.join("/");
        if variant == "default" {
            return record.clone();
        }
        if variant.strip_prefix(pipeline).is_some_and(|rest| rest.is_empty() || rest.starts_with(',')) {
            return format!("{record}-{}", variant.replace('/', "-"));
        }
    }
    match &typed[..] {
        // `runs/mine`: the folder of all runs says nothing of this one.
        [.., of_runs, own] if of_runs == OF_RUNS => own.clone(),
        [.., above, own] => format!("{above}-{own}"),
        _ => whole.last().cloned().unwrap_or_default(),
    }
}

pub fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "json")
}

/// The artifacts and the summary in a folder, by name.
pub fn results_in(folder: &Path) -> Result<BTreeSet<String>, DiffError> {
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

/// A JSON file.
pub fn read_json(path: &Path) -> Result<Value, DiffError> {
    let text = refuse_named_pipe(path)
        .and_then(|()| fs::read(path))
        .map_err(|source| DiffError::Io { path: path.to_owned(), source })?;
    serde_json::from_slice(&text).map_err(|source| DiffError::Json { path: path.to_owned(), source })
}

/// The address of a file as seen from the folder of a page; `None` where the file is not there.
pub fn address(page: &Path, file: &Path) -> Option<String> {
    let from = page.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (from, to) = (from.canonicalize().ok()?, file.canonicalize().ok()?);
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(shared).map(|_| "..".to_owned());
    let down = to.components().skip(shared).map(|part| part.as_os_str().to_string_lossy().into_owned());
    Some(up.chain(down).collect::<Vec<_>>().join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Makes run folders; a name that ends with `!` is one whose last run was refused.
    fn made(folders: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (folder, pipeline) in folders {
            let failed = folder.ends_with('!');
            let folder = root.path().join(folder.trim_end_matches('!'));
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join(SUMMARY), "{}").unwrap();
            let end = if failed { "state = \"failed\"\nexit_code = 3\n" } else { "" };
            fs::write(folder.join(Pipeline::OF_A_RUN), format!("[run]\nname = \"{pipeline}\"\n{end}")).unwrap();
        }
        root
    }

    fn names(root: &Path) -> Vec<String> {
        runs_below(&[root.to_owned()]).unwrap().into_iter().map(|run| run.name).collect()
    }

    #[test]
    fn a_run_is_called_by_its_record_and_its_pipeline() {
        let root = made(&[
            ("runs/v1.2/default", "default"),
            ("runs/v1.3/default", "default"),
            ("runs/a/papers/civic", "papers/civic"),
            ("runs/b/papers/civic", "papers/civic"),
            ("runs/fleet/t/runs/c/default,filter.cfc=60", "default"),
            ("runs/fleet/t/runs/c/default,filter.cfc=180", "default"),
            ("runs/d/mine", "default"),
            ("runs/o1", "default"),
        ]);
        let expected = [
            "a-papers-civic",
            "b-papers-civic",
            "c-default,filter.cfc=180",
            "c-default,filter.cfc=60",
            "d-mine",
            "o1",
            "v1.2",
            "v1.3",
        ];
        assert_eq!(names(root.path()), expected);
    }

    #[test]
    fn two_folders_of_a_record_are_refused_by_both_names_and_a_link_is_none() {
        let root = made(&[("runs/a/default", "default"), ("runs/fleet/t/runs/a/default", "default")]);
        let error = runs_below(&[root.path().to_owned()]).unwrap_err().to_string();
        assert!(error.contains("runs/a/default and ") && error.contains("runs/fleet/t/runs/a/default"), "{error}");
        // The same folder twice is one.
        let one = root.path().join("runs/a");
        assert_eq!(runs_below(&[one.clone(), one.join("default")]).unwrap().len(), 1);
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&one, root.path().join("runs/fleet/t/latest")).unwrap();
            fs::remove_dir_all(root.path().join("runs/fleet/t/runs")).unwrap();
            assert_eq!(names(root.path()), ["a"]);
        }
    }

    #[test]
    fn a_run_that_failed_says_so_and_other_json_is_no_run() {
        let root = made(&[("runs/a/default!", "default")]);
        fs::write(root.path().join("runs/other.json"), "{\"schema\": \"mine\"}").unwrap();
        let runs = runs_below(&[root.path().to_owned()]).unwrap();
        assert_eq!(runs.len(), 1);
        let problem = crumple_stage::results_of_an_earlier_run(&runs[0].path).unwrap();
        assert!(problem.ends_with("ended with exit code 3: it left no results"), "{problem}");
        fs::write(root.path().join("runs/b.json"), "{\"schema\": \"crumple.exp").unwrap();
        assert_eq!(names(root.path()), ["a", "b"], "cut off: whoever reads it says so");
    }

    #[test]
    fn an_address_leads_from_the_page_to_the_file() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir_all(folder.path().join("runs/a b")).unwrap();
        let report = folder.path().join("runs/a b/report.html");
        fs::write(&report, "").unwrap();
        assert_eq!(address(&folder.path().join("index.html"), &report).as_deref(), Some("runs/a b/report.html"));
        let page = folder.path().join("runs/pages/index.html");
        fs::create_dir(page.parent().unwrap()).unwrap();
        assert_eq!(address(&page, &report).as_deref(), Some("../a b/report.html"));
        assert_eq!(address(&page, &folder.path().join("absent")), None);
    }
}
