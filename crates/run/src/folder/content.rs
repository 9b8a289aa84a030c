//! What lies in a run folder, what of it is foreign, and what a run sweeps away.

use std::fs::{self, File};
use std::io;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::readable;
use crumple_stage::{Pipeline, Usage};
use tempfile::NamedTempFile;

use crate::command::elsewhere;
use crate::names::PIPELINE_OF_A_RUN;

/// What a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Content {
    /// There is no such file, or it is empty.
    Nothing,
    /// It begins as an artifact does.
    Artifact,
    /// Anything else.
    Other,
}

/// What the file at a path holds, by its first bytes.
pub(crate) fn content_of(path: &Path) -> Content {
    let mut start = Vec::new();
    match File::open(path).and_then(|file| file.take(5).read_to_end(&mut start)) {
        Err(_) | Ok(0) => Content::Nothing,
        Ok(_) if start == b"\x89MCAP" => Content::Artifact,
        Ok(_) => Content::Other,
    }
}

/// Whether an output of this name is an artifact.
pub(crate) fn is_artifact(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|ending| ending == "mcap")
}

/// Refuses a folder whose files have names of outputs and are not: a run removes and replaces such files.
///
/// A run removes the report first and the artifacts after it, so its report never stands alone; and its artifacts are
/// MCAP files.
pub(crate) fn refuse_files_of_others<'a>(folder: &Path, outputs: impl Iterator<Item = &'a str>) -> Result<(), Usage> {
    let (artifacts, reports): (Vec<&str>, Vec<&str>) = outputs.partition(|name| is_artifact(name));
    let refused = |what: String| {
        let problem = format!("{what} in {}; a run would replace it, and nothing was run", folder.display());
        Err(Usage::new(problem).hint(format!("choose another folder: {}; or move the file away", elsewhere())))
    };
    if let Some(other) = artifacts.iter().find(|name| content_of(&folder.join(name)) == Content::Other) {
        return refused(format!("{other} is no artifact (no MCAP file)"));
    }
    let has_artifact = artifacts.iter().any(|name| folder.join(name).exists());
    match reports.iter().find(|name| folder.join(name).exists()) {
        Some(report) if !has_artifact => refused(format!("{report} stands without an artifact of a run")),
        _ => Ok(()),
    }
}

/// Refuses a folder in which a result is a link: a run would write through it, into the results of another.
pub(crate) fn refuse_links<'a>(folder: &Path, mut outputs: impl Iterator<Item = &'a str>) -> Result<(), Usage> {
    let is_link = |name: &&str| fs::symlink_metadata(folder.join(name)).is_ok_and(|found| found.is_symlink());
    let Some(name) = outputs.find(is_link) else { return Ok(()) };
    let link = folder.join(name);
    let target = fs::read_link(&link).unwrap_or_default();
    let problem = format!(
        "{} is a link to {}; a run would write through it, and nothing was run",
        link.display(),
        target.display()
    );
    Err(Usage::new(problem).hint(format!("remove the link: rm {}", link.display())))
}

/// Digest of every byte of the results, and of which file each program is; an error where one of them is missing.
///
/// A program is known by its place on the disk, its size and the times of its content and of its inode: the system sets
/// the last one, so that no copy or edit passes for it.
pub(crate) fn state_of<'a>(
    folder: &Path,
    results: impl Iterator<Item = &'a str>,
    programs: &[PathBuf],
) -> io::Result<String> {
    let mut state = blake3::Hasher::new();
    for name in results {
        let mut content = blake3::Hasher::new();
        content.update_reader(File::open(folder.join(name))?)?;
        state.update(format!("{name} {}\n", content.finalize().to_hex()).as_bytes());
    }
    for program in programs {
        let file = fs::metadata(program)?;
        state.update(format!("{} {} {:?}\n", program.display(), file.len(), identity(&file)).as_bytes());
    }
    Ok(format!("blake3:{}", state.finalize().to_hex()))
}

/// Place of a file on the disk and the times of its content and of its inode.
#[cfg(unix)]
fn identity(file: &fs::Metadata) -> impl std::fmt::Debug {
    use std::os::unix::fs::MetadataExt;
    (file.dev(), file.ino(), [file.mtime(), file.mtime_nsec(), file.ctime(), file.ctime_nsec()])
}

/// The times of a file: elsewhere than on Unix an edit that sets them back passes unseen.
#[cfg(not(unix))]
fn identity(file: &fs::Metadata) -> impl std::fmt::Debug {
    (file.modified().ok(), file.created().ok())
}

