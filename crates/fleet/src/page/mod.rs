//! `fleet.html`: the runs of a fleet on one page, for people: km/h, mm, g, kN/m.
//! May use `tables`, `runs` and `records`.

pub mod document;
pub mod failures;
pub mod histogram;
pub mod markup;
pub mod outliers;
pub mod quantities;
pub mod run_table;
pub mod scatter;
pub mod sparkline;
