//! How well each candidate's parameters are known: followed through the filter of its record, assessed, paired with
//! its dual.
//! May use `inputs` and `options`.

pub mod candidate_assessment;
pub mod candidates;
pub mod dual_pairs;
pub mod replace_by_refined;
pub mod sensor_waves;