/// Folder inside the run folder in which programs from elsewhere write.
const NEW: &str = ".crumple-run.new";

/// Where a program from elsewhere writes before its result is taken over.
pub(crate) fn folder_of_new_results(folder: &Path) -> PathBuf {
    folder.join(NEW)
}

/// Removes the temporary files of the outputs and the results that were never taken over; what has another name stays.
/// Only under the lock: nobody else writes here.
pub(crate) fn sweep<'a>(folder: &Path, outputs: impl Iterator<Item = &'a str>) -> io::Result<()> {
    let outputs: Vec<&str> = outputs.collect();
    remove_files(folder, |name| is_temporary(name, &outputs))?;
    let new = folder_of_new_results(folder);
    // A link to a folder elsewhere is not what a run leaves.
    if fs::symlink_metadata(&new).is_ok_and(|found| found.is_dir()) {
        remove_files(&new, |name| outputs.contains(&name) || is_temporary(name, &outputs))?;
        match fs::remove_dir(&new) {
            Err(error) if error.kind() != io::ErrorKind::DirectoryNotEmpty => return Err(error),
            _ => {}
        }
    }
    Ok(())
}

/// Whether it is what an output is called before it is whole.
fn is_temporary(name: &str, outputs: &[&str]) -> bool {
    let of = |output: &&str| name.strip_prefix('.').and_then(|rest| rest.strip_prefix(output));
    name.ends_with(".tmp") && outputs.iter().filter_map(of).any(|rest| rest.starts_with('.'))
}

