//! When a variable-projection fit stops, and why it did.

/// Why an iterative fit stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Termination {
    /// `|J' e|` fell below the tolerance times `|J| |e|`: a stationary point.
    GradientConverged,
    /// The linear model promises a decrease below 1e-13 of the loss.
    CostConverged,
    /// The model follows the data to rounding.
    PerfectFit,
    /// No step lowers the loss any more: stationary as far as `f64` can tell.
    NoImprovement,
    /// The limit of iterations was reached; the parameters are the best seen.
    IterationLimit,
    /// Stationary, with a parameter on its bound.
    OnBound,
}

impl Termination {
    /// In the words of the artifact.
    pub fn name(self) -> &'static str {
        match self {
            Self::GradientConverged => "gradient-converged",
            Self::CostConverged => "cost-converged",
            Self::PerfectFit => "perfect-fit",
            Self::NoImprovement => "no-improvement",
            Self::IterationLimit => "iteration-limit",
            Self::OnBound => "on-bound",
        }
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Iterations at most.
    pub max_iterations: usize,
    /// Tolerance of the gradient test, the largest cosine between a sensitivity and the residual.
    pub gradient: f64,
}

impl Default for Stop {
    fn default() -> Self {
        Self { max_iterations: 200, gradient: 1e-8 }
    }
}
