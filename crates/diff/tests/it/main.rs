//! Tests of `crumple-diff`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod cli;
mod folders;
mod prints;
mod program;
mod texts;
mod values;
