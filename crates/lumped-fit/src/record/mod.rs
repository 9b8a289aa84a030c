//! What is known of a test: its events, its waves, how they were measured, where they are compared.

pub mod fit_quantity;
pub mod measurement;
pub mod observation;
pub mod sensor;
pub mod sensor_noise;
pub mod test_data;
pub mod wall_force;
pub mod wall_response;
