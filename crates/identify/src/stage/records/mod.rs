//! Identified models, and what speaks for or against them, as records of the artifact.

pub mod discrete;
pub mod evidence;
pub mod lines;
pub mod model;
pub mod realization;
pub mod responses;
pub mod results;
