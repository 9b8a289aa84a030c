//! Tests of `crumple-ingest`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod acceptance;
mod choices;
mod exchanges;
mod iso_mme;
mod lvm;
mod messages;
mod messy_tables;
mod nhtsa;
mod protobuf;
mod refusals;
mod robustness;
mod spreadsheets;
mod tables;
mod tdm;
mod tdms;
