//! One impact of one candidate: its structure with the mass asked for, the wall or a partner, an occupant, what comes
//! out, how far it reaches.

pub mod against;
pub mod candidate;
pub mod felt;
pub mod occupant;
pub mod outcome;
pub mod partner;
pub mod reach;
pub mod restraint_fit;
pub mod scenario;
pub mod setting;
