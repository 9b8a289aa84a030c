//! What must hold between the numbers of a record, whoever wrote it.

use super::{CandidateV1, EventsV1, MetricsV2, PredictionV1, UncertaintyV1};
use crate::finite::first_beyond;

/// Ends are computed in different ways and may pass each other by rounding, by this share of themselves.
const ROUNDING: f64 = 1e-9;

/// Error where the low end of an interval is above its high end. The value is not asked: that of a closed form, or of a
/// metric that is zero, may lie outside what repetitions say of it.
fn rises(name: &str, low: Option<f64>, high: Option<f64>) -> Result<(), String> {
    match low.zip(high) {
        Some((low, high)) if low > high + ROUNDING * low.abs().max(high.abs()) => {
            Err(format!("the interval of {name} has its low end, {low}, above its high end, {high}"))
        }
        _ => Ok(()),
    }
}

/// Error unless the number is at least this.
fn at_least(name: &str, least: f64, value: f64) -> Result<(), String> {
    if value >= least { Ok(()) } else { Err(format!("{name} is {value}, expected at least {least}")) }
}

/// Error unless the number is a share.
fn is_share(name: &str, value: f64) -> Result<(), String> {
    if (0.0..=1.0).contains(&value) { Ok(()) } else { Err(format!("{name} is {value}, expected 0 to 1")) }
}

/// Numbers of a crash stay below this in SI units: the largest of cars are unloading stiffnesses of 1e9 N/m.
const LARGEST: f64 = 1e15;

impl UncertaintyV1 {
    fn check_numbers(&self) -> Result<(), String> {
        for (name, deviation) in &self.standard_deviation {
            at_least(&format!("the standard deviation of {name}"), 0.0, *deviation)?;
        }
        for (name, low) in &self.interval_low {
            let high = self.interval_high.get(name).copied().flatten();
            rises(name, *low, high)?;
        }
        let beyond = self.correlation.iter().flatten().find(|r| r.abs() > 1.0 + ROUNDING);
        if let Some(correlation) = beyond {
            return Err(format!("a correlation is {correlation}, expected -1 to 1"));
        }
        for profile in &self.profile {
            rises(&profile.parameter, profile.low, profile.high)?;
        }
        for repeated in self.bootstrap.iter().chain(&self.propagation) {
            is_share("coverage", repeated.coverage)?;
            for (name, low) in &repeated.low {
                rises(name, Some(*low), repeated.high.get(name).copied())?;
            }
        }
        Ok(())
    }
}

impl CandidateV1 {
    pub(crate) fn first_too_large(&self) -> Option<(String, f64)> {
        first_beyond(&self.parameters, LARGEST)
    }

    pub(crate) fn check_numbers(&self) -> Result<(), String> {
        self.uncertainty.as_ref().map_or(Ok(()), UncertaintyV1::check_numbers)
    }
}

impl EventsV1 {
    pub(crate) fn first_too_large(&self) -> Option<(String, f64)> {
        first_beyond(self, LARGEST)
    }

    pub(crate) fn check_numbers(&self) -> Result<(), String> {
        if self.time_zero_s != 0.0 {
            return Err(format!(
                "time_zero_s is {0}, expected 0: times are seconds from contact, which ingest settles. Run ingest \
                 again with its --time-zero moved by {0} s",
                self.time_zero_s
            ));
        }
        self.dynamic_crush_m.map_or(Ok(()), |crush| at_least("dynamic_crush_m", 0.0, crush))?;
        self.intervals.iter().try_for_each(|interval| rises(&interval.name, Some(interval.low), Some(interval.high)))
    }
}

impl MetricsV2 {
    pub(crate) fn first_too_large(&self) -> Option<(String, f64)> {
        first_beyond(self, LARGEST)
    }

    pub(crate) fn check_numbers(&self) -> Result<(), String> {
        self.metrics.iter().try_for_each(|metric| rises(&metric.name, metric.low, metric.high))
    }
}

impl PredictionV1 {
    pub(crate) fn first_too_large(&self) -> Option<(String, f64)> {
        first_beyond(self, LARGEST)
    }

    pub(crate) fn check_numbers(&self) -> Result<(), String> {
        at_least("mass_kg", 0.0, self.mass_kg)?;
        self.dynamic_crush_m.map_or(Ok(()), |crush| at_least("dynamic_crush_m", 0.0, crush))?;
        self.intervals.iter().try_for_each(|interval| {
            is_share("level", interval.level)?;
            rises(&interval.name, Some(interval.low), Some(interval.high))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::record::Record;
    use crate::records::PredictedIntervalV1;

    #[test]
    fn events_that_count_from_elsewhere_than_contact_are_refused_with_what_to_do() {
        let events = |time_zero_s| EventsV1 { time_zero_s, ..EventsV1::default() };
        assert_eq!(events(0.0).check_numbers(), Ok(()));
        let error = events(-0.018).check_numbers().unwrap_err();
        assert!(error.contains("seconds from contact") && error.contains("--time-zero"), "{error}");
    }

    #[test]
    fn a_record_that_contradicts_itself_says_where() {
        let interval = |low, level| PredictedIntervalV1 {
            name: "dynamic_crush_m".to_owned(),
            level,
            low,
            high: 0.8,
            interval_by: String::new(),
        };
        let prediction = |low, level, crush| PredictionV1 {
            dynamic_crush_m: Some(crush),
            intervals: vec![interval(low, level)],
            ..PredictionV1::default()
        };
        assert_eq!(prediction(0.6, 0.9, 0.7).check_numbers(), Ok(()));
        let text = prediction(1e3, 0.9, 0.7).check_numbers().unwrap_err();
        assert_eq!(text, "the interval of dynamic_crush_m has its low end, 1000, above its high end, 0.8");
        assert_eq!(prediction(0.6, 1.4, 0.7).check_numbers().unwrap_err(), "level is 1.4, expected 0 to 1");
        assert_eq!(prediction(0.6, 0.9, -1e18).first_impossible(), Some(("dynamic_crush_m".to_owned(), -1e18)));
        assert_eq!(prediction(0.6, 0.9, 1e6).first_impossible(), None);
        let text = prediction(-2.0, 0.9, -1.0).check_numbers().unwrap_err();
        assert_eq!(text, "dynamic_crush_m is -1, expected at least 0");

        let mut known = UncertaintyV1 { correlation: vec![vec![1.0, -1.7]], ..UncertaintyV1::default() };
        assert_eq!(known.check_numbers().unwrap_err(), "a correlation is -1.7, expected -1 to 1");
        known = UncertaintyV1 { standard_deviation: [("k".to_owned(), -1.0)].into(), ..UncertaintyV1::default() };
        assert!(known.check_numbers().is_err());
    }
}
