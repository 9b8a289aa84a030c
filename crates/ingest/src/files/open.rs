//! A record from the disk: the main file, the files beside it that belong to it, the sidecar.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crumple_artifact::refuse_named_pipe;
use crumple_signal::SIMULATED;
use rayon::prelude::*;

use crate::error::WHAT_IS_READ;
use crate::files::zip;
use crate::formats::iso_mme::{channel_file, is_channel_folder, is_channel_name};
use crate::formats::reader::{
    Bundle, FILE_LIMIT, LargeFile, NamedBytes, ReadSeek, Reader, ShowProgress, Stamp, check_total, stem,
};
use crate::formats::registry::{is_ending_of_a_record, recognise};
use crate::formats::simulation;
use crate::{IngestError, IngestSettings, Result, check_size, refuse_path, refuse_size};

/// Tables above this are read piece by piece, bytes.
const STREAM_ABOVE: u64 = 64 << 20;
/// Start of such a table that is looked at for its layout, bytes.
const HEAD_OF_LARGE: u64 = 16 << 20;
/// Start of a file by which its format is known, bytes.
const HEAD: u64 = 8192;
/// Start of a file by which a simulation is known: the names of a table in front of its first row, bytes.
const HEAD_OF_SIMULATION: u64 = 1 << 20;
/// Files up to this are read at once; of larger ones is shown how far they are read, bytes.
const AT_ONCE: u64 = 4 << 20;
/// Largest table, bytes.
const LARGE_LIMIT: u64 = 64 << 30;

impl Bundle {
    /// Reads a file, a folder with one NHTSA or ISO-MME test, or a zip archive of either.
    pub fn open(path: &Path) -> Result<Self> {
        Self::open_with_progress(path, |_, _| Box::new(|_| ()))
    }

    /// The same, showing how far it has come.
    pub fn open_with_progress(path: &Path, show: ShowProgress) -> Result<Self> {
        let (name, main_path) = name_and_main_file(path)?;
        let length = fs::metadata(&main_path).map_err(|error| unreadable(&main_path, &error))?.len();
        if length > STREAM_ABOVE
            && let Some(mut bundle) = Self::open_large(&main_path, length, show)?
        {
            bundle.sidecar = sidecar_of(&main_path, show)?;
            return Ok(bundle);
        }
        if let Some(mut bundle) = Self::open_on_disk(&name, &main_path)? {
            bundle.sidecar = sidecar_of(&main_path, show)?;
            return Ok(bundle);
        }
        let bytes = read(&main_path, show)?;
        let mut bundle = if zip::is_zip(&bytes) {
            let mut bundle = zip::open(&name, &bytes)?;
            if zip::is_tdm(&name) {
                bundle.read_companions(&main_path, show)?;
            }
            bundle
        } else {
            let mut bundle = Self::from_bytes(&file_name(&main_path), bytes)?;
            bundle.name = name;
            bundle.read_companions(&main_path, show)?;
            bundle
        };
        bundle.sidecar = sidecar_of(&main_path, show)?;
        Ok(bundle)
    }

    /// A record whose reader takes pieces from where they stand: its files stay on the disk. `None` for other formats,
    /// and for files that fit into memory.
    fn open_on_disk(name: &str, main_path: &Path) -> Result<Option<Self>> {
        let (main_name, start) = (file_name(main_path), head(main_path, HEAD)?);
        let Some(reader) = recognise(&main_name, &start).ok().filter(|reader| reader.seeks) else { return Ok(None) };
        let (companions, _) = companions_of(reader, &main_name, main_path)?;
        let mut stamps = Vec::new();
        for (name, path) in std::iter::once((main_name.clone(), main_path.to_owned())).chain(companions) {
            let file = Unchanging::open(&path).map_err(|error| unreadable(&path, &error))?;
            stamps.push((name, path, file.stamp));
        }
        let total: u64 = stamps.iter().map(|(.., stamp)| stamp.length).sum();
        if total <= STREAM_ABOVE {
            return Ok(None);
        }
        let changed = io::Error::new(io::ErrorKind::ResourceBusy, "one of its files changed while it was read");
        let digests = Self::digests_at(main_path).ok_or_else(|| unreadable(main_path, &changed))?;
        let mut bundle = Self::with_reader(&main_name, start, reader);
        name.clone_into(&mut bundle.name);
        let files = stamps
            .into_iter()
            .map(|(name, path, stamp)| (name, LargeFile::new(path, stamp, digests.record.clone(), opened)));
        bundle.on_disk = files.collect();
        Ok(Some(bundle))
    }

