//! Dynamic crush and rebound: zeros and minimum of the velocity.

use crumple_signal::{Displacement, Signal, Velocity};

use crate::events::unstopped::unstopped;
use crate::metric::grid::same_grid;
use crate::{MetricsError, Unstopped};

/// The moment of largest crush: the first zero of velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DynamicCrush {
    /// Time t_m, s from time zero.
    pub time_s: f64,
    /// Dynamic crush C = x(t_m), m.
    pub displacement_m: f64,
    /// Index of the first sample with v ≤ 0.
    pub index: usize,
}

/// The lowest velocity after dynamic crush.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rebound {
    /// Lowest velocity v_s, m/s; never positive.
    pub velocity_m_per_s: f64,
    /// Time t_s of the first such sample, s from time zero.
    pub time_s: f64,
    /// Displacement there, m. An estimate of the residual crush, no measurement of it.
    pub displacement_m: f64,
    /// The lowest velocity is the last sample: the record ends before the vehicle is free.
    pub still_separating: bool,
}

/// What happens in a crash, as far as the record shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct CrashEvents {
    /// Dynamic crush; `None`: the velocity never reaches zero.
    pub crush: Option<DynamicCrush>,
    /// Rebound; `None` without dynamic crush.
    pub rebound: Option<Rebound>,
    /// Velocity of the last sample, m/s.
    pub end_velocity_m_per_s: f64,
    /// Zeros of velocity after the first, s from time zero, either direction. Not used for anything.
    pub later_zeros_s: Vec<f64>,
    /// End of the event and lowest velocity up to it, where the velocity never reaches zero.
    pub unstopped: Option<Unstopped>,
}

/// Finds dynamic crush and rebound in a motion.
///
/// Dynamic crush is at the first sample k ≥ 1 at or after `time_zero_s` with `v[k] ≤ 0`: `t_m = t[k-1] +
/// T·v[k-1]/(v[k-1] - v[k])`, `C = x[k-1] + (t_m - t[k-1])·v[k-1]/2`, which is the trapezoid up to the interpolated
/// zero. Interpolating linearly errs by at most `T²·max|a'|/(8·|a|)` in t_m. The rebound velocity is the lowest
/// sample from k on. A record that ends while the velocity is positive has neither; its last sample is not a crush. It
/// has the lowest velocity up to the [end of the event](unstopped).
/// Noise around zero makes many later zeros, which is why only the first counts.
pub fn crash_events(
    velocity: &Signal<Velocity>,
    displacement: &Signal<Displacement>,
    time_zero_s: f64,
) -> Result<CrashEvents, MetricsError> {
    same_grid(("the velocity", velocity), ("the displacement", displacement))?;
    let (v, x, dt) = (velocity.samples(), displacement.samples(), velocity.dt_s());
    let zero_between = |k: usize| velocity.time_s(k - 1) - time_zero_s + dt * v[k - 1] / (v[k - 1] - v[k]);

    let from = velocity.index_at_or_after(time_zero_s).max(1);
    let first = (from..v.len()).find(|&k| v[k] <= 0.0 && v[k - 1] > 0.0);
    let crush = first.map(|k| {
        let time_s = zero_between(k);
        let since_sample = time_s - (velocity.time_s(k - 1) - time_zero_s);
        DynamicCrush { time_s, displacement_m: x[k - 1] + since_sample * v[k - 1] / 2.0, index: k }
    });

    let mut later_zeros_s = Vec::new();
    let rebound = first.map(|start| {
        let mut lowest = start;
        for k in start + 1..v.len() {
            if v[k] < v[lowest] {
                lowest = k;
            }
            // A sample at exactly zero belongs to the interval that reaches it.
            if (v[k - 1] < 0.0 && v[k] >= 0.0) || (v[k - 1] > 0.0 && v[k] <= 0.0) {
                later_zeros_s.push(zero_between(k));
            }
        }
        Rebound {
            velocity_m_per_s: v[lowest],
            time_s: velocity.time_s(lowest) - time_zero_s,
            displacement_m: x[lowest],
            still_separating: lowest + 1 == v.len() && v[lowest] < 0.0,
        }
    });
    let unstopped = if crush.is_none() { unstopped(velocity, time_zero_s) } else { None };
    Ok(CrashEvents { crush, rebound, end_velocity_m_per_s: v[v.len() - 1], later_zeros_s, unstopped })
}

