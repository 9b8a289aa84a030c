//! Tests of `crumple-metrics`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod catalogue;
mod curves;
mod events;
mod four_channels;
mod marks;
mod occupant_and_road;
mod properties;
mod pulse;
