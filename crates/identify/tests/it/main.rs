//! Tests of `crumple-identify`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod any_waveform;
mod automatic;
mod daisy_program;
mod delays_and_filters;
mod faults;
mod generic_records;
mod program;
mod screen;
mod stage;
mod stage_evidence;
mod stage_markov;
mod stage_methods;
mod stage_orders;
mod stage_structures;
mod true_words;
