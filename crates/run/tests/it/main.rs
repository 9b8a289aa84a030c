//! `crumple-run` with stages that only copy: what it promises holds whatever the stages compute.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod chain;
mod damage;
mod endings;
mod export;
mod fleet;
mod stand_in;
