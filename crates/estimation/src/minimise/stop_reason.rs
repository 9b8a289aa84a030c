//! Why a bounded descent stopped, and how records name it.
//!
//! All of these are results: the point is the best that was seen. Only [`StopReason::IterationLimit`] says that going
//! on could still lower the cost.

use std::fmt;

/// Why a fit stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The residuals are orthogonal to every sensitivity: a stationary point.
    GradientConverged,
    /// The cost no longer decreases.
    CostConverged,
    /// The parameters no longer move.
    StepConverged,
    /// The iteration limit was reached; the parameters are the best seen.
    IterationLimit,
}

impl StopReason {
    /// The name in records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::GradientConverged => "gradient-converged",
            Self::CostConverged => "cost-converged",
            Self::StepConverged => "step-converged",
            Self::IterationLimit => "iteration-limit",
        }
    }
}

impl fmt::Display for StopReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
