//! Identity and state of a measuring channel, and its sensitive axis.

pub mod channel;
