//! Both nonlinear models of a single mass fitted to its displacement, from starts by the momentum.

pub mod coordinates;
pub mod momentum_starts;
pub mod nonlinear1;
pub mod nonlinear2;
