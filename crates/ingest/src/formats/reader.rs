//! What a reader is and what it sees: the bytes of one record.

use std::collections::BTreeMap;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::recording::content::Recording;
use crate::{IngestSettings, Result, refuse_size};

/// Largest file that is read, bytes.
pub const FILE_LIMIT: u64 = 1 << 30;
/// Most memory the files of one record may take, bytes.
const TOTAL_LIMIT: u64 = 2 << 30;

/// A format that is read. To add one: a file with a constant of this type, and a line in
/// [`READERS`](crate::formats::registry::READERS).
#[derive(Clone, Copy)]
pub struct Reader {
    /// Name in artifacts: `csv`, `nhtsa-ev5`.
    pub format: &'static str,
    /// Whether a file that starts with these bytes (up to 8192) is of this format.
    pub recognises: fn(head: &[u8]) -> bool,
    /// Whether the file `name` beside the main file `main` belongs to the same record.
    pub companion: fn(main: &str, name: &str) -> bool,
    /// Whether files of the record may also lie in the folder `Channel` beside the main file, or in its parent.
    pub spans_folders: bool,
    /// Whether a file that starts with these bytes can be read piece by piece, when it is too long for memory.
    pub streams: fn(head: &[u8]) -> bool,
    /// Whether pieces of its files are read where they stand: long ones stay on the disk.
    pub seeks: bool,
    /// Flags about the form of a file that have an effect here, `--unit`; others given are warned about.
    pub relevant_flags: &'static [&'static str],
    /// Whether mass and impact speed can be stated in comment lines of the file.
    pub has_comments: bool,
    /// Reads the record. Sees bytes only; the same bytes and settings give the same recording.
    pub read: fn(&Bundle, &IngestSettings) -> Result<Recording>,
}

impl Reader {
    /// A format of one file, which is read whole.
    pub(crate) const fn of_one_file(
        format: &'static str,
        recognises: fn(&[u8]) -> bool,
        relevant_flags: &'static [&'static str],
        read: fn(&Bundle, &IngestSettings) -> Result<Recording>,
    ) -> Self {
        Self {
            format,
            recognises,
            companion: |_, _| false,
            spans_folders: false,
            streams: |_| false,
            seeks: false,
            relevant_flags,
            has_comments: false,
            read,
        }
    }
}

/// What a library makes of a file; a fault of its own on a damaged file is a refusal like any other.
pub(crate) fn guarded<T>(read: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err("its structure contradicts itself".to_owned()))
}

/// A file's name without folder, and its content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedBytes {
    /// Name without folder.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// Everything that is read of one record. What is made of it depends on these bytes and on nothing else.
pub struct Bundle {
    /// Name of the file or folder the user gave, without its parents.
    pub name: String,
    /// The file with the record, or its description.
    pub main: NamedBytes,
    /// Files beside it that belong to it, by name.
    pub companions: BTreeMap<String, Vec<u8>>,
    /// `<input>.toml` beside the input.
    pub sidecar: Option<NamedBytes>,
    /// The reader of the main file's format.
    pub reader: &'static Reader,
    /// A table too long to be held in memory as text: `main` has its start only.
    pub large: Option<LargeFile>,
    /// All files by name, where they are too long for memory and the reader seeks: `main` has the start of its only.
    pub on_disk: BTreeMap<String, LargeFile>,
    /// Shows how far the reading of a large file has come.
    pub show_progress: ShowProgress,
}

/// Shows how far work has come. Called with what is done and the bytes there are to it; what it returns is called with
/// the bytes of each piece done.
pub type ShowProgress = fn(what: String, total: u64) -> Box<dyn FnMut(u64)>;

/// What is read from any place on.
pub trait ReadSeek: io::Read + io::Seek {}
impl<T: io::Read + io::Seek> ReadSeek for T {}

/// Opens a file. Reading fails at its end where it is not the file of the stamp any more.
pub type Open = fn(path: &Path, stamp: Stamp) -> io::Result<Box<dyn ReadSeek>>;

/// What changes when a file is written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stamp {
    /// Bytes.
    pub length: u64,
    /// Time of the last change.
    pub modified: Option<SystemTime>,
}

/// A file that is read piece by piece.
#[derive(Debug, Clone)]
pub struct LargeFile {
    /// Its length, bytes.
    pub length: u64,
    path: PathBuf,
    stamp: Stamp,
    open: Open,
    digest: String,
}

impl LargeFile {
    /// A file at `path` with its stamp from before the digest of its record was taken, opened by `open`.
    pub fn new(path: PathBuf, stamp: Stamp, digest: String, open: Open) -> Self {
        Self { length: stamp.length, path, stamp, open, digest }
    }

    /// The file, to be read from any place on.
    pub fn open(&self) -> io::Result<Box<dyn ReadSeek>> {
        (self.open)(&self.path, self.stamp)
    }

    /// Its bytes from an offset on.
    pub fn from_offset(&self, offset: u64) -> io::Result<Box<dyn ReadSeek>> {
        let mut file = self.open()?;
        file.seek(io::SeekFrom::Start(offset))?;
        Ok(file)
    }
}

impl Bundle {
    /// Reads the record.
    pub fn read(&self, settings: &IngestSettings) -> Result<Recording> {
        (self.reader.read)(self, settings)
    }

    /// `blake3:<hex>` of the record. One file: of its bytes. Several: of each file's name, a zero byte, its length
    /// (u64, little-endian) and its bytes, the main file first, the others by name. The sidecar is not part of it.
    pub fn digest(&self) -> String {
        if let Some(large) = self.large.as_ref().or(self.on_disk.values().next()) {
            return large.digest.clone();
        }
        let mut hasher = blake3::Hasher::new();
        if self.companions.is_empty() {
            hasher.update(&self.main.bytes);
        } else {
            let main = (self.main.name.as_str(), &self.main.bytes);
            let others = self.companions.iter().map(|(name, bytes)| (name.as_str(), bytes));
            for (name, bytes) in std::iter::once(main).chain(others) {
                hasher.update(&framed(name, bytes.len() as u64));
                hasher.update(bytes);
            }
        }
        format!("blake3:{}", hasher.finalize().to_hex())
    }
}

/// What stands before the bytes of each of several files in [`Bundle::digest`].
pub(crate) fn framed(name: &str, length: u64) -> Vec<u8> {
    [name.as_bytes(), &[0], &length.to_le_bytes()].concat()
}

/// Refuses more than [`TOTAL_LIMIT`].
pub fn check_total(name: &str, total: u64) -> Result<()> {
    if total <= TOTAL_LIMIT {
        return Ok(());
    }
    refuse_size(
        name,
        format!("the files of the record take more than {} MiB", TOTAL_LIMIT >> 20),
        format!("at most {} MiB for one test", TOTAL_LIMIT >> 20),
    )
}

/// A file's name without its last extension.
pub fn stem(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}