fn remove_files(folder: &Path, is_meant: impl Fn(&str) -> bool) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if is_meant(&entry.file_name().to_string_lossy()) && !entry.file_type()?.is_dir() {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// How the file begins, so that no other is replaced.
const HEAD: &str = "# The pipeline of this run, with everything it was laid over and what was set beside it.\n";

/// The pipeline on its way to the stages. It becomes that of the folder once the run is whole: until then the one of
/// the run before stays.
#[derive(Debug)]
pub(crate) struct PipelineOfRun {
    file: PathBuf,
    new: Option<NamedTempFile>,
}

impl PipelineOfRun {
    /// Writes it into the folder under a name that the next run sweeps, unless its options are those of the run before.
    pub(crate) fn write(folder: &Path, pipeline: &Pipeline, before: Option<&Pipeline>) -> anyhow::Result<Self> {
        let file = folder.join(PIPELINE_OF_A_RUN);
        let is_same = |before: &Pipeline| before.name() == pipeline.name() && pipeline.changes_since(before).is_empty();
        if before.is_some_and(is_same) {
            return Ok(Self { file, new: None });
        }
        Ok(Self { file, new: Some(written(folder, pipeline)?) })
    }

    /// Whether the run before had the same options.
    pub(crate) fn is_unchanged(&self) -> bool {
        self.new.is_none()
    }

    /// The file that the stages are given.
    pub(crate) fn path(&self) -> &Path {
        self.new.as_ref().map_or(&self.file, |new| new.path())
    }

    /// The run is whole: this is its pipeline.
    pub(crate) fn keep(self, folder: &Path, pipeline: &Pipeline) -> anyhow::Result<()> {
        if self.new.is_none() && pipeline_before(folder)?.is_some_and(|kept| kept.end() == pipeline.end()) {
            return Ok(());
        }
        let whole = written(folder, pipeline)?;
        whole.persist(&self.file).with_context(|| format!("cannot write {}", self.file.display()))?;
        Ok(())
    }
}

/// The file of a pipeline, not yet under its name.
pub(crate) fn written(folder: &Path, pipeline: &Pipeline) -> anyhow::Result<NamedTempFile> {
    let write = || {
        let prefix = format!(".{PIPELINE_OF_A_RUN}.");
        let mut builder = tempfile::Builder::new();
        let mut new = readable(builder.prefix(&prefix).suffix(".tmp")).tempfile_in(folder)?;
        new.write_all(format!("{HEAD}{pipeline}").as_bytes()).map(|()| new)
    };
    write().with_context(|| format!("cannot write the pipeline into {}", folder.display()))
}

/// The pipeline of the last whole run in a folder; refused where the file of its name is somebody else's.
pub(crate) fn pipeline_before(folder: &Path) -> anyhow::Result<Option<Pipeline>> {
    let file = folder.join(PIPELINE_OF_A_RUN);
    match fs::read_to_string(&file) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Ok(text) if text.starts_with(HEAD) => Ok(Pipeline::read(&file, None).ok()),
        _ => {
            let problem = format!("{} is not that of a run, which would replace it; nothing was run", file.display());
            Err(Usage::new(problem)
                .hint(format!("choose another folder: {}; or move the file away", elsewhere()))
                .into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_report_without_artifacts_and_artifacts_of_others_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, content: &[u8]| fs::write(folder.path().join(name), content).unwrap();
        let refused = || {
            refuse_files_of_others(folder.path(), ["1-ingest.mcap", "report.html", "summary.json"].into_iter())
                .map_err(|error| error.to_string())
        };
        assert_eq!(refused(), Ok(()));
        write("summary.json", b"{}");
        assert!(refused().unwrap_err().starts_with("summary.json stands without an artifact"), "{:?}", refused());
        write("1-ingest.mcap", b"\x89MCAP0\r\n");
        assert_eq!(refused(), Ok(()));
        write("1-ingest.mcap", b"text");
        assert!(refused().unwrap_err().starts_with("1-ingest.mcap is no artifact"), "{:?}", refused());
    }

    #[test]
    fn a_byte_of_a_result_and_another_program_of_the_same_size_are_seen() {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("program");
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
        write("a", "1");
        write("program", "x");
        let state = || state_of(folder.path(), ["a"].into_iter(), std::slice::from_ref(&program)).ok();
        let first = state().unwrap();
        assert_eq!(state(), Some(first.clone()));
        write("a", "2");
        assert_ne!(state(), Some(first.clone()));
        write("a", "1");
        assert_eq!(state(), Some(first.clone()));
        fs::remove_file(&program).unwrap();
        assert_eq!(state(), None);
        write("b", "y");
        write("program", "x");
        assert_ne!(state(), Some(first));
    }

    #[test]
    fn only_what_a_killed_run_left_goes() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let new = folder_of_new_results(folder.path());
        fs::create_dir(&new).unwrap();
        for name in [".1-ingest.mcap.aBc123.tmp", "1-ingest.mcap", ".mine.tmp", "notes.txt"] {
            fs::write(path(name), "x").unwrap();
        }
        for name in ["1-ingest.mcap", ".1-ingest.mcap.x.tmp", "mine.txt"] {
            fs::write(new.join(name), "x").unwrap();
        }
        let sweep = || sweep(folder.path(), ["1-ingest.mcap"].into_iter()).unwrap();
        sweep();
        let left: Vec<_> = fs::read_dir(&new).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["mine.txt"]);
        fs::remove_file(new.join("mine.txt")).unwrap();
        sweep();
        let mut names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(names, [".mine.tmp", "1-ingest.mcap", "notes.txt"]);
    }

    fn pipeline(text: &str) -> Pipeline {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("p.toml");
        fs::write(&path, text).unwrap();
        Pipeline::read(&path, None).unwrap()
    }

    #[test]
    fn it_is_that_of_the_folder_once_the_run_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let mut mine = pipeline("[filter]\ncfc = 180\n");
        let names = || fs::read_dir(folder.path()).unwrap().count();
        let write =
            |mine: &Pipeline, before: Option<&Pipeline>| PipelineOfRun::write(folder.path(), mine, before).unwrap();
        drop(write(&mine, None));
        assert_eq!((names(), pipeline_before(folder.path()).unwrap()), (0, None));
        mine.note_end("blake3:1", 4);
        write(&mine, None).keep(folder.path(), &mine).unwrap();
        let before = pipeline_before(folder.path()).unwrap().unwrap();
        assert_eq!((names(), mine.changes_since(&before), before.end()), (1, Vec::new(), Some(("blake3:1", 4))));
        // The same options with other results.
        mine.note_end("blake3:2", 0);
        let again = write(&mine, Some(&before));
        assert!(again.is_unchanged());
        again.keep(folder.path(), &mine).unwrap();
        assert_eq!(pipeline_before(folder.path()).unwrap().unwrap().end(), Some(("blake3:2", 0)));
        fs::write(folder.path().join(PIPELINE_OF_A_RUN), "[filter]\n").unwrap();
        let error = pipeline_before(folder.path()).unwrap_err().to_string();
        assert!(error.contains("0-pipeline.toml is not that of a run"), "{error}");
    }
}
