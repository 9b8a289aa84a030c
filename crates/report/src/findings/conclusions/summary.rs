//! `summary.json`: what a script reads of a run. Schema `crumple.summary.v1`.

use std::collections::BTreeMap;

use crumple_artifact::records::{
    ConcernV1, EventsV1, FitV1, MetricV1, ModeV1, PredictionV1, SimulationV1, UncertaintyV1,
};
use schemars::JsonSchema;
use serde::Serialize;

use crate::findings::conclusions::conclusion::{Conclusion, conclusion};
use crate::findings::conclusions::distinct_curves::{DistinctCurve, distinct_curves};
use crate::findings::conclusions::key_numbers::{KeyNumber, key_numbers};
use crate::findings::results::ranking::compare_ids;
use crate::findings::{CandidateResult, Certainties, Model, Ranking, Run};

/// The JSON Schema of `summary.json`.
pub fn summary_schema() -> serde_json::Value {
    let written = schemars::generate::SchemaSettings::draft2020_12().for_serialize();
    written.into_generator().into_root_schema_for::<Summary<'_>>().to_value()
}

/// The summary of a run. Keys are written in the order of the fields, numbers in full, SI units throughout.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Summary<'a> {
    schema: &'static str,
    pipeline: Option<&'a str>,
    /// What to hold of all this, in two sentences.
    verdict: Conclusion,
    test: TestSummary<'a>,
    events: Option<&'a EventsV1>,
    /// The numbers of the page's first screen.
    key_numbers: Vec<KeyNumber>,
    metrics: BTreeMap<&'a str, MetricSummary<'a>>,
    /// Metrics of channels that the pulse has none of: occupants, barrier, recorder.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    other_metrics: Vec<OtherMetricSummary<'a>>,
    models: Vec<ModelSummary<'a>>,
    candidates: Vec<CandidateSummary<'a>>,
    /// Candidates by the curve they answer with.
    distinct_curves: Vec<DistinctCurve>,
    /// Candidate for the prediction of other tests, and why, or why none.
    recommended: Option<&'a str>,
    recommended_because: &'a str,
    /// Adequate candidate with the fewest parameters, all determined.
    simplest: Option<&'a str>,
    simplest_because: Option<&'a str>,
    /// Candidate that follows the record closest.
    closest: Option<&'a str>,
    closest_because: Option<&'a str>,
    /// The same as `recommended`.
    best: Option<String>,
    /// Why this run can have none, whatever fits.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_best: Option<String>,
    /// Parameters of the best that this record does not determine.
    best_undetermined: Vec<&'a str>,
    /// Where the 95 % interval of a parameter spans more than a factor of a thousand.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    best_hardly_determined: Vec<&'a str>,
    ranking: Vec<String>,
    /// The figure that orders `ranking`.
    ranked_by: &'static str,
    /// Those with an AICc by that, lowest first.
    ranking_by_aicc: Vec<String>,
    matching_best: Option<MatchingSummary<'a>>,
    predictions: &'a [PredictionV1],
    /// What speaks against the results, gravest first. Weights go from 1 to 9: what it changes (1 to 3) times how
    /// prominently the page shows that (1 to 3).
    concerns: Vec<ConcernV1>,
    notes: Vec<String>,
    other_channels: Vec<&'a str>,
    missing: &'a [String],
}