    /// A long table: its start in memory, the rest read when it is parsed. `None` for another format.
    fn open_large(path: &Path, length: u64, show: ShowProgress) -> Result<Option<Self>> {
        let start = head(path, HEAD_OF_LARGE)?;
        if zip::is_zip(&start) || !(recognise(&file_name(path), &start)?.streams)(&start) {
            return Ok(None);
        }
        if length > LARGE_LIMIT {
            return refuse_size(
                path.display(),
                format!("{} GiB", length >> 30),
                format!("tables up to {} GiB", LARGE_LIMIT >> 30),
            );
        }
        let mut hasher = blake3::Hasher::new();
        let file = Unchanging::open(path).map_err(|error| unreadable(path, &error))?;
        let stamp = file.stamp;
        let watched = Watched { inner: file, done: show(format!("digest of {}", file_name(path)), length) };
        hasher.update_reader(watched).map_err(|error| unreadable(path, &error))?;
        let mut bundle = Self::from_bytes(&file_name(path), start)?;
        let digest = format!("blake3:{}", hasher.finalize().to_hex());
        bundle.large = Some(LargeFile::new(path.to_owned(), stamp, digest, opened));
        bundle.show_progress = show;
        Ok(Some(bundle))
    }

    fn read_companions(&mut self, main_path: &Path, show: ShowProgress) -> Result<()> {
        let (files, total) = companions_of(self.reader, &self.main.name, main_path)?;
        check_total(&self.name, total)?;
        let contents: Vec<_> = files.par_iter().map(|(_, path)| read(path, show)).collect();
        for ((name, _), bytes) in files.into_iter().zip(contents) {
            self.companions.insert(name, bytes?);
        }
        if self.reader.spans_folders && self.companions.is_empty() {
            // The channels of a test may lie in an archive beside its description.
            let folder = main_path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            for path in entries(folder)?.iter().filter(|path| is_channel_archive(path)) {
                zip::add_from(&file_name(path), &read(path, show)?, self)?;
            }
        }
        check_total(&self.name, self.companions.values().map(|bytes| bytes.len() as u64).sum())
    }
}

/// The name of a record, and the file that stands for it.
pub(crate) fn name_and_main_file(path: &Path) -> Result<(String, PathBuf)> {
    let is_folder = fs::metadata(path).map_err(|error| unreadable(path, &error))?.is_dir();
    let main_path = if is_folder { main_file_of(path)? } else { path.to_owned() };
    refuse_named_pipe(&main_path).map_err(|error| unreadable(&main_path, &error))?;
    Ok((file_name(if is_folder { path } else { &main_path }), main_path))
}

/// Whether a file or a folder is the result of a simulation, by how its main file starts.
pub fn is_simulation(path: &Path) -> bool {
    let head = name_and_main_file(path).and_then(|(name, file)| Ok((name, head(&file, HEAD_OF_SIMULATION)?)));
    let reader = head.and_then(|(name, head)| recognise(&name, &head));
    reader.is_ok_and(|reader| SIMULATED.contains(&reader.format))
}

/// The files beside the main file that belong to its record, by name, and the bytes of all.
pub(crate) fn companions_of(
    reader: &Reader,
    main_name: &str,
    main_path: &Path,
) -> Result<(Vec<(String, PathBuf)>, u64)> {
    let may_have = |ending: &str| (reader.companion)(main_name, &format!("{}.{ending}", stem(main_name)));
    if !["001", "tdx"].into_iter().any(may_have) && !simulation::has_companions(reader) {
        return Ok((Vec::new(), 0));
    }
    let folder = main_path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut folders = vec![folder.to_owned()];
    if reader.spans_folders {
        folders.extend(channel_folder(folder)?);
        folders.extend(folder.parent().filter(|_| is_channel_folder(&file_name(folder))).map(Path::to_owned));
    }
    let mut files = BTreeMap::new();
    let mut total = 0_u64;
    for folder in folders {
        for path in entries(&folder)? {
            let name = file_name(&path);
            let known = name == main_name || files.contains_key(&name);
            if (reader.companion)(main_name, &name)
                && !known
                && let Ok(metadata) = fs::metadata(&path)
                && metadata.is_file()
            {
                total = total.saturating_add(metadata.len());
                files.insert(name, path);
            }
        }
    }
    Ok((files.into_iter().collect(), total))
}

