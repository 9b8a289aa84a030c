//! Tests of `crumple-artifact-cli`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod cli;
mod curve;
mod new_stage;
