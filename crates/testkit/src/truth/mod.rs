//! Every sentence and number that a run says, read back and compared with the truth of its record.

mod cases;
mod counts;
mod fit;
mod known;
mod labels;
mod net;
mod numbers_of_runs;
mod page;
mod rules;
mod run;
mod sentences;
mod shown;
mod template;

pub use cases::{Extent, RunCase, cases};
pub use net::{Complaint, Net};
pub use rules::Registry;
pub use run::{Failure, Made, run};
pub use shown::{Shown, numbers, plain};
