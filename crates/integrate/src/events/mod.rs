//! What a motion says about the crash: time zero, sign of the pulse, events, findings in words.
//! May use `motion`.

pub mod findings;
pub mod sign;
pub mod speed_question;
pub mod time_zero;
