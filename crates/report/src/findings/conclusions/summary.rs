//! `summary.json`: what a script reads of a run, and what index and fleet read of many. Schema `crumple.summary.v1`.

use std::collections::BTreeMap;

use crumple_artifact::records::{
    EventsV1, FitV1, ImpactV1, IntervalSourceV1, MetricV1, ModeV1, PredictionV1, RemarkV1, SimulationV1, UncertaintyV1,
};
use crumple_stage::is_no_result;
use serde::de::Error as _;
use serde::{Deserialize, Serialize};

use crate::findings::conclusions::concerns::{Concern, remarks, warnings};
use crate::findings::conclusions::conclusion::{Conclusion, conclusion};
use crate::findings::conclusions::distinct_curves::{DistinctCurve, distinct_curves};
use crate::findings::conclusions::key_numbers::{KeyNumber, key_numbers};
use crate::findings::conclusions::status::Status;
use crate::findings::names::name_among;
use crate::findings::{CandidateResult, IdentifiabilityCounts, Model, Ranking, Run, StageProgram};

/// The schema that a summary names.
const SCHEMA: &str = "crumple.summary.v1";

/// The schema of the summary of one model for several tests.
pub const OF_SEVERAL_TESTS: &str = "crumple.together.v1";

/// The JSON Schema of `summary.json`.
#[cfg(feature = "schemas")]
pub fn summary_schema() -> serde_json::Value {
    let written = schemars::generate::SchemaSettings::draft2020_12().for_serialize();
    written.into_generator().into_root_schema_for::<Summary>().to_value()
}

/// The summary of a run. Keys are written in the order of the fields, numbers in full, SI units throughout. What an
/// earlier version did not write is empty when it is read.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
#[cfg_attr(feature = "schemas", schemars(!default))]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub struct Summary {
    pub schema: String,
    pub pipeline: Option<String>,
    /// What to hold of all this, in two sentences.
    pub verdict: Conclusion,
    pub test: TestSummary,
    pub events: Option<EventsV1>,
    /// Every impact of the pulse, in the order of time.
    pub impacts: Vec<ImpactV1>,
    /// The numbers of the page's first screen.
    pub key_numbers: Vec<KeyNumber>,
    pub metrics: BTreeMap<String, MetricSummary>,
    /// Metrics of channels that the pulse has none of: occupants, barrier, recorder.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_metrics: Vec<OtherMetricSummary>,
    pub models: Vec<ModelSummary>,
    pub candidates: Vec<CandidateSummary>,
    /// Candidates by the curve they answer with.
    pub distinct_curves: Vec<DistinctCurve>,
    /// Candidate for the prediction of other tests, and why, or why none.
    pub recommended: Option<String>,
    pub recommended_because: String,
    /// Adequate candidate with the fewest parameters, all determined.
    pub simplest: Option<String>,
    pub simplest_because: Option<String>,
    /// Candidate that follows the record closest.
    pub closest: Option<String>,
    pub closest_because: Option<String>,
    /// The same as `recommended`.
    pub best: Option<String>,
    /// Why this run can have none, whatever fits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_best: Option<String>,
    /// Parameters of the best that this record does not determine.
    pub best_undetermined: Vec<String>,
    /// Where the 95 % interval of a parameter spans more than a factor of a thousand.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub best_hardly_determined: Vec<String>,
    pub ranking: Vec<String>,
    /// The figure that orders `ranking`.
    pub ranked_by: String,
    /// Those with a criterion in the choice, in its order: the adequate first, then by the criterion with priors.
    pub ranking_by_aicc: Vec<String>,
    pub matching_best: Option<MatchingSummary>,
    pub predictions: Vec<PredictionV1>,
    /// What speaks against the results, gravest first. Weights go from 1 to 9: what it changes (1 to 3) times how
    /// prominently the page shows that (1 to 3).
    pub concerns: Vec<Concern>,
    /// What the stages and the report remark, with codes and values, strongest first: `crumple explain CODE`.
    pub remarks: Vec<RemarkV1>,
    /// How often the run remarks what its pipeline allows, by code: these speak against nothing.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub allowed: BTreeMap<String, usize>,
    /// `stage: text`.
    pub notes: Vec<String>,
    /// How many warnings there are, those of the report too.
    pub warnings: Option<usize>,
    pub other_channels: Vec<String>,
    pub missing: Vec<String>,
    /// Programs from elsewhere that stood for stages.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub programs: Vec<StageProgram>,
}

