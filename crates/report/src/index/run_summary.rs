//! What an index and the tables of a fleet take from `summary.json` of a run.

use crate::phrases::PHRASES;
use std::collections::BTreeMap;

use crate::findings::Status;
use crate::phrases::words::fill;
use crumple_artifact::records::{EventsV1, PredictionV1, SimulationV1};
use serde::Deserialize;

/// The summary of a run, as far as those need it who read it. Keys that it lacks are empty.
#[derive(Debug, Clone, Deserialize)]
pub struct RunSummary {
    /// The test.
    pub test: SummaryTest,
    /// How sure the recommended model is, and why there is no result.
    #[serde(default, rename = "verdict")]
    pub conclusion: SummaryConclusion,
    /// Events of the crash.
    #[serde(default)]
    pub events: Option<EventsV1>,
    /// Metrics of the pulse by name.
    #[serde(default)]
    pub metrics: BTreeMap<String, SummaryMetric>,
    /// Metrics that only other channels have.
    #[serde(default)]
    pub other_metrics: Vec<MetricOfChannel>,
    /// Candidates.
    #[serde(default)]
    pub candidates: Vec<SummaryCandidate>,
    /// Id of the candidate for predictions.
    #[serde(default)]
    pub recommended: Option<String>,
    /// Why that one.
    #[serde(default)]
    pub recommended_because: Option<String>,
    /// Id of the adequate candidate with the fewest parameters.
    #[serde(default)]
    pub simplest: Option<String>,
    /// Id of the candidate closest to the record.
    #[serde(default)]
    pub closest: Option<String>,
    /// Ids of the candidates, best fit first.
    #[serde(default)]
    pub ranking: Vec<String>,
    /// Impacts that were not made.
    #[serde(default)]
    pub predictions: Vec<PredictionV1>,
    /// What speaks against the results, gravest first.
    #[serde(default)]
    pub concerns: Vec<SummaryConcern>,
    /// `stage: text`.
    #[serde(default)]
    pub notes: Vec<String>,
}

/// The test.
#[derive(Debug, Clone, Deserialize)]
pub struct SummaryTest {
    /// Title.
    pub title: String,
    /// Test mass.
    pub mass_kg: Option<f64>,
    /// Impact speed.
    pub impact_speed_m_per_s: Option<f64>,
    /// Channel the crash was read from.
    pub channel: Option<String>,
    /// Its sampling rate.
    pub sample_rate_hz: Option<f64>,
    /// Vehicle.
    #[serde(default)]
    pub vehicle: Option<String>,
    /// Barrier.
    #[serde(default)]
    pub barrier: Option<String>,
}

/// What a run comes to, as far as an index shows it.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct SummaryConclusion {
    /// `model`, `none-recommended`, `no-result`.
    #[serde(default)]
    pub standing: String,
    /// Whether the results may be used.
    #[serde(default)]
    pub status: Option<Status>,
    /// The same with its reason.
    #[serde(default)]
    pub status_sentence: String,
    /// Numbers of the recommended model that were asked of the record.
    #[serde(default)]
    pub parameters: Option<usize>,
    /// How many of them it determines.
    #[serde(default)]
    pub determined: Option<usize>,
    /// How many of the others are known to an order of magnitude.
    #[serde(default)]
    pub order_of_magnitude: Option<usize>,
    /// How many may be anything.
    #[serde(default)]
    pub open: Option<usize>,
    /// Why there is no result.
    #[serde(default)]
    pub reason: Option<String>,
}

/// What speaks against a result.
#[derive(Debug, Clone, Deserialize)]
pub struct SummaryConcern {
    /// In words.
    pub text: String,
}

/// A metric of the pulse.
#[derive(Debug, Clone, Deserialize)]
pub struct SummaryMetric {
    /// Value, SI.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: String,
    /// Its definition in the catalogue.
    #[serde(default)]
    pub definition_id: Option<String>,
    /// Lower end of its interval.
    #[serde(default)]
    pub low: Option<f64>,
    /// Upper end.
    #[serde(default)]
    pub high: Option<f64>,
}

