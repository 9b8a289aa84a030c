//! What a table takes from `summary.json` of a run.

use std::collections::BTreeMap;

use crumple_artifact::records::{EventsV1, PredictionV1, SimulationV1};
use serde::Deserialize;

/// The summary of a run, as far as the tables need it.
#[derive(Debug, Deserialize)]
pub(crate) struct RunSummary {
    pub(crate) test: SummaryTest,
    #[serde(default)]
    pub(crate) events: Option<EventsV1>,
    #[serde(default)]
    pub(crate) metrics: BTreeMap<String, SummaryMetric>,
    #[serde(default)]
    pub(crate) other_metrics: Vec<MetricOfChannel>,
    #[serde(default)]
    pub(crate) candidates: Vec<SummaryCandidate>,
    #[serde(default)]
    pub(crate) recommended: Option<String>,
    #[serde(default)]
    pub(crate) recommended_because: Option<String>,
    #[serde(default)]
    pub(crate) simplest: Option<String>,
    #[serde(default)]
    pub(crate) closest: Option<String>,
    #[serde(default)]
    pub(crate) ranking: Vec<String>,
    #[serde(default)]
    pub(crate) predictions: Vec<PredictionV1>,
    #[serde(default)]
    pub(crate) notes: Vec<String>,
}

/// The test.
#[derive(Debug, Deserialize)]
pub(crate) struct SummaryTest {
    pub(crate) title: String,
    pub(crate) mass_kg: Option<f64>,
    pub(crate) impact_speed_m_per_s: Option<f64>,
    pub(crate) channel: Option<String>,
    pub(crate) sample_rate_hz: Option<f64>,
    #[serde(default)]
    pub(crate) vehicle: Option<String>,
    #[serde(default)]
    pub(crate) barrier: Option<String>,
}

/// A metric of the pulse.
#[derive(Debug, Deserialize)]
pub(crate) struct SummaryMetric {
    pub(crate) value: Option<f64>,
    pub(crate) unit: String,
    #[serde(default)]
    pub(crate) definition_id: Option<String>,
    #[serde(default)]
    pub(crate) low: Option<f64>,
    #[serde(default)]
    pub(crate) high: Option<f64>,
}

/// A metric of another channel.
#[derive(Debug, Deserialize)]
pub(crate) struct MetricOfChannel {
    pub(crate) name: String,
    pub(crate) channel: String,
    #[serde(default)]
    pub(crate) location: Option<String>,
    #[serde(flatten)]
    pub(crate) metric: SummaryMetric,
}

/// A candidate.
#[derive(Debug, Deserialize)]
pub(crate) struct SummaryCandidate {
    pub(crate) id: String,
    pub(crate) model: String,
    pub(crate) method: String,
    pub(crate) parameters: BTreeMap<String, f64>,
    pub(crate) physical: bool,
    #[serde(default)]
    pub(crate) equivalent_to: Option<String>,
    #[serde(default)]
    pub(crate) simulation: Option<SimulationV1>,
    #[serde(default)]
    pub(crate) uncertainty: Option<ParameterIntervals>,
}

/// 95 % intervals of parameters; `null`: open.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct ParameterIntervals {
    #[serde(default)]
    pub(crate) interval_low: BTreeMap<String, Option<f64>>,
    #[serde(default)]
    pub(crate) interval_high: BTreeMap<String, Option<f64>>,
}

impl RunSummary {
    /// Value of a metric of the pulse.
    pub(crate) fn metric(&self, name: &str) -> Option<f64> {
        self.metrics.get(name)?.value
    }

    /// The first candidate of a model in the ranking that has the parameter.
    pub(crate) fn parameter(&self, model: &str, name: &str) -> Option<f64> {
        let of_id = |id: &String| self.candidates.iter().find(|candidate| candidate.id == *id);
        let of_model = |candidate: &&SummaryCandidate| candidate.model == model && candidate.physical;
        self.ranking.iter().filter_map(of_id).find(of_model)?.parameters.get(name).copied()
    }
}

/// The model year that the name of a vehicle begins with, as NHTSA writes it: `2018 TOYOTA CAMRY`.
pub(crate) fn model_year(vehicle: &str) -> Option<i64> {
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
}
