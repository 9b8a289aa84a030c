//! The motion of a vehicle from its acceleration and impact speed: where the integration starts, and drift that a known
//! velocity shows.

use serde::{Deserialize, Serialize};

use crate::summation::sum_twice;
use crate::{Acceleration, Displacement, IntegrateError, IntegrationRule, Signal, Velocity, moves_before_contact};

/// Where the integration starts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum IntegrationStart {
    /// Record-start for a channel that carries a frequency class and has samples before time zero; time-zero otherwise,
    /// and for what falls or brakes until then, whose speed is the one at contact.
    #[default]
    Auto,
    /// At time zero with the impact speed: right for an unfiltered record, whose jump at contact is at its place.
    TimeZero,
    /// At the first sample with the impact speed, displacement shifted to zero at time zero: right for a filtered
    /// record, whose jump at contact is spread to both sides of time zero.
    RecordStart,
}

/// Where the integration did start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UsedStart {
    /// At time zero.
    TimeZero,
    /// At the first sample.
    RecordStart,
}

/// The start that was used, to be used again.
impl From<UsedStart> for IntegrationStart {
    fn from(used: UsedStart) -> Self {
        match used {
            UsedStart::TimeZero => Self::TimeZero,
            UsedStart::RecordStart => Self::RecordStart,
        }
    }
}

impl IntegrationStart {
    /// What `auto` means for a record. A filter without phase puts half of a jump at contact before time zero; starting
    /// there loses 0.05 m/s for a jump of 10 g at CFC 60 and, in a Kelvin model fitted to it, 2 % of the damping.
    pub fn resolve(self, low_pass_filtered: bool, samples_before_contact: usize, moves: bool) -> UsedStart {
        match self {
            Self::RecordStart => UsedStart::RecordStart,
            Self::Auto if low_pass_filtered && samples_before_contact > 0 && !moves => UsedStart::RecordStart,
            Self::Auto | Self::TimeZero => UsedStart::TimeZero,
        }
    }
}

impl UsedStart {
    /// The name used in artifacts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::TimeZero => "time-zero",
            Self::RecordStart => "record-start",
        }
    }
}

/// A sample this close to time zero is at time zero, in sampling intervals: rounding of decimal time stamps.
pub(crate) const ON_GRID: f64 = 1e-6;

/// How an acceleration is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntegrationSettings {
    /// Summation rule.
    pub rule: IntegrationRule,
    /// First sample of the sum.
    pub start: IntegrationStart,
    /// Impact speed v0, m/s; 0 for a motion from rest.
    pub impact_speed_m_per_s: f64,
    /// Whether the acceleration went through a low-pass filter; decides what [`IntegrationStart::Auto`] means.
    pub low_pass_filtered: bool,
}

/// Motion of the vehicle from the start of the integration; three signals on one grid, which is the record's.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// The acceleration that was integrated.
    pub acceleration: Signal<Acceleration>,
    /// Velocity.
    pub velocity: Signal<Velocity>,
    /// Displacement, zero at time zero: crush while the vehicle is in contact.
    pub displacement: Signal<Displacement>,
    /// Where the integration started.
    pub start: UsedStart,
}

/// Integrates an acceleration twice.
///
/// From time zero: `v = v0`, `x = 0` at time zero; between samples the acceleration is taken as linear, so that a
/// time zero off the grid costs one shorter first step. Where the record starts up to one interval after time zero,
/// the speed is held until then.
///
/// From the start of the record: `v = v0` at the first sample, and the displacement is shifted so that it is zero at
/// time zero. For a low-pass filtered record, because the filter puts half of a jump at contact before time zero, and
/// starting there would lose that half's change of velocity (some 0.05 m/s at CFC 60 for a jump of 10 g). The price
/// is that a wrong zero level acts for longer: remove it first.
///
/// Times are seconds from contact, which need not be on the grid of the samples.
///
/// How wrong it is: by the rule, O(T²) and below 0.01 mm of crush for the trapezoid at 10 kHz; by the inputs as in
/// `docs/methods/integration.md`. On four channels of a real barrier test the start with the record costs 0.5 to 0.7
/// mm of crush by what zero level and noise do before the event.
///
/// # Errors
/// An impact speed that is negative or no number; fewer than two samples at or after time zero; a record that starts
/// more than one interval after it; sums that leave the range of numbers.
pub fn integrate(
    acceleration: &Signal<Acceleration>,
    settings: &IntegrationSettings,
) -> Result<Motion, IntegrateError> {
    integrate_reporting(acceleration, settings, |_| ())
}