/// A metric of another channel.
#[derive(Debug, Clone, Deserialize)]
pub struct MetricOfChannel {
    /// Name.
    pub name: String,
    /// Channel.
    pub channel: String,
    /// Where it sits.
    #[serde(default)]
    pub location: Option<String>,
    /// The metric.
    #[serde(flatten)]
    pub metric: SummaryMetric,
}

/// A candidate.
#[derive(Debug, Clone, Deserialize)]
pub struct SummaryCandidate {
    /// `model/method/index`.
    pub id: String,
    /// Model.
    pub model: String,
    /// Method.
    pub method: String,
    /// Parameters by name, each with its unit in it.
    pub parameters: BTreeMap<String, f64>,
    /// Whether no parameter is negative.
    pub physical: bool,
    /// Id of the candidate with the same motion.
    #[serde(default)]
    pub equivalent_to: Option<String>,
    /// Its simulation.
    #[serde(default)]
    pub simulation: Option<SimulationV1>,
    /// How well its parameters are known.
    #[serde(default)]
    pub uncertainty: Option<ParameterIntervals>,
}

/// 95 % intervals of parameters by name; `null`: open.
#[derive(Debug, Clone, Default, Deserialize)]
pub struct ParameterIntervals {
    /// Lower ends.
    #[serde(default)]
    pub interval_low: BTreeMap<String, Option<f64>>,
    /// Upper ends.
    #[serde(default)]
    pub interval_high: BTreeMap<String, Option<f64>>,
}

impl RunSummary {
    /// Reads the bytes of `summary.json`.
    pub fn from_json(bytes: &[u8]) -> serde_json::Result<Self> {
        serde_json::from_slice(bytes)
    }

    /// Value of a metric of the pulse.
    pub fn metric(&self, name: &str) -> Option<f64> {
        self.metrics.get(name)?.value
    }

    /// A parameter of the first physical candidate of a model in the ranking.
    pub fn parameter(&self, model: &str, name: &str) -> Option<f64> {
        let of_id = |id: &String| self.candidates.iter().find(|candidate| candidate.id == *id);
        let of_model = |candidate: &&SummaryCandidate| candidate.model == model && candidate.physical;
        self.ranking.iter().filter_map(of_id).find(of_model)?.parameters.get(name).copied()
    }

    /// The model year that the name of the vehicle begins with.
    pub fn model_year(&self) -> Option<i64> {
        model_year(self.test.vehicle.as_deref()?)
    }

    /// The model that is recommended, unless nothing is to be used.
    pub(crate) fn usable_model(&self) -> Option<&str> {
        self.recommended.as_deref().filter(|_| self.conclusion.status != Some(Status::DoNotUse))
    }

    /// How many of its numbers are determined, with a wide interval, open: `3 of 5 determined, 2 open`.
    pub(crate) fn certainty(&self) -> Option<String> {
        let texts = &PHRASES.runs;
        let of = &self.conclusion;
        let counts = [("determined", of.determined?.to_string()), ("parameters", of.parameters?.to_string())];
        let mut words = fill(texts.determined, &counts);
        let others = [(of.order_of_magnitude, texts.order_of_magnitude), (of.open, texts.open)];
        for (count, text) in others.into_iter().filter_map(|(count, text)| Some((count.filter(|n| *n > 0)?, text))) {
            words.push_str(&fill(text, &[("count", count.to_string())]));
        }
        Some(words)
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
    fn how_sure_a_model_is_stands_in_words() {
        let words = |conclusion: &str| {
            let test = r#"{"title": "t", "mass_kg": 1.0, "impact_speed_m_per_s": null, "channel": null,
                "sample_rate_hz": null}"#;
            let json = format!("{{\"test\": {test}, \"verdict\": {conclusion}}}");
            RunSummary::from_json(json.as_bytes()).unwrap().certainty()
        };
        let all = r#"{"parameters": 5, "determined": 3, "order_of_magnitude": 1, "open": 1}"#;
        assert_eq!(words(all).as_deref(), Some("3 of 5 determined, 1 with a wide interval, 1 open"));
        assert_eq!(words(r#"{"parameters": 4, "determined": 4}"#).as_deref(), Some("4 of 4 determined"));
        assert_eq!(words(r#"{"kind": "occupant", "parameters": null}"#), None);
    }
}
