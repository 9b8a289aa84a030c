//! Tests of `crumple-lumped-fit`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod chain_assessment;
mod chain_fit;
mod closed_forms;
mod double_fit;
mod known_truth;
mod load_paths;
mod nonlinear_fit;
mod propagation;
mod sensor_fit;
mod solve;
