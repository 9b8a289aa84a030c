//! Tests of `crumple-diff`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod cli;
mod prints;
mod program;
mod values;
