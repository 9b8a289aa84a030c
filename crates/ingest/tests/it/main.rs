//! Tests of `crumple-ingest`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod acceptance;
mod bags;
mod choices;
mod exchanges;
mod iso_mme;
mod limits;
mod listing;
mod lvm;
mod messages;
mod messy_tables;
mod mutated_real_files;
mod nhtsa;
mod protobuf;
mod recorders;
mod refusals;
mod robustness;
mod spreadsheets;
mod tables;
mod tdm;
mod tdms;
mod two_vehicles;
