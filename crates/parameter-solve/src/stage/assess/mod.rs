//! How well each candidate's parameters are known, by the minimum of the misfit that it carries.

pub mod candidate_assessment;
pub mod candidates;
