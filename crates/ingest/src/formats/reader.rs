//! The files of one record, read into memory: the main file, the files beside it that belong to it, the sidecar.

use std::cell::{OnceCell, RefCell};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use crumple_stage::Progress;

use crate::error::WHAT_IS_READ;
use crate::files::zip;
use crate::formats::iso_mme::{self, is_channel_name};
use crate::formats::registry::{Reader, recognise};
use crate::{IngestError, Place};

/// Largest file that is read, bytes.
pub const FILE_LIMIT: u64 = 1 << 30;
/// Tables above this are read piece by piece, bytes.
const STREAM_ABOVE: u64 = 64 << 20;
/// Start of such a table that is looked at for its layout, bytes.
const HEAD_OF_LARGE: u64 = 16 << 20;
/// Largest table, bytes.
const LARGE_LIMIT: u64 = 64 << 30;
/// Most memory the files of one record may take, bytes.
pub const TOTAL_LIMIT: u64 = 2 << 30;

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
    pub reader: &'static dyn Reader,
    /// A table too long to be held in memory as text: `main` has its start only.
    pub large: Option<LargeFile>,
    /// Told of the bytes read of a large file.
    pub progress: OnceCell<RefCell<Progress>>,
}

/// A table that is read piece by piece.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LargeFile {
    /// Where it is.
    pub path: PathBuf,
    /// Its length, bytes.
    pub length: u64,
    digest: String,
}

impl Bundle {
    /// Reads a file, a folder with one NHTSA or ISO-MME test, or a zip archive of either.
    pub fn open(path: &Path) -> Result<Self, IngestError> {
        let metadata = fs::metadata(path).map_err(|error| unreadable(path, &error))?;
        let main_path = if metadata.is_dir() { main_file_of(path)? } else { path.to_owned() };
        let length = fs::metadata(&main_path).map_err(|error| unreadable(&main_path, &error))?.len();
        if length > STREAM_ABOVE
            && let Some(mut bundle) = Self::open_large(&main_path, length)?
        {
            bundle.sidecar = sidecar_of(&main_path)?;
            return Ok(bundle);
        }
        let bytes = read(&main_path)?;
        let name = file_name(if metadata.is_dir() { path } else { &main_path });
        let mut bundle = if zip::is_zip(&bytes) {
            zip::open(&name, &bytes)?
        } else {
            let mut bundle = Self::from_bytes(&file_name(&main_path), bytes)?;
            bundle.name = name;
            bundle.read_companions(&main_path)?;
            bundle
        };
        bundle.sidecar = sidecar_of(&main_path)?;
        Ok(bundle)
    }

    /// A long table: its start in memory, the rest read when it is parsed. `None` for another format.
    fn open_large(path: &Path, length: u64) -> Result<Option<Self>, IngestError> {
        let start = head(path, HEAD_OF_LARGE)?;
        if zip::is_zip(&start) || !recognise(&file_name(path), &start)?.streams(&start) {
            return Ok(None);
        }
        if length > LARGE_LIMIT {
            return Err(IngestError::TooLarge {
                place: Place::file(&path.display().to_string()),
                found: format!("{} GiB", length >> 30),
                limit: format!("tables up to {} GiB", LARGE_LIMIT >> 30),
            });
        }
        let mut hasher = blake3::Hasher::new();
        let file = fs::File::open(path).map_err(|error| unreadable(path, &error))?;
        let progress = Progress::new(format!("digest of {}", file_name(path)), length);
        hasher.update_reader(progress.watch(file)).map_err(|error| unreadable(path, &error))?;
        let mut bundle = Self::from_bytes(&file_name(path), start)?;
        let digest = format!("blake3:{}", hasher.finalize().to_hex());
        bundle.large = Some(LargeFile { path: path.to_owned(), length, digest });
        Ok(Some(bundle))
    }

    /// A record that is one file, already in memory.
    pub fn from_bytes(name: &str, bytes: Vec<u8>) -> Result<Self, IngestError> {
        let reader = recognise(name, &bytes)?;
        Ok(Self {
            name: name.to_owned(),
            main: NamedBytes { name: name.to_owned(), bytes },
            companions: BTreeMap::new(),
            sidecar: None,
            reader,
            large: None,
            progress: OnceCell::new(),
        })
    }

    fn read_companions(&mut self, main_path: &Path) -> Result<(), IngestError> {
        let may_have =
            |ending: &str| self.reader.companion(&self.main.name, &format!("{}.{ending}", stem(&self.main.name)));
        if !["001", "tdx"].into_iter().any(may_have) {
            return Ok(());
        }
        let folder = main_path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let mut folders = vec![folder.to_owned()];
        if self.reader.spans_folders() {
            folders.extend(channel_folder(folder)?);
            folders.extend(folder.parent().filter(|_| is_channel_folder(&file_name(folder))).map(Path::to_owned));
        }
        let mut total = 0;
        for folder in folders {
            for path in entries(&folder)? {
                let name = file_name(&path);
                let known = name == self.main.name || self.companions.contains_key(&name);
                if self.reader.companion(&self.main.name, &name) && !known && path.is_file() {
                    let bytes = read(&path)?;
                    total += bytes.len() as u64;
                    check_total(&self.name, total)?;
                    self.companions.insert(name, bytes);
                }
            }
        }
        Ok(())
    }

