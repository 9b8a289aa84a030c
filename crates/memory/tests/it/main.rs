//! Tests of `crumple-memory`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod budget;
