//! Tests of `crumple-report`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod browser;
mod compare;
mod conclusion;
mod diff;
mod index;
mod key_numbers;
mod page_parts;
mod report;
mod sample;
mod shared_files;
mod what_if;
