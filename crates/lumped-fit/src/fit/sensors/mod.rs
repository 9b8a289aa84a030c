//! Any model fitted to the motion of one or several sensors, weighed by their noise levels.
//! May use `fit/multistart`, `fit/descents`, `fit/halton_starts`, `free` and `record`.

pub mod fit;
pub mod problem;
