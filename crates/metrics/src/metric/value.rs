//! A metric: a number with unit, definition, window and interval.

use std::fmt;

use crumple_numerics::estimation::statistics::quantile;
use crumple_signal::Sampled;

use crate::Definition;
use crate::error::MetricsError;

/// Part of a record, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Its start.
    pub from_s: f64,
    /// Its end; the start again for a moment.
    pub to_s: f64,
}

/// Where the value lies, as far as what was measured says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lowest value.
    pub low: f64,
    /// Highest value.
    pub high: f64,
    /// How it was found.
    pub by: IntervalBy,
}

/// How an interval was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IntervalBy {
    /// Lowest and highest of so many channels that measured the same.
    Channels(usize),
    /// 5 % and 95 % quantile of so many repetitions with perturbed inputs.
    Replicates(usize),
    /// Half of the step in which a recorder keeps a value, with the deviation of the instrument, or half of its
    /// sampling interval.
    Resolution,
    /// What restitutions from 0 to the largest believed make of a change of velocity.
    Restitution,
}

/// The words used in artifacts.
impl fmt::Display for IntervalBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Channels(n) => write!(f, "range over {n} channels"),
            Self::Replicates(n) => write!(f, "5-95 % of {n} replicates"),
            Self::Restitution => f.write_str("restitution from 0 to the largest that is believed"),
            Self::Resolution => f.write_str("resolution of the recorder: half of its step and an instrument of 1.9 %"),
        }
    }
}

/// One number, with what is needed to print it and to compute it again; or the reason why it is missing.
#[derive(Debug, Clone, PartialEq)]
pub struct Metric {
    /// Name, e.g. `peak_acceleration`.
    pub name: &'static str,
    /// Value in [`unit`](Self::unit), finite; `None` where the record does not show it.
    pub value: Option<f64>,
    /// SI unit, `1` for a ratio.
    pub unit: &'static str,
    /// How it is computed and after whom; for a missing value, why it is missing.
    pub definition: String,
    /// Which definition, e.g. `hic15-fmvss208`: the key of [`CATALOGUE`](crate::metric::definitions::CATALOGUE).
    pub id: &'static str,
    /// The part of the record the value belongs to, where it belongs to one.
    pub window: Option<Window>,
    /// Where the value lies, where several channels or the stated uncertainty of the inputs say it.
    pub interval: Option<Interval>,
    /// Whether the value is a lower bound, because the record ends too early.
    pub is_lower_bound: bool,
}

impl Interval {
    /// 5 % and 95 % quantile of the values of repetitions, linear between order statistics (type 7 of Hyndman & Fan,
    /// 1996); `None` without values.
    pub fn of_replicates(mut values: Vec<f64>) -> Option<Self> {
        values.sort_unstable_by(f64::total_cmp);
        let (low, high) = (quantile(&values, 0.05)?, quantile(&values, 0.95)?);
        let by = IntervalBy::Replicates(values.len());
        (low.is_finite() && high.is_finite()).then_some(Self { low, high, by })
    }

    /// The same, widened where it does not hold the value itself: an error of the inputs adds to a magnitude of nearly
    /// zero and never takes from it, so that the repetitions lie on one side of the value.
    #[must_use]
    pub fn holding(self, value: f64) -> Self {
        Self { low: self.low.min(value), high: self.high.max(value), ..self }
    }
}

impl Metric {
    /// A value; absent if it is not finite, which only happens where the samples leave the range of numbers.
    pub fn with_value(definition: &Definition, value: f64) -> Self {
        if !value.is_finite() {
            return Self::absent(definition, "not computable from this record");
        }
        Self {
            name: definition.name,
            value: Some(value),
            unit: definition.unit,
            definition: definition.text.to_owned(),
            id: definition.id,
            window: None,
            interval: None,
            is_lower_bound: false,
        }
    }

    /// No value, and why.
    pub fn absent(definition: &Definition, reason: &str) -> Self {
        Self {
            name: definition.name,
            value: None,
            unit: definition.unit,
            definition: format!("absent: {reason}"),
            id: definition.id,
            window: None,
            interval: None,
            is_lower_bound: false,
        }
    }

    /// The value if there is one, else the reason.
    pub fn of(definition: &Definition, value: Option<f64>, reason: &str) -> Self {
        value.map_or_else(|| Self::absent(definition, reason), |value| Self::with_value(definition, value))
    }

    /// States the part of the record; nothing for a missing value.
    pub fn over(mut self, from_s: f64, to_s: f64) -> Self {
        self.window = self.value.map(|_| Window { from_s, to_s });
        self
    }

    /// Appends a remark to the definition.
    pub fn remarked(mut self, remark: &str) -> Self {
        if self.value.is_some() {
            self.definition = format!("{}; {remark}", self.definition);
        }
        self
    }

    /// States that the value is a lower bound, with the reason for the definition.
    pub fn as_lower_bound(self, because: &str) -> Self {
        let is_lower_bound = self.value.is_some();
        Self { is_lower_bound, ..self.remarked(because) }
    }
}

/// Refuses two signals that are not sampled at the same times.
pub(crate) fn same_grid(
    (first, a): (&'static str, &Sampled),
    (second, b): (&'static str, &Sampled),
) -> Result<(), MetricsError> {
    if a.is_empty() {
        return Err(MetricsError::Empty);
    }
    if a.len() != b.len() || a.t0_s() != b.t0_s() || a.dt_s() != b.dt_s() {
        return Err(MetricsError::Grids {
            first,
            first_len: a.len(),
            first_t0_s: a.t0_s(),
            second,
            second_len: b.len(),
            second_t0_s: b.t0_s(),
        });
    }
    Ok(())
}

/// Refuses what cannot be rated: grids that differ, a reference of zeros.
pub(crate) fn rated_grid(reference: &Sampled, comparison: &Sampled) -> Result<(), MetricsError> {
    same_grid(("the reference", reference), ("the comparison", comparison))?;
    if reference.samples().iter().all(|x| *x == 0.0) {
        return Err(MetricsError::ZeroReference);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_replicates_leaves_a_twentieth_out_on_either_side() {
        let interval = Interval::of_replicates((0..=100).rev().map(f64::from).collect()).unwrap();
        // Places 5 and 95 of 0..=100; 0.05·100 is 5 but for rounding.
        assert!((interval.low - 5.0).abs() < 1e-12 && (interval.high - 95.0).abs() < 1e-12);
        assert_eq!(interval.by.to_string(), "5-95 % of 101 replicates");
        assert_eq!(Interval::of_replicates(vec![2.0]).map(|i| (i.low, i.high)), Some((2.0, 2.0)));
        // A magnitude of nothing, to which every error adds.
        let (low, high) = (interval.low, interval.high);
        assert_eq!(interval.holding(0.0), Interval { low: 0.0, ..interval });
        assert_eq!(interval.holding(50.0), Interval { low, high, ..interval });
        assert_eq!(interval.holding(100.0), Interval { high: 100.0, ..interval });
        assert_eq!(Interval::of_replicates(vec![]), None);
    }
}
