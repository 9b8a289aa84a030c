//! Zip archives: one NHTSA or ISO-MME test, or one table, in any folder of the archive; a workbook; the packed header
//! of a TDM file.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use crate::formats::iso_mme::{channel_file, is_channel_folder, is_channel_name};
use crate::formats::reader::{Bundle, FILE_LIMIT, check_total, stem};
use crate::formats::registry::{CONTAINERS, NUMPY};
use crate::formats::workbook;
use crate::recording::content::MINIMUM_SAMPLES;
use crate::{IngestError, Result, check_size, refuse_path, refuse_size};

/// Most entries that are looked through.
const ENTRY_LIMIT: usize = 20_000;
/// Endings of names that may be tables; the content decides.
const TABLES: [&str; 6] = ["csv", "tsv", "txt", "dat", "asc", "prn"];

/// Whether these are the first bytes of a zip archive (an empty one included).
pub fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}

/// An entry: index in the archive, folder, name.
struct Entry {
    index: usize,
    folder: String,
    name: String,
}

impl Entry {
    fn has_extension(&self, endings: &[&str]) -> bool {
        endings.contains(&self.extension().as_str())
    }

    fn extension(&self) -> String {
        self.name.rsplit_once('.').map_or_else(String::new, |(_, e)| e.to_ascii_lowercase())
    }
}

/// Reads the one record in an archive. Names are compared only, nothing is unpacked to disk.
pub fn open(file: &str, bytes: &[u8]) -> Result<Bundle> {
    let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(file, error))?;
    if zip.len() > ENTRY_LIMIT {
        return refuse_size(
            file,
            format!("{} entries", zip.len()),
            format!("archives of one test, at most {ENTRY_LIMIT} files"),
        );
    }
    let entries = list_entries(&zip);
    if entries.iter().any(|e| e.folder == "xl" && e.name == "workbook.xml") {
        refuse_beyond_memory(file, entries.iter().map(|e| claimed_size(&mut zip, e)).sum())?;
        return Ok(Bundle::with_reader(file, bytes.to_vec(), &workbook::WORKBOOK));
    }
    refuse_documents(file, &entries)?;
    let mut total = 0;
    let main = match channel_file(file, &mut zip, &entries)? {
        Some(entry) => entry,
        None => main_entry(file, &mut zip, &entries)?,
    };
    let main_bytes = inflate(file, &mut zip, main, &mut total)?;
    let mut bundle = if is_zip(&main_bytes) && main.has_extension(&["tdm", "xlsx"]) {
        open(&main.name, &main_bytes)?
    } else {
        Bundle::from_bytes(&main.name, main_bytes)?
    };
    // DIAdem packs the header of a TDM file, whose samples lie beside it.
    if is_tdm(file) && main.name == "header.xml" {
        file.clone_into(&mut bundle.main.name);
    }
    file.clone_into(&mut bundle.name);
    add_companions(file, &mut zip, &entries, main, &mut bundle, &mut total)?;
    Ok(bundle)
}

pub fn is_tdm(file: &str) -> bool {
    file.to_ascii_lowercase().ends_with(".tdm")
}

/// Adds what an archive beside the main file of a record has of it.
pub fn add_from(file: &str, bytes: &[u8], bundle: &mut Bundle) -> Result<()> {
    let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(file, error))?;
    let entries = list_entries(&zip);
    let Some(first) = entries.iter().find(|entry| (bundle.reader.companion)(&bundle.main.name, &entry.name)) else {
        return Ok(());
    };
    let main = Entry { index: usize::MAX, folder: first.folder.clone(), name: bundle.main.name.clone() };
    add_companions(file, &mut zip, &entries, &main, bundle, &mut 0)
}