#[derive(Debug, Serialize, JsonSchema)]
struct TestSummary<'a> {
    title: &'a str,
    mass_kg: Option<f64>,
    impact_speed_m_per_s: Option<f64>,
    channel: Option<&'a str>,
    sample_rate_hz: Option<f64>,
    vehicle: Option<&'a str>,
    barrier: Option<&'a str>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct MetricSummary<'a> {
    value: Option<f64>,
    unit: &'a str,
    definition_id: Option<&'a str>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    low: Option<f64>,
    high: Option<f64>,
    interval_by: Option<&'a str>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct OtherMetricSummary<'a> {
    name: &'a str,
    channel: &'a str,
    location: Option<&'a str>,
    #[serde(flatten)]
    metric: MetricSummary<'a>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct ModelSummary<'a> {
    id: &'a str,
    method: Option<&'a str>,
    order: Option<u32>,
    fit_percent: Option<f64>,
    /// Fit of samples that it has not seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    unseen_fit_percent: Option<f64>,
    /// All poles, the modes first.
    poles: Vec<PoleSummary>,
    modes: &'a [ModeV1],
    transfer_function: Option<TransferFunctionSummary<'a>>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct PoleSummary {
    re_per_s: f64,
    im_rad_per_s: f64,
}

#[derive(Debug, Serialize, JsonSchema)]
struct TransferFunctionSummary<'a> {
    numerator: &'a [f64],
    denominator: &'a [f64],
}

#[derive(Debug, Serialize, JsonSchema)]
struct CandidateSummary<'a> {
    id: &'a str,
    model: &'a str,
    method: &'a str,
    parameters: &'a BTreeMap<String, f64>,
    physical: bool,
    equivalent_to: Option<&'a str>,
    /// How many of its numbers the record determines.
    certainties: Certainties<'a>,
    simulation: Option<&'a SimulationV1>,
    fit: Option<&'a FitV1>,
    uncertainty: Option<&'a UncertaintyV1>,
    notes: &'a [String],
}

/// Which solution of coefficient matching the simulation supports.
#[derive(Debug, Serialize, JsonSchema)]
struct MatchingSummary<'a> {
    id: &'a str,
    equivalent_to: Option<&'a str>,
    fit_percent: Option<f64>,
    physical: bool,
}

/// Sums a run up.
///
/// `best` is the recommended candidate ([`Ranking`]). A metric name that several channels carry stands for the pulse
/// channel.
pub fn summary<'a>(run: &'a Run, ranking: &'a Ranking) -> Summary<'a> {
    let (verdict, concerns) = conclusion(run, ranking);
    let channel = run.channel_id();
    let choice = run.recommendation.as_ref();
    let test = &run.test;
    Summary {
        schema: "crumple.summary.v1",
        pipeline: run.pipeline.as_deref(),
        verdict,
        test: TestSummary {
            title: &test.title,
            mass_kg: test.mass_kg,
            impact_speed_m_per_s: test.impact_speed_m_per_s,
            channel,
            // That of the record: of one sampled fast, the filter keeps fewer.
            sample_rate_hz: run.measured.raw.as_ref().or(run.acceleration()).map(crumple_signal::Sampled::rate_hz),
            vehicle: test.vehicle.as_deref(),
            barrier: test.barrier.as_deref(),
        },
        events: run.events.as_ref(),
        key_numbers: key_numbers(run),
        metrics: run
            .metrics
            .iter()
            .filter_map(|metric| run.metric(&metric.name))
            .map(|metric| (metric.name.as_str(), metric_summary(metric)))
            .collect(),
        other_metrics: run.metrics_of_others().map(|metric| other_metric(run, metric)).collect(),
        models: run.models.iter().map(model).collect(),
        candidates: run
            .candidates
            .iter()
            .map(|candidate| CandidateSummary {
                id: &candidate.id,
                model: &candidate.record.model,
                method: &candidate.record.method,
                parameters: &candidate.record.parameters,
                physical: candidate.record.physical,
                equivalent_to: candidate.record.equivalent_to.as_deref(),
                certainties: candidate.certainties(),
                simulation: candidate.simulation.as_ref(),
                fit: candidate.record.fit.as_ref(),
                uncertainty: candidate.record.uncertainty.as_ref(),
                notes: &candidate.record.notes,
            })
            .collect(),
        distinct_curves: distinct_curves(run, ranking),
        recommended: ranking.best.as_deref(),
        recommended_because: &ranking.because,
        simplest: choice.and_then(|choice| choice.simplest.as_deref()),
        simplest_because: choice.map(|choice| choice.simplest_because.as_str()),
        closest: choice.and_then(|choice| choice.closest.as_deref()),
        closest_because: choice.map(|choice| choice.closest_because.as_str()),
        best: ranking.best.clone(),
        no_best: ranking.no_best.clone(),
        best_undetermined: ranking
            .best
            .as_deref()
            .and_then(|id| run.candidate(id))
            .map_or_else(Vec::new, |best| best.record.undetermined()),
        best_hardly_determined: ranking
            .best
            .as_deref()
            .and_then(|id| run.candidate(id))
            .map_or_else(Vec::new, |best| best.certainties().order_of_magnitude),
        ranking: ranking.order.clone(),
        ranked_by: "simulation.fit_as_measured_percent: displacement fit of the model, measured as the record was, \
                    over simulation.from_s to simulation.to_s, highest first; fit_percent where it is null",
        ranking_by_aicc: ids_ordered_by_aicc(run),
        matching_best: ranking.best_of_matching(run).map(|candidate| MatchingSummary {
            id: &candidate.id,
            equivalent_to: candidate.record.equivalent_to.as_deref(),
            fit_percent: candidate.fit_percent(),
            physical: candidate.record.physical,
        }),
        predictions: &run.predictions,
        concerns,
        notes: run.notes.iter().map(|note| format!("{}: {}", note.stage, note.note)).collect(),
        other_channels: test.channels.iter().map(|c| c.id.as_str()).filter(|id| Some(*id) != channel).collect(),
        missing: &run.missing,
    }
}

