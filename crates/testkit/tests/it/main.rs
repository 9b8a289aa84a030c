//! Tests of `crumple-testkit`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod atlas;
mod bad_input;
mod book;
mod camry;
mod choice_cases;
mod clock_cases;
mod determinism;
mod earlier_runs;
mod first_screen;
mod fleet;
mod formats;
mod identify_cases;
mod just_run;
mod kits;
mod known_truth_chain;
mod main_job;
mod page;
mod pairs;
mod paper_pipelines;
mod passport;
mod schemas;
mod swapped;
mod together;
mod validate;
mod why;
