//! Tests of `crumple-ingest`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod acceptance;
mod choices;
mod exchanges;
mod iso_mme;
mod lvm;
mod messages;
mod messy_loggers;
mod messy_tables;
mod nhtsa;
mod other_programs;
mod protobuf;
mod refusals;
mod robustness;
mod spreadsheets;
mod tables;
mod tdm;
mod tdms;

use crumple_ingest::{IngestSettings, Ingested, ReadChannel, Recording};

fn lenient() -> IngestSettings {
    IngestSettings { allow_missing: Some(true), ..IngestSettings::default() }
}

fn notes(ingested: &Ingested) -> String {
    ingested.notes.to_texts().join("\n")
}

fn samples(found: &ReadChannel) -> &[f64] {
    found.wave.as_ref().unwrap().samples()
}

#[track_caller]
fn has_note(recording: &Recording, words: &str) {
    let notes = recording.notes.to_texts();
    assert!(notes.iter().any(|note| note.contains(words)), "{words:?} is not in {notes:#?}");
}
