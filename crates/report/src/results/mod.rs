//! Everything the artifacts of a run say: its types, the ranking of candidates, residuals.
//! Uses text.

pub mod mass_divisions;
pub mod ranking;
pub mod residual;
pub mod run;
