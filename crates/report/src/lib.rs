//! Writes `report.html` and `summary.json` from the artifacts of a run.
//!
//! A [`Run`] is everything the artifacts say, gathered by topic; [`summary`](fn@summary) is what a script reads of it,
//! [`Page`] what a person looks at. Both are functions of the run alone. Units other than SI exist on the page only.

pub mod escape;
pub mod figure;
pub mod figures;
mod gather;
pub mod page;
pub mod people;
mod ranking;
mod run;
mod summary;
pub mod tool;

pub use gather::gather;
pub use page::Page;
pub use ranking::{Ranking, pairs_of_equals};
pub use run::{Candidate, Element, Measured, Model, OtherSensor, Run, StageNote, StageRecord};
pub use summary::{Summary, summary};
