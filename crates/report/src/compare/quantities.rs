//! The numbers of several runs: key numbers, parameters of the recommended models, what these predict; how far each and
//! its interval are from those of the first run, as a multiple of what counts as the same.

use std::collections::BTreeMap;

use crumple_artifact::records::{CandidateV1, Doubt, PredictionV1};
use crumple_diff::{Base, CompareSettings, Limit, Tolerances, compare_with_limits};
use crumple_signal::key_quantities::{CRUSH, DELTA_V, KeyQuantity, OLC, PEAK, RESTITUTION, TIME_OF_CRUSH};
use serde::Serialize;
use serde_json::{Value, json};

use crate::drawing::numbers::{ABSENT, Rounding};
use crate::findings::{CandidateSummary, Summary, doubt_in_words, parameter, parameter_order};
use crate::words;

use super::scenarios::{Scenario, scenarios};

/// What a quantity is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// The test.
    KeyNumber,
    /// The recommended model.
    Parameter,
    /// Crush of another test, by the recommended model.
    Prediction,
    /// What else it says of that test.
    PredictedDetail,
}

/// How many digits a quantity is shown with.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Digits {
    Decimals(usize),
    /// Of a parameter, of which a run may have no interval.
    Parameter {
        is_mass: bool,
    },
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
    pub doubt: Option<Doubt>,
    /// What stands before it.
    sign: &'static str,
    /// How far it may be from that of the first run.
    limit: Option<Limit>,
    /// How far an end of its interval may be from that of the first run, as a share of the first interval's width.
    interval_share: f64,
}

/// How far an end of an interval may move, as a share of its width, and still be the same: a standard deviation comes
/// from an inverse and is known to a tenth, as is half of the interval that is made from it.
pub const INTERVAL_SHARE: f64 = 0.05;

/// Whether the ends of intervals have a limit of their own, beside that of every number.
pub fn allows_intervals(settings: &CompareSettings) -> bool {
    let Tolerances { base, abs, rel, .. } = settings.tolerances;
    base != Base::Exact && abs.is_none() && rel.is_none() && !settings.bits
}

fn interval_share(settings: &CompareSettings) -> f64 {
    if allows_intervals(settings) { INTERVAL_SHARE } else { 0.0 }
}

impl Quantity {
    /// The distance of a run's number from that of the first run over the limit; above 1 it differs. Infinite where one
    /// of both has none, or alone determines it; 0 where such numbers are not compared.
    pub fn beyond(&self, run: usize) -> f64 {
        match (&self.values[0], &self.values[run]) {
            (Some(first), Some(own)) => {
                let distance = (own.value - first.value).abs();
                match (own.limit, first.doubt.is_some(), own.doubt.is_some()) {
                    (None, ..) | (_, true, true) => 0.0,
                    (_, before, after) if before != after => f64::INFINITY,
                    (Some(limit), ..) if distance > 0.0 => distance / limit.allowed(),
                    _ => 0.0,
                }
            }
            (None, None) => 0.0,
            _ => f64::INFINITY,
        }
    }

    /// Whether a run's number is farther from that of the first run than the limit.
    pub fn differs(&self, run: usize) -> bool {
        self.beyond(run) > 1.0
    }

    /// Whether a run's interval is another one than that of the first run, or one of both has none.
    pub fn interval_differs(&self, run: usize) -> bool {
        let (Some(first), Some(own)) = (&self.values[0], &self.values[run]) else { return false };
        let (Some(before), Some(after)) = (first.interval, own.interval) else {
            return first.interval.is_some() != own.interval.is_some();
        };
        let Some(Limit { tolerance, .. }) = own.limit.filter(|_| own.interval_share.is_finite()) else { return false };
        let width = before[0].zip(before[1]).map_or(0.0, |(low, high)| high - low);
        let allowed = |end: f64| tolerance.abs + tolerance.rel * end.abs();
        before.into_iter().zip(after).any(|ends| match ends {
            (Some(x), Some(y)) => (x - y).abs() > allowed(x.abs().max(y.abs())).max(own.interval_share * width),
            (x, y) => x.is_some() != y.is_some(),
        })
    }

