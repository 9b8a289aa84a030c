//! Tests of `crumple-sysid`, one program.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod best_of_many_starts;
mod crash_rate;
mod daisy;
mod era;
mod evidence;
mod known_truth;
mod okid;
mod output_error;
mod paper_matrices;
mod recovery;
mod several_channels;
mod transfer_functions;