/// The test.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
#[cfg_attr(feature = "schemas", schemars(!default))]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub struct TestSummary {
    pub title: String,
    pub mass_kg: Option<f64>,
    pub impact_speed_m_per_s: Option<f64>,
    pub channel: Option<String>,
    pub sample_rate_hz: Option<f64>,
    pub vehicle: Option<String>,
    pub barrier: Option<String>,
}

/// A metric of the pulse.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
#[cfg_attr(feature = "schemas", schemars(!default))]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub struct MetricSummary {
    pub value: Option<f64>,
    pub unit: String,
    pub definition_id: Option<String>,
    pub from_s: Option<f64>,
    pub to_s: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub interval_by: Option<String>,
    /// What the interval is made from.
    pub interval_source: Option<IntervalSourceV1>,
}

/// A metric of another channel.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
#[cfg_attr(feature = "schemas", schemars(!default))]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub struct OtherMetricSummary {
    pub name: String,
    pub channel: String,
    pub location: Option<String>,
    #[serde(flatten)]
    pub metric: MetricSummary,
}

/// An identified model.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
#[cfg_attr(feature = "schemas", schemars(!default))]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub struct ModelSummary {
    pub id: String,
    pub method: Option<String>,
    pub order: Option<u32>,
    pub fit_percent: Option<f64>,
    /// Fit of samples that it has not seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unseen_fit_percent: Option<f64>,
    /// All poles, the modes first.
    pub poles: Vec<PoleSummary>,
    pub modes: Vec<ModeV1>,
    pub transfer_function: Option<TransferFunctionSummary>,
}

/// A pole.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub struct PoleSummary {
    pub re_per_s: f64,
    pub im_rad_per_s: f64,
}

/// A transfer function, highest power first.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub struct TransferFunctionSummary {
    pub numerator: Vec<f64>,
    pub denominator: Vec<f64>,
}

/// A candidate.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(default)]
#[cfg_attr(feature = "schemas", schemars(!default))]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub struct CandidateSummary {
    pub id: String,
    pub model: String,
    pub method: String,
    pub parameters: BTreeMap<String, f64>,
    pub physical: bool,
    pub equivalent_to: Option<String>,
    /// How many of its numbers the record determines.
    pub certainties: IdentifiabilityCounts,
    pub simulation: Option<SimulationV1>,
    pub fit: Option<FitV1>,
    pub uncertainty: Option<UncertaintyV1>,
    pub notes: Vec<String>,
    /// Criterion of the choice, without priors; `null`: it took no part, or the record is too short for its parameters.
    pub aicc: Option<f64>,
    /// The same with priors, above the lowest of the candidates that take part.
    pub difference_with_priors: Option<f64>,
}

/// Which solution of coefficient matching the simulation supports.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub struct MatchingSummary {
    pub id: String,
    pub equivalent_to: Option<String>,
    pub fit_percent: Option<f64>,
    pub physical: bool,
}