    /// A run's interval in the unit of people.
    pub fn interval(&self, run: usize) -> Option<String> {
        let own = self.values[run].as_ref()?;
        let (ends, rounding) = (own.interval?, self.rounding(own, 0));
        let end = |end: Option<f64>| end.map_or_else(|| "open".to_owned(), |end| rounding.show(self.factor * end));
        Some(words::between(&end(ends[0]), &end(ends[1])))
    }

    /// Whether a run's number lies in the interval of the first run; `None`: there is no such interval or number.
    pub fn is_within_interval(&self, run: usize) -> Option<bool> {
        let [low, high] = self.values[0].as_ref()?.interval?;
        let value = self.values[run].as_ref()?.value;
        Some(low.is_none_or(|low| value >= low) && high.is_none_or(|high| value <= high))
    }

    /// A run's number in the unit of people.
    pub fn shown(&self, run: usize) -> String {
        self.shown_with(run, 0)
    }

    /// With so many decimals more than the quantity has.
    fn shown_with(&self, run: usize, more: usize) -> String {
        self.values[run].as_ref().map_or_else(
            || ABSENT.to_owned(),
            |own| {
                let number = self.rounding(own, more).show(self.factor * own.value);
                format!("{}{}", own.sign, words::with_unit(number, self.unit))
            },
        )
    }

    /// Decimals that tell both values of a difference apart; 0 where they differ as they are.
    fn decimals_to_tell(&self) -> usize {
        /// A difference below a thousandth of the last decimal is no limit of any quantity.
        const MOST: usize = 3;
        if self.values.len() != 2 || !self.differs(1) {
            return 0;
        }
        (0..=MOST).find(|more| self.shown_with(0, *more) != self.shown_with(1, *more)).unwrap_or(0)
    }

    /// Whether a run has the number and does not determine it.
    pub fn is_undetermined(&self, run: usize) -> bool {
        self.values[run].as_ref().is_some_and(|own| own.doubt.is_some())
    }

    /// A run's number in the unit of people, or that the run does not determine it. Two that differ are shown with as
    /// many decimals as tell them apart.
    pub fn known(&self, run: usize) -> String {
        match self.is_undetermined(run) {
            true => doubt_in_words(Doubt::NotDetermined).to_owned(),
            false => self.shown_with(run, self.decimals_to_tell()),
        }
    }

    /// The digits of a quantity, since a change that counts may be smaller than its interval; of a parameter those that
    /// a run's interval supports.
    fn rounding(&self, own: &RunValue, more: usize) -> Rounding {
        let ends = own.interval.unwrap_or_default().map(|end| end.map(|end| self.factor * end));
        match self.digits {
            Digits::Decimals(decimals) => Rounding::of_quantity(None, decimals + more),
            Digits::Parameter { is_mass } => Rounding::of_ends(ends[0], ends[1]).unwrap_or(if is_mass {
                Rounding::to_integers(self.factor * own.value)
            } else {
                Rounding::WITHOUT_INTERVAL
            }),
        }
    }

