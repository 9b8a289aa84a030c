//! Both nonlinear models of a single mass fitted to its displacement, from starts by the momentum.
//! May use `fit/descents`, `fit/options`, `candidate` and `record`.

pub mod momentum_starts;
pub mod nonlinear1;
pub mod nonlinear2;
pub mod problem;
