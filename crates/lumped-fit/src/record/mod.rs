//! What is known of a test: its events, its waves, how they were measured, where they are compared.

pub mod measurement;
pub mod observation;
pub mod sensor;
pub mod sensor_noise;
