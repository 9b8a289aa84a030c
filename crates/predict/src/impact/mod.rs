//! One impact of one candidate: its structure with the mass asked for, what comes out, how far it reaches.
//! Uses no other room.

pub mod against;
pub mod candidate;
pub mod outcome;
pub mod reach;
