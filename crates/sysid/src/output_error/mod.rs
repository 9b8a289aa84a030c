//! Sampled models whose simulated output is nearest to the measured one.
//! May use poles, subspace, arx, data, error.

pub(crate) mod cascade;
pub(crate) mod options;
pub(crate) mod output_error;
pub(crate) mod starts;
