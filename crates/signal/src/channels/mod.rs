//! Identity and state of a measuring channel, and its sensitive axis.
//! Uses units.

pub mod channel;