/// A reader that tells how many bytes were read.
struct Watched<R> {
    inner: R,
    done: Box<dyn FnMut(u64)>,
}

impl<R: Read> Read for Watched<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        (self.done)(count as u64);
        Ok(count)
    }
}

/// A file whose end is an error where it was written to since its stamp was taken: half of the old and half of the new
/// is no record.
pub(crate) struct Unchanging {
    file: fs::File,
    pub(crate) stamp: Stamp,
}

impl Unchanging {
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let file = fs::File::open(path)?;
        let stamp = stamp_of(&file)?;
        Ok(Self { file, stamp })
    }
}

impl Read for Unchanging {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        if count == 0 && !buffer.is_empty() && stamp_of(&self.file)? != self.stamp {
            return Err(io::Error::new(io::ErrorKind::ResourceBusy, "it changed while it was read"));
        }
        Ok(count)
    }
}

impl Seek for Unchanging {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

fn stamp_of(file: &fs::File) -> io::Result<Stamp> {
    let metadata = file.metadata()?;
    Ok(Stamp { length: metadata.len(), modified: metadata.modified().ok() })
}

/// The file of the stamp.
fn opened(path: &Path, stamp: Stamp) -> io::Result<Box<dyn ReadSeek>> {
    Ok(Box::new(Unchanging { file: fs::File::open(path)?, stamp }))
}

pub(crate) fn file_name(path: &Path) -> String {
    // `..` and `.` have no name of their own.
    let name = path
        .file_name()
        .map(OsStr::to_os_string)
        .or_else(|| path.canonicalize().ok().and_then(|full| full.file_name().map(OsStr::to_os_string)));
    name.map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

fn read(path: &Path, show: ShowProgress) -> Result<Vec<u8>> {
    let metadata = fs::metadata(path).map_err(|error| unreadable(path, &error))?;
    if is_device(metadata.file_type()) {
        return Err(unreadable(path, &io::Error::new(io::ErrorKind::InvalidInput, "it is a device, not a file")));
    }
    let length = metadata.len();
    let check_length = |bytes| check_size(path.display(), bytes, FILE_LIMIT, "# MiB", "files up to # MiB");
    check_length(length)?;
    let read = || -> io::Result<Vec<u8>> {
        let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
        let mut file = Unchanging::open(path)?;
        // A pipe states no length.
        if length <= AT_ONCE {
            (&file.file).take(FILE_LIMIT + 1).read_to_end(&mut bytes)?;
            // Its end: whether it is still the file that it was.
            let _ = file.read(&mut [0])?;
        } else {
            let done = show(format!("reading {}", file_name(path)), length);
            Watched { inner: file, done }.take(FILE_LIMIT + 1).read_to_end(&mut bytes)?;
        }
        Ok(bytes)
    };
    let bytes = read().map_err(|error| unreadable(path, &error))?;
    check_length(bytes.len() as u64).map(|()| bytes)
}

/// Whether it is a device. Elsewhere than on Unix these are not files.
#[cfg(unix)]
fn is_device(kind: fs::FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_char_device() || kind.is_block_device()
}

/// Whether it is a device. Elsewhere than on Unix these are not files.
#[cfg(not(unix))]
fn is_device(_: fs::FileType) -> bool {
    false
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let list = fs::read_dir(folder).map_err(|error| unreadable(folder, &error))?;
    let mut paths: Vec<PathBuf> = list.filter_map(Result::ok).map(|entry| entry.path()).collect();
    paths.sort();
    Ok(paths)
}

fn is_channel_archive(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("zip")) && path.is_file()
}

fn channel_folder(folder: &Path) -> Result<Option<PathBuf>> {
    Ok(entries(folder)?.into_iter().find(|path| is_channel_folder(&file_name(path)) && path.is_dir()))
}

/// The file that stands for a folder: its one EV5 file; else the test file, the channel list or the first channel file
/// of an ISO-MME test; else what its only subfolder has.
fn main_file_of(folder: &Path) -> Result<PathBuf> {
    let all = entries(folder)?;
    let mut places = all.clone();
    if let Some(channel) = channel_folder(folder)? {
        places.extend(entries(&channel)?);
    }
    for extension in ["ev5", "mme", "chn"] {
        let is_it =
            |path: &&PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension)) && path.is_file();
        let candidates: Vec<&PathBuf> = places.iter().filter(is_it).collect();
        match candidates.as_slice() {
            [one] => return Ok((*one).clone()),
            [] => {}
            several => {
                return refuse_path(
                    folder.display(),
                    format!(
                        "a folder with {} .{} files: {}",
                        several.len(),
                        extension.to_uppercase(),
                        several.iter().take(10).map(|p| file_name(p)).collect::<Vec<_>>().join(", ")
                    ),
                    "the folder of one test",
                    format!("give the .{} file of the test", extension.to_uppercase()),
                );
            }
        }
    }
    for path in places.iter().filter(|path| is_channel_name(&file_name(path)) && path.is_file()) {
        if channel_file::recognises(&head(path, 8192)?) {
            return Ok(path.clone());
        }
    }
    let mut results: Vec<(u8, &PathBuf)> =
        all.iter().filter_map(|path| Some((simulation::rank(&file_name(path))?, path))).collect();
    results.sort();
    for (_, path) in results.into_iter().filter(|(_, path)| path.is_file()) {
        if simulation::is_result(&head(path, 8192)?) {
            return Ok(path.clone());
        }
    }
    if all.iter().any(|path| file_name(path) == "metadata.yaml") {
        let is_mcap = |path: &&PathBuf| path.extension().is_some_and(|ending| ending == "mcap");
        if let [only] = all.iter().filter(is_mcap).collect::<Vec<_>>().as_slice() {
            return Ok((*only).clone());
        }
        return refuse_path(
            folder.display(),
            "a folder with a ROS 2 bag (rosbag2), which is not read as it is",
            WHAT_IS_READ,
            format!(
                "convert it to MCAP: write \"output_bags: [{{uri: converted, storage_id: mcap, all: true}}]\" into \
                 out.yaml, run \"ros2 bag convert -i {} -o out.yaml\", and give converted/converted_0.mcap",
                folder.display()
            ),
        );
    }
    if let [only] = all.as_slice()
        && only.is_dir()
    {
        return main_file_of(only);
    }
    let records: Vec<&PathBuf> = all.iter().filter(|path| path.is_file() && is_named_as_a_record(path)).collect();
    match records.as_slice() {
        [only] => Ok((*only).clone()),
        [first, _, ..] => refuse_path(
            folder.display(),
            format!("a folder with {} files that are records each by its name: {}", records.len(), file_name(first)),
            "the folder of one test, or a file",
            format!("crumple fleet {} runs each of them; of one test give the file with its pulse", folder.display()),
        ),
        [] => refuse_path(
            folder.display(),
            format!("a folder without an .EV5 file or an ISO-MME test ({} other entries)", all.len()),
            "the folder of one test, or a file",
            "give the file itself, such as crash.csv",
        ),
    }
}

