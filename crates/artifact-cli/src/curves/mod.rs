//! Static force-deflection curves of a candidate, as tables for people and for other programs.

pub mod static_curve;
pub mod tables;
