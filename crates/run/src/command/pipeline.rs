//! Which pipeline file is meant, and its name.

use std::path::{Path, PathBuf};

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
    /// Whether the file has a table of this name. One that cannot be read has: the stages say why.
    pub(crate) fn has_table(&self, name: &str) -> bool {
        let text = std::fs::read_to_string(&self.file).ok();
        let table: Option<toml::Table> = text.and_then(|text| text.parse().ok());
        table.is_none_or(|table| table.contains_key(name))
    }

    /// The pipeline of a run that was made: that of its summary where the project has it, else what is typed.
    pub(crate) fn of_run(folder: &Path, typed: &str, project: &Path) -> Self {
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
    fn a_table_is_looked_for_in_the_file_and_the_pipeline_of_a_run_in_its_summary() {
        let project = tempfile::tempdir().unwrap();
        let folder = project.path().join("pipelines");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(folder.join("a.toml"), "[predict]\n").unwrap();
        std::fs::write(folder.join("b.toml"), "[ingest]\n").unwrap();
        let has = |name: &str| Pipeline::resolve(name, project.path()).has_table("predict");
        assert_eq!([has("a"), has("b"), has("missing")], [true, false, true]);
        let of_run = || Pipeline::of_run(project.path(), "a", project.path()).name;
        assert_eq!(of_run(), "a");
        std::fs::write(project.path().join("summary.json"), "{\"pipeline\": \"b\"}").unwrap();
        assert_eq!(of_run(), "b");
        std::fs::write(project.path().join("summary.json"), "{\"pipeline\": \"elsewhere\"}").unwrap();
        assert_eq!(of_run(), "a");
    }
}
