//! Both nonlinear models of a single mass fitted to its displacement, from starts by the momentum.
//! May use `fit/at_crush`, `fit/problem`, `fit/multistart`, `fit/descents`, `fit/options`, `candidate`, `free` and
//! `record`.

pub mod coordinates;
pub mod momentum_starts;
pub mod nonlinear1;
pub mod nonlinear2;
