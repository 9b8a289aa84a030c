//! Writes `report.html` and `summary.json` from the artifacts of a run.
//!
//! A [`Run`] is what the artifacts say ([`findings`]), [`Page`] what a person looks at. It is a function of the run
//! alone. Units other than SI exist on the page only.

mod compare;
pub mod drawing;
mod figures;
pub mod findings;
mod frame;
mod index;
mod page;
pub mod run_numbers;
mod stage;
mod validate;
pub mod words;

pub use compare::causes::name_of_cause;
pub use compare::compared_run::ComparedRun;
pub use compare::document::RunComparison;
pub use compare::first_screen::first_screen;
pub use compare::quantities::{Group, Quantity, quantities};
pub use compare::why::{Divided, DividedNumber};
pub use crumple_diff::CompareSettings;
pub use figures::all::all_figures;
#[cfg(feature = "schemas")]
pub use findings::summary_schema;
pub use findings::{
    CandidateResult, CandidateSummary, Concern, Conclusion, Element, IdentifiabilityCounts, JointTests, Kind, LeftOut,
    MeasuredWaves, MetricSummary, Model, ModelOutput, Number, OF_SEVERAL_TESTS, OtherMetricSummary, OverviewLine,
    Ranking, ResultStatus, Run, SensorMotion, Soundness, StageRecord, Status, StatusReason, Summary, TestOfJointModel,
    TestSummary, compare_ids, conclusion, model_year, overview, summary,
};
pub use index::pulse_line;
pub use index::{FiguresOfRuns, RunIndex};
pub use index::{IndexedRun, status};
pub use page::document::{Page, write_shared_files};
pub use run_numbers::RunNumber;
pub use stage::accept::ACCEPT;
pub use stage::diff::{DIFF, diff};
pub use stage::together::JointAnswer;
pub use stage::{COMPARE, CompareCli, INDEX, PROGRAM, compare_runs};
