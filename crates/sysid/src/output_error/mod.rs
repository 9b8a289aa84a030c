//! Sampled models whose simulated output is nearest to the measured one.

pub(crate) mod options;
pub(crate) mod output_error;
