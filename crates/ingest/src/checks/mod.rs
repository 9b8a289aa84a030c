//! What is noted about the channels: quality, time grids, sensors that should agree.
//! May use pulse, time and recording; corrects nothing.

pub mod channel_quality;
pub mod lost_point;
pub mod redundant_sensors;
