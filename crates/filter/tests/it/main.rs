//! Tests of `crumple-filter`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod general;
mod properties;
mod real_record;
mod reference_cases;
mod stage;
