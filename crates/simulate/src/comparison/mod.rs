//! A simulation beside the test: errors, ratings, information criterion, other sensors.
//! May use nothing.

pub mod deceleration_peak;
pub mod information;
pub mod other_sensor;
pub mod ratings;
pub mod simulation;
