//! Tests of `crumple-filter`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod general;
mod reference_cases;
mod stage;
