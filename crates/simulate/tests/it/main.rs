//! Tests of `crumple-simulate`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod command;
mod simulation;
