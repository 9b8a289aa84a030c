//! Writes `report.html` and `summary.json` from the artifacts of a run.
//!
//! A [`Run`] is everything the artifacts say, gathered by topic; [`summary`](fn@summary) is what a script reads of it,
//! [`Page`] what a person looks at. Both are functions of the run alone. Units other than SI exist on the page only.
//!
//! rooms: compare index | page | frame figures | conclusions | results | text

mod compare;
mod conclusions;
mod figures;
mod frame;
mod index;
mod page;
mod results;
mod text;

pub use compare::compared_run::ComparedRun;
pub use compare::document::RunComparison;
pub use compare::first_screen::first_screen;
pub use conclusions::conclusion::{Conclusion, Number, Standing, conclusion};
pub use conclusions::kind::Kind;
pub use conclusions::overview::overview;
pub use conclusions::summary::{Summary, summary, summary_schema};
pub use figures::all::all_figures;
pub use index::document::{FiguresOfRuns, RunIndex};
pub use index::indexed_run::{IndexedRun, status};
pub use index::pulse::pulse_line;
pub use index::quantities::{self, Quantity};
pub use index::run_summary::{
    MetricOfChannel, ParameterIntervals, RunSummary, SummaryCandidate, SummaryConcern, SummaryConclusion,
    SummaryMetric, SummaryTest, model_year,
};
pub use page::document::{Page, write_shared_files};
pub use results::joint::{JointTest, JointTests, LeftOut};
pub use results::ranking::{Ranking, compare_ids};
pub use results::run::{
    CandidateResult, Certainties, Element, MeasuredWaves, Model, Run, SensorMotion, StageNote, StageRecord,
};
pub use text::language::{Language, fill};
