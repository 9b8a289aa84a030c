//! What a motion says about the crash: time zero, sign of the pulse, events, findings in words.

pub mod findings;
pub mod sign;
pub mod speed_question;
pub mod time_zero;
