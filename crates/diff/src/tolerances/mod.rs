//! How far two values may be apart: tables, rules of the user, units, candidates and their deviations.

pub mod candidate;
pub mod rules;
pub mod settings;
pub mod table;
pub mod tolerance;
pub mod unit;
