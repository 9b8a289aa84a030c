//! What a run says, held against the known truth of its record: values of `summary.json`, values of remarks, and every
//! number that people see.

mod cases;
mod codes;
mod found;
mod known;
mod models;
mod net;
mod page_text;
#[cfg(test)]
mod planted;
mod remarks;
mod run;
mod surfaces;
mod values;

pub use cases::{Extent, RunCase, cases};
pub use found::Found;
pub use net::Net;
pub use remarks::Explained;
pub use run::{Failure, Made, run_all};