/// Whether a file ends as tables and containers do, texts aside, which may be a readme; its content decides when it is
/// read.
fn is_named_as_a_record(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| is_ending_of_a_record(&ending))
}

pub(crate) fn head(path: &Path, length: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let file = fs::File::open(path).map_err(|error| unreadable(path, &error))?;
    file.take(length).read_to_end(&mut bytes).map_err(|error| unreadable(path, &error))?;
    Ok(bytes)
}

pub(crate) fn sidecar_of(main_path: &Path, show: ShowProgress) -> Result<Option<NamedBytes>> {
    let path = crumple_stage::sidecar_of(main_path);
    if !path.is_file() {
        return Ok(None);
    }
    Ok(Some(NamedBytes { name: file_name(&path), bytes: read(&path, show)? }))
}

fn unreadable(path: &Path, error: &io::Error) -> IngestError {
    let (found, hint) = match error.kind() {
        io::ErrorKind::NotFound => ("no such file or folder".to_owned(), "check the path"),
        io::ErrorKind::PermissionDenied => ("no permission to read it".to_owned(), "check the file's permissions"),
        io::ErrorKind::ResourceBusy => (error.to_string(), "read it again once it is written"),
        io::ErrorKind::InvalidInput => (error.to_string(), "give the file with the record"),
        _ => (error.to_string(), "check the path and the disk"),
    };
    IngestError::path(path.display(), found, format!("{WHAT_IS_READ}, or the folder of a test"), hint)
}

