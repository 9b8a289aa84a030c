//! Tests of `crumple-integrate`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod criteria;
mod end_of_contact;
mod known_truth;
mod several_channels;
mod stage;
mod uncertainty;
mod without_structure;

use std::path::Path;
use std::process::Output;

use crumple_artifact::Artifact;
use crumple_artifact::records::EventsV1;
use crumple_testkit::programs::Program;

const PROGRAM: Program = Program { exe: env!("CARGO_BIN_EXE_crumple-integrate"), output: "3-integrate.mcap" };

fn run(input: &Path, flags: &[&str]) -> Output {
    PROGRAM.run(input, flags)
}

fn result(input: &Path, flags: &[&str]) -> Artifact {
    Artifact::open(&PROGRAM.written(input, flags)).unwrap()
}

fn events(artifact: &Artifact) -> EventsV1 {
    artifact.record("/events").unwrap().unwrap()
}
