//! Figures of the crash: the test with its models, other sensors, springs at work, divisions of the mass.

pub mod crush_over_speed;
pub mod curves;
mod drawn_models;
pub mod elements;
mod force;
pub mod mass_split;
pub mod recorded;
pub mod residual;
mod same_place;
pub mod sensors;
