//! What a run comes to, whatever shows it: results gathered from its artifacts, the ranking of candidates, key numbers,
//! warnings by their weight, the verdict in two sentences, the summary.
//!
//! A [`Run`] is everything the artifacts say, gathered by topic; [`summary`](fn@summary) is what a script reads of it.
//! Both are SI alone; units of people stand in sentences only.

mod conclusions;
mod names;
mod results;
mod sentences_shown;
mod text;

pub use conclusions::concerns::{
    Concern, concerns, first_warnings, is_of_a_failed_method, is_of_another_candidate, warnings,
};
pub(crate) use conclusions::concerns::{more_warnings, what_to_do};
pub(crate) use conclusions::conclusion::with_mass_against;
pub use conclusions::conclusion::{Conclusion, Number, conclusion};
pub use conclusions::distinct_curves::{DistinctCurve, SAME_CURVE, SAME_RESTITUTION, distinct_curves, same_curve};
pub(crate) use conclusions::key_numbers::class_of_record;
pub use conclusions::key_numbers::{KeyNumber, Spread, key_numbers};
pub use conclusions::kind::{Kind, ResultStatus};
pub use conclusions::overview::{OverviewLine, overview};
pub use conclusions::own_remarks::{REMARKS, StatedInFile};
pub use conclusions::status::{Status, StatusReason};
#[cfg(feature = "schemas")]
pub use conclusions::summary::summary_schema;
pub use conclusions::summary::{
    CandidateSummary, MatchingSummary, MetricSummary, ModelSummary, OF_SEVERAL_TESTS, OtherMetricSummary, PoleSummary,
    Summary, TestSummary, TransferFunctionSummary, model_year, summary,
};
pub use conclusions::uses::{Soundness, Use};
pub use names::model_name;
pub use results::joint::{JointTests, LeftOut, TestOfJointModel};
pub use results::model_output::{ErrorCorrelation, ModelOutput};
pub use results::one_spring::OneSpring;
pub use results::parameters::ShownParameter;
pub use results::ranking::{Ranking, compare_ids};
pub use results::run::{
    CandidateResult, Element, IdentifiabilityCounts, MeasuredWaves, Model, PoleStability, Run, SensorMotion,
    StageProgram, StageRecord, doubt_in_words,
};
pub use results::{mass_divisions, ranking};
pub use text::{HEAD, capitalised, markdown, parameter, parameter_order, record_name, short, words_and_unit};
