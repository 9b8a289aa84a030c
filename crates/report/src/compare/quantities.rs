//! The numbers of several runs: key numbers, parameters of the recommended models, predicted crush; how far each is
//! from that of the first run, as a multiple of what counts as the same.

use std::collections::BTreeMap;

use crumple_artifact::records::{CandidateV1, Doubt, PredictionV1};
use crumple_diff::{Base, CompareSettings, Limit, Tolerances, compare_with_limits};
use crumple_signal::key_quantities::CRUSH;
use serde::Serialize;
use serde_json::{Value, json};

use crate::drawing::numbers::{ABSENT, KM_PER_H_PER_M_PER_S, digits_of_interval};
use crate::findings::{CandidateSummary, Summary, parameter, parameter_order};
use crate::phrases::PHRASES;
use crate::phrases::words::{self, fill};

/// What a quantity is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// The test.
    KeyNumber,
    /// The recommended model.
    Parameter,
    /// Another test, by the recommended model.
    Prediction,
}

/// How many digits a quantity is shown with.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Digits {
    Decimals(usize),
    Significant(usize),
}

/// A number of several runs.
#[derive(Debug, Clone)]
pub struct Quantity {
    /// What it is of.
    pub group: Group,
    /// A name that stays the same from run to run: `peak_acceleration`, `k1_n_per_m`, `crush at 40.0 km/h`.
    pub key: String,
    /// What people call it.
    pub name: String,
    /// Unit that people use; empty: none.
    pub unit: &'static str,
    /// From SI to that unit.
    factor: f64,
    digits: Digits,
    /// One a run; `None`: the run has no such number.
    pub values: Vec<Option<RunValue>>,
}

/// What a run says of a quantity, SI.
#[derive(Debug, Clone, Default)]
pub struct RunValue {
    /// The number.
    pub value: f64,
    /// Its interval.
    pub interval: Option<[Option<f64>; 2]>,
    /// Why it is in doubt.
    pub doubt: Option<&'static str>,
    /// What stands before it.
    sign: &'static str,
    /// How far it may be from that of the first run.
    limit: Option<Limit>,
}

impl Quantity {
    /// The distance of a run's number from that of the first run over the limit; above 1 it differs. Infinite where one
    /// of both has none.
    pub fn beyond(&self, run: usize) -> f64 {
        match (&self.values[0], &self.values[run]) {
            (Some(first), Some(own)) => {
                let distance = (own.value - first.value).abs();
                let allowed = own.limit.map_or(0.0, |limit| limit.allowed());
                if distance == 0.0 { 0.0 } else { distance / allowed }
            }
            (None, None) => 0.0,
            _ => f64::INFINITY,
        }
    }

    /// Whether a run's number is farther from that of the first run than the limit.
    pub fn differs(&self, run: usize) -> bool {
        self.beyond(run) > 1.0
    }

    /// The change over the limit, both as they are shown.
    pub fn times(&self, run: usize) -> f64 {
        let (Some(first), Some(own)) = (&self.values[0], &self.values[run]) else { return self.beyond(run) };
        match own.limit.filter(|_| self.is_share(run) && first.value != 0.0) {
            Some(limit) => ((own.value - first.value) / first.value).abs() / limit.tolerance.rel,
            None => self.beyond(run),
        }
    }

    /// Whether a run's number lies in the interval of the first run; `None`: there is no such interval or number.
    pub fn is_within_interval(&self, run: usize) -> Option<bool> {
        let [low, high] = self.values[0].as_ref()?.interval?;
        let value = self.values[run].as_ref()?.value;
        Some(low.is_none_or(|low| value >= low) && high.is_none_or(|high| value <= high))
    }

    /// A run's number in the unit of people.
    pub fn shown(&self, run: usize) -> String {
        self.values[run].as_ref().map_or_else(
            || ABSENT.to_owned(),
            |own| format!("{}{}", own.sign, words::with_unit(self.number(own.value, 0), self.unit)),
        )
    }

    fn number(&self, value: f64, more: usize) -> String {
        match self.digits {
            Digits::Decimals(decimals) => words::decimals(self.factor * value, decimals + more),
            Digits::Significant(digits) => words::significant(self.factor * value, digits + more),
        }
    }

    /// How far a run's number is from that of the first run: in percent where the limit is a share, else in its unit.
    pub fn change(&self, run: usize) -> Option<String> {
        let (first, own) = (self.values[0].as_ref()?.value, self.values[run].as_ref()?);
        if self.is_share(run) && first != 0.0 {
            return Some(words::deviation(100.0 * (own.value - first) / first.abs(), 1, "%"));
        }
        Some(self.difference(own.value - first))
    }

