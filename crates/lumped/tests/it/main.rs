//! Tests of `crumple-lumped`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod chain;
mod coefficient_matching;
mod elastoplastic_motion;
mod energy;
mod equal_roots;
mod force_deflection;
mod known_truth;
mod physical_coordinates;
mod properties;
mod secant_chain;
mod sensitivity;
mod structure;
