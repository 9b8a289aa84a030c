//! Tests of `crumple-parameter-solve`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod command;
mod command_chain;
mod command_models;
mod command_own;
mod sensor_assessment;
