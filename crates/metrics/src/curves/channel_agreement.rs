//! Redundant channels: how far two are apart, and the range of a metric over several.

use crumple_signal::{Acceleration, Signal, Velocity};

use crate::curves::residuals::residuals;
use crate::metric::grid::same_grid;
use crate::{Interval, IntervalBy, Metric, MetricsError};

/// Dynamic crushes further apart than this share are not averaged.
pub const LARGEST_CRUSH_GAP: f64 = 0.05;

/// Acceleration, velocity and events of one of two redundant channels.
#[derive(Debug, Clone, Copy)]
pub struct ChannelMotion<'a> {
    /// Filtered acceleration.
    pub acceleration: &'a Signal<Acceleration>,
    /// Velocity.
    pub velocity: &'a Signal<Velocity>,
    /// Dynamic crush, m.
    pub dynamic_crush_m: Option<f64>,
}

/// How far two redundant channels (left and right) are apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Agreement {
    /// Largest |Δa|, m/s².
    pub largest_acceleration_gap_m_per_s2: f64,
    /// |Δv| at the given time; `None` outside the record.
    pub velocity_gap_m_per_s: Option<f64>,
    /// |ΔC|, m.
    pub crush_gap_m: Option<f64>,
    /// |ΔC| over the mean C.
    pub crush_gap_ratio: Option<f64>,
    /// Fit of the second to the first, %.
    pub fit_percent: Option<f64>,
}

impl Agreement {
    /// Whether the channels may be averaged: |ΔC|/C at most 5 %.
    pub fn may_be_averaged(&self) -> bool {
        self.crush_gap_ratio.is_some_and(|ratio| ratio <= LARGEST_CRUSH_GAP)
    }
}

/// Compares two channels on one grid after filtering; `at_s` is the time of the velocities, usually t_m, on their axis.
pub fn agreement(first: ChannelMotion<'_>, second: ChannelMotion<'_>, at_s: f64) -> Result<Agreement, MetricsError> {
    same_grid(("the first channel", first.acceleration), ("the second channel", second.acceleration))?;
    let pairs = first.acceleration.samples().iter().zip(second.acceleration.samples());
    let crush_gap_m = first.dynamic_crush_m.zip(second.dynamic_crush_m).map(|(a, b)| (a - b).abs());
    let mean = first.dynamic_crush_m.zip(second.dynamic_crush_m).map(|(a, b)| (a + b).abs() / 2.0);
    Ok(Agreement {
        largest_acceleration_gap_m_per_s2: pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max),
        velocity_gap_m_per_s: first.velocity.at(at_s).zip(second.velocity.at(at_s)).map(|(a, b)| (a - b).abs()),
        crush_gap_m,
        crush_gap_ratio: crush_gap_m.zip(mean).map(|(gap, mean)| gap / mean).filter(|ratio| ratio.is_finite()),
        fit_percent: residuals(first.acceleration, second.acceleration)?.fit_percent,
    })
}

/// A metric of one channel with the lowest and the highest of all channels as its interval.
///
/// The spread of redundant channels is the honest error bar of one of them; the value stays that of `of`, because
/// channels are averaged on request only. `None` without other channels, with different definitions, or where one has
/// no value.
pub fn over_channels(of: &Metric, others: &[&Metric]) -> Option<Metric> {
    let value = of.value.filter(|_| !others.is_empty())?;
    let (mut low, mut high) = (value, value);
    for other in others {
        let value = other.value.filter(|_| other.id == of.id && other.unit == of.unit)?;
        (low, high) = (low.min(value), high.max(value));
    }
    let by = IntervalBy::Channels(others.len() + 1);
    Some(Metric { interval: Some(Interval { low, high, by }), ..of.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metric::definitions::{OLC, VPI};

    #[test]
    fn the_spread_of_channels_is_the_interval_of_the_first() {
        let olc = |value| Metric::with_value(&OLC, value);
        let spread = over_channels(&olc(295.0), &[&olc(300.0), &olc(290.0)]).unwrap();
        let by = IntervalBy::Channels(3);
        assert_eq!((spread.value, spread.interval), (Some(295.0), Some(Interval { low: 290.0, high: 300.0, by })));
        assert_eq!(by.to_string(), "range over 3 channels");
        assert_eq!(over_channels(&olc(1.0), &[&Metric::absent(&OLC, "why")]), None);
        assert_eq!(over_channels(&olc(1.0), &[&Metric::with_value(&VPI, 1.0)]), None);
        assert_eq!(over_channels(&olc(1.0), &[]), None);
    }

    #[test]
    fn tells_how_far_two_channels_are_apart() {
        let a = [[0.0, -2.0, 0.0], [0.0, -3.0, 0.0]].map(|a| Signal::new(0.0, 0.5, a.to_vec()).unwrap());
        let v = [[4.0, 3.5, 3.0], [4.0, 3.25, 2.5]].map(|v| Signal::new(0.0, 0.5, v.to_vec()).unwrap());
        let motion = |k: usize, c| ChannelMotion { acceleration: &a[k], velocity: &v[k], dynamic_crush_m: c };
        let gaps = agreement(motion(0, Some(0.75)), motion(1, Some(0.73)), 0.75).unwrap();
        assert_eq!((gaps.largest_acceleration_gap_m_per_s2, gaps.velocity_gap_m_per_s), (1.0, Some(0.375)));
        assert!(gaps.may_be_averaged());
        assert!(!agreement(motion(0, Some(0.75)), motion(1, None), 0.75).unwrap().may_be_averaged());
        assert!(!agreement(motion(0, Some(0.75)), motion(1, Some(0.7)), 0.75).unwrap().may_be_averaged());
    }
}
