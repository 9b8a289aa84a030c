//! Everything the artifacts of a run say: its types, the ranking of candidates, the summary.
//! Uses text.

pub mod concerns;
pub mod conclusion;
pub mod distinct_curves;
pub mod key_numbers;
pub mod kind;
pub mod mass_divisions;
pub mod overview;
pub mod ranking;
pub mod residual;
pub mod run;
pub mod summary;