impl CrashEvents {
    /// Coefficient of restitution e = -v_s/v0 against a rigid barrier; 0 where the velocity never gets below zero.
    pub fn restitution(&self, impact_speed_m_per_s: f64) -> Option<f64> {
        // `+ 0.0` turns the -0.0 of a vehicle that stops dead into 0.
        self.rebound.map(|rebound| -rebound.velocity_m_per_s / impact_speed_m_per_s + 0.0)
    }

    /// Change of velocity, m/s: v0 - v_s, or where the velocity never reaches zero v0 less the lowest up to the end of
    /// the event.
    pub fn delta_v_m_per_s(&self, impact_speed_m_per_s: f64) -> Option<f64> {
        self.lowest().map(|(velocity_m_per_s, _)| impact_speed_m_per_s - velocity_m_per_s)
    }

    /// When the velocity is the one of [`delta_v_m_per_s`](Self::delta_v_m_per_s), s from time zero.
    pub fn time_of_delta_v_s(&self) -> Option<f64> {
        self.lowest().map(|(_, time_s)| time_s)
    }

    fn lowest(&self) -> Option<(f64, f64)> {
        let stopped = self.rebound.map(|rebound| (rebound.velocity_m_per_s, rebound.time_s));
        stopped.or_else(|| self.unstopped.map(|unstopped| (unstopped.velocity_m_per_s, unstopped.time_s)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(v: &[f64], x: &[f64]) -> CrashEvents {
        crash_events(&Signal::new(0.0, 0.5, v.to_vec()).unwrap(), &Signal::new(0.0, 0.5, x.to_vec()).unwrap(), 0.0)
            .unwrap()
    }

    #[test]
    fn the_first_zero_counts_and_later_ones_are_listed() {
        let events = motion(&[2.0, 1.0, -1.0, -2.0, 2.0], &[0.0, 0.75, 0.75, 0.0, 0.0]);
        // Halfway between 0.5 s and 1.0 s: literals, exact in binary.
        assert_eq!(events.crush, Some(DynamicCrush { time_s: 0.75, displacement_m: 0.875, index: 2 }));
        let rebound = events.rebound.unwrap();
        assert_eq!((rebound.velocity_m_per_s, rebound.time_s, rebound.still_separating), (-2.0, 1.5, false));
        assert_eq!(events.later_zeros_s, [1.75]);
        assert_eq!(events.restitution(4.0), Some(0.5));
        assert_eq!(events.delta_v_m_per_s(4.0), Some(6.0));
    }

    #[test]
    fn a_velocity_that_stays_positive_has_no_crush_and_no_rebound() {
        let events = motion(&[2.0, 1.0, 0.5], &[0.0, 0.75, 1.125]);
        assert_eq!((events.crush, events.rebound), (None, None));
        assert_eq!(events.end_velocity_m_per_s, 0.5);
        assert_eq!((events.restitution(2.0), events.delta_v_m_per_s(2.0)), (None, None));
    }

    #[test]
    fn a_minimum_at_the_last_sample_is_still_separating() {
        assert!(motion(&[1.0, -1.0, -2.0], &[0.0; 3]).rebound.unwrap().still_separating);
    }

    #[test]
    fn a_vehicle_that_stops_dead_has_no_restitution() {
        let events = motion(&[1.0, 0.0, 0.0], &[0.0, 0.25, 0.25]);
        assert_eq!(events.restitution(1.0), Some(0.0));
        assert!(!events.rebound.unwrap().still_separating);
    }

    #[test]
    fn refuses_velocity_and_displacement_of_different_lengths() {
        let error = crash_events(
            &Signal::new(0.0, 0.5, vec![1.0, 0.0]).unwrap(),
            &Signal::new(0.0, 0.5, vec![1.0]).unwrap(),
            0.0,
        )
        .unwrap_err();
        assert_eq!(
            error.to_string(),
            "the velocity has 2 samples from 0 s, the displacement has 1 from 0 s: one grid is needed"
        );
    }
}
