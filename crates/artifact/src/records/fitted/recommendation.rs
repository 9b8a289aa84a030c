//! Record: which candidate to use for what, and why.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Which candidate to use, and what spoke for it. Topic `/recommendation`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RecommendationV1 {
    /// Candidate for the prediction of other tests; `null`: none qualifies.
    pub recommended: Option<String>,
    /// Why this one, or why none, in one sentence.
    pub recommended_because: String,
    /// Adequate candidate with the fewest parameters, all of them determined.
    pub simplest: Option<String>,
    /// Why this one, or why none.
    pub simplest_because: String,
    /// How the evidence stands to `beside`; `null`: there is none, or none is recommended.
    #[serde(default)]
    pub strength: Option<StrengthV1>,
    /// The candidate of another model with the lowest criterion of those that might be recommended instead.
    #[serde(default)]
    pub beside: Option<String>,
    /// Channels whose records decided: the pulse, and the sensors on other masses that were fitted.
    #[serde(default)]
    pub decided_by: Vec<String>,
    /// Candidate that follows the record closest.
    pub closest: Option<String>,
    /// Why this one, or why none.
    pub closest_because: String,
    /// What the information criterion was computed from; `null`: nothing could be compared.
    pub evidence: Option<RecommendationEvidenceV1>,
    /// What is known beside the record, as squared terms.
    #[serde(default)]
    pub priors: Vec<PriorV1>,
    /// All candidates, best with priors first, then those that are not adequate.
    #[serde(default)]
    pub candidates: Vec<RatedCandidateV1>,
}

/// How the evidence for a recommended candidate stands to that for the best candidate of another model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum StrengthV1 {
    /// The criteria differ by 10 at most.
    Weak,
    /// The criterion of the recommended candidate is lower by more than 10.
    Decisive,
    /// The criterion of the other is lower by more than 10: the recommended candidate was chosen for its crush at lower
    /// speeds.
    Contrary,
}

/// What the information criterion was computed from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RecommendationEvidenceV1 {
    /// Quantity compared, e.g. `acceleration`.
    pub quantity: String,
    /// Whether the models were sampled and filtered as the record was.
    pub as_measured: bool,
    /// Compared window: start, s after time zero.
    pub from_s: f64,
    /// Compared window: end.
    pub to_s: f64,
    /// Samples compared.
    pub samples: u64,
    /// Independent samples that all candidates are compared with.
    pub effective_samples: f64,
}

/// One piece of prior knowledge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PriorV1 {
    /// Name, e.g. `restitution`.
    pub name: String,
    /// What it says, in words and numbers.
    pub statement: String,
    /// Where it comes from.
    pub source: String,
}

/// One candidate in the choice.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct RatedCandidateV1 {
    /// Candidate.
    pub id: String,
    /// What takes the energy: `plastic`, `damped` or `elastic`.
    pub class: String,
    /// Whether its model describes the record.
    pub adequate: bool,
    /// Why it is not adequate.
    pub not_adequate_because: Option<String>,
    /// Events of its own test that it misses by more than an adequate model may: `dynamic_crush`,
    /// `time_of_dynamic_crush`, `coefficient_of_restitution`. A recommended candidate that misses one of the last two
    /// is good for its dynamic crush alone.
    #[serde(default)]
    pub missed_events: Vec<String>,
    /// Dynamic crush of the model over that of the test, less 1; the largest of several tests; `null`: it never stops.
    #[serde(default)]
    pub crush_error: Option<f64>,
    /// Time of dynamic crush of the model over that of the test, less 1; the largest of several tests.
    #[serde(default)]
    pub time_error: Option<f64>,
    /// Restitution of the model less that of the test; the largest of several tests; `null`: the test shows none.
    #[serde(default)]
    pub restitution_error: Option<f64>,
    /// Free numbers that it was charged for.
    pub parameters: u32,
    /// Of these, how many the record determines, to better than an order of magnitude.
    pub determined: u32,
    /// Root mean square misfit as measured, unit of the quantity of the evidence; of springs and dampers at its least,
    /// if noise might explain that.
    pub misfit: Option<f64>,
    /// Displacement fit as measured, percent.
    pub fit_as_measured_percent: Option<f64>,
    /// Coefficient of restitution of the model in the test.
    pub coefficient_of_restitution: Option<f64>,
    /// Misfit of the wall's force, percent of its root mean square, where the record has one.
    pub force_misfit_percent: Option<f64>,
    /// Score as measured, without priors: minus twice the logarithm of the density that the model gives the record
    /// before it is fitted to it. Earlier versions wrote a corrected Akaike criterion.
    pub aicc: Option<f64>,
    /// The same above the lowest of the adequate candidates.
    pub aicc_difference: Option<f64>,
    /// What each prior adds.
    #[serde(default)]
    pub priors: Vec<PriorTermV1>,
    /// Score with all priors above the lowest of the compared candidates.
    pub difference_with_priors: Option<f64>,
    /// What it weighs in a prediction, all weights together 1: `exp(-d/2)` of the difference with priors; zero: it is
    /// not for prediction. `null` in records of earlier versions.
    #[serde(default)]
    pub weight: Option<f64>,
    /// Standard deviations of the logarithms of its free numbers, once the record is known, beside what no lumped model
    /// describes of it; each at most `ln 2`.
    #[serde(default)]
    pub log_deviations: BTreeMap<String, f64>,
}

/// What a prior adds to the criterion of a candidate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct PriorTermV1 {
    /// Name of the prior.
    pub name: String,
    /// Its squared term.
    pub term: f64,
}
