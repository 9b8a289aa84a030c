//! One stage: how it is started, how it ended, how the result of a program from elsewhere is taken over.

pub mod ending;
pub mod start;
pub mod take_over;
