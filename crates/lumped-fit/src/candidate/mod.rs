//! A parameter set with how it was found, how it was fitted and how well it is known, and its parameters in words.

pub mod method;
pub mod minimum;
pub mod parameter_set;
pub mod parameter_words;
