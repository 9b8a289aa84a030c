//! Exact steps of linear equations of motion, their derivatives, and the search for the first zero on them.

pub mod crossing;
pub mod derivatives;
pub mod driven;
pub mod falling_zero;
pub mod linear_motion;
pub mod linear_system;
pub mod scaling;
pub mod second_order;
