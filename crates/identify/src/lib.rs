//! Identifies linear models from a record.
//!
//! One method so far: [`era`], the eigensystem realization algorithm, which takes the record for the impulse response
//! of a linear system and returns the smallest balanced one that has it, with poles, modes and the evidence for them.

mod caveats;
mod era;
mod factors;
mod fit;
mod golub_kahan;
mod hankel;
mod modal;
mod order;

pub use caveats::{caveats, filter_edge_hz};
pub use era::{Era, EraError, EraOptions, Order, Realization, era};
pub use factors::Decomposition;
pub use fit::{fit_percent, rmse};
pub use modal::IdentifiedMode;
pub use order::{GapOrder, order_by_gap};
