//! Which reader a file belongs to, by its content alone.

use std::collections::BTreeMap;

use crate::error::WHAT_IS_READ;
use crate::formats::reader::{Bundle, NamedBytes, Reader};
use crate::formats::simulation::ascii;
use crate::formats::{
    ev5, hdf5, iso_mme, json_lines, lvm, mat, mcap, parquet, ros_bag, simulation, table, tdm, tdms, universal, workbook,
};
use crate::{IngestError, Result, refuse};

/// All readers, the most particular first: the first that recognises a file reads it.
pub const READERS: &[&Reader] = &[
    &mcap::MCAP,
    &ros_bag::ROS_BAG,
    &tdms::TDMS,
    &tdm::TDM,
    &lvm::LVM,
    &mat::MAT,
    &hdf5::HDF5,
    &parquet::PARQUET,
    &json_lines::JSON_LINES,
    &simulation::BINOUT,
    &simulation::T01,
    &simulation::TEXTS,
    &simulation::TABLE,
    &simulation::CURVES,
    &workbook::WORKBOOK,
    &universal::UNIVERSAL,
    &ev5::EV5,
    &iso_mme::ISO_MME,
    &table::TABLE,
];

/// Endings of files that hold more than text.
pub(crate) const CONTAINERS: [&str; 11] =
    ["tdms", "tdm", "lvm", "mat", "uff", "unv", "xlsx", "h5", "hdf5", "parquet", "jsonl"];

/// Whether files that end so, in small letters, are meant as records whatever is in them. Texts, which may be a readme,
/// are not among them.
pub fn is_ending_of_a_record(ending: &str) -> bool {
    CONTAINERS.contains(&ending) || ["csv", "tsv", "ev5", "mme", "mcap", "bag", "zip"].contains(&ending)
}

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
            on_disk: BTreeMap::new(),
            show_progress: |_, _| Box::new(|_| ()),
        }
    }
}

/// The reader for a file, or why there is none: empty, known but not read, or not known at all.
pub(crate) fn recognise(file: &str, bytes: &[u8]) -> Result<&'static Reader> {
    let ends_in =
        |expected: &str| file.rsplit_once('.').is_some_and(|(_, ending)| ending.eq_ignore_ascii_case(expected));
    if bytes.trim_ascii().is_empty() {
        // The channels of the test lie beside it.
        if ends_in("mme") || ends_in("chn") {
            return Ok(&iso_mme::ISO_MME);
        }
        let found = if bytes.is_empty() { "the file is empty" } else { "the file holds nothing but blanks" };
        return refuse(file, found, WHAT_IS_READ, "check that the export or the download is complete");
    }
    if let Some((what, instead)) = recognise_foreign(bytes) {
        return Err(IngestError::foreign(file, what, instead));
    }
    let head = &bytes[..bytes.len().min(8192)];
    if ends_in("mme") && !iso_mme::channel_file::recognises(head) && iso_mme::channel_file::has_keyword_lines(head) {
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
        "an LS-DYNA keyword file",
        "copy the rows below *DEFINE_CURVE into a text file of two columns, time and value",
        |b| text(b).starts_with(b"*KEYWORD") || has(b, b"*DEFINE_CURVE"),
    ),
    (
        "an MDF measurement file (MDF 3 or MDF4)",
        "export it as CSV with asammdf: \
            python -c \"import asammdf; asammdf.MDF('FILE').export('csv', 'out.csv', time_from_zero=False, \
            add_units=True)\"; that writes a file out.NAME.csv for each channel group",
        |b| b.starts_with(b"MDF     ") || b.starts_with(b"UnFinMF "),
    ),
    (
        "an Arrow or Feather file",
        "write it as CSV: python -c \"import pandas; pandas.read_feather('FILE').to_csv('out.csv', index=False)\"",
        |b| b.starts_with(b"ARROW1\0\0") || b.starts_with(b"FEA1"),
    ),
    ("an array of NumPy (.npy)", NUMPY, |b| b.starts_with(b"\x93NUMPY")),
    ("a text file of Octave", OCTAVE, is_octave_text),
    ("a binary file of Octave", OCTAVE, |b| b.starts_with(b"Octave-1-")),
    ("an output text of LS-DYNA (matsum, deforc or another one)", LS_DYNA, |b| {
        ascii::is_of_ls_dyna(b) && !ascii::recognises(b)
    }),
    ("a plot database of LS-DYNA (d3plot)", LS_DYNA, is_d3plot),
    ("a DEWESoft file", DEWESOFT, |b| has_early(b, b"MULTI_STREAM_FILE") || has_early(b, b"Dewesoft_Data")),
    (
        "a VBOX file (.vbo)",
        "export time and longitudinal acceleration as CSV from VBOX Test Suite, with their units in the header",
        |b| text(b).starts_with(b"File created on") && (has(b, b"[header]") || has(b, b"[column names]")),
    ),
    ("a catman file", CATMAN, |b| {
        // File identifiers 5009 to 5014, then where the data begin.
        matches!(b, [0x91..=0x96, 0x13, _, _, 0..=0x0F, 0, ..])
    }),
    ("an imc FAMOS file", TABLE, |b| b.starts_with(b"|CF,")),
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
    ("JSON text", TABLE, |b| json(b) && !json_lines::recognises(&b[..b.len().min(8192)])),
    ("a RIFF file (sound or video)", TABLE, |b| b.starts_with(b"RIFF")),
    ("an executable program", "give the record itself", |b| b.starts_with(b"\x7FELF") || b.starts_with(b"MZ\x90\0")),
];

