//! What a file in a folder is: a record, or something beside it.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crumple_ingest::{READERS, Reader};

/// Bytes of a file that its reader is recognised by.
const HEAD: u64 = 8192;
/// Endings of files that are meant as records whatever is in them: one that is empty or damaged is a row of the fleet.
const RECORDS: [&str; 10] = ["csv", "tsv", "ev5", "mme", "tdms", "tdm", "lvm", "mcap", "bag", "zip"];
/// Endings of text files that are records if they hold rows of numbers.
const TABLES: [&str; 5] = ["txt", "dat", "asc", "prn", ""];
/// Name of the reader that takes any text.
const ANY_TEXT: &str = "csv";

/// What a file is.
#[derive(Clone, Copy)]
pub(crate) enum Contents {
    /// A record of a format that is recognised.
    Record(&'static dyn Reader),
    /// A record by its ending.
    NamedRecord,
    /// No record.
    Other,
}

/// Looks into a file.
pub(crate) fn contents(path: &Path) -> io::Result<Contents> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    let ending = ending(path);
    let by_name = if RECORDS.contains(&ending.as_str()) { Contents::NamedRecord } else { Contents::Other };
    if head.trim_ascii().is_empty() {
        return Ok(by_name);
    }
    Ok(match READERS.iter().copied().find(|reader| reader.recognises(&head)) {
        Some(reader) if reader.format() != ANY_TEXT => Contents::Record(reader),
        Some(reader) if TABLES.contains(&ending.as_str()) && has_rows_of_numbers(&head) => Contents::Record(reader),
        _ => by_name,
    })
}

/// Ending of a file name in small letters.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Whether three lines or more are two numbers or more each.
fn has_rows_of_numbers(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    let is_row = |line: &&str| {
        let cells = line.split([',', ';', '\t', ' ']).filter(|cell| !cell.is_empty());
        let numbers: Vec<bool> = cells.map(|cell| cell.trim().parse::<f64>().is_ok()).collect();
        numbers.len() > 1 && numbers.iter().all(|is_number| *is_number)
    };
    text.lines().filter(is_row).count() > 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_told_from_a_text() {
        assert!(has_rows_of_numbers(b"t a\n0 1\n1e-3 2\n2e-3 3\n"));
        assert!(!has_rows_of_numbers(b"Read me.\n1 of 3\n2 of 3\n3 of 3\n"));
    }

    #[test]
    fn a_record_is_known_by_its_content_and_a_broken_one_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let is_record = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            !matches!(contents(&path).unwrap(), Contents::Other)
        };
        let table = "time_s,a\n0,1\n1,2\n2,3\n";
        for (name, text, expected) in [
            ("a.csv", table, true),
            ("empty.csv", "", true),
            ("words.csv", "nothing to see", true),
            ("a.txt", table, true),
            ("readme.txt", "nothing to see", false),
            ("readme.md", "nothing to see", false),
            ("empty", "", false),
        ] {
            assert_eq!(is_record(name, text), expected, "{name}");
        }
    }
}