/// [`integrate`] with a report of progress, in samples. Memory: velocity and displacement; the acceleration is shared.
pub fn integrate_reporting(
    acceleration: &Signal<Acceleration>,
    settings: &IntegrationSettings,
    report: impl FnMut(u64),
) -> Result<Motion, IntegrateError> {
    integrate_from(acceleration, settings, LateRecord::Refused, report)
}

/// What happens to a record that starts more than one interval after time zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LateRecord {
    /// It is refused: its velocity at the first sample is not known.
    Refused,
    /// The impact speed is held until the first sample.
    Held,
}

/// [`integrate_reporting`] with a choice of what happens to a late record.
pub fn integrate_from(
    acceleration: &Signal<Acceleration>,
    settings: &IntegrationSettings,
    late: LateRecord,
    report: impl FnMut(u64),
) -> Result<Motion, IntegrateError> {
    let &IntegrationSettings { rule, impact_speed_m_per_s: v0, .. } = settings;
    if !(v0.is_finite() && v0 >= 0.0) {
        return Err(IntegrateError::ImpactSpeed(v0));
    }
    let dt_s = acceleration.dt_s();
    let zero = acceleration.index_at_or_after(0.0);
    // Time from time zero to the sample at or after it.
    let gap_s = acceleration.time_s(zero);
    let gap_s = if gap_s < ON_GRID * dt_s { 0.0 } else { gap_s };
    let too_late = gap_s > dt_s * (1.0 + ON_GRID) && (late == LateRecord::Refused || gap_s.is_infinite());
    if zero + 2 > acceleration.len() || gap_s.is_nan() || too_late {
        let (first_s, last_s) = (acceleration.t0_s(), acceleration.end_s());
        return Err(IntegrateError::NoContact { first_s, last_s });
    }

    let moves = moves_before_contact(acceleration);
    let start = settings.start.resolve(settings.low_pass_filtered, zero, moves);
    let from = match start {
        UsedStart::TimeZero => zero,
        UsedStart::RecordStart => 0,
    };
    let part = acceleration.slice(from, acceleration.len());
    let (mut velocity, mut displacement) = (vec![0.0; part.len()], vec![0.0; part.len()]);
    let outputs = (velocity.as_chunks_mut::<1>().0, displacement.as_chunks_mut::<1>().0);
    let grid = ContactGrid { dt_s, zero, gap_s };
    grid.integrate(acceleration.samples().as_chunks::<1>().0, (rule, start), v0, outputs, report);
    let (t0_s, dt_s) = (part.t0_s(), part.dt_s());
    Ok(Motion {
        velocity: Signal::new(t0_s, dt_s, velocity)?,
        displacement: Signal::new(t0_s, dt_s, displacement)?,
        acceleration: part.into(),
        start,
    })
}

/// Where time zero lies among the samples of an acceleration.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactGrid {
    pub dt_s: f64,
    /// First sample at or after time zero.
    pub zero: usize,
    /// Its time after time zero, s.
    pub gap_s: f64,
}

impl ContactGrid {
    /// Velocities and displacements of N accelerations on the grid, from the start on: as many as the samples from
    /// there.
    #[inline(always)]
    pub(crate) fn integrate<const N: usize>(
        self,
        a: &[[f64; N]],
        (rule, start): (IntegrationRule, UsedStart),
        v0: f64,
        (velocity, displacement): (&mut [[f64; N]], &mut [[f64; N]]),
        report: impl FnMut(u64),
    ) {
        let Self { dt_s, zero, gap_s } = self;
        if start == UsedStart::TimeZero || zero == 0 {
            let first = self.first_step(a, rule, v0);
            sum_twice(&a[zero.min(a.len())..], dt_s, rule, first, (velocity, displacement), report);
            return;
        }
        sum_twice(a, dt_s, rule, [[v0; N], [0.0; N]], (&mut *velocity, &mut *displacement), report);
        if zero >= displacement.len() {
            return;
        }
        let mut x_zero = [0.0; N];
        for lane in 0..N {
            // Displacement at time zero, the velocity taken as linear between the samples around it.
            let (before, after) = (velocity[zero - 1][lane], velocity[zero][lane]);
            let v_zero = after - (after - before) * gap_s / dt_s;
            x_zero[lane] = displacement[zero][lane] - gap_s * (after + v_zero) / 2.0;
        }
        for x in displacement {
            for lane in 0..N {
                x[lane] -= x_zero[lane];
            }
        }
    }

