//! One model for several tests: the waves of all of them side by side, each with its own speed, mass and filter.

pub mod joint_fit;
pub mod rate_factor;
pub mod unloading;
