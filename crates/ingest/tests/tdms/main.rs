//! TDMS: the real files, and files built here for what they lack.

#![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

mod identity;
mod layout;
mod mutations;
mod real_files;
mod scaling;
mod time;
mod writer;
