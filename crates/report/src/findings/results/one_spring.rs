//! A curve or a record as one spring.

use crumple_artifact::records::IntervalSourceV1;
use crumple_signal::key_quantities::STIFFNESS;

use crate::findings::results::run::Run;
use crate::words;

/// Stiffness of the linear spring that takes up the energy of the test at its crush.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneSpring {
    /// N/m.
    pub n_per_m: f64,
    /// Ends of its interval, N/m.
    pub ends: Option<(f64, f64)>,
    /// What the interval is made from.
    pub source: Option<IntervalSourceV1>,
}

impl OneSpring {
    /// Metric that has it.
    pub const METRIC: &str = "average_stiffness";

    /// `769 kN/m`: the same on page, console and in captions.
    pub fn shown(&self) -> String {
        words::rounded(self.n_per_m, self.ends, STIFFNESS.shown())
    }

    /// `769 kN/m (90 %: 750 to 790)`.
    pub fn with_interval(&self) -> String {
        words::with_interval(self.n_per_m, self.ends, self.source, &STIFFNESS)
    }
}

impl Run {
    /// The test as one spring; `None` where mass, impact speed or crush are not known.
    pub fn one_spring(&self) -> Option<OneSpring> {
        let metric = self.metric(OneSpring::METRIC)?;
        Some(OneSpring { n_per_m: metric.value?, ends: metric.low.zip(metric.high), source: metric.source() })
    }
}