    /// A difference, SI, in the unit of people.
    pub fn difference(&self, difference: f64) -> String {
        let decimals = match self.digits {
            Digits::Decimals(decimals) => decimals + 1,
            Digits::Significant(_) => 1,
        };
        words::deviation(self.factor * difference, decimals, self.unit)
    }

    /// What counts as the same, in words.
    pub fn limit(&self, run: usize) -> Option<String> {
        let limit = self.values[run].as_ref()?.limit?;
        let short = |value: f64| if value < 1e-2 && value > 0.0 { format!("{value:.0e}") } else { format!("{value}") };
        Some(match self.is_share(run) {
            true => words::with_unit(short(100.0 * limit.tolerance.rel), "%"),
            // Six digits: without the rounding of the unit's factor.
            false => words::with_unit(short((1e6 * self.factor * limit.allowed()).round() / 1e6), self.unit),
        })
    }

    fn is_share(&self, run: usize) -> bool {
        let limit = self.values[run].as_ref().and_then(|own| own.limit);
        limit.is_some_and(|limit| limit.tolerance.rel * limit.scale > limit.tolerance.abs)
    }

    /// What stands beside a run's number: how far it is from the first where it differs, its interval or its doubt.
    pub fn beside(&self, run: usize) -> String {
        let Some(own) = &self.values[run] else { return String::new() };
        let change = self.change(run).filter(|_| self.differs(run));
        let interval = || {
            let ends = own.interval?;
            let open = PHRASES.model.open;
            let digits = ends[0].zip(ends[1]).map_or(3, |(low, high)| digits_of_interval(low, high, 3));
            let end = |end: Option<f64>| match (end, self.digits) {
                (None, _) => open.to_owned(),
                (Some(end), Digits::Decimals(_)) => self.number(end, 0),
                (Some(end), Digits::Significant(_)) => words::significant(self.factor * end, digits),
            };
            Some(words::between(&end(ends[0]), &end(ends[1])))
        };
        let known = own.doubt.map(str::to_owned).or_else(interval);
        change.into_iter().chain(known).collect::<Vec<_>>().join("; ")
    }
}

/// What an engineer calls the same.
pub fn engineering() -> CompareSettings {
    let tolerances = Tolerances { base: Base::Engineering, ..Tolerances::default() };
    CompareSettings { tolerances, ..CompareSettings::default() }
}

/// All numbers of several runs: every one that a run has. Parameters are those of the models that the runs recommend.
pub fn quantities(runs: &[&Summary], settings: &CompareSettings) -> Vec<Quantity> {
    let mut all = key_numbers(runs, settings);
    all.extend(parameters(runs, settings));
    all.extend(predictions(runs, settings));
    all
}

/// Limits of the numbers of a record: those of each run against the first, by place.
fn limits(topic: &str, records: &[Value], settings: &CompareSettings) -> Vec<BTreeMap<String, Limit>> {
    records.iter().map(|record| compare_with_limits(topic, &records[0], record, settings).1).collect()
}

fn key_numbers(runs: &[&Summary], settings: &CompareSettings) -> Vec<Quantity> {
    let records: Vec<Value> = runs.iter().map(|run| json!(run.key_numbers)).collect();
    let limits = limits("/metrics", &records, settings);
    let names = in_order(runs.iter().map(|run| run.key_numbers.iter().map(|number| &*number.name).collect()));
    let row = |name: &str| {
        let of_run = |k: usize| runs[k].key_numbers.iter().find(|number| number.name == name);
        let quantity = (0..runs.len()).find_map(of_run)?.quantity();
        let (factor, decimals, unit) = quantity.shown();
        let value = |k: usize| {
            let number = of_run(k)?;
            Some(RunValue {
                value: number.value?,
                interval: number.low.zip(number.high).map(|(low, high)| [Some(low), Some(high)]),
                doubt: None,
                sign: number.sign(),
                limit: limits[k].get(&format!("[{name}].value")).copied(),
            })
        };
        Some(Quantity {
            group: Group::KeyNumber,
            key: name.to_owned(),
            name: if quantity.title.is_empty() { words::metric(name) } else { quantity.title.to_owned() },
            unit,
            factor,
            digits: Digits::Decimals(decimals),
            values: (0..runs.len()).map(value).collect(),
        })
    };
    names.into_iter().filter_map(row).collect()
}

/// The candidate that a run recommends.
pub fn recommended(run: &Summary) -> Option<&CandidateSummary> {
    let id = run.recommended.as_ref()?;
    run.candidates.iter().find(|candidate| candidate.id == *id)
}

