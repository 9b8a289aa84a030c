//! Exact steps of linear equations of motion, their derivatives, and the search for the first zero on them.
//! May use `motion` and `kind`.

pub mod crossing;
pub mod driven;
pub mod exact_step;
pub mod falling_zero;
pub mod linear_motion;
pub mod second_order;
pub mod stumpff;
