//! `fleet.html`: the runs of a fleet as an index, with figures of all of them. The page, its table and its quantities
//! are those of `crumple-report`.

pub mod distributions;
pub mod document;
pub mod outliers;
pub mod pulse;
pub mod scatter;