/// Sums a run up.
///
/// `best` is the recommended candidate ([`Ranking`]). A metric name that several channels carry stands for the pulse
/// channel.
pub fn summary(run: &Run, ranking: &Ranking) -> Summary {
    let (verdict, concerns) = conclusion(run, ranking);
    let remarks = remarks(run, ranking, verdict.kind, &concerns);
    let warnings = warnings(&concerns).count();
    let channel = run.channel_id();
    let choice = run.recommendation.as_ref();
    let test = &run.test;
    let best = ranking.best.as_deref().and_then(|id| run.candidate(id));
    let owned = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
    Summary {
        schema: SCHEMA.to_owned(),
        pipeline: run.pipeline.clone(),
        verdict,
        test: TestSummary {
            title: test.title.clone(),
            mass_kg: test.mass_kg,
            impact_speed_m_per_s: test.impact_speed_m_per_s,
            channel: channel.map(str::to_owned),
            // That of the record: of one sampled fast, the filter keeps fewer.
            sample_rate_hz: run.measured.raw.as_ref().or(run.acceleration()).map(crumple_signal::Sampled::rate_hz),
            vehicle: test.vehicle.clone(),
            barrier: test.barrier.clone(),
        },
        events: run.events.clone(),
        impacts: run.impacts.clone(),
        key_numbers: key_numbers(run),
        metrics: run
            .metrics
            .iter()
            .filter_map(|metric| run.metric(&metric.name))
            .map(|metric| (metric.name.clone(), metric_summary(metric)))
            .collect(),
        other_metrics: run.metrics_of_others().map(|metric| other_metric(run, metric)).collect(),
        models: run.models.iter().map(model).collect(),
        candidates: run.candidates.iter().map(|candidate| candidate_summary(run, candidate)).collect(),
        distinct_curves: distinct_curves(run, ranking),
        recommended: ranking.best.clone(),
        recommended_because: ranking.because.clone(),
        simplest: choice.and_then(|choice| choice.simplest.clone()),
        simplest_because: choice.map(|choice| choice.simplest_because.clone()),
        closest: choice.and_then(|choice| choice.closest.clone()),
        closest_because: choice.map(|choice| choice.closest_because.clone()),
        best: ranking.best.clone(),
        no_best: ranking.no_best().map(str::to_owned),
        best_undetermined: best.map_or_else(Vec::new, |best| owned(best.record.undetermined())),
        best_hardly_determined: best.map_or_else(Vec::new, |best| best.certainties().order_of_magnitude),
        ranking: ranking.order.clone(),
        ranked_by: "the choice: adequate candidates first, then by difference_with_priors, each with its dual behind \
                    it; those that were not rated by the displacement fit, highest first"
            .to_owned(),
        ranking_by_aicc: choice.map_or_else(Vec::new, |choice| {
            choice.candidates.iter().filter(|rated| rated.aicc.is_some()).map(|rated| rated.id.clone()).collect()
        }),
        matching_best: ranking.best_of_matching(run).map(|candidate| MatchingSummary {
            id: candidate.id.clone(),
            equivalent_to: candidate.record.equivalent_to.clone(),
            fit_percent: candidate.fit_percent(),
            physical: candidate.record.physical,
        }),
        predictions: run.predictions.clone(),
        allowed: counts_of_allowed(run, &remarks),
        remarks,
        concerns,
        notes: run.remarks.iter().filter(|remark| !is_no_result(remark)).map(as_text).collect(),
        warnings: Some(warnings),
        other_channels: owned(test.channels.iter().map(|c| c.id.as_str()).filter(|id| Some(*id) != channel).collect()),
        missing: run.missing.clone(),
        programs: run.provenance.iter().filter_map(|record| record.program.clone()).collect(),
    }
}

/// `ingest: warning: text`.
fn as_text(remark: &RemarkV1) -> String {
    format!("{}: {}{}", remark.stage, remark.mark(), remark.text)
}

/// How often a run remarks what its pipeline allows.
fn counts_of_allowed(run: &Run, remarks: &[RemarkV1]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for remark in remarks.iter().filter(|remark| run.allowed.contains(&remark.code)) {
        *counts.entry(remark.code.clone()).or_default() += 1;
    }
    counts
}

/// A simulation without what its artifact has for pictures: the residual with its autocorrelation, and the band.
fn without_pictures(simulation: SimulationV1) -> SimulationV1 {
    SimulationV1 { residual: None, band: None, ..simulation }
}

fn candidate_summary(run: &Run, candidate: &CandidateResult) -> CandidateSummary {
    let record = candidate.record.clone();
    let rated = run.rated(&candidate.id);
    CandidateSummary {
        aicc: rated.and_then(|rated| rated.aicc),
        difference_with_priors: rated.and_then(|rated| rated.difference_with_priors),
        id: candidate.id.clone(),
        certainties: candidate.certainties(),
        simulation: candidate.simulation.clone().map(without_pictures),
        model: record.model,
        method: record.method,
        parameters: record.parameters,
        physical: record.physical,
        equivalent_to: record.equivalent_to,
        fit: record.fit,
        uncertainty: record.uncertainty,
        notes: record.notes,
    }
}

fn metric_summary(metric: &MetricV1) -> MetricSummary {
    MetricSummary {
        value: metric.value,
        unit: metric.unit.clone(),
        definition_id: metric.definition_id.clone(),
        from_s: metric.from_s,
        to_s: metric.to_s,
        low: metric.low,
        high: metric.high,
        interval_by: metric.interval_by.clone(),
        interval_source: metric.source(),
    }
}

fn other_metric(run: &Run, metric: &MetricV1) -> OtherMetricSummary {
    let channel = metric.channels().into_iter().find_map(|id| run.test.channel(id));
    let location = channel.map(|channel| channel.location.clone()).filter(|location| !location.is_empty());
    let (name, channel) = (metric.name.clone(), metric.channel.clone());
    OtherMetricSummary { name, channel, location, metric: metric_summary(metric) }
}

