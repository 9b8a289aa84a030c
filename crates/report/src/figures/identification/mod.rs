//! Figures of the identified models: simulated outputs and their errors, poles, singular values, stabilisation,
//! responses over frequency and time.

pub mod bode;
pub mod poles;
pub mod responses;
pub mod simulated;
pub mod singular_values;
pub mod stabilisation;
