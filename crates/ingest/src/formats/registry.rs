//! Which reader a file belongs to, by its content alone.

use std::collections::BTreeMap;

use crate::error::WHAT_IS_READ;
use crate::formats::reader::{Bundle, NamedBytes, Reader};
use crate::formats::{ev5, iso_mme, lvm, mat, mcap, ros_bag, table, tdm, tdms, universal, workbook};
use crate::{IngestError, Result, refuse};

/// All readers, the most particular first: the first that recognises a file reads it.
pub const READERS: &[&Reader] = &[
    &mcap::MCAP,
    &ros_bag::ROS_BAG,
    &tdms::TDMS,
    &tdm::TDM,
    &lvm::LVM,
    &mat::MAT,
    &workbook::WORKBOOK,
    &universal::UNIVERSAL,
    &ev5::EV5,
    &iso_mme::ISO_MME,
    &table::TABLE,
];

impl Bundle {
    /// A record that is one file, already in memory.
    pub fn from_bytes(name: &str, bytes: Vec<u8>) -> Result<Self> {
        let reader = recognise(name, &bytes)?;
        Ok(Self::with_reader(name, bytes, reader))
    }

    /// The same, where the reader is known.
    pub(crate) fn with_reader(name: &str, bytes: Vec<u8>, reader: &'static Reader) -> Self {
        Self {
            name: name.to_owned(),
            main: NamedBytes { name: name.to_owned(), bytes },
            companions: BTreeMap::new(),
            sidecar: None,
            reader,
            large: None,
            show_progress: |_, _| Box::new(|_| ()),
        }
    }
}

/// The reader for a file, or why there is none: empty, known but not read, or not known at all.
pub(crate) fn recognise(file: &str, bytes: &[u8]) -> Result<&'static Reader> {
    if bytes.trim_ascii().is_empty() {
        let found = if bytes.is_empty() { "the file is empty" } else { "the file holds nothing but blanks" };
        return refuse(file, found, WHAT_IS_READ, "check that the export or the download is complete");
    }
    if let Some((what, instead)) = recognise_foreign(bytes) {
        return Err(IngestError::foreign(file, what, instead));
    }
    let head = &bytes[..bytes.len().min(8192)];
    let is_mme = file.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case("mme"));
    if is_mme && !iso_mme::channel_file::recognises(head) && iso_mme::channel_file::has_keyword_lines(head) {
        return Ok(&iso_mme::ISO_MME);
    }
    READERS.iter().copied().find(|reader| (reader.recognises)(head)).ok_or_else(|| {
        if let Some((what, instead)) = recognise_ending(file) {
            return IngestError::foreign(file, what, instead);
        }
        let start: Vec<String> = bytes.iter().take(8).map(|b| format!("{b:02x}")).collect();
        IngestError::content(
            file,
            format!("binary data of an unknown kind, starting with {}", start.join(" ")),
            WHAT_IS_READ,
            TABLE,
        )
    })
}

const TABLE: &str = "export the channels as CSV: time and acceleration columns with their units in the header";
const EV5: &str = "take the \"EV5 ASCII X-Y\" download of the test";

/// A format that is not read: what it is, what to do instead, whether a file starts so.
type Foreign = (&'static str, &'static str, fn(&[u8]) -> bool);

