//! Tests of `crumple-numerics`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]
mod round_trips;