    /// How far a run's number is from that of the first run: in percent where the limit is a share, else in its unit;
    /// `None` where one of both has none or does not determine it.
    pub fn change(&self, run: usize) -> Option<String> {
        if [0, run].into_iter().any(|run| self.is_undetermined(run)) {
            return None;
        }
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
            Digits::Parameter { .. } => 1,
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
        let doubt = own.doubt.map(|doubt| doubt_in_words(doubt).to_owned());
        let known = doubt.or_else(|| self.interval(run));
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
                interval_share: interval_share(settings),
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
            let doubt = record.doubt(name);
            Some(RunValue {
                value: *record.parameters.get(name)?,
                interval: ends.map(|(low, high)| [*low, *high]),
                doubt,
                sign: "",
                limit: limits[k].get(&format!("parameters.{name}")).copied(),
                interval_share: if doubt.is_some() { f64::INFINITY } else { interval_share(settings) },
            })
        };
        Some(Quantity {
            group: Group::Parameter,
            key: name.to_owned(),
            name: symbol,
            unit,
            factor,
            digits: Digits::Parameter { is_mass: parameter_order(&model.model, name).0 == 0 },
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

/// Field of [`PredictionV1`] and how its number is shown.
type Predicted = (fn(&PredictionV1) -> Option<f64>, &'static str, &'static KeyQuantity);

/// What a prediction says of an impact, the crush first.
pub const PREDICTED: [Predicted; 6] = [
    (|made| made.dynamic_crush_m, "dynamic_crush_m", &CRUSH),
    (|made| made.time_of_dynamic_crush_s, "time_of_dynamic_crush_s", &TIME_OF_CRUSH),
    (|made| made.delta_v_m_per_s, "delta_v_m_per_s", &DELTA_V),
    (|made| made.coefficient_of_restitution, "coefficient_of_restitution", &RESTITUTION),
    (|made| made.peak_acceleration_m_per_s2, "peak_acceleration_m_per_s2", &PEAK),
    (|made| made.olc_m_per_s2, "olc_m_per_s2", &OLC),
];

/// What the recommended models say of the impacts that more than one run was predicted at.
fn predictions<'a>(runs: &[&'a Summary], settings: &CompareSettings) -> Vec<Quantity> {
    let made_of = |run: &'a Summary| -> Vec<Scenario<'a>> {
        let all = scenarios(run).into_iter();
        let mut of_best: Vec<_> = all.filter(|one| run.recommended.as_ref() == Some(&one.made.candidate)).collect();
        of_best.sort_by(|a, b| a.made.impact_speed_m_per_s.total_cmp(&b.made.impact_speed_m_per_s));
        of_best
    };
    let predicted: Vec<Vec<Scenario<'_>>> = runs.iter().map(|run| made_of(run)).collect();
    let of_run = |run: usize, asked: &str| predicted[run].iter().find(|one| one.asked == asked).map(|one| one.made);
    let all = in_order(predicted.iter().map(|of_run| of_run.iter().map(|one| one.asked.as_str()).collect()));
    let is_shared = |asked: &&str| (0..runs.len()).filter(|k| of_run(*k, asked).is_some()).count() > 1;
    let rows = all.into_iter().filter(is_shared).flat_map(|asked| {
        let of_runs: Vec<Option<&PredictionV1>> = (0..runs.len()).map(|k| of_run(k, asked)).collect();
        PREDICTED.iter().map(move |one| predicted_row(one, asked, &of_runs, settings)).collect::<Vec<_>>()
    });
    rows.filter(|row| row.values.iter().any(Option::is_some)).collect()
}

/// One number of one impact.
fn predicted_row(
    (number, field, quantity): &Predicted,
    at: &str,
    of_runs: &[Option<&PredictionV1>],
    settings: &CompareSettings,
) -> Quantity {
    let records: Vec<Value> = of_runs.iter().map(|made| json!({ *field: made.and_then(number) })).collect();
    let limits = limits("/prediction/1", &records, settings);
    let value = |k: usize| {
        let made = of_runs[k]?;
        let interval = made.intervals.iter().find(|interval| interval.name == *field);
        Some(RunValue {
            value: number(made)?,
            interval: interval.map(|interval| [Some(interval.low), Some(interval.high)]),
            limit: limits[k].get(*field).copied(),
            interval_share: interval_share(settings),
            ..RunValue::default()
        })
    };
    let is_crush = quantity.key == CRUSH.key;
    // A predicted crush is that of a model, and is compared closer than it is measured.
    let (factor, decimals, unit) = quantity.shown();
    let decimals = decimals + usize::from(is_crush);
    let speed = at.replacen(' ', "\u{a0}", 1);
    Quantity {
        group: if is_crush { Group::Prediction } else { Group::PredictedDetail },
        key: format!("{} at {at}", if is_crush { "crush" } else { quantity.key }),
        name: match is_crush {
            true => format!("Predicted crush at {speed}"),
            false => format!("Predicted {} at {speed}", quantity.name),
        },
        unit,
        factor,
        digits: Digits::Decimals(decimals),
        values: (0..of_runs.len()).map(value).collect(),
    }
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
