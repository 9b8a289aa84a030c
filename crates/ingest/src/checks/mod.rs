//! What is noted about the channels: quality, time grids, sensors that should agree, units and signs exchanged.
//! Corrects nothing.

pub mod channel_quality;
pub mod exchange_question;
pub mod misplaced_decimal_point;
pub mod redundant_sensors;
