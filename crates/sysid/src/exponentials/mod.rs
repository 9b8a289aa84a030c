//! A record as a sum of exponentials: the free motion of a linear system.

pub(crate) mod exponential_sum;
pub(crate) mod options;
pub(crate) mod starts;
pub(crate) mod terms;
