//! Why a candidate does not describe its record.

use std::fmt;

use crate::selection::compared_candidate::ComparedCandidate;
use crate::selection::prior::SelectionRules;

/// An event of the test that a model repeats or misses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TestEvent {
    /// The dynamic crush.
    Crush,
    /// The time of dynamic crush.
    Time,
    /// The coefficient of restitution.
    Restitution,
}

impl TestEvent {
    /// Its name in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crush => "dynamic_crush",
            Self::Time => "time_of_dynamic_crush",
            Self::Restitution => "coefficient_of_restitution",
        }
    }
}

/// A reason why a candidate is not adequate.
#[derive(Debug, Clone, PartialEq)]
pub enum Inadequacy {
    /// A spring or damper is negative.
    NotPassive,
    /// These parameters, in words, are on a bound of their search.
    OnBound(Vec<String>),
    /// It has no displacement to compare.
    NoDisplacement,
    /// Its displacement fit is too low, percent.
    DisplacementFit {
        /// The fit.
        percent: f64,
        /// The least fit that is adequate.
        limit: f64,
    },
    /// It has no response to compare.
    NoResponse,
    /// It has no dynamic crush: the mass does not stop.
    NeverStops,
    /// It misses an event of its own test: crush and time by a share, restitution by a difference.
    Misses {
        /// The event.
        event: TestEvent,
        /// Model beside test.
        error: f64,
        /// The largest error that is adequate.
        limit: f64,
    },
    /// It does not follow a sensor on another mass, which an adequate candidate follows.
    MissesSensor {
        /// Channel of the sensor.
        channel: String,
        /// Displacement fit there, percent.
        percent: f64,
        /// The least fit that is adequate.
        limit: f64,
    },
}

impl Inadequacy {
    /// Every reason against each candidate; none: it is adequate. A sensor on another mass speaks against those that do
    /// not follow it where another candidate does: it decides among models of more masses and of fewer.
    pub fn of_all(candidates: &[ComparedCandidate], rules: &SelectionRules) -> Vec<Vec<Self>> {
        let mut all: Vec<Vec<Self>> = candidates.iter().map(|candidate| Self::of(candidate, rules)).collect();
        let limit = rules.adequate_fit_percent;
        let misses = |candidate: &ComparedCandidate| {
            let (channel, percent) = candidate.worst_sensor.clone().filter(|(_, percent)| *percent < limit)?;
            Some(Self::MissesSensor { channel, percent, limit })
        };
        if all.iter().zip(candidates).any(|(reasons, candidate)| reasons.is_empty() && misses(candidate).is_none()) {
            all.iter_mut().zip(candidates).for_each(|(reasons, candidate)| reasons.extend(misses(candidate)));
        }
        all
    }

    fn of(candidate: &ComparedCandidate, rules: &SelectionRules) -> Vec<Self> {
        let mut reasons = Vec::new();
        if !candidate.physical {
            reasons.push(Self::NotPassive);
        }
        if !candidate.on_bound.is_empty() {
            reasons.push(Self::OnBound(candidate.on_bound.clone()));
        }
        let limit = rules.adequate_fit_percent;
        match candidate.fit_percent {
            None => reasons.push(Self::NoDisplacement),
            Some(percent) if percent < limit => reasons.push(Self::DisplacementFit { percent, limit }),
            Some(_) if candidate.misfit.is_none() => reasons.push(Self::NoResponse),
            Some(_) => {}
        }
        let own = &candidate.own_test;
        if own.crush.is_none() {
            reasons.push(Self::NeverStops);
        }
        let events = [
            (TestEvent::Crush, own.crush, 0.01 * rules.crush_limit_percent),
            (TestEvent::Restitution, own.restitution, rules.restitution_limit),
            (TestEvent::Time, own.time, 0.01 * rules.time_limit_percent),
        ];
        reasons.extend(events.into_iter().filter_map(|(event, error, limit)| {
            let error = error.filter(|error| error.abs() > limit)?;
            Some(Self::Misses { event, error, limit })
        }));
        reasons
    }

    /// Whether the dynamic crush of a candidate with this reason may be used nevertheless: it misses nothing but the
    /// time of the crush, the rebound, or the motion of another mass.
    pub fn leaves_the_crush(&self) -> bool {
        let is_event = matches!(self, Self::Misses { event: TestEvent::Time | TestEvent::Restitution, .. });
        is_event || matches!(self, Self::MissesSensor { .. })
    }
}

impl fmt::Display for Inadequacy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotPassive => write!(f, "a spring or damper is negative"),
            Self::OnBound(names) => write!(f, "on a bound of its search: {}", names.join(", ")),
            Self::NoDisplacement => write!(f, "no displacement to compare"),
            Self::DisplacementFit { percent, limit } => {
                write!(f, "displacement fit of {percent:.1} % below {limit} %")
            }
            Self::NoResponse => write!(f, "no response to compare"),
            Self::NeverStops => write!(f, "the model never stops"),
            Self::MissesSensor { channel, percent, limit } => {
                write!(f, "follows the displacement of {channel} to {percent:.1} %, limit {limit} %")
            }
            Self::Misses { event: TestEvent::Restitution, error, limit } => {
                write!(f, "misses the restitution of its own test by {error:+.2}, limit {limit}")
            }
            Self::Misses { event, error, limit } => {
                let event = if *event == TestEvent::Crush { "dynamic crush" } else { "time of dynamic crush" };
                let (error, limit) = (100.0 * error, 100.0 * limit);
                write!(f, "misses the {event} of its own test by {error:+.1} %, limit {limit:.1} %")
            }
        }
    }
}
