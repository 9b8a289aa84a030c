//! What a model answers: in time to an input or an initial state, and over frequency.

pub mod frequency_response;
pub mod response;
pub mod simulate;
