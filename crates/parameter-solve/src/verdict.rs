//! The verdict on a candidate, as the artifact and a person get it.

use std::collections::BTreeMap;

use crumple_parameter_solve::{Candidate, DualScale, Judgement, Propagation, Uncertainty, all_in_words};
use crumple_stage::records::{ProfileV1, ReplicatesV1, UncertaintyV1};

/// Both ends of an interval.
pub type Ends = (Option<f64>, Option<f64>);

/// The verdict on one candidate.
#[derive(Debug, Clone)]
pub struct Judged {
    pub judgement: Judgement,
    pub propagation: Option<Propagation>,
    /// What the propagation repeated: a fit or a closed form.
    pub repeated: &'static str,
    /// Whether the model was followed through the filter of the record.
    pub through_filter: bool,
}

impl Judged {
    /// The verdict on the dual of the model judged.
    pub fn of_dual(&self, dual: &DualScale) -> Self {
        Self {
            judgement: self.judgement.of_dual(dual),
            propagation: self.propagation.as_ref().map(|p| dual.propagation(p)),
            repeated: self.repeated,
            through_filter: self.through_filter,
        }
    }

    /// What goes to the artifact.
    pub fn record(&self) -> UncertaintyV1 {
        let j = &self.judgement;
        let own = |name: &&'static str| (*name).to_owned();
        let finite = |values: &BTreeMap<&'static str, f64>| values.iter().map(|(k, v)| (own(k), *v)).collect();
        let side = |of: fn(&Ends) -> Option<f64>| {
            j.interval.iter().map(|(name, interval)| (own(name), of(interval))).collect()
        };
        UncertaintyV1 {
            method: if self.through_filter {
                "linearised about the minimum seen through the record's filter, autocorrelated residuals".to_owned()
            } else {
                "linearised about the minimum, autocorrelated residuals".to_owned()
            },
            standard_deviation: finite(&j.standard_deviation),
            condition: j.condition,
            interval_low: side(|i| i.0),
            interval_high: side(|i| i.1),
            order: j.parameters.iter().map(own).collect(),
            correlation: j.correlation.clone(),
            rank: Some(j.rank as u32),
            weakest_direction: j.weakest_direction.clone(),
            effective_samples: Some(j.effective_samples),
            profile: j
                .profile
                .iter()
                .map(|p| ProfileV1 {
                    parameter: p.parameter.to_owned(),
                    low: p.low,
                    high: p.high,
                    identifiable: p.identifiable(),
                    values: p.points.iter().map(|(value, _)| *value).collect(),
                    rise: p.points.iter().map(|(_, rise)| *rise).collect(),
                })
                .collect(),
            bootstrap: j.bootstrap.as_ref().map(|b| {
                let ends = |of: fn(&Ends) -> Option<f64>| {
                    b.interval.iter().filter_map(|(name, i)| Some((own(name), of(i)?))).collect()
                };
                ReplicatesV1 {
                    method: format!("block bootstrap of the misfit, blocks of {} samples", b.block),
                    replicates: b.replicates as u64,
                    coverage: 0.95,
                    low: ends(|i| i.0),
                    high: ends(|i| i.1),
                }
            }),
            propagation: self.propagation.as_ref().map(|p| ReplicatesV1 {
                method: format!(
                    "{} repeated with mass, impact speed, zero level and time zero drawn anew",
                    self.repeated
                ),
                replicates: p.repetitions as u64,
                coverage: 0.9,
                low: p.interval_90.iter().map(|(name, (low, _))| (own(name), *low)).collect(),
                high: p.interval_90.iter().map(|(name, (_, high))| (own(name), *high)).collect(),
            }),
        }
    }

    /// What a person should hear at once: parameters that the record does not determine; propagated intervals.
    pub fn line(&self, candidate: &Candidate) -> String {
        let mut parts = Vec::new();
        let open = || self.judgement.profile.iter().filter(|p| !p.identifiable()).map(|p| p.parameter);
        if open().next().is_some() {
            parts.push(format!("not identifiable: {}", all_in_words(&candidate.model, open())));
        }
        if let Some(p) = &self.propagation
            && let Some((low, high)) = p.interval_90.get("dynamic_crush_m")
        {
            parts.push(format!(
                "{} repetitions with uncertain inputs: crush {:.1} to {:.1} mm (5 to 95 %)",
                p.repetitions,
                1e3 * low,
                1e3 * high
            ));
        }
        if parts.is_empty() { String::new() } else { format!("{}: {}", candidate.id(), parts.join("; ")) }
    }
}

/// The uncertainty that a fit to several sensors or a matching brings along, with 95 % intervals from its standard deviations: log-normal, so
/// that a spring stays positive, 1.96 relative deviations wide; open beyond a factor of `e^9`, and for what is on a bound.
pub fn of_its_own(uncertainty: &Uncertainty, parameters: &BTreeMap<String, f64>) -> UncertaintyV1 {
    let ends = |side: f64| {
        parameters
            .iter()
            .filter(|(name, _)| !matches!(name.as_str(), "crush_m" | "v0_m_per_s") && !name.ends_with("_kg"))
            .map(|(name, value)| {
                let known = uncertainty.standard_deviation.get(name.as_str()).filter(|_| *value > 0.0);
                let half = known.map(|deviation| 1.96 * deviation / value).filter(|half| *half < 9.0);
                (name.clone(), half.map(|half| value * (side * half).exp()))
            })
            .collect()
    };
    UncertaintyV1 {
        method: uncertainty.method.to_owned(),
        standard_deviation: uncertainty.standard_deviation.iter().map(|(k, v)| ((*k).to_owned(), *v)).collect(),
        condition: Some(uncertainty.condition),
        interval_low: ends(-1.0),
        interval_high: ends(1.0),
        ..UncertaintyV1::default()
    }
}