fn parameters(runs: &[&Summary], settings: &CompareSettings) -> Vec<Quantity> {
    let models: Vec<Option<CandidateV1>> = runs.iter().map(|run| recommended(run).map(record)).collect();
    let records: Vec<Value> = models.iter().map(|model| json!(model)).collect();
    let limits = limits("/parameters/recommended", &records, settings);
    let names_of = |model: &CandidateV1| {
        let mut names: Vec<String> = model.parameters.keys().cloned().collect();
        names.sort_by(|a, b| parameter_order(&model.model, a).cmp(&parameter_order(&model.model, b)));
        names
    };
    let lists: Vec<Vec<String>> = models.iter().map(|model| model.as_ref().map_or_else(Vec::new, names_of)).collect();
    let names = in_order(lists.iter().map(|names| names.iter().map(String::as_str).collect()));
    let row = |name: &str| {
        let model = models.iter().flatten().find(|model| model.parameters.contains_key(name))?;
        let (symbol, factor, unit) = parameter(&model.model, name, 1.0);
        let value = |k: usize| {
            let record = models[k].as_ref()?;
            let known = record.uncertainty.as_ref();
            let ends = known.and_then(|known| Some((known.interval_low.get(name)?, known.interval_high.get(name)?)));
            let texts = &PHRASES.model;
            Some(RunValue {
                value: *record.parameters.get(name)?,
                interval: ends.map(|(low, high)| [*low, *high]),
                doubt: record.doubt(name).map(|doubt| match doubt {
                    Doubt::OnBound => texts.on_a_bound,
                    Doubt::NotDetermined => texts.not_determined,
                }),
                sign: "",
                limit: limits[k].get(&format!("parameters.{name}")).copied(),
            })
        };
        Some(Quantity {
            group: Group::Parameter,
            key: name.to_owned(),
            name: symbol,
            unit,
            factor,
            digits: Digits::Significant(4),
            values: (0..runs.len()).map(value).collect(),
        })
    };
    names.into_iter().filter_map(row).collect()
}

/// What of a candidate says how well its numbers are known.
fn record(candidate: &CandidateSummary) -> CandidateV1 {
    CandidateV1 {
        model: candidate.model.clone(),
        parameters: candidate.parameters.clone(),
        fit: candidate.fit.clone(),
        uncertainty: candidate.uncertainty.clone(),
        ..CandidateV1::default()
    }
}

/// Predicted crush against the wall at the speeds that more than one run was predicted at.
fn predictions(runs: &[&Summary], settings: &CompareSettings) -> Vec<Quantity> {
    let mut predicted: Vec<BTreeMap<u64, &PredictionV1>> = Vec::new();
    for run in runs {
        let wall = run.predictions.iter().filter(|p| p.partner.is_none() && p.collision.is_none());
        let of_model = wall.filter(|p| Some(&p.candidate) == run.recommended.as_ref() && p.dynamic_crush_m.is_some());
        // Bits of positive numbers are in the order of the numbers.
        predicted.push(of_model.map(|p| (p.impact_speed_m_per_s.to_bits(), p)).collect());
    }
    let mut speeds: Vec<u64> = predicted.iter().flat_map(|of_run| of_run.keys().copied()).collect();
    speeds.sort_unstable();
    speeds.dedup();
    speeds.retain(|speed| predicted.iter().filter(|of_run| of_run.contains_key(speed)).count() > 1);
    let crush = |p: &PredictionV1| json!({ "dynamic_crush_m": p.dynamic_crush_m });
    let row = |speed: u64| {
        let of_runs: Vec<Option<&PredictionV1>> = predicted.iter().map(|of_run| of_run.get(&speed).copied()).collect();
        let records: Vec<Value> = of_runs.iter().map(|p| p.map_or(Value::Null, crush)).collect();
        let limits = limits("/prediction/1", &records, settings);
        let value = |k: usize| {
            let own = of_runs[k]?;
            let interval = own.intervals.iter().find(|interval| interval.name == "dynamic_crush_m");
            Some(RunValue {
                value: own.dynamic_crush_m?,
                interval: interval.map(|interval| [Some(interval.low), Some(interval.high)]),
                limit: limits[k].get("dynamic_crush_m").copied(),
                ..RunValue::default()
            })
        };
        let at = words::quantity(KM_PER_H_PER_M_PER_S * f64::from_bits(speed), 1, "km/h");
        Quantity {
            group: Group::Prediction,
            key: format!("crush at {}", at.replace('\u{a0}', " ")),
            name: fill(PHRASES.runs.predicted_crush, &[("speed", at)]),
            unit: CRUSH.unit,
            factor: CRUSH.factor,
            digits: Digits::Decimals(1),
            values: (0..runs.len()).map(value).collect(),
        }
    };
    speeds.into_iter().map(row).collect()
}

/// Names of all lists, each once: those of the first, then what others add.
fn in_order<'a>(lists: impl Iterator<Item = Vec<&'a str>>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for name in lists.flatten() {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}
