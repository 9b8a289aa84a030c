//! Takes out the drift that a known velocity shows.

use crumple_signal::{Acceleration, Signal};
use serde::{Deserialize, Serialize};

use crate::{IntegrateError, Motion, Settings, integrate};

/// What is taken to be wrong with the acceleration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum DriftShape {
    /// A constant zero level: the velocity drifts along a straight line.
    #[default]
    Bias,
    /// A zero level that grows from nothing: the velocity drifts along a parabola.
    Linear,
}

/// A velocity known from elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EndCondition {
    /// The velocity, m/s.
    pub velocity_m_per_s: f64,
    /// When, on the record's time axis, s; `None`: at the last sample.
    pub time_s: Option<f64>,
    /// What is taken to be wrong.
    pub shape: DriftShape,
}

/// A correction of drift, as applied.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// Subtracted from the acceleration, m/s²; for [`DriftShape::Linear`] its value at the time of the condition.
    pub acceleration_m_per_s2: f64,
    /// Velocity there without the correction less the stated one, m/s: what the drift has gathered up to then.
    pub velocity_gap_m_per_s: f64,
    /// Time of the condition, that of a sample, s on the record's time axis.
    pub time_s: f64,
    /// What was taken to be wrong.
    pub shape: DriftShape,
}

impl DriftShape {
    /// The name used in notes.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bias => "bias",
            Self::Linear => "linear",
        }
    }
}

/// Integrates an acceleration less the drift that brings its velocity to the one stated.
///
/// The drift is `c` (bias) or `c·(t - t_start)/(t_end - t_start)` (linear) from the start of the integration on, with
/// the one `c` for which the velocity at the end condition is met with the rule in use. It hides every other error too:
/// a wrong gain, impact speed or time zero comes out as a bias. So it is never applied unasked, and its size is
/// reported. The acceleration of the result is the corrected one.
///
/// Every rule of summation is linear in the acceleration, so `c = gap/effect` with the velocity that a drift of 1 m/s²
/// gathers up to the condition by the same rule from the same start: about the time τ between the two for a bias, τ/2
/// for a linear drift. One solution, no iteration; the velocity is met to rounding (1e-10 m/s over 2500 samples). The
/// condition is moved to the sample at or after its time. A time t after the start of the integration the correction
/// has changed the path by `-c·t²/2` (bias) or `-c·t³/(6·τ)` (linear).
///
/// # Errors
/// As of [`integrate`], and where the condition is not after the first sample of the motion and up to its last.
pub fn integrate_without_drift(
    acceleration: &Signal<Acceleration>,
    settings: &Settings,
    end: EndCondition,
) -> Result<(Motion, Drift), IntegrateError> {
    without_drift(acceleration, settings, end, |acceleration| integrate(acceleration, settings))
}

/// [`integrate_without_drift`] with the integration given, which is that of `settings`. It is called three times: on
/// the record, on the drift of unit size, on the corrected record.
pub(crate) fn without_drift(
    acceleration: &Signal<Acceleration>,
    settings: &Settings,
    end: EndCondition,
    integrate: impl Fn(&Signal<Acceleration>) -> Result<Motion, IntegrateError>,
) -> Result<(Motion, Drift), IntegrateError> {
    let first = integrate(acceleration)?;
    let start_s = first.velocity.t0_s();
    let last = first.velocity.len() - 1;
    let asked_s = end.time_s.unwrap_or_else(|| first.velocity.end_s());
    let index = first.velocity.index_at_or_after(asked_s);
    if !asked_s.is_finite() || index == 0 || index > last {
        return Err(IntegrateError::EndCondition { time_s: asked_s, first_s: start_s, last_s: first.velocity.end_s() });
    }
    let time_s = first.velocity.time_s(index);
    let velocity_gap_m_per_s = first.velocity.samples()[index] - end.velocity_m_per_s;
    drop(first);

    let unit = |t_s: f64| match end.shape {
        DriftShape::Bias => 1.0,
        DriftShape::Linear => ((t_s - start_s) / (time_s - start_s)).max(0.0),
    };
    let shape = acceleration.with_samples(acceleration.times_s().map(unit).collect())?;
    // What a drift of one m/s² does to the velocity there, by the same rule from the same start.
    let effect_s = integrate(&shape)?.velocity.samples()[index] - settings.impact_speed_m_per_s;
    let c = velocity_gap_m_per_s / effect_s;
    let corrected = acceleration.samples().iter().zip(shape.samples()).map(|(a, s)| a - c * s).collect();
    let motion = integrate(&acceleration.with_samples(corrected)?)?;
    Ok((motion, Drift { acceleration_m_per_s2: c, velocity_gap_m_per_s, time_s, shape: end.shape }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rule, Start};

    /// A half-sine pulse with a drift of known size.
    fn drifting(c: f64, shape: DriftShape) -> Signal<Acceleration> {
        let at = |t: f64| {
            let pulse = if (0.0..0.1).contains(&t) { -200.0 * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 };
            pulse + c * if shape == DriftShape::Bias { 1.0 } else { (t + 0.05) / 0.25 }
        };
        Signal::new(-0.05, 1e-4, (0..=2500).map(|k| at(f64::from(k) * 1e-4 - 0.05)).collect()).unwrap()
    }

    #[test]
    fn a_known_drift_is_found_and_taken_out_whatever_the_rule_and_the_start() {
        for rule in Rule::ALL {
            for (start, shape) in [
                (Start::RecordStart, DriftShape::Bias),
                (Start::RecordStart, DriftShape::Linear),
                (Start::TimeZero, DriftShape::Bias),
            ] {
                let settings =
                    Settings { rule, start, time_zero_s: 0.0, impact_speed_m_per_s: 10.0, low_pass_filtered: true };
                let clean = integrate(&drifting(0.0, shape), &settings).unwrap();
                let stated = *clean.velocity.samples().last().unwrap();
                let end = EndCondition { velocity_m_per_s: stated, time_s: None, shape };
                let (motion, drift) = integrate_without_drift(&drifting(0.7, shape), &settings, end).unwrap();
                // Linear in c: rounding of 2500 sums only.
                assert!((drift.acceleration_m_per_s2 - 0.7).abs() < 1e-9, "{rule:?} {start:?} {drift:?}");
                assert!((motion.velocity.samples().last().unwrap() - stated).abs() < 1e-10);
                for (x, y) in motion.displacement.samples().iter().zip(clean.displacement.samples()) {
                    assert!((x - y).abs() < 1e-10);
                }
            }
        }
    }

    #[test]
    fn refuses_a_condition_outside_the_motion() {
        let settings = Settings {
            rule: Rule::Trapezoid,
            start: Start::TimeZero,
            time_zero_s: 0.0,
            impact_speed_m_per_s: 10.0,
            low_pass_filtered: false,
        };
        for time_s in [-0.01, 0.0, 0.3, f64::NAN] {
            let end = EndCondition { velocity_m_per_s: 0.0, time_s: Some(time_s), shape: DriftShape::Bias };
            let result = integrate_without_drift(&drifting(0.0, DriftShape::Bias), &settings, end);
            assert!(matches!(result, Err(IntegrateError::EndCondition { .. })), "{time_s}: {result:?}");
        }
    }
}
