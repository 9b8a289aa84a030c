//! Tests of `crumple-lumped`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod coefficient_matching;
mod energy;
mod equal_roots;
mod force_deflection;
mod known_truth;
mod own_law;
mod properties;
mod secant_chain;
mod structure;
