//! Dynamic time warping of two curves in a band, without a table of the band.
//!
//! The band is filled along anti-diagonals, whose cells do not depend on each other, several diagonals at a time in
//! tiles that stay in the cache. A narrower band gives a path, and so a cost that the least one does not exceed: on
//! either end of a diagonal, cells above it are left out, for costs only grow along a path (pruned warping; Silva &
//! Batista, SIAM SDM 2016). Sums and minima are monotone in floating point too, so the path is the same to the last
//! tie, for every width of the processor's vectors. A fixed number of fronts is kept; the way back fills again what
//! lies between two of them and can reach the path, in as many levels as it takes until a triangle of cells is small:
//! memory that grows with the band alone.
//!
//! Work: n times the band at worst, for curves that nothing aligns; a fraction of it for curves that resemble each
//! other. No exact method is known whose worst case grows with less than nearly n² (Bringmann & Künnemann, FOCS 2015).

mod band;
mod cells;
mod cone;
mod front;
mod path;
mod sweep;

pub(super) use band::Warping;
