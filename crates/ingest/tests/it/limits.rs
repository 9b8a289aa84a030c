//! Files that claim or hold too much meet a limit with a name.

use std::fs;
use std::io::{Cursor, Write};

use crumple_ingest::{Bundle, IngestError, IngestSettings, ingest};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

fn archive(files: &[(&str, usize)]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let zeros = vec![b'0'; 1 << 20];
    for (name, mebibytes) in files {
        zip.start_file(*name, SimpleFileOptions::default()).unwrap();
        for _ in 0..*mebibytes {
            zip.write_all(&zeros).unwrap();
        }
    }
    zip.finish().unwrap().into_inner()
}

fn open(name: &str, bytes: &[u8]) -> Result<Bundle, IngestError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    Bundle::open(&path)
}

fn refused(bundle: Result<Bundle, IngestError>) -> String {
    let error = match bundle.and_then(|bundle| ingest(&bundle, &IngestSettings::default())) {
        Err(error) => error,
        Ok(_) => panic!("it was read"),
    };
    assert!(matches!(error, IngestError::TooLarge { .. }), "{error:?}");
    error.to_string()
}

#[test]
fn a_zip_bomb_is_not_inflated_to_its_end() {
    let bomb = archive(&[("a.csv", 300)]);
    assert!(bomb.len() < 1 << 20, "a good bomb is small");
    assert_eq!(refused(open("a.zip", &bomb)), "a.zip: a.csv: more than 256 MiB when unpacked");
}

#[test]
fn a_bomb_of_many_files_is_refused_by_what_it_claims() {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("v1.EV5", SimpleFileOptions::default()).unwrap();
    zip.write_all(b"----- EV5 -----\n----- TEST -----\n").unwrap();
    for k in 0..9 {
        zip.start_file(format!("v1.{k:03}"), SimpleFileOptions::default()).unwrap();
        zip.write_all(b"0\n").unwrap();
    }
    let mut bomb = zip.finish().unwrap().into_inner();
    // Each of the nine claims 240 MiB, within the limit of a file: 24 bytes into its entry of the central directory.
    let entries: Vec<usize> = (0..bomb.len()).filter(|at| bomb[*at..].starts_with(b"PK\x01\x02")).collect();
    for at in &entries[1..] {
        bomb[at + 24..at + 28].copy_from_slice(&(240_u32 << 20).to_le_bytes());
    }
    assert_eq!(refused(open("a.zip", &bomb)), "a.zip: the files of the record take more than 2048 MiB");
}

#[test]
fn an_archive_of_countless_files_is_refused_before_any_is_read() {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for k in 0..20_001 {
        zip.start_file(format!("{k}.csv"), SimpleFileOptions::default()).unwrap();
    }
    assert_eq!(refused(open("a.zip", &zip.finish().unwrap().into_inner())), "a.zip: 20001 entries");
}

#[test]
fn endless_lines_are_refused_where_they_start() {
    let line = "1".repeat((1 << 20) + 10);
    assert_eq!(
        refused(open("a.csv", format!("0,1\n{line}").as_bytes())),
        "a.csv, line 2: the line is longer than 1 MiB"
    );
    let header = "Channel code :10VEHC000000ACX0\n";
    let text = format!("{header}Comments :{line}");
    assert_eq!(refused(open("a.001", text.as_bytes())), "a.001, line 2: the line is longer than 1 MiB");
}

#[test]
fn endless_headers_are_refused() {
    let text = format!("Channel code :10VEHC000000ACX0\n{}", "Comments :x\n".repeat(20_000));
    assert_eq!(refused(open("a.001", text.as_bytes())), "a.001, line 10001: more than 10000 lines of keywords");
}

#[test]
fn thousands_of_columns_are_no_record() {
    let row = vec!["1"; 5000].join(",");
    assert_eq!(refused(open("a.csv", format!("{row}\n{row}\n").as_bytes())), "a.csv, line 1: 5000 columns");
}
