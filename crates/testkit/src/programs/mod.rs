//! Starts the programs as a user does: the whole pipeline through `just`, or one stage on prepared inputs.

pub mod fleet;
pub mod pipeline;
pub mod program;
pub(crate) mod steps;
mod test_runner;

pub use steps::StepError;
pub use test_runner::asked_for_tests;
