//! Which pipeline file is meant, and its name.

use std::path::{Path, PathBuf};

/// The pipeline of a run in its folder.
pub(crate) const PIPELINE_OF_A_RUN: &str = "0-pipeline.toml";

/// A pipeline file and the name that its run folders have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pipeline {
    /// The file.
    pub file: PathBuf,
    /// `default`, `papers/civic`.
    pub name: String,
}

impl Pipeline {
    /// The path of a file is that file; all else is a name below `pipelines/` of the project.
    pub fn resolve(text: &str, project: &Path) -> Self {
        let below = text.strip_prefix("pipelines/").unwrap_or(text);
        let name = below.strip_suffix(".toml").unwrap_or(below);
        let is_path = text.starts_with(['/', '.']) || (text.ends_with(".toml") && Path::new(text).is_file());
        if !is_path {
            let file = project.join("pipelines").join(format!("{name}.toml"));
            return Self { file, name: name.to_owned() };
        }
        let last = name.rsplit('/').next().unwrap_or(name);
        Self { file: PathBuf::from(text), name: if below == text { last } else { name }.to_owned() }
    }
}

impl Pipeline {
    /// The file with what it is laid over, the default pipeline of the project, and with options set beside it.
    pub(crate) fn read(&self, project: &Path, set: &[String]) -> anyhow::Result<crumple_stage::Pipeline> {
        let default = Some(project.join("pipelines/default.toml")).filter(|path| path.is_file());
        let mut read = crumple_stage::Pipeline::read(&self.file, default.as_deref())?;
        set.iter().try_for_each(|typed| read.set(typed))?;
        Ok(read)
    }

    /// Whether it lies below `pipelines/` of the project.
    pub(crate) fn is_of(&self, project: &Path) -> bool {
        self.file.starts_with(project.join("pipelines"))
    }

    /// The pipeline of a run that was made: what it was run with, else that of its summary where the project has it,
    /// else what is typed.
    pub(crate) fn of_run(folder: &Path, typed: &str, project: &Path) -> Self {
        let file = folder.join(PIPELINE_OF_A_RUN);
        if let Some(name) = crumple_stage::Pipeline::read(&file, None).ok().as_ref().and_then(|made| made.name()) {
            return Self { name: name.to_owned(), file };
        }
        let summary = std::fs::read_to_string(folder.join("summary.json")).ok();
        let summary: Option<serde_json::Value> = summary.and_then(|text| serde_json::from_str(&text).ok());
        let name = summary.as_ref().and_then(|summary| summary["pipeline"].as_str());
        let made = name.map(|name| Self::resolve(name, project)).filter(|made| made.file.is_file());
        made.unwrap_or_else(|| Self::resolve(typed, project))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lie_below_the_project_and_paths_anywhere() {
        let resolved = |text: &str| {
            let pipeline = Pipeline::resolve(text, Path::new("/project"));
            (pipeline.file.to_str().unwrap().to_owned(), pipeline.name)
        };
        let pair = |file: &str, name: &str| (file.to_owned(), name.to_owned());
        assert_eq!(resolved("default"), pair("/project/pipelines/default.toml", "default"));
        assert_eq!(resolved("papers/civic"), pair("/project/pipelines/papers/civic.toml", "papers/civic"));
        assert_eq!(
            resolved("pipelines/papers/civic.toml"),
            pair("/project/pipelines/papers/civic.toml", "papers/civic")
        );
        assert_eq!(resolved("none.toml"), pair("/project/pipelines/none.toml", "none"));
        assert_eq!(resolved("./my own.toml"), pair("./my own.toml", "my own"));
        assert_eq!(resolved("/else/where/p.toml"), pair("/else/where/p.toml", "p"));
    }

    #[test]
    fn the_pipeline_of_a_run_is_in_its_folder_or_named_by_its_summary() {
        let project = tempfile::tempdir().unwrap();
        let folder = project.path().join("pipelines");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(folder.join("a.toml"), "[predict]\n").unwrap();
        std::fs::write(folder.join("b.toml"), "base = 'none'\n[ingest]\n").unwrap();
        let has = |name: &str, set: &[String]| {
            let read = Pipeline::resolve(name, project.path()).read(project.path(), set);
            read.map(|pipeline| pipeline.table("predict").is_some()).ok()
        };
        assert_eq!([has("a", &[]), has("b", &[]), has("missing", &[])], [Some(true), Some(false), None]);
        assert_eq!(has("a", &["predict=false".to_owned()]), Some(false));
        let of_run = || Pipeline::of_run(project.path(), "a", project.path()).name;
        assert_eq!(of_run(), "a");
        std::fs::write(project.path().join("summary.json"), "{\"pipeline\": \"b\"}").unwrap();
        assert_eq!(of_run(), "b");
        std::fs::write(project.path().join("summary.json"), "{\"pipeline\": \"elsewhere\"}").unwrap();
        assert_eq!(of_run(), "a");
        std::fs::write(project.path().join(PIPELINE_OF_A_RUN), "[run]\nname = 'mine'\n").unwrap();
        assert_eq!(of_run(), "mine");
    }
}
