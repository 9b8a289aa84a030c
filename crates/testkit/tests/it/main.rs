//! Tests of `crumple-testkit`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod bad_input;
mod camry;
mod choice;
mod committed_fixtures;
mod damage;
mod determinism;
mod first_screen;
mod fleet;
mod formats;
mod fuzz;
mod generic_record;
mod just_run;
mod known_truth_chain;
mod main_job;
mod predict;
mod rates;
mod schemas;
mod slurm;
mod swapped_stage;
mod together;
mod truth;
