//! Which reader a file belongs to, by its content alone.

use crate::error::WHAT_IS_READ;
use crate::formats::ev5;
use crate::formats::iso_mme;
use crate::formats::lvm;
use crate::formats::mcap;
use crate::formats::not_read;
use crate::formats::reader::Bundle;
use crate::formats::ros_bag;
use crate::formats::table;
use crate::formats::tdm;
use crate::formats::tdms;
use crate::recording::content::Recording;
use crate::{IngestError, Place, Settings};

/// A format that is read. To add one: a file with a type that implements this, and a line in [`READERS`].
pub trait Reader: Sync {
    /// Name in artifacts: `csv`, `nhtsa-ev5`.
    fn format(&self) -> &'static str;

    /// Whether a file that starts with `head` (up to 8192 bytes) is of this format.
    fn recognises(&self, head: &[u8]) -> bool;

    /// Whether the file `name` beside the main file `main` belongs to the same record.
    fn companion(&self, _main: &str, _name: &str) -> bool {
        false
    }

    /// Whether files of the record may also lie in the folder `Channel` beside the main file, or in its parent.
    fn spans_folders(&self) -> bool {
        false
    }

    /// Whether a file that starts with `head` can be read piece by piece, when it is too long for memory.
    fn streams(&self, _head: &[u8]) -> bool {
        false
    }

    /// Flags about the form of a file that the reader heeds, by their names, `--unit`; others given are warned about.
    fn heeds(&self) -> &'static [&'static str] {
        &[]
    }

    /// Reads the record. Sees bytes only; the same bytes and settings give the same recording.
    fn read(&self, bundle: &Bundle, settings: &Settings) -> Result<Recording, IngestError>;
}

/// All readers, the most particular first: the first that recognises a file reads it.
pub const READERS: &[&dyn Reader] =
    &[&mcap::Mcap, &ros_bag::RosBag, &tdms::Tdms, &tdm::Tdm, &lvm::Lvm, &ev5::Ev5, &iso_mme::IsoMme, &table::Table];

/// The reader for a file, or why there is none: empty, known but not read, or not known at all.
pub fn recognise(file: &str, bytes: &[u8]) -> Result<&'static dyn Reader, IngestError> {
    if bytes.trim_ascii().is_empty() {
        let found = if bytes.is_empty() { "the file is empty" } else { "the file holds nothing but blanks" };
        return Err(IngestError::content(
            Place::file(file),
            found,
            WHAT_IS_READ,
            "check that the export or the download is complete",
        ));
    }
    if let Some((what, instead)) = not_read::recognise(bytes) {
        return Err(IngestError::Foreign { file: file.to_owned(), what: what.to_owned(), instead: instead.to_owned() });
    }
    let head = &bytes[..bytes.len().min(8192)];
    let is_mme = file.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("mme"));
    if is_mme && !iso_mme::IsoMme.recognises(head) && iso_mme::has_keyword_lines(head) {
        return Ok(&iso_mme::IsoMme);
    }
    READERS.iter().copied().find(|reader| reader.recognises(head)).ok_or_else(|| {
        if let Some((what, instead)) = not_read::by_ending(file) {
            return IngestError::Foreign { file: file.to_owned(), what: what.to_owned(), instead: instead.to_owned() };
        }
        let start: Vec<String> = bytes.iter().take(8).map(|b| format!("{b:02x}")).collect();
        IngestError::content(
            Place::file(file),
            format!("binary data of an unknown kind, starting with {}", start.join(" ")),
            WHAT_IS_READ,
            "export the channels as CSV: time and acceleration columns with their units in the header",
        )
    })
}
