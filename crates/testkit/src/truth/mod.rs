//! Every sentence and number that a run says, read back and compared with the truth of its record.

mod cases;
mod known;
mod remarks;
mod rules;
mod run;
mod sentences;
mod template;

pub use crate::truth::run::{Failure, Made, Shown, numbers, plain, run};
pub use crate::truth::sentences::{Complaint, Net};
pub use cases::{Extent, RunCase, cases};
pub use remarks::Explained;
pub use rules::Registry;
