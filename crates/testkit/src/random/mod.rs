//! Numbers that look random and are the same in every run, by their place.
//! Rows of them: `crumple_numerics::estimation::random`.

mod white_noise;

pub use white_noise::{uniform, white_noise};
