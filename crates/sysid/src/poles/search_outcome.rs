//! Outcome of a search for the poles of transfer functions.

use crate::poles::multistart::Search;
use crate::{Start, StopReason};

/// How a search for the poles of transfer functions ended, and how sure it is of them.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchOutcome {
    /// Whether the initial conditions were estimated.
    pub initial_estimated: bool,
    /// Kind of the best start.
    pub start: Start,
    /// Its iterations.
    pub iterations: u32,
    /// Evaluations of all starts.
    pub evaluations: u64,
    /// Why the best one stopped.
    pub stop_reason: StopReason,
    /// Whether one of its unknowns stands on a bound.
    pub on_bound: bool,
    /// Mean square of the errors of every refined start, best first: in the square of the output's unit, of several
    /// outputs divided by their root mean squares.
    pub losses: Vec<f64>,
    /// Condition number of the column-scaled sensitivities of all unknowns.
    pub condition: f64,
    /// Standard deviations of the denominator's coefficients without its leading 1, highest power first, from the
    /// covariance of the linearised fit inflated for correlated residuals; infinite where not determined.
    pub denominator_deviations: Vec<f64>,
    /// Standard deviations of frequency (rad/s) and damping ratio of every mode; `None` where not determined.
    pub mode_deviations: Vec<Option<(f64, f64)>>,
}

impl SearchOutcome {
    /// Of a search with `poles` poles; `deviations` are those of the denominator's coefficients without its 1, then of
    /// the frequencies, then of the damping ratios.
    pub(crate) fn new(search: &Search, condition: f64, poles: usize, deviations: &[f64]) -> Self {
        let (denominator, modes) = deviations.split_at(poles);
        let (frequencies, dampings) = modes.split_at(poles);
        let known = |(w, zeta): (&f64, &f64)| (w.is_finite() && zeta.is_finite()).then_some((*w, *zeta));
        Self {
            initial_estimated: search.problem.free,
            start: search.start,
            iterations: search.best.iterations,
            evaluations: search.evaluations,
            stop_reason: search.best.stop,
            on_bound: search.best.on_bound.contains(&true),
            losses: search.losses.clone(),
            condition,
            denominator_deviations: denominator.to_vec(),
            mode_deviations: frequencies.iter().zip(dampings).map(known).collect(),
        }
    }
}
