//! Bounded minimisation: Levenberg-Marquardt, variable projection, interior point, L-SHADE; and why each stopped.
//!
//! All of these are results: the point is the best that was seen. [`StopReason::IterationLimit`] and
//! [`StopReason::SlowDescent`] say that going on could still lower the cost. Whether unknowns stand on a bound is said
//! beside the reason, by the optimum.

use std::fmt;

pub use crate::estimation::minimise::variable_projection::Stop;

pub mod interior_point;
pub mod l_shade;
pub mod levenberg_marquardt;
pub mod separable_covariance;
pub mod variable_projection;

/// Why a fit stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The residuals are orthogonal to every sensitivity: a stationary point.
    GradientConverged,
    /// Neither the cost nor its linear model falls by more than the tolerance; in a population all costs are alike.
    CostConverged,
    /// The parameters no longer move.
    StepConverged,
    /// The model follows the record to rounding.
    PerfectFit,
    /// No step with a finite response lowers the cost any more.
    NoImprovement,
    /// The cost still falls, by less in many steps than is worth them: a valley that the record leaves open.
    SlowDescent,
    /// The limit of iterations or evaluations was reached; the parameters are the best seen.
    IterationLimit,
}

impl StopReason {
    /// The name in records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::GradientConverged => "gradient-converged",
            Self::CostConverged => "cost-converged",
            Self::StepConverged => "step-converged",
            Self::PerfectFit => "perfect-fit",
            Self::NoImprovement => "no-improvement",
            Self::SlowDescent => "slow-descent",
            Self::IterationLimit => "iteration-limit",
        }
    }

    /// The name in records without a list of active bounds: `on-bound` where the descent converged and an unknown
    /// stands on a bound beyond which the cost falls.
    pub fn name_with_bounds(self, on_bound: bool) -> &'static str {
        let converged = matches!(self, Self::GradientConverged | Self::CostConverged | Self::StepConverged);
        if on_bound && converged { "on-bound" } else { self.name() }
    }
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
