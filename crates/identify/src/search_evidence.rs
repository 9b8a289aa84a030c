//! What a search for continuous poles tells of itself, as evidence.

use crumple_identify::{Start, Termination};
use crumple_stage::records::EvidenceV1;

/// What transfer functions of one path and of several have in common.
pub struct Searched<'a> {
    /// Hold that was declared.
    pub hold: &'a str,
    /// Whether the initial conditions were estimated.
    pub initial_estimated: bool,
    /// Kind of the best start, its iterations, why it stopped.
    pub best: (Start, usize, Termination),
    /// Evaluations of all starts.
    pub evaluations: usize,
    /// Loss of every refined start.
    pub losses: &'a [f64],
    /// Condition number of the sensitivities.
    pub condition: f64,
    /// Deviations of the denominator's coefficients.
    pub denominator_deviations: &'a [f64],
    /// Deviations of frequency and damping of every mode.
    pub mode_deviations: &'a [Option<(f64, f64)>],
    /// Paper whose procedure this is.
    pub paper: Option<&'a str>,
}

impl Searched<'_> {
    /// Puts it into the evidence of one output.
    pub fn put(&self, support: &mut EvidenceV1) {
        let (start, iterations, termination) = self.best;
        support.hold = Some(self.hold.to_owned());
        support.initial_conditions = if self.initial_estimated { "estimated" } else { "zero" }.to_owned();
        support.start = Some(start.name().to_owned());
        support.stop_reason = Some(termination.name().to_owned());
        support.iterations = u32::try_from(iterations).ok();
        support.evaluations = Some(self.evaluations as u64);
        support.losses = self.losses.to_vec();
        support.condition = Some(self.condition).filter(|c| c.is_finite());
        support.denominator_deviations = known(self.denominator_deviations);
        support.frequency_deviations = self.mode_deviations.iter().map(|d| d.map(|d| d.0)).collect();
        support.damping_deviations = self.mode_deviations.iter().map(|d| d.map(|d| d.1)).collect();
        support.paper = self.paper.map(str::to_owned);
    }
}

/// Deviations, or none where they are not determined.
pub fn known(deviations: &[f64]) -> Vec<f64> {
    if deviations.iter().all(|x| x.is_finite()) { deviations.to_vec() } else { Vec::new() }
}
