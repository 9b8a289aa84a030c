//! What a passport says of the files of a run.

use std::path::Path;

use crumple_stage::Refused;

/// Folder of the record in a crate.
const OF_RECORD: &str = "record";

/// What a file is to the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Role {
    /// The record, or the file of options beside it.
    Input,
    /// The pipeline, or what the run made.
    Own,
}

/// A file that a run was made from, or that it made.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Item {
    /// Its name: `crash.csv`, `4-identify.mcap`.
    pub name: String,
    pub role: Role,
    /// Bytes; of a record that was not at hand unknown.
    pub size: Option<u64>,
    /// Digest of its bytes; that of a record of several files is in `content`.
    pub bytes: Option<String>,
    /// Digest of what it holds: of an artifact whatever its compression, of a record as it is read.
    pub content: Option<String>,
    /// Whether it is in the crate.
    pub is_inside: bool,
}

impl Item {
    /// Its path in a crate that holds it.
    pub(crate) fn place(&self) -> String {
        match self.role {
            Role::Input => format!("{OF_RECORD}/{}", self.name),
            Role::Own => self.name.clone(),
        }
    }

    /// The digest that is compared.
    pub(crate) fn compared(&self) -> Option<&str> {
        self.content.as_deref().or(self.bytes.as_deref())
    }
}

/// The files of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Contents {
    /// Version of Crumple.
    pub version: String,
    pub pipeline: Item,
    pub record: Item,
    /// The file of options beside the record.
    pub sidecar: Option<Item>,
    /// In the order of the chain.
    pub results: Vec<Item>,
}

impl Contents {
    /// All files, those that were there first in front.
    pub(crate) fn items(&self) -> impl Iterator<Item = &Item> {
        [&self.pipeline, &self.record].into_iter().chain(&self.sidecar).chain(&self.results)
    }
}

/// Errors: a path that leaves the folder that it is in.
pub(crate) fn refuse_path_that_leaves(file: &Path, path: &str) -> Result<(), Refused> {
    let is_normal = |part| matches!(part, std::path::Component::Normal(_));
    let stays = !path.is_empty() && !path.contains(['\\', '\0']) && Path::new(path).components().all(is_normal);
    if stays {
        return Ok(());
    }
    Err(damaged(file, format!("the path {path:?} leads out of the crate")))
}

/// A crate that cannot be used as it is.
pub(crate) fn damaged(file: &Path, found: impl std::fmt::Display) -> Refused {
    Refused::new(format!("{}: {found}", file.display()))
        .expected("a folder or a .zip as crumple passport writes it")
        .hint("ask who made it for another copy")
}
