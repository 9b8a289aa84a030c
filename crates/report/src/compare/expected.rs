//! What is kept of an accepted run, small enough for a repository: `expected/<record>.json`.

use std::collections::BTreeMap;

use crumple_artifact::records::ContactV1;
use crumple_diff::{CompareSettings, DiffError, rules_of};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::findings::{CandidateSummary, ModelSummary, StageRecord, Summary, record_name};

/// The limits of a pipeline by their patterns, as a file of tolerances has them.
pub type Limits = BTreeMap<String, Value>;

/// These settings with the limits of a pipeline, behind what was typed. Errors: a limit is none.
pub fn within(settings: &CompareSettings, limits: &Limits) -> Result<CompareSettings, DiffError> {
    let tolerances = settings.tolerances.with_rules(rules_of(limits)?);
    Ok(CompareSettings { tolerances, ..settings.clone() })
}

/// What is kept of an accepted run.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Expected {
    /// `crumple.expected.v2`.
    pub schema: String,
    /// The record: its file's name and digest.
    pub record: [String; 2],
    /// Where contact lies on the axis of the record.
    pub contact: Option<ContactV1>,
    /// The options of its pipeline by stage, as they were written, and behind `flags` what was typed for the stage.
    pub options: BTreeMap<String, Value>,
    /// The limits within which its pipeline says that runs are the same.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub limits: Limits,
    /// Programs, settings and content digests of the artifacts.
    pub stages: Vec<StageRecord>,
    /// What people decide by.
    pub summary: Summary,
    /// Whether nothing but a summary was given, so that its artifacts are not known.
    #[serde(skip)]
    pub is_summary_alone: bool,
}

impl Expected {
    /// The schema of such a file.
    pub const SCHEMA: &str = "crumple.expected.v2";
    /// The schema of earlier ones: test, key numbers, recommended model and its predictions.
    const EARLIER: &str = "crumple.expected.v1";

    /// Whether a file of this schema was accepted, by this version or an earlier one.
    pub fn is_schema(schema: &Value) -> bool {
        [Self::SCHEMA, Self::EARLIER].iter().any(|known| schema == known)
    }

    /// Whether an earlier version kept it, which held less.
    pub fn is_earlier(&self) -> bool {
        self.schema == Self::EARLIER
    }

    /// Of a run: what a review compares, and nothing besides.
    pub fn of_run(run: Self) -> Self {
        let Self { record, contact, options, limits, stages, summary, .. } = run;
        let is_named = |id: &String| named(&summary).any(|(_, named)| named == id);
        let kept = |one: &CandidateSummary| if is_named(&one.id) { without_repetitions(one) } else { in_short(one) };
        let kept = Summary {
            schema: summary.schema.clone(),
            pipeline: summary.pipeline.clone(),
            verdict: summary.verdict.clone(),
            test: summary.test.clone(),
            events: summary.events.clone(),
            impacts: summary.impacts.clone(),
            key_numbers: summary.key_numbers.clone(),
            metrics: summary.metrics.clone(),
            other_metrics: summary.other_metrics.clone(),
            models: summary.models.iter().map(without_polynomials).collect(),
            candidates: summary.candidates.iter().map(kept).collect(),
            recommended: summary.recommended.clone(),
            simplest: summary.simplest.clone(),
            closest: summary.closest.clone(),
            predictions: summary.predictions.clone(),
            concerns: summary.concerns.clone(),
            remarks: summary.remarks.clone(),
            warnings: summary.warnings,
            best_undetermined: summary.best_undetermined.clone(),
            best_hardly_determined: summary.best_hardly_determined.clone(),
            matching_best: summary.matching_best.clone(),
            ..Summary::default()
        };
        Self {
            schema: Self::SCHEMA.to_owned(),
            record,
            contact,
            options,
            limits,
            stages,
            summary: kept,
            is_summary_alone: false,
        }
    }

    /// These settings with the limits of its pipeline, behind what was typed. Errors: a limit is none.
    pub fn within(&self, settings: &CompareSettings) -> Result<CompareSettings, DiffError> {
        within(settings, &self.limits)
    }

    /// The record with the first characters of its digest.
    pub fn record(&self) -> String {
        record_name(&self.record[0], &self.record[1])
    }
}

/// The candidates that a choice names, by what it names them.
pub fn named(summary: &Summary) -> impl Iterator<Item = (&'static str, &String)> {
    let names = [("recommended", &summary.recommended), ("simplest", &summary.simplest), ("closest", &summary.closest)];
    names.into_iter().filter_map(|(name, id)| Some((name, id.as_ref()?)))
}

/// A candidate without what follows from the rest or only explains it.
fn without_repetitions(candidate: &CandidateSummary) -> CandidateSummary {
    let mut kept = candidate.clone();
    kept.notes.clear();
    if let Some(known) = &mut kept.uncertainty {
        known.correlation.clear();
        known.profile.clear();
    }
    kept
}

/// A candidate that the choice names for nothing: whether it is physical, and how many of its numbers are determined.
pub fn in_short(candidate: &CandidateSummary) -> CandidateSummary {
    let CandidateSummary { id, model, method, physical, equivalent_to, certainties, .. } = candidate.clone();
    CandidateSummary { id, model, method, physical, equivalent_to, certainties, ..CandidateSummary::default() }
}

/// An identified model by its modes; its polynomials follow from them.
fn without_polynomials(model: &ModelSummary) -> ModelSummary {
    ModelSummary { poles: Vec::new(), transfer_function: None, ..model.clone() }
}