/// Adds the files of an archive that belong to its main file.
fn add_companions(
    file: &str,
    zip: &mut ZipArchive<Cursor<&[u8]>>,
    entries: &[Entry],
    main: &Entry,
    bundle: &mut Bundle,
    total: &mut u64,
) -> Result<()> {
    let is_companion = |entry: &&Entry| {
        let beside = entry.folder == main.folder
            || (bundle.reader.spans_folders && are_of_one_test(&main.folder, &entry.folder));
        let known = entry.index == main.index || bundle.companions.contains_key(&entry.name);
        beside && !known && (bundle.reader.companion)(&bundle.main.name, &entry.name)
    };
    let companions: Vec<&Entry> = entries.iter().filter(is_companion).collect();
    // By the sizes that the archive claims, before any is unpacked; that none holds more than it claims is checked
    // there.
    let mut claimed = *total;
    for entry in &companions {
        claimed = claimed.saturating_add(claimed_size(zip, entry));
        check_total(file, claimed)?;
    }
    refuse_beyond_memory(file, claimed - *total)?;
    for entry in companions {
        if !bundle.companions.contains_key(&entry.name) {
            let bytes = inflate(file, zip, entry, total)?;
            bundle.companions.insert(entry.name.clone(), bytes);
        }
    }
    Ok(())
}

/// The bytes that the archive says an entry has.
fn claimed_size(zip: &mut ZipArchive<Cursor<&[u8]>>, entry: &Entry) -> u64 {
    zip.by_index_raw(entry.index).map_or(0, |raw| raw.size())
}

/// Whether one folder is the folder `Channel` of the other.
fn are_of_one_test(a: &str, b: &str) -> bool {
    let channel_of = |inner: &str, outer: &str| {
        let (parent, name) = inner.rsplit_once('/').unwrap_or(("", inner));
        is_channel_folder(name) && parent == outer
    };
    channel_of(a, b) || channel_of(b, a)
}

/// The first channel file, where the archive has neither a description of a test nor tables but ISO-MME channel files.
fn channel_file<'a>(
    file: &str,
    zip: &mut ZipArchive<Cursor<&[u8]>>,
    entries: &'a [Entry],
) -> Result<Option<&'a Entry>> {
    if entries.iter().any(|e| e.has_extension(&["ev5", "mme", "chn"])) {
        return Ok(None);
    }
    let Some(first) = entries.iter().find(|e| is_channel_name(&e.name)) else { return Ok(None) };
    let bytes = inflate(file, zip, first, &mut 0)?;
    Ok(channel_file::recognises(&bytes[..bytes.len().min(8192)]).then_some(first))
}

fn list_entries(zip: &ZipArchive<Cursor<&[u8]>>) -> Vec<Entry> {
    let mut entries = Vec::new();
    for index in 0..zip.len() {
        let Some(Ok(path)) = zip.name_for_index(index) else { continue };
        let path = path.replace('\\', "/");
        let (folder, name) = path.rsplit_once('/').unwrap_or(("", &path));
        let junk = name.is_empty() || name.starts_with('.') || folder.split('/').any(|part| part == "__MACOSX");
        if !junk {
            entries.push(Entry { index, folder: folder.to_owned(), name: name.to_owned() });
        }
    }
    entries.sort_by(|a, b| (&a.folder, &a.name).cmp(&(&b.folder, &b.name)));
    entries
}

/// Office documents are zip archives, too.
fn refuse_documents(file: &str, entries: &[Entry]) -> Result<()> {
    let holds = |folder: &str, name: &str| entries.iter().any(|e| e.folder == folder && e.name.starts_with(name));
    let ends = |extension: &str| entries.iter().any(|e| e.extension() == extension);
    let csv = "save the sheet with the record as CSV (time and acceleration columns with their units in the header)";
    let (what, instead) = if holds("xl", "workbook") {
        ("a binary Excel workbook (xlsb)", "save it as .xlsx or CSV")
    } else if holds("word", "document") {
        ("a Word document", csv)
    } else if holds("", "content.xml") && holds("", "mimetype") {
        ("an OpenDocument file", csv)
    } else if ends("npy") && entries.iter().all(|entry| entry.extension() == "npy") {
        ("an archive of NumPy (.npz)", NUMPY)
    } else {
        return Ok(());
    };
    if ends("ev5") {
        return Ok(());
    }
    Err(IngestError::foreign(file, what, instead))
}

/// Whether a table has rows enough for a record: telephones put tables about themselves beside the data.
fn may_be_a_record(file: &str, zip: &mut ZipArchive<Cursor<&[u8]>>, entry: &Entry) -> Result<bool> {
    let is_long = claimed_size(zip, entry) > (MINIMUM_SAMPLES << 10) as u64;
    Ok(is_long || inflate(file, zip, entry, &mut 0)?.iter().filter(|b| **b == b'\n').count() >= MINIMUM_SAMPLES)
}

