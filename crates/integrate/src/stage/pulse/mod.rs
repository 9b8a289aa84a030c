//! The channels that are integrated: first contact, motion and events, agreement of redundant sensors, records.

pub mod channel_agreement;
pub mod impact_speed;
pub mod integrated;
pub mod integration;
pub mod other_channels;
pub mod records;
pub mod summary;
pub mod time_zero;
