//! The objective rating of ISO/TS 18571: corridor, phase, magnitude and slope of one curve against another.
//! May use `curves/best_shift`, `curves/corridor_rating` and `metric`.

mod magnitude;
pub mod rating;
mod slope;
mod warping;
