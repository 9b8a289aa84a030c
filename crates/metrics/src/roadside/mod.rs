//! Criteria of roadside hardware: ASI, THIV, PHD, OIV, ORA.

pub mod asi;
pub mod flail_space;
