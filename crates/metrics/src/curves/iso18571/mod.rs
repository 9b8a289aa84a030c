//! The objective rating of ISO/TS 18571: corridor, phase, magnitude and slope of one curve against another.

mod magnitude;
pub mod rating;
mod slope;
mod warping;