/// Formats known by their first bytes, in the order they are tried.
const FORMATS: &[Foreign] = &[
    ("a PDF document", TABLE, |b| has_early(b, b"%PDF-")),
    ("a TDMS index file", "the samples are in the .tdms file beside it: give that", |b| b.starts_with(b"TDSh")),
    ("an NHTSA EV6 or other specification file than EV5", EV5, |b| {
        has_early(b, b"----- EV") && !has_early(b, b"----- EV5")
    }),
    (
        "an SQLite database (a ROS 2 bag .db3, perhaps)",
        "convert a ROS 2 bag to MCAP: write \"output_bags: [{uri: converted, storage_id: mcap, all: true}]\" \
            into out.yaml and run \"ros2 bag convert -i FOLDER -o out.yaml\"; of anything else export the channels as \
            CSV",
        |b| b.starts_with(b"SQLite format 3"),
    ),
    (
        "an enDAQ recording (IDE)",
        "export it as CSV with enDAQ Lab or idelib: time and acceleration columns with their units in the \
            header",
        |b| b.starts_with(b"\x1A\x45\xDF\xA3"),
    ),
    ("a DTS channel file (SLICE)", DTS, |b| b.starts_with(b"\x1F\x35\x36\x2C")),
    ("a DTS setup file", DTS, |b| xml(b) && (has(b, b"<DTS") || has(b, b"DTS."))),
    ("NHTSA test data as JSON (version 6)", EV5, |b| {
        json(b) && (has(b, b"General Test Info") || has(b, b"Instrumentation Info"))
    }),
    (
        "a MATLAB 7.3 file (HDF5)",
        "save it in MATLAB as version 7: save('record.mat', '-struct', 'S', '-v7') with S = load('FILE')",
        |b| b.starts_with(b"MATLAB 7.3"),
    ),
    ("an HDF5 file", TABLE, |b| b.starts_with(b"\x89HDF\r\n")),
    (
        "an LS-DYNA keyword file",
        "copy the rows below *DEFINE_CURVE into a text file of two columns, time and value",
        |b| text(b).starts_with(b"*KEYWORD") || has(b, b"*DEFINE_CURVE"),
    ),
    (
        "an MDF measurement file (MDF 3 or MDF4)",
        "export it as CSV with asammdf: \
            python -c \"import asammdf; asammdf.MDF('FILE').export('csv', 'out.csv')\"",
        |b| b.starts_with(b"MDF     ") || b.starts_with(b"UnFinMF "),
    ),
    ("a Parquet file", TABLE, |b| b.starts_with(b"PAR1")),
    ("an old Excel or other Office document", TABLE, |b| b.starts_with(b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1")),
    // A zip archive that is given is opened before this; what comes here was in one.
    ("a zip archive inside an archive", "unpack the outer one and give the inner one", |b| {
        b.starts_with(b"PK\x03\x04") && !workbook::recognises(b)
    }),
    ("a gzip archive", UNPACK, |b| b.starts_with(b"\x1F\x8B")),
    ("a 7z archive", UNPACK, |b| b.starts_with(b"7z\xBC\xAF\x27\x1C")),
    ("an xz archive", UNPACK, |b| b.starts_with(b"\xFD7zXZ")),
    ("a bzip2 archive", UNPACK, |b| b.starts_with(b"BZh") && b.get(4) == Some(&b'1')),
    ("a zstd archive", UNPACK, |b| b.starts_with(b"\x28\xB5\x2F\xFD")),
    ("a RAR archive", UNPACK, |b| b.starts_with(b"Rar!\x1A\x07")),
    ("a tar archive", UNPACK, |b| b.get(257..262) == Some(b"ustar")),
    ("a picture", TABLE, |b| b.starts_with(b"\x89PNG") || b.starts_with(b"\xFF\xD8\xFF") || b.starts_with(b"GIF8")),
    ("a web page", "download the data file itself", |b| html(b)),
    ("an XML document", TABLE, |b| xml(b) && !has(b, b"usi:tdm")),
    ("JSON text", TABLE, |b| json(b)),
    ("a RIFF file (sound or video)", TABLE, |b| b.starts_with(b"RIFF")),
    ("an executable program", "give the record itself", |b| b.starts_with(b"\x7FELF") || b.starts_with(b"MZ\x90\0")),
];

const DTS: &str = "export the test as ISO-MME (ISO 13499) or CSV from the DTS software";

/// Binary formats without a mark of their own, by the ending of the name: only asked where the content is not known.
const BY_ENDING: &[(&[&str], &str, &str)] = &[
    (
        &["uds"],
        "an NHTSA UDS-1992 file",
        "take the \"EV5 ASCII X-Y\" download of the same NHTSA test, its ISO-MME or its TDMS files",
    ),
    (
        &["tdx"],
        "the file of samples of a DIAdem TDM record (TDX)",
        "give the .TDM file of the same name, beside it: it says what the samples are",
    ),
    (&["tlf", "bin"], "a DTS TDAS file, perhaps", DTS),
    (&["dts", "chn"], "a DTS SLICE file, perhaps", DTS),
    (&["pi", "dsp"], "a DADiSP file, perhaps", "export the channels as CSV from DADiSP"),
];

/// What a file of unknown content may be by its name, and what to do instead.
fn recognise_ending(file: &str) -> Option<(&'static str, &'static str)> {
    let ending = file.rsplit_once('.')?.1.to_ascii_lowercase();
    BY_ENDING
        .iter()
        .find(|(endings, ..)| endings.contains(&ending.as_str()))
        .map(|(_, what, instead)| (*what, *instead))
}

const UNPACK: &str = "unpack it and give the record itself (zip archives are read as they are)";

/// What `bytes` are, if they are in a known format that is not read, and what to do instead.
fn recognise_foreign(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let head = &bytes[..bytes.len().min(4096)];
    FORMATS.iter().find(|(.., matches)| matches(head)).map(|(what, instead, _)| (*what, *instead))
}

fn has(bytes: &[u8], needle: &[u8]) -> bool {
    bytes.windows(needle.len()).any(|window| window == needle)
}

/// PDF allows junk in front; so do files that went through mail.
fn has_early(bytes: &[u8], needle: &[u8]) -> bool {
    has(&bytes[..bytes.len().min(1024)], needle)
}

fn text(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start()
}

fn xml(bytes: &[u8]) -> bool {
    text(bytes).starts_with(b"<?xml")
}

fn html(bytes: &[u8]) -> bool {
    let start = text(bytes);
    let start = start[..start.len().min(14)].to_ascii_lowercase();
    start.starts_with(b"<!doctype html") || start.starts_with(b"<html")
}

fn json(bytes: &[u8]) -> bool {
    let start = text(bytes);
    start.first() == Some(&b'{') || (start.first() == Some(&b'[') && has(start, b"\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_formats_by_their_magic() {
        let cases: [(&[u8], &str); 7] = [
            (b"%PDF-1.7\n", "PDF"),
            (b"TDSh\x0e\0\0\0", "TDMS index"),
            (b"SQLite format 3\0", "SQLite"),
            (b"\x1A\x45\xDF\xA3\x01", "enDAQ"),
            (b"MDF     4.10    ", "MDF4"),
            (b"{\"General Test Info\": {}}", "NHTSA"),
            (b"<?xml version=\"1.0\"?>\n<test>", "XML"),
        ];
        for (bytes, name) in cases {
            let (what, instead) = recognise_foreign(bytes).unwrap();
            assert!(what.contains(name), "{what}");
            assert!(!instead.is_empty());
        }
    }

    #[test]
    fn an_ending_tells_what_the_content_does_not() {
        assert!(recognise_ending("v01234.UDS").unwrap().1.contains("EV5 ASCII"));
        assert_eq!(recognise_ending("a.xyz"), None);
    }

    #[test]
    fn leaves_tables_and_ev5_alone() {
        for text in
            ["time_s,accel_g\n0,1\n", "# channel: 3\n0 1\n", "# Source\n----- EV5 -----\n", "-1 2\n-0.9 3\n", ""]
        {
            assert_eq!(recognise_foreign(text.as_bytes()), None, "{text}");
        }
    }
}
