//! One model for several tests: the waves of all of them side by side, each with its own speed, mass and filter.
//! May use `solvers`, `fit`, `candidate`, `free` and `record`.

pub mod joint_fit;
pub mod rate_factor;
pub mod unloading;
