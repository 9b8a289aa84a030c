//! What was done to an acceleration before its motion stood in an artifact.

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
    /// Whether these are all steps; else a filter or a rule stands in no record, or in one that cannot be repeated.
    pub known: bool,
}
