//! A simulation beside the test: errors, ratings, information criterion, other sensors.

pub mod deceleration_peak;
pub mod information;
pub mod other_sensor;
pub mod ratings;
pub mod simulation;
