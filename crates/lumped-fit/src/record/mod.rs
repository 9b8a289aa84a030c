//! What is known of a test: its events, its waves, how they were measured, where they are compared.
//! Uses no other room.

pub mod fit_quantity;
pub mod measurement;
pub mod observation;
pub mod sensor;
pub mod test_data;