/// Reads a sidecar. An unknown key is refused; a value has its unit in it.
pub fn parse(file: &str, bytes: &[u8]) -> Result<IngestSettings> {
    const EXPECTED: &str = "lines such as mass = \"873 kg\"";
    let refuse = |found: String, hint: &str| IngestError::content(file, found, EXPECTED, hint);
    let text = std::str::from_utf8(bytes)
        .map_err(|_| refuse("the text is not UTF-8".to_owned(), "save the sidecar as UTF-8"))?;
    let table: toml::Table = text
        .parse()
        .map_err(|error: toml::de::Error| refuse(one_line(&error.to_string()), "put text values in quotes"))?;
    for key in table.keys() {
        if !IngestSettings::KEYS.contains(&key.as_str()) {
            return Err(IngestError::unknown_key(
                file,
                key,
                EXPECTED,
                format!("the keys are: {}", IngestSettings::KEYS.join(", ")),
            ));
        }
    }
    table
        .try_into()
        .map_err(|error: toml::de::Error| refuse(one_line(error.message()), "write the value with its unit, in quotes"))
}

/// What the sidecar of a record states; nothing where there is none.
pub fn settings(bundle: &Bundle) -> Result<IngestSettings> {
    bundle
        .sidecar
        .as_ref()
        .map_or_else(|| Ok(IngestSettings::default()), |sidecar| parse(&sidecar.name, &sidecar.bytes))
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn a_file_that_grows_while_it_is_read_is_refused() -> io::Result<()> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("crash.csv");
        fs::write(&path, "0,1\n0.1,2\n")?;
        let mut text = String::new();
        assert_eq!(Unchanging::open(&path)?.read_to_string(&mut text)?, 10);
        let mut reader = Unchanging::open(&path)?;
        reader.read_exact(&mut [0; 4])?;
        fs::OpenOptions::new().append(true).open(&path)?.write_all(b"0.2,3\n")?;
        let error = reader.read_to_string(&mut text).map_err(|error| error.to_string());
        assert_eq!(error, Err("it changed while it was read".to_owned()));
        Ok(())
    }

    #[test]
    fn every_key_is_read_and_a_value_with_its_unit() {
        let texts = "channel unit time_unit skip_to sheet field vehicle title barrier wall".split(' ');
        let texts = texts.map(|key| format!("{key} = \"x\"\n")).collect::<String>();
        let units = "mass = '873 kg'\nimpact_speed = '36 km/h'\ntime_zero = '1 s'\n\
            sample_time = '1 s'\nresample = '9 Hz'\ntime_zero_uncertainty = '1 ms'\ntime_zero_rule = 'edr'\n\
            scale = 'a=50mV/g'";
        let words = "sign = 'flip'\nkind = 'sled'\nprofile = 'edr'\nplace = 'head'\nimpact = 1\nvehicle_number = 1\n\
            overlap = 'glancing'\nallow_missing = true\nunits = 'mm-s-t'\nnode = '7'\naxis = 'x'";
        let text = format!("{units}\n{words}\n{texts}");
        assert!(IngestSettings::KEYS.iter().all(|key| text.lines().any(|line| line.starts_with(&format!("{key} =")))));
        let settings = parse("a.toml", text.as_bytes()).unwrap();
        assert_eq!((settings.mass.unwrap().si(), settings.impact_speed.unwrap().si()), (873.0, 10.0));
        assert_eq!((settings.sign, settings.channel.as_deref()), (Some(crate::Sign::Flip), Some("x")));
    }

    #[test]
    fn an_unknown_key_is_refused() {
        let error = parse("a.toml", b"impact-sped = \"36 km/h\"\n").unwrap_err();
        assert_eq!(error.to_string(), "a.toml: unknown key \"impact-sped\"");
        assert!(error.hint().starts_with("the keys are: mass, impact_speed, "), "{}", error.hint());
    }

    #[test]
    fn asks_back_for_a_unit() {
        let error = parse("a.toml", b"mass = 873\n").unwrap_err();
        assert!(error.to_string().contains("\"873\" has no unit"), "{error}");
    }
}