pub(crate) const NUMPY: &str = "write time and acceleration as the columns of a CSV file: numpy.savetxt('out.csv', \
    numpy.column_stack([t, a]), delimiter=',', header='time [s],accel [g]', comments='')";
const OCTAVE: &str = "save it in Octave for MATLAB: save -v7 record.mat t a, with the names of time and acceleration";
const LS_DYNA: &str = "give binout or nodout of the same run, or the folder with them";
const DEWESOFT: &str = "export time and acceleration as CSV or as MATLAB file from DEWESoft";
const CATMAN: &str = "export time and acceleration as ASCII or as MATLAB file from catman";

fn is_octave_text(bytes: &[u8]) -> bool {
    let mut lines = text(bytes).split(|b| *b == b'\n');
    let first = lines.next().unwrap_or_default();
    let mut is_typed = || lines.next().is_some_and(|line| line.starts_with(b"# type: "));
    first.starts_with(b"# Created by Octave") || (first.starts_with(b"# name: ") && is_typed())
}

/// The control block: ten words of title, then time, kind of file, version, number of dimensions, of nodes, 6 for
/// LS-DYNA; words of four or eight bytes.
fn is_d3plot(bytes: &[u8]) -> bool {
    let is_of_words = |size: usize| {
        let word =
            |k: usize| bytes.get(k * size..k * size + 4).and_then(|b| Some(u32::from_le_bytes(b.try_into().ok()?)));
        let title = bytes.get(..10 * size).is_some_and(|b| b.iter().all(|b| matches!(b, 0 | b' '..=b'~')));
        title
            && matches!(word(11), Some(1 | 5 | 11))
            && matches!(word(15), Some(2..=8))
            && matches!(word(17), Some(2 | 6))
    };
    is_of_words(4) || is_of_words(8)
}

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
    (&["dxd", "d7d", "d7z"], "a DEWESoft file, perhaps", DEWESOFT),
    (&["mat"], "a MATLAB file of version 4, perhaps", "save it in MATLAB or Octave as version 7: save -v7"),
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
        let d3plot = |size: usize| {
            let mut bytes = vec![b' '; 64 * size];
            for (word, value) in [(11, 1_u8), (15, 4), (16, 90), (17, 6)] {
                bytes[word * size..(word + 1) * size].fill(0);
                bytes[word * size] = value;
            }
            bytes
        };
        let cases: [(&[u8], &str); 19] = [
            (b"%PDF-1.7\n", "PDF"),
            (b"TDSh\x0e\0\0\0", "TDMS index"),
            (b"SQLite format 3\0", "SQLite"),
            (b"\x1A\x45\xDF\xA3\x01", "enDAQ"),
            (b"MDF     4.10    ", "MDF4"),
            (b"{\"General Test Info\": {}}", "NHTSA"),
            (b"<?xml version=\"1.0\"?>\n<test>", "XML"),
            (b"ARROW1\0\0\xff", "Feather"),
            (b"\x93NUMPY\x01\0", "NumPy"),
            (b"# Created by Octave 7.3.0, Sat\n# name: t\n", "text file of Octave"),
            (b"# name: t\n# type: matrix\n# rows: 2\n", "text file of Octave"),
            (b"Octave-1-L\0", "binary file of Octave"),
            (b" sled\n        LS-DYNA smp.1       date 1/2/2024\n mat.# 1 inten= 0\n", "matsum"),
            (&d3plot(4), "d3plot"),
            (&d3plot(8), "d3plot"),
            (b"MULTI_STREAM_FILE_VER02106\0\0\0Dewesoft_Data_7.x__", "DEWESoft"),
            (b"File created on 12/03/2020 @ 13:05\r\n\r\n[header]\r\nsatellites\r\n", "VBOX"),
            (b"\x94\x13\x20\x01\0\0\x05\0", "catman"),
            (b"|CF,2,1,1;|CK,1,3,1,1;", "imc"),
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
        for text in [
            "time_s,accel_g\n0,1\n",
            "# from ls-dyna, date 1/2/24\n0 1\n",
            "# name: x\n0 1\n",
            "# channel: 3\n0 1\n",
            "# Source\n----- EV5 -----\n",
            "-1 2\n-0.9 3\n",
            "",
        ] {
            assert_eq!(recognise_foreign(text.as_bytes()), None, "{text}");
        }
    }
}
