//! Which reader a file belongs to, by its content alone.

use std::collections::BTreeMap;

use crate::error::WHAT_IS_READ;
use crate::formats::reader::{Bundle, NamedBytes, Reader};
use crate::formats::{ev5, iso_mme, lvm, mcap, not_read, ros_bag, table, tdm, tdms};
use crate::{IngestError, Place};

/// All readers, the most particular first: the first that recognises a file reads it.
pub const READERS: &[&dyn Reader] =
    &[&mcap::Mcap, &ros_bag::RosBag, &tdms::Tdms, &tdm::Tdm, &lvm::Lvm, &ev5::Ev5, &iso_mme::IsoMme, &table::Table];

impl Bundle {
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
            show_progress: |_, _| Box::new(|_| ()),
        })
    }
}

/// The reader for a file, or why there is none: empty, known but not read, or not known at all.
pub(crate) fn recognise(file: &str, bytes: &[u8]) -> Result<&'static dyn Reader, IngestError> {
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
    if is_mme && !iso_mme::IsoMme.recognises(head) && iso_mme::header::has_keyword_lines(head) {
        return Ok(&iso_mme::IsoMme);
    }
    READERS.iter().copied().find(|reader| reader.recognises(head)).ok_or_else(|| {
        if let Some((what, instead)) = not_read::recognise_ending(file) {
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
