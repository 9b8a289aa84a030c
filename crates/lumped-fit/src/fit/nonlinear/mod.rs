//! TODO room

pub mod momentum_starts;
pub mod nonlinear1;
pub mod nonlinear2;
pub mod problem;
