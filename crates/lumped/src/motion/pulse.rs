//! An acceleration over time that is known between its samples: a crash pulse.

use crate::LumpedError;
use crate::error::{finite, positive};

/// An acceleration over time, m/s²; zero before its start and after its end.
#[derive(Debug, Clone, PartialEq)]
pub enum CrashPulse {
    /// `peak sin(π t/T)` for `0 <= t <= T`.
    HalfSine {
        /// Peak, m/s².
        peak_m_per_s2: f64,
        /// Duration `T`, s.
        duration_s: f64,
    },
    /// Straight lines between `(time, acceleration)`, s and m/s², times rising from zero or more.
    Lines(Vec<(f64, f64)>),
}

/// An input between two instants of its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Course {
    /// `value + slope (t - from)`.
    Line { from_s: f64, value: f64, slope: f64 },
    /// `peak sin(frequency t)`, rad/s.
    Sine { peak: f64, frequency: f64 },
}

impl CrashPulse {
    /// From zero to the peak at `peak_s` and back to zero at `duration_s`. Errors: a peak that is not inside.
    pub fn triangle(peak_m_per_s2: f64, peak_s: f64, duration_s: f64) -> Result<Self, LumpedError> {
        let pulse = Self::Lines(vec![(0.0, 0.0), (peak_s, peak_m_per_s2), (duration_s, 0.0)]);
        pulse.check()?;
        Ok(pulse)
    }

    /// Refuses numbers that are not finite, a duration that is not positive, times that do not rise.
    pub fn check(&self) -> Result<(), LumpedError> {
        match self {
            Self::HalfSine { peak_m_per_s2, duration_s } => {
                finite("peak_m_per_s2", *peak_m_per_s2)?;
                positive("duration_s", *duration_s)
            }
            Self::Lines(points) => {
                points.iter().flat_map(|(t, a)| [t, a]).try_for_each(|x| finite("sample of a pulse", *x))?;
                let rises = points.windows(2).all(|pair| pair[0].0 < pair[1].0);
                let first = points.first().map_or(0.0, |(t, _)| *t);
                if !rises || first < 0.0 {
                    let expected = "zero or more, and every time above the one before";
                    return Err(LumpedError::Value { name: "first time of a pulse", value: first, expected });
                }
                Ok(())
            }
        }
    }

    /// The same, upside down: the deceleration of a vehicle as the acceleration of a base.
    pub fn reversed(&self) -> Self {
        match self {
            Self::HalfSine { peak_m_per_s2, duration_s } => {
                Self::HalfSine { peak_m_per_s2: -peak_m_per_s2, duration_s: *duration_s }
            }
            Self::Lines(points) => Self::Lines(points.iter().map(|(t, a)| (*t, -a)).collect()),
        }
    }

    /// Stretch `number` from zero on, with the instant of its end, s; `None` after the last.
    pub(crate) fn stretch(&self, number: usize) -> Option<(Course, f64)> {
        match self {
            Self::HalfSine { peak_m_per_s2, duration_s } => {
                let course = Course::Sine { peak: *peak_m_per_s2, frequency: std::f64::consts::PI / duration_s };
                (number == 0).then_some((course, *duration_s))
            }
            Self::Lines(points) => {
                let first_s = points.first()?.0;
                // Nothing comes before a first time above zero.
                let ((from_s, value), (to_s, next)) = match (number + usize::from(first_s == 0.0)).checked_sub(1) {
                    None => ((0.0, 0.0), (first_s, 0.0)),
                    Some(i) => (*points.get(i)?, *points.get(i + 1)?),
                };
                Some((Course::Line { from_s, value, slope: (next - value) / (to_s - from_s) }, to_s))
            }
        }
    }
}
