//! Tests of `crumple-integrate`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod barrier;
mod criteria;
mod known_truth;
mod properties;
mod real_record;
mod reference_cases;
mod several_channels;
mod stage;
mod two_vehicles;
mod uncertainty;
mod unusual_records;