    /// Velocities (m/s) and displacements (m) at the first sample at or after time zero.
    ///
    /// The acceleration at time zero is interpolated between the samples around it, and the step of `gap_s` goes by the
    /// rule; Simpson's takes the trapezoid for it. Without a sample before time zero the speed is held: `[v0,
    /// v0·gap_s]`.
    #[inline(always)]
    fn first_step<const N: usize>(self, a: &[[f64; N]], rule: IntegrationRule, v0: f64) -> [[f64; N]; 2] {
        let Self { dt_s, zero, gap_s } = self;
        let mut first = [[v0; N], [v0 * gap_s; N]];
        if gap_s == 0.0 || zero == 0 || zero >= a.len() {
            return first;
        }
        for lane in 0..N {
            let (before, after) = (a[zero - 1][lane], a[zero][lane]);
            let at_zero = after - (after - before) * gap_s / dt_s;
            (first[0][lane], first[1][lane]) = match rule {
                // One interval in part is too little for a parabola.
                IntegrationRule::Trapezoid | IntegrationRule::Simpson => {
                    let v = v0 + gap_s * (at_zero + after) / 2.0;
                    (v, gap_s * (v0 + v) / 2.0)
                }
                IntegrationRule::ForwardEuler => (v0 + gap_s * at_zero, gap_s * v0),
            };
        }
        first
    }
}

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

/// What is known of a motion from elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum KnownEnd {
    /// Its velocity, m/s.
    #[serde(rename = "velocity_m_per_s")]
    Velocity(f64),
    /// Its displacement from contact on, m.
    #[serde(rename = "displacement_m")]
    Displacement(f64),
}

/// A velocity or a displacement known from elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EndCondition {
    /// What is known.
    #[serde(flatten)]
    pub known: KnownEnd,
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
    /// What the drift has gathered up to then: the velocity (m/s) or displacement (m) there without the correction less
    /// the one known.
    pub gap: f64,
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

/// Integrates an acceleration less the drift that brings its velocity, or displacement, to the one known.
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
/// has changed the path by `-c·t²/2` (bias) or `-c·t³/(6·τ)` (linear). A known displacement is met in the same way,
/// with the displacement that a drift of 1 m/s² gathers.
///
/// # Errors
/// Those of [`integrate`], and where the condition is not after the first sample of the motion and up to its last; that
/// of a displacement, which is 0 at contact, not after contact.
pub fn integrate_without_drift(
    acceleration: &Signal<Acceleration>,
    settings: &IntegrationSettings,
    end: EndCondition,
) -> Result<(Motion, Drift), IntegrateError> {
    // The start of the record as it is: a drift taken out must not look like braking before contact.
    let settings = IntegrationSettings { start: integrate(acceleration, settings)?.start.into(), ..*settings };
    without_drift(acceleration, &settings, end, |acceleration| integrate(acceleration, &settings))
}

