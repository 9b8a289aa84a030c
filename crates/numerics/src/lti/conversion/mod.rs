//! Between continuous and sampled models, and between state space and transfer function.

pub mod continuous;
pub mod first_order_hold;
pub mod to_transfer_function;
pub mod zero_order_hold;
