//! Figures of the identified models: poles, singular values, stabilisation, responses over frequency and time.
//! Uses results and text.

pub mod bode;
pub mod poles;
pub mod responses;
pub mod singular_values;
pub mod stabilisation;
