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
pub mod phrases;

pub use compare::compared_run::ComparedRun;
pub use compare::document::RunComparison;
pub use compare::first_screen::first_screen;
pub use figures::all::all_figures;
pub use findings::{
    CandidateResult, Certainties, Conclusion, Element, JointTests, Kind, LeftOut, MeasuredWaves, Model, Number,
    OverviewLine, Ranking, Run, SensorMotion, StageNote, StageRecord, Standing, Status, StatusReason, Summary,
    TestOfJointModel, compare_ids, conclusion, overview, summary, summary_schema,
};
pub use index::document::{FiguresOfRuns, RunIndex};
pub use index::indexed_run::{IndexedRun, status};
pub use index::pulse::pulse_line;
pub use index::quantities::{self, Quantity};
pub use index::run_summary::{
    MetricOfChannel, ParameterIntervals, RunSummary, SummaryCandidate, SummaryConcern, SummaryConclusion,
    SummaryMetric, SummaryTest, model_year,
};
pub use page::document::{Page, write_shared_files};
pub use phrases::words::fill;
