//! Linear models: state space, transfer function, and the modes of a pole.

pub mod mode;
pub mod state_space;
pub mod transfer_function;