    /// `blake3:<hex>` of the record. One file: of its bytes. Several: of each file's name, a zero byte, its length (u64,
    /// little-endian) and its bytes, the main file first, the others by name. The sidecar is not part of it.
    pub fn digest(&self) -> String {
        if let Some(large) = &self.large {
            return large.digest.clone();
        }
        let mut hasher = blake3::Hasher::new();
        if self.companions.is_empty() {
            hasher.update(&self.main.bytes);
        } else {
            let main = (self.main.name.as_str(), &self.main.bytes);
            let others = self.companions.iter().map(|(name, bytes)| (name.as_str(), bytes));
            for (name, bytes) in std::iter::once(main).chain(others) {
                hasher.update(name.as_bytes());
                hasher.update(&[0]);
                hasher.update(&(bytes.len() as u64).to_le_bytes());
                hasher.update(bytes);
            }
        }
        format!("blake3:{}", hasher.finalize().to_hex())
    }
}

/// Refuses more than [`TOTAL_LIMIT`].
pub(crate) fn check_total(name: &str, total: u64) -> Result<(), IngestError> {
    if total <= TOTAL_LIMIT {
        return Ok(());
    }
    Err(IngestError::TooLarge {
        place: Place::file(name),
        found: format!("the files of the record take more than {} MiB", TOTAL_LIMIT >> 20),
        limit: format!("at most {} MiB for one test", TOTAL_LIMIT >> 20),
    })
}

/// A file's name without its last extension.
pub(crate) fn stem(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

fn file_name(path: &Path) -> String {
    // `..` and `.` have no name of their own.
    let name = path
        .file_name()
        .map(OsStr::to_os_string)
        .or_else(|| path.canonicalize().ok().and_then(|full| full.file_name().map(OsStr::to_os_string)));
    name.map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

fn read(path: &Path) -> Result<Vec<u8>, IngestError> {
    let length = fs::metadata(path).map_err(|error| unreadable(path, &error))?.len();
    if length > FILE_LIMIT {
        return Err(IngestError::TooLarge {
            place: Place::file(&path.display().to_string()),
            found: format!("{} MiB", length >> 20),
            limit: format!("files up to {} MiB", FILE_LIMIT >> 20),
        });
    }
    let read = || -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
        Progress::of_reading(path).watch(fs::File::open(path)?).read_to_end(&mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|error| unreadable(path, &error))
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, IngestError> {
    let list = fs::read_dir(folder).map_err(|error| unreadable(folder, &error))?;
    let mut paths: Vec<PathBuf> = list.filter_map(Result::ok).map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths)
}

/// The folder of channel files in an ISO-MME test, in any case.
pub(crate) fn is_channel_folder(name: &str) -> bool {
    name.eq_ignore_ascii_case("channel") || name.eq_ignore_ascii_case("channels")
}

fn channel_folder(folder: &Path) -> Result<Option<PathBuf>, IngestError> {
    Ok(entries(folder)?.into_iter().find(|path| is_channel_folder(&file_name(path)) && path.is_dir()))
}

/// The file that stands for a folder: its one EV5 file; else the test file, the channel list or the first channel file of
/// an ISO-MME test; else what its only subfolder has.
fn main_file_of(folder: &Path) -> Result<PathBuf, IngestError> {
    let all = entries(folder)?;
    let mut places = all.clone();
    if let Some(channel) = channel_folder(folder)? {
        places.extend(entries(&channel)?);
    }
    for extension in ["ev5", "mme", "chn"] {
        let is_it =
            |path: &&PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension)) && path.is_file();
        let found: Vec<&PathBuf> = places.iter().filter(is_it).collect();
        match found.as_slice() {
            [one] => return Ok((*one).clone()),
            [] => {}
            several => {
                return Err(IngestError::Path {
                    path: folder.display().to_string(),
                    found: format!(
                        "a folder with {} .{} files: {}",
                        several.len(),
                        extension.to_uppercase(),
                        several.iter().take(10).map(|p| file_name(p)).collect::<Vec<_>>().join(", ")
                    ),
                    expected: "the folder of one test".to_owned(),
                    hint: format!("give the .{} file of the test", extension.to_uppercase()),
                });
            }
        }
    }
    for path in places.iter().filter(|path| is_channel_name(&file_name(path)) && path.is_file()) {
        if iso_mme::IsoMme.recognises(&head(path, 8192)?) {
            return Ok(path.clone());
        }
    }
    match all.as_slice() {
        [only] if only.is_dir() => main_file_of(only),
        _ => Err(IngestError::Path {
            path: folder.display().to_string(),
            found: format!("a folder without an .EV5 file or an ISO-MME test ({} other entries)", all.len()),
            expected: "the folder of one test, or a file".to_owned(),
            hint: "give the file itself, such as crash.csv".to_owned(),
        }),
    }
}

fn head(path: &Path, length: u64) -> Result<Vec<u8>, IngestError> {
    let mut bytes = Vec::new();
    let file = fs::File::open(path).map_err(|error| unreadable(path, &error))?;
    file.take(length).read_to_end(&mut bytes).map_err(|error| unreadable(path, &error))?;
    Ok(bytes)
}

fn sidecar_of(main_path: &Path) -> Result<Option<NamedBytes>, IngestError> {
    let mut name = main_path.as_os_str().to_owned();
    name.push(".toml");
    let path = PathBuf::from(name);
    if !path.is_file() {
        return Ok(None);
    }
    Ok(Some(NamedBytes { name: file_name(&path), bytes: read(&path)? }))
}

fn unreadable(path: &Path, error: &std::io::Error) -> IngestError {
    let (found, hint) = match error.kind() {
        std::io::ErrorKind::NotFound => ("no such file or folder".to_owned(), "check the path"),
        std::io::ErrorKind::PermissionDenied => ("no permission to read it".to_owned(), "check the file's permissions"),
        _ => (error.to_string(), "check the path and the disk"),
    };
    IngestError::Path {
        path: path.display().to_string(),
        found,
        expected: format!("{WHAT_IS_READ}, or the folder of a test"),
        hint: hint.to_owned(),
    }
}
