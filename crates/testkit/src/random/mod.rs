//! Numbers that look random and are the same in every run: normal deviates in a row, uniform ones by their place.
//! Uses no other room.

mod normal_deviates;
mod white_noise;

pub use normal_deviates::NormalDeviates;
pub use white_noise::{uniform, white_noise};
