//! Figures of the identified models: poles, singular values, stabilisation, responses over frequency and time.

pub mod bode;
pub mod poles;
pub mod responses;
pub mod singular_values;
pub mod stabilisation;
