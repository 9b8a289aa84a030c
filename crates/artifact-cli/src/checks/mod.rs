//! Checks that an intact artifact says what the format demands.
//! Uses no other room.

pub mod check;