/// The EV5 file, else the only table, else the only file.
fn main_entry<'a>(file: &str, zip: &mut ZipArchive<Cursor<&[u8]>>, entries: &'a [Entry]) -> Result<&'a Entry> {
    const EXPECTED: &str = "an archive with one .EV5 file, one ISO-MME test or one table";
    let with = |endings: &[&str]| entries.iter().filter(|e| e.has_extension(endings)).collect::<Vec<&Entry>>();
    let mut tables = with(&TABLES);
    tables.retain(|e| !e.name.to_lowercase().contains("readme"));
    let measurements = with(&CONTAINERS);
    let mut records = Vec::new();
    for table in tables.iter().filter(|_| tables.len() > 1 && measurements.is_empty()) {
        if may_be_a_record(file, zip, table)? {
            records.push(*table);
        }
    }
    let tables = if records.is_empty() { tables } else { records };
    for candidates in [with(&["ev5"]), with(&["mme"]), with(&["chn"]), measurements, tables] {
        match candidates.as_slice() {
            [] => {}
            [one] => return Ok(one),
            several => {
                let names: Vec<&str> = several.iter().take(10).map(|e| e.name.as_str()).collect();
                let found = format!("{} records in one archive: {}", several.len(), names.join(", "));
                return refuse_path(file, found, EXPECTED, "unpack it and give the one you mean");
            }
        }
    }
    match entries {
        [one] => return Ok(one),
        [] => return Err(damaged(file, "the archive is empty")),
        _ => {}
    }
    if let Some(Entry { name, .. }) = entries.iter().find(|e| e.extension() == "zip") {
        let found = format!("an archive inside the archive: {name}");
        return refuse_path(file, found, EXPECTED, format!("unpack it and give {name}"));
    }
    let is_curve = |e: &&Entry| e.extension().bytes().all(|b| b.is_ascii_digit()) && e.name.contains('.');
    let curves: Vec<&Entry> = entries.iter().filter(is_curve).collect();
    if let [first, ..] = curves.as_slice() {
        let found = format!("{} signal files but no .EV5 file", curves.len());
        let expected = format!("{}.EV5 in the same folder of the archive", stem(&first.name));
        return refuse_path(file, found, expected, "take the whole \"EV5 ASCII X-Y\" archive of the test");
    }
    let found = format!("{} files, none of them an .EV5 file or a table", entries.len());
    refuse_path(file, found, EXPECTED, "unpack it and give the record itself")
}

/// What the archive claims must fit into the memory that is left, before any of it is unpacked.
fn refuse_beyond_memory(at: &str, claimed: u64) -> Result<()> {
    let limit = "at most the # MiB that are left of the memory limit (--memory-limit gives more)";
    check_size(at, claimed, crumple_memory::left(), "# MiB when unpacked", limit)
}

/// One entry, up to [`FILE_LIMIT`]: a small archive may claim to hold terabytes.
fn inflate(file: &str, zip: &mut ZipArchive<Cursor<&[u8]>>, entry: &Entry, total: &mut u64) -> Result<Vec<u8>> {
    let at = format!("{file}: {}", entry.name);
    let damaged = |error: &dyn std::fmt::Display| damaged(file, format!("{}: {error}", entry.name));
    let reader = zip.by_index(entry.index).map_err(|error| damaged(&error))?;
    let (limit, claimed) = (FILE_LIMIT.min(1 << 28), reader.size());
    refuse_beyond_memory(&at, claimed)?;
    let mut bytes = Vec::new();
    if claimed <= limit {
        bytes.reserve(usize::try_from(claimed.min(1 << 24)).unwrap_or(0));
        reader.take(limit + 1).read_to_end(&mut bytes).map_err(|error| damaged(&error))?;
    }
    let found = format!("more than {} MiB when unpacked", limit >> 20);
    check_size(at, claimed.max(bytes.len() as u64), limit, &found, "entries up to # MiB")?;
    *total += bytes.len() as u64;
    check_total(file, *total)?;
    Ok(bytes)
}

fn damaged(file: &str, found: impl std::fmt::Display) -> IngestError {
    IngestError::content(
        file,
        format!("the zip archive cannot be read: {found}"),
        "a complete, unencrypted archive (stored or deflated)",
        "download it again, or unpack it and give the record itself",
    )
}
