//! One impact of one candidate: its structure with the mass asked for, the wall or a partner, an occupant, what comes
//! out, how far it reaches.

pub mod candidate;
pub mod made_test;
pub mod outcome;
pub mod partner;
pub mod restraint;
