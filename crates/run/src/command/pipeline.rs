//! Which pipeline file is meant, and its name.

use std::path::{Path, PathBuf};

/// A pipeline file and the name that its run folders have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Pipeline {
    /// The file.
    pub(crate) file: PathBuf,
    /// `default`, `papers/civic`.
    pub(crate) name: String,
}

impl Pipeline {
    /// The path of a file is that file; all else is a name below `pipelines/` of the project.
    pub(crate) fn resolve(text: &str, project: &Path) -> Self {
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
}
