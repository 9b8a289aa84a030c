//! Many records, one run folder each: the program behind `just fleet`.
//!
//! It knows which records there are, which of their runs are up to date, and how many run at a time. A run itself is
//! that of `crumple-run`, with all that it promises. What the runs found is gathered into tables and a page; [`study`]
//! asks what they say of vehicles.

mod command;
mod make;
mod page;
mod records;
mod regression;
mod runs;
mod study;
pub(crate) mod tables;
mod watch;

pub use command::Options;
pub use make::fleet;
pub use study::{StudyOptions, study};
pub use watch::{WatchOptions, watch};
