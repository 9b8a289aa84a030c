//! The record of a run: where it lies, whether it is what the run read, whether it is one file.

use std::fs;
use std::path::{Path, PathBuf};

use crumple_ingest::{Bundle, RecordDigests};
use crumple_stage::records::SourceV1;
use crumple_stage::{Refused, sidecar_of};

use super::contents::{Item, Role};
use super::crate_files::is_zip;
use crate::program::digest_of;

/// The record of a run and the file of options beside it, with their places where they are at hand as they were.
#[derive(Debug)]
pub(crate) struct Record {
    pub item: Item,
    pub path: Option<PathBuf>,
    pub sidecar: Option<Item>,
    pub sidecar_path: Option<PathBuf>,
}

impl Record {
    /// Errors: it shall go in and is not at hand, another one by now, or more than one file.
    pub(crate) fn find(
        at: Option<PathBuf>,
        noted: &str,
        source: &SourceV1,
        sidecar: Option<&str>,
        with_record: bool,
    ) -> anyhow::Result<Self> {
        let found = at.and_then(|path| Some((digests(&path).ok()?, path)));
        let same = found.filter(|(digests, _)| digests.record == source.digest);
        let refused = |problem: String, hint: &str| {
            Refused::new(problem).expected("the record as the run read it, in one file").hint(hint.to_owned())
        };
        if with_record && same.is_none() {
            let problem = format!("the record {noted:?} is not at hand, or another one by now");
            return Err(refused(problem, "say where it is as it was: --record FILE; or leave out --with-record").into());
        }
        let single = same.as_ref().map(|(_, path)| path.as_path()).filter(|path| is_one_file(path));
        if with_record && single.is_none() {
            let problem = format!("the record {noted:?} is more than one file");
            return Err(refused(problem, "pack it into a zip archive and run that: crumple run TEST.zip").into());
        }
        let input = |name: String, path: Option<&Path>, content: &str, goes_in: bool| Item {
            name,
            role: Role::Input,
            size: path.and_then(|path| fs::metadata(path).ok()).map(|file| file.len()),
            bytes: path.and_then(digest_of),
            content: Some(content.to_owned()),
            is_inside: goes_in && path.is_some(),
        };
        let item = input(source.name.clone(), single, &source.digest, with_record);
        // Options are no samples: the file goes in, as the pipeline does.
        let beside = single.map(sidecar_of);
        let is_same = |path: &PathBuf| digest_of(path).as_deref() == sidecar;
        let sidecar_path = beside.filter(is_same);
        let name = sidecar_of(&source.name).display().to_string();
        // Without them nobody can run it again.
        let is_of_several_files = same.is_some() && single.is_none();
        if sidecar.is_some() && sidecar_path.is_none() && !is_of_several_files {
            let problem = format!("the options beside the record, {name}, are not what the run read");
            let hint = "put the file as it was beside the record and call it from where the run was made, or run again";
            return Err(refused(problem, hint).into());
        }
        let sidecar = sidecar.map(|digest| input(name, sidecar_path.as_deref(), digest, true));
        Ok(Self { item, path: single.map(Path::to_owned), sidecar, sidecar_path })
    }
}

/// Digests of a record as it is now.
pub(crate) fn digests(record: &Path) -> anyhow::Result<RecordDigests> {
    match Bundle::digests_at(record) {
        Some(digests) => Ok(digests),
        None => Ok(Bundle::open(record).map_err(|error| Refused::new(error.to_string()))?.digests()),
    }
}

/// Whether a record is a single file, beside its options: a table, an archive.
pub(crate) fn is_one_file(record: &Path) -> bool {
    let is_packed = is_zip(record);
    record.is_file() && (is_packed || Bundle::open(record).is_ok_and(|bundle| bundle.companions.is_empty()))
}
