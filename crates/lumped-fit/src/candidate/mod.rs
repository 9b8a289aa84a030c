//! A parameter set with how it was found, how it was fitted and how well it is known, and its parameters in words.
//! May use `record`.

pub mod linearised;
pub mod method;
pub mod note;
pub mod parameter_set;
pub mod parameter_words;
