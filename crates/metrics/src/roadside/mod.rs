//! Criteria of roadside hardware: ASI, THIV, PHD, OIV, ORA.
//! May use `sums` and `metric`.

pub mod asi;
pub mod butterworth;
pub mod flail_space;