/// Candidates that have an AICc, lowest first; equal ones in id order.
fn ids_ordered_by_aicc(run: &Run) -> Vec<String> {
    let aicc_of = |candidate: &CandidateResult| Some((candidate.simulation.as_ref()?.aicc?, candidate.id.clone()));
    let mut candidates: Vec<(f64, String)> = run.candidates.iter().filter_map(aicc_of).collect();
    candidates.sort_by(|(a, x), (b, y)| a.total_cmp(b).then_with(|| compare_ids(x, y)));
    candidates.into_iter().map(|(_, id)| id).collect()
}

fn metric_summary(metric: &MetricV1) -> MetricSummary<'_> {
    MetricSummary {
        value: metric.value,
        unit: &metric.unit,
        definition_id: metric.definition_id.as_deref(),
        from_s: metric.from_s,
        to_s: metric.to_s,
        low: metric.low,
        high: metric.high,
        interval_by: metric.interval_by.as_deref(),
    }
}

fn other_metric<'a>(run: &'a Run, metric: &'a MetricV1) -> OtherMetricSummary<'a> {
    let channel = metric.channel.split('+').find_map(|id| run.test.channel(id));
    let location = channel.map(|channel| channel.location.as_str()).filter(|location| !location.is_empty());
    OtherMetricSummary { name: &metric.name, channel: &metric.channel, location, metric: metric_summary(metric) }
}

fn model(model: &Model) -> ModelSummary<'_> {
    let identification = model.identification.as_ref();
    ModelSummary {
        id: &model.id,
        method: identification.map(|i| i.method.as_str()),
        order: identification.map(|i| i.order).or(u32::try_from(model.poles().count()).ok().filter(|&n| n > 0)),
        fit_percent: model.fit_percent(),
        unseen_fit_percent: model.unseen_fit_percent(),
        poles: model.poles().map(|([re_per_s, im_rad_per_s], _)| PoleSummary { re_per_s, im_rad_per_s }).collect(),
        modes: &model.modes,
        transfer_function: model
            .transfer_function
            .as_ref()
            .map(|tf| TransferFunctionSummary { numerator: &tf.numerator, denominator: &tf.denominator }),
    }
}

impl Summary<'_> {
    /// The text of `summary.json`: indented by two blanks, a line end at its end.
    pub fn to_json(&self) -> serde_json::Result<String> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        Ok(text)
    }
}