fn model(model: &Model) -> ModelSummary {
    let identification = model.identification.as_ref();
    ModelSummary {
        id: model.id.clone(),
        method: identification.map(|i| i.method.clone()),
        order: identification.map(|i| i.order).or(u32::try_from(model.poles().count()).ok().filter(|&n| n > 0)),
        fit_percent: model.fit_percent(),
        unseen_fit_percent: model.unseen_fit_percent(),
        poles: model.poles().map(|([re_per_s, im_rad_per_s], _)| PoleSummary { re_per_s, im_rad_per_s }).collect(),
        modes: model.modes.clone(),
        transfer_function: model
            .transfer_function
            .as_ref()
            .map(|tf| TransferFunctionSummary { numerator: tf.numerator.clone(), denominator: tf.denominator.clone() }),
    }
}

impl Summary {
    /// The text of `summary.json`: indented by two blanks, a line end at its end.
    pub fn to_json(&self) -> serde_json::Result<String> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        Ok(text)
    }

    /// Reads the bytes of `summary.json`, those of earlier versions too.
    pub fn from_json(bytes: &[u8]) -> serde_json::Result<Self> {
        let summary: Self = serde_json::from_slice(bytes)?;
        if summary.schema == SCHEMA { Ok(summary) } else { Err(serde_json::Error::custom(format!("not a {SCHEMA}"))) }
    }

    /// Value of a metric of the pulse.
    pub fn metric(&self, name: &str) -> Option<f64> {
        self.metrics.get(name)?.value
    }

    /// What a candidate is, in words that no other candidate of the run has: `Kelvin model (fitted)`.
    pub fn name_of(&self, id: &str) -> String {
        name_among(id, self.candidates.iter().map(|candidate| (&*candidate.id, &candidate.parameters)))
    }

    /// A parameter of the first physical candidate of a model in the ranking.
    pub fn parameter(&self, model: &str, name: &str) -> Option<f64> {
        let of_id = |id: &String| self.candidates.iter().find(|candidate| candidate.id == *id);
        let of_model = |candidate: &&CandidateSummary| candidate.model == model && candidate.physical;
        self.ranking.iter().filter_map(of_id).find(of_model)?.parameters.get(name).copied()
    }

    /// How many warnings there are. An earlier summary has only those that it ranked.
    pub fn count_of_warnings(&self) -> usize {
        self.warnings.unwrap_or(self.concerns.len())
    }

    /// The model year that the name of the vehicle begins with.
    pub fn model_year(&self) -> Option<i64> {
        model_year(self.test.vehicle.as_deref()?)
    }

    /// The candidate that is recommended, unless nothing is to be used.
    pub(crate) fn usable(&self) -> Option<&CandidateSummary> {
        let id = self.recommended.as_ref().filter(|_| self.verdict.status != Some(Status::DoNotUse))?;
        self.candidates.iter().find(|candidate| candidate.id == *id)
    }
}

/// The model year that the name of a vehicle begins with, as NHTSA writes it: `2018 TOYOTA CAMRY`.
pub fn model_year(vehicle: &str) -> Option<i64> {
    let first = vehicle.split_whitespace().next()?;
    first.parse().ok().filter(|year| first.len() == 4 && (1900..2200).contains(year))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_year_stands_in_front_of_the_vehicle() {
        assert_eq!(model_year("2018 TOYOTA CAMRY LE"), Some(2018));
        for other in ["TOYOTA 2018", "20 x", "", "12345 x", "1800 x"] {
            assert_eq!(model_year(other), None, "{other}");
        }
    }

    #[test]
    fn a_summary_of_an_earlier_version_is_read() {
        let read = |json: &str| Summary::from_json(json.as_bytes());
        let summary = read(
            r#"{"schema": "crumple.summary.v1", "test": {"title": "t"}, "verdict": {"language": "de", "kind": "of old"},
                "concerns": [{"stage": "ingest", "about": "pulse", "weight": 3, "text": "a"}]}"#,
        )
        .unwrap();
        assert_eq!((summary.count_of_warnings(), summary.verdict.status), (1, None));
        let json = r#"{"parameters": 5, "determined": 3, "order_of_magnitude": 1, "open": 1}"#;
        let verdict: Conclusion = serde_json::from_str(json).unwrap();
        assert_eq!(verdict.certainty().as_deref(), Some("3 of 5 determined, 1 with a wide interval, 1 open"));
        assert!(read(r#"{"schema": "crumple.together.v1"}"#).is_err() && read("{}").is_err());
    }
}
