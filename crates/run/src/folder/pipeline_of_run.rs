//! The pipeline of a run in its folder: what the stages were given, and what the next run is compared with.

use std::fs::{self, Permissions};
use std::io::Write;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_stage::{Pipeline, Usage};
use tempfile::NamedTempFile;

use crate::command::PIPELINE_OF_A_RUN;

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
        let mut new = tempfile::Builder::new()
            .prefix(&format!(".{PIPELINE_OF_A_RUN}."))
            .suffix(".tmp")
            .permissions(Permissions::from_mode(0o666))
            .tempfile_in(folder)?;
        new.write_all(format!("{HEAD}{pipeline}").as_bytes()).map(|()| new)
    };
    write().with_context(|| format!("cannot write the pipeline into {}", folder.display()))
}

/// The pipeline of the last whole run in a folder; refused where the file of its name is somebody else's.
pub(crate) fn pipeline_before(folder: &Path) -> anyhow::Result<Option<Pipeline>> {
    let file = folder.join(PIPELINE_OF_A_RUN);
    match fs::read_to_string(&file) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Ok(text) if text.starts_with(HEAD) => Ok(Pipeline::read(&file, None).ok()),
        _ => {
            let problem = format!("{} is not that of a run, which would replace it; nothing was run", file.display());
            Err(Usage::new(problem)
                .hint("choose another folder: just out=DIR run RECORD; or move the file away")
                .into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