/// [`integrate_without_drift`] with the integration given, which is that of `settings`. It is called three times: on
/// the record, on the drift of unit size, on the corrected record.
pub fn without_drift(
    acceleration: &Signal<Acceleration>,
    settings: &IntegrationSettings,
    end: EndCondition,
    integrate: impl Fn(&Signal<Acceleration>) -> Result<Motion, IntegrateError>,
) -> Result<(Motion, Drift), IntegrateError> {
    let first = integrate(acceleration)?;
    let start_s = first.velocity.t0_s();
    let last = first.velocity.len() - 1;
    let asked_s = end.time_s.unwrap_or_else(|| first.velocity.end_s());
    let index = first.velocity.index_at_or_after(asked_s);
    let is_of_contact = matches!(end.known, KnownEnd::Displacement(_)) && asked_s <= 0.0;
    if !asked_s.is_finite() || index == 0 || index > last || is_of_contact {
        return Err(IntegrateError::EndCondition { time_s: asked_s, first_s: start_s, last_s: first.velocity.end_s() });
    }
    let time_s = first.velocity.time_s(index);
    // What is known there, and what it is without any acceleration.
    let (known, without, of): (f64, f64, fn(&Motion, usize) -> f64) = match end.known {
        KnownEnd::Velocity(v) => (v, settings.impact_speed_m_per_s, |motion, k| motion.velocity.samples()[k]),
        KnownEnd::Displacement(x) => {
            (x, settings.impact_speed_m_per_s * time_s, |motion, k| motion.displacement.samples()[k])
        }
    };
    let gap = of(&first, index) - known;
    drop(first);

    let unit = |t_s: f64| match end.shape {
        DriftShape::Bias => 1.0,
        DriftShape::Linear => ((t_s - start_s) / (time_s - start_s)).max(0.0),
    };
    let shape = acceleration.with_samples(acceleration.times_s().map(unit).collect())?;
    // What a drift of one m/s² does there, by the same rule from the same start.
    let c = gap / (of(&integrate(&shape)?, index) - without);
    let corrected = acceleration.samples().iter().zip(shape.samples()).map(|(a, s)| a - c * s).collect();
    let motion = integrate(&acceleration.with_samples(corrected)?)?;
    Ok((motion, Drift { acceleration_m_per_s2: c, gap, time_s, shape: end.shape }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn auto_starts_early_only_where_contact_is_spread_and_the_record_shows_it() {
        assert_eq!(IntegrationStart::Auto.resolve(true, 200, false), UsedStart::RecordStart);
        assert_eq!(IntegrationStart::Auto.resolve(true, 0, false), UsedStart::TimeZero);
        assert_eq!(IntegrationStart::Auto.resolve(false, 200, false), UsedStart::TimeZero);
        assert_eq!(IntegrationStart::TimeZero.resolve(true, 200, false), UsedStart::TimeZero);
        assert_eq!(IntegrationStart::RecordStart.resolve(false, 0, false), UsedStart::RecordStart);
        assert_eq!(IntegrationStart::Auto.resolve(true, 200, true), UsedStart::TimeZero);
    }

    fn settings(start: IntegrationStart) -> IntegrationSettings {
        IntegrationSettings {
            rule: IntegrationRule::Trapezoid,
            start,
            impact_speed_m_per_s: 4.0,
            low_pass_filtered: true,
        }
    }

    fn constant(t0_s: f64) -> Signal<Acceleration> {
        Signal::new(t0_s, 0.5, vec![-2.0; 6]).unwrap()
    }

    #[test]
    fn from_time_zero_the_motion_starts_there_on_the_record_s_grid() {
        let motion = integrate(&constant(-1.0), &settings(IntegrationStart::TimeZero)).unwrap();
        assert_eq!((motion.velocity.t0_s(), motion.start), (0.0, UsedStart::TimeZero));
        assert_eq!(motion.velocity.samples(), [4.0, 3.0, 2.0, 1.0]);
        assert_eq!(motion.displacement.samples(), [0.0, 1.75, 3.0, 3.75]);
        assert_eq!(motion.acceleration.len(), 4);
    }

    #[test]
    fn from_the_record_s_start_the_displacement_is_zero_at_time_zero() {
        let motion = integrate(&constant(-1.0), &settings(IntegrationStart::Auto)).unwrap();
        assert_eq!((motion.velocity.t0_s(), motion.start), (-1.0, UsedStart::RecordStart));
        assert_eq!(motion.velocity.samples()[..3], [4.0, 3.0, 2.0]);
        assert_eq!(motion.displacement.samples()[..4], [-3.0, -1.25, 0.0, 0.75]);
    }

    #[test]
    fn a_time_zero_between_samples_is_met_exactly_by_a_constant_acceleration() {
        // v = 4 - 2t, x = 4t - t², contact between samples; binary values throughout.
        let motion = integrate(&constant(-0.75), &settings(IntegrationStart::TimeZero)).unwrap();
        assert_eq!((motion.velocity.t0_s(), motion.velocity.samples()[0]), (0.25, 3.5));
        assert_eq!(motion.displacement.samples()[0], 0.9375);
        // From the record's start the speed is 4 there, 2.5 at time zero, and x = 0 there.
        let motion = integrate(&constant(-0.75), &settings(IntegrationStart::RecordStart)).unwrap();
        assert_eq!(motion.displacement.samples()[2], 0.25 * (2.5 + 2.0) / 2.0);
    }

    #[test]
    fn a_record_that_starts_one_sample_late_holds_the_speed_until_then() {
        let motion = integrate(&constant(0.5), &settings(IntegrationStart::Auto)).unwrap();
        assert_eq!((motion.velocity.samples()[0], motion.displacement.samples()[0]), (4.0, 2.0));
    }

    #[test]
    fn refuses_a_record_without_time_zero() {
        for t0_s in [0.75, -2.25, -99.0] {
            let result = integrate(&constant(t0_s), &settings(IntegrationStart::TimeZero));
            assert!(matches!(result, Err(IntegrateError::NoContact { .. })), "{t0_s}: {result:?}");
        }
        let empty = Signal::new(0.0, 0.5, vec![]).unwrap();
        assert!(integrate(&empty, &settings(IntegrationStart::RecordStart)).is_err());
    }

    #[test]
    fn a_motion_from_rest_is_its_change_of_velocity() {
        let from_rest = IntegrationSettings { impact_speed_m_per_s: 0.0, ..settings(IntegrationStart::TimeZero) };
        let motion = integrate(&constant(-1.0), &from_rest).unwrap();
        assert_eq!(motion.velocity.samples(), [0.0, -1.0, -2.0, -3.0]);
    }

    #[test]
    fn refuses_an_impact_speed_that_is_none() {
        for v0 in [-4.0, f64::NAN, f64::INFINITY] {
            let settings = IntegrationSettings { impact_speed_m_per_s: v0, ..settings(IntegrationStart::Auto) };
            assert!(matches!(integrate(&constant(-1.0), &settings), Err(IntegrateError::ImpactSpeed(_))));
        }
    }

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
        for rule in IntegrationRule::ALL {
            for (start, shape) in [
                (IntegrationStart::RecordStart, DriftShape::Bias),
                (IntegrationStart::RecordStart, DriftShape::Linear),
                (IntegrationStart::TimeZero, DriftShape::Bias),
            ] {
                let settings = IntegrationSettings { rule, start, impact_speed_m_per_s: 10.0, low_pass_filtered: true };
                let clean = integrate(&drifting(0.0, shape), &settings).unwrap();
                let stated = *clean.velocity.samples().last().unwrap();
                let end = EndCondition { known: KnownEnd::Velocity(stated), time_s: None, shape };
                let (motion, drift) = integrate_without_drift(&drifting(0.7, shape), &settings, end).unwrap();
                // Linear in c: rounding of 2500 sums only.
                assert!((drift.acceleration_m_per_s2 - 0.7).abs() < 1e-9, "{rule:?} {start:?} {drift:?}");
                assert!((motion.velocity.samples().last().unwrap() - stated).abs() < 1e-10);
                for (x, y) in motion.displacement.samples().iter().zip(clean.displacement.samples()) {
                    assert!((x - y).abs() < 1e-10);
                }
                let way = *clean.displacement.samples().last().unwrap();
                let end = EndCondition { known: KnownEnd::Displacement(way), ..end };
                let (motion, drift) = integrate_without_drift(&drifting(0.7, shape), &settings, end).unwrap();
                assert!((drift.acceleration_m_per_s2 - 0.7).abs() < 1e-9, "{rule:?} {start:?} {drift:?}");
                assert!((motion.displacement.samples().last().unwrap() - way).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn refuses_a_condition_outside_the_motion() {
        let settings = IntegrationSettings {
            rule: IntegrationRule::Trapezoid,
            start: IntegrationStart::TimeZero,
            impact_speed_m_per_s: 10.0,
            low_pass_filtered: false,
        };
        for time_s in [-0.01, 0.0, 0.3, f64::NAN] {
            let end = EndCondition { known: KnownEnd::Velocity(0.0), time_s: Some(time_s), shape: DriftShape::Bias };
            let result = integrate_without_drift(&drifting(0.0, DriftShape::Bias), &settings, end);
            assert!(matches!(result, Err(IntegrateError::EndCondition { .. })), "{time_s}: {result:?}");
        }
    }
}
