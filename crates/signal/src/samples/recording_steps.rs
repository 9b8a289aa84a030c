//! What was done to an acceleration before its motion stood in an artifact.

use crate::{PreEventWindow, Sampled, pre_event};

/// The steps between an acceleration and the motion that was recorded of it, as the records of a run state them:
/// sampling, channel filter, integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordingSteps {
    /// Sampling interval, s.
    pub dt_s: f64,
    /// First sample of the acceleration, s after contact; negative before it.
    pub first_s: f64,
    /// Samples of the acceleration.
    pub samples: usize,
    /// Filter of second order that ran forward and backward: a0, a1, a2, b1, b2, and the samples mirrored through the
    /// end points before. `None`: not filtered.
    pub two_pass_filter: Option<([f64; 5], usize)>,
    /// Whether the integration starts at contact (else at the first sample), with the impact speed.
    pub from_contact: bool,
    /// Whether every sample holds until the next (forward Euler); else trapezoids.
    pub forward_euler: bool,
    /// What the filtered acceleration shows before the event; `None`: too little.
    pub before_event: Option<BeforeEvent>,
    /// Whether these are all steps; else a filter or a rule stands in no record, or in one that cannot be repeated.
    pub known: bool,
}

/// The stretch before the event from which the zero level of an acceleration was read, and the noise there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeforeEvent {
    /// First sample of the zero level, s after contact.
    pub from_s: f64,
    /// Samples that the zero level is the mean of.
    pub samples: usize,
    /// Standard deviation of the filtered acceleration, unit of the samples.
    pub noise: f64,
    /// Samples that it is of: those that the ends of the record do not reach through the filter.
    pub noise_samples: usize,
}

impl BeforeEvent {
    /// In the usual window ([`PreEventWindow`]) of a filtered acceleration, contact at `time_zero_s` of its axis.
    ///
    /// `end_s`: what is left out of the noise at the first sample, because a filter that mirrors the record there
    /// passes more of it. `None` where less than 10 ms are left.
    pub fn of(filtered: &Sampled, time_zero_s: f64, end_s: f64) -> Option<Self> {
        let window = PreEventWindow::default();
        let whole = pre_event(filtered, window)?;
        let inner =
            pre_event(filtered, PreEventWindow { from_s: window.from_s.max(filtered.t0_s() + end_s), ..window })?;
        Some(Self {
            from_s: whole.from_s - time_zero_s,
            samples: whole.samples,
            noise: inner.noise_floor,
            noise_samples: inner.samples,
        })
    }
}
