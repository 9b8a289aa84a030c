//! Tests of `crumple-integrate`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod criteria;
mod known_truth;
mod several_channels;
mod stage;
mod uncertainty;
