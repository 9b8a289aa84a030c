//! Tests of `crumple-metrics`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod curves;
mod events;
mod properties;
mod pulse;
