//! What moves the models, from records of the test.
//! May use nothing.

pub mod excitation;
