//! Tests of `crumple-ingest`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod brought;
mod choices;
mod contact;
mod exchanges;
mod impacts;
mod iso_mme;
mod logger_texts;
mod lvm;
mod messages;
mod messy_loggers;
mod messy_tables;
mod nhtsa;
mod other_programs;
mod protobuf;
mod refusals;
mod robustness;
mod simulations;
mod spreadsheets;
mod tables;
mod tdm;
mod tdms;

use std::io::{Cursor, Write};
use std::path::Path;
use std::process::Command;

use clap::Parser as _;
use crumple_ingest::{Bundle, IngestError, IngestSettings, Ingested, ReadChannel, Recording, ingest};

/// The settings of flags: `--unit g --skip-to two words`.
fn given(flags: &str) -> IngestSettings {
    #[derive(clap::Parser)]
    struct Flags {
        #[command(flatten)]
        settings: IngestSettings,
    }
    let flags = flags.split("--").map(|flag| format!("--{}", flag.trim().replacen(' ', "=", 1)));
    Flags::parse_from(std::iter::once("ingest".to_owned()).chain(flags.skip(1))).settings
}

fn lenient() -> IngestSettings {
    given("--allow-missing")
}

/// Reads bytes under a name.
fn read_as(name: &str, bytes: impl Into<Vec<u8>>, settings: &IngestSettings) -> Result<Ingested, IngestError> {
    ingest(&Bundle::from_bytes(name, bytes.into())?, settings)
}

/// Reads a file or a folder.
fn open(path: impl AsRef<Path>, settings: &IngestSettings) -> Result<Ingested, IngestError> {
    ingest(&Bundle::open(path.as_ref())?, settings)
}

/// Writes files into a folder.
fn write(folder: &Path, files: &[(impl AsRef<str>, impl AsRef<[u8]>)]) {
    for (name, content) in files {
        let path = folder.join(name.as_ref());
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content).unwrap();
    }
}

/// An archive of files.
fn zipped(files: &[(impl AsRef<str>, impl AsRef<[u8]>)]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        zip.start_file(name.as_ref(), zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(content.as_ref()).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

/// Exit code, stdout and stderr of the program.
fn program(path: &Path, flags: &[&str]) -> (i32, String, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_crumple-ingest")).arg(path).args(flags).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (done.status.code().unwrap(), text(done.stdout), text(done.stderr))
}

fn notes(ingested: &Ingested) -> String {
    ingested.notes.to_texts().join("\n")
}

fn samples(found: &ReadChannel) -> &[f64] {
    found.wave.as_ref().unwrap().samples()
}

/// Start and interval of a channel, s.
fn grid(found: &ReadChannel) -> (f64, f64) {
    let wave = found.wave.as_ref().unwrap();
    (wave.t0_s(), wave.dt_s())
}

#[track_caller]
fn has_note(recording: &Recording, words: &str) {
    let notes = recording.notes.to_texts();
    assert!(notes.iter().any(|note| note.contains(words)), "{words:?} is not in {notes:#?}");
}
