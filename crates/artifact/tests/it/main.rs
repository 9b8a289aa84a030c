//! Tests of `crumple-artifact`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod container;
mod damage;
mod layout;
mod records;
