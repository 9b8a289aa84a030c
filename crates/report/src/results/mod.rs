//! Everything the artifacts of a run say: its types, the ranking of candidates, the summary.
//! Uses text.

pub mod distinct_curves;
pub mod key_numbers;
pub mod mass_divisions;
pub mod ranking;
pub mod residual;
pub mod run;
pub mod summary;
