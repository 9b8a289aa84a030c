//! The search for poles of continuous transfer functions and exponential sums: cascades of sections, starting points,
//! the separable problem.

pub(crate) mod cascade;
pub(crate) mod multistart;
pub(crate) mod options;
pub(crate) mod pole_problem;
pub(crate) mod search_outcome;
pub(crate) mod starts;
pub(crate) mod stretches;
pub(crate) mod time_scale;
