//! What moves the models, from records of the test.

pub mod excitation;
