//! The files of a crate, in a folder or in a zip archive: written with fixed times, read within limits.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_stage::Refused;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use super::contents::{damaged, refuse_path_that_leaves};

/// Most entries of an archive. A crate has a dozen.
const ENTRY_LIMIT: usize = 100;

/// What is written at a place of a crate.
pub(crate) enum Source {
    File(PathBuf),
    Text(String),
}

impl Source {
    pub(crate) fn size(&self) -> u64 {
        match self {
            Self::File(path) => fs::metadata(path).map_or(0, |file| file.len()),
            Self::Text(text) => text.len() as u64,
        }
    }

    fn copy(&self, to: &mut impl Write) -> io::Result<()> {
        match self {
            Self::File(path) => io::copy(&mut File::open(path)?, to).map(drop),
            Self::Text(text) => to.write_all(text.as_bytes()),
        }
    }
}

/// Writes a crate: a zip archive where the name ends so, else a folder.
pub(crate) fn write(output: &Path, files: &[(String, Source)]) -> anyhow::Result<()> {
    let cannot = || format!("cannot write {}", output.display());
    if !is_zip(output) {
        for (place, source) in files {
            let path = output.join(place);
            write_atomically(&path, OutputKind::Export, |file| source.copy(file)).with_context(cannot)?;
        }
        return Ok(());
    }
    // No clock and no rights of the disk: the same files give the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .large_file(files.iter().any(|(_, source)| source.size() > u64::from(u32::MAX)));
    write_atomically(output, OutputKind::Export, |file| -> anyhow::Result<()> {
        let mut zip = ZipWriter::new(file);
        for (place, source) in files {
            zip.start_file(place.as_str(), options)?;
            source.copy(&mut zip)?;
        }
        zip.finish()?.flush()?;
        Ok(())
    })
    .with_context(cannot)
}

pub(crate) fn is_zip(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("zip"))
}

/// The files of a crate that somebody gives.
pub(crate) enum CrateFiles {
    Folder(PathBuf),
    Zip(PathBuf, Box<ZipArchive<File>>),
}

impl CrateFiles {
    /// Errors: there is nothing, no archive, an entry whose path leaves the crate or that is a link.
    pub(crate) fn open(path: &Path) -> Result<Self, Refused> {
        if path.is_dir() {
            return Ok(Self::Folder(path.to_owned()));
        }
        let cannot = |error: &dyn std::fmt::Display| damaged(path, format!("cannot be read as a zip archive: {error}"));
        let file = File::open(path).map_err(|error| damaged(path, error))?;
        if !file.metadata().is_ok_and(|file| file.is_file()) {
            return Err(damaged(path, "is neither a folder nor a file"));
        }
        let mut zip = ZipArchive::new(file).map_err(|error| cannot(&error))?;
        if zip.len() > ENTRY_LIMIT {
            return Err(damaged(path, format!("{} entries, a crate has at most {ENTRY_LIMIT}", zip.len())));
        }
        for index in 0..zip.len() {
            let entry = zip.by_index_raw(index).map_err(|error| cannot(&error))?;
            let name = entry.name().map_err(|error| cannot(&error))?;
            refuse_path_that_leaves(path, &name)?;
            if entry.is_symlink() {
                return Err(damaged(path, format!("{name} is a link")));
            }
        }
        Ok(Self::Zip(path.to_owned(), Box::new(zip)))
    }

    pub(crate) fn path(&self) -> &Path {
        match self {
            Self::Folder(path) | Self::Zip(path, _) => path,
        }
    }

    /// A file of text.
    pub(crate) fn text(&mut self, place: &str, limit: u64) -> Result<String, Refused> {
        let mut bytes = Vec::new();
        if self.copy(place, limit, &mut bytes)?.is_none() {
            return Err(damaged(self.path(), format!("{place} has more than the {limit} bytes that it may have")));
        }
        String::from_utf8(bytes).map_err(|_| damaged(self.path(), format!("{place} is no text in UTF-8")))
    }

    /// Copies a file of at most so many bytes; its size and its digest, `None` where it has more. What an archive
    /// claims reserves nothing.
    pub(crate) fn copy(
        &mut self,
        place: &str,
        limit: u64,
        to: &mut dyn Write,
    ) -> Result<Option<(u64, String)>, Refused> {
        let crate_path = self.path().to_owned();
        let cannot = |error: &dyn std::fmt::Display| damaged(&crate_path, format!("{place} cannot be read: {error}"));
        refuse_path_that_leaves(&crate_path, place)?;
        let mut reader: Box<dyn Read> = match self {
            Self::Folder(folder) => Box::new(open_inside(folder, place)?),
            Self::Zip(_, zip) => Box::new(zip.by_name(place).map_err(|error| cannot(&error))?),
        };
        let (mut hasher, mut size, mut piece) = (blake3::Hasher::new(), 0, vec![0; 1 << 16]);
        loop {
            let count = reader.read(&mut piece).map_err(|error| cannot(&error))?;
            if count == 0 {
                return Ok(Some((size, format!("blake3:{}", hasher.finalize()))));
            }
            size += count as u64;
            if size > limit {
                return Ok(None);
            }
            hasher.update(&piece[..count]);
            to.write_all(&piece[..count]).map_err(|error| cannot(&error))?;
        }
    }
}

/// Opens a regular file below a folder, without following a link.
fn open_inside(folder: &Path, place: &str) -> Result<File, Refused> {
    let mut path = folder.to_owned();
    for part in Path::new(place).components() {
        path.push(part);
        let found = fs::symlink_metadata(&path).map_err(|error| damaged(&path, error))?;
        if found.is_symlink() {
            return Err(damaged(&path, "is a link, and a crate holds none"));
        }
    }
    if !path.is_file() {
        return Err(damaged(&path, "is no file"));
    }
    File::open(&path).map_err(|error| damaged(&path, error))
}
