//! Velocity and displacement from an acceleration and the impact speed.

use crumple_signal::{Acceleration, Displacement, Signal, Velocity, falls_before_event};

use crate::{IntegrateError, Rule, Start, UsedStart, integrate_twice_into};

/// A sample this close to time zero is at time zero, in sampling intervals: rounding of decimal time stamps.
const ON_GRID: f64 = 1e-6;

/// How an acceleration is integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Summation rule.
    pub rule: Rule,
    /// First sample of the sum.
    pub start: Start,
    /// Time zero on the record's axis, s.
    pub time_zero_s: f64,
    /// Impact speed v0, m/s; 0 for a motion from rest.
    pub impact_speed_m_per_s: f64,
    /// Whether the acceleration went through a low-pass filter; decides what [`Start::Auto`] means.
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
/// The samples stay where they are: a time zero other than 0 s is an offset, not a new grid.
///
/// How wrong it is: by the rule, O(T²) and below 0.01 mm of crush for the trapezoid at 10 kHz; by the inputs as in the
/// table of the crate. On four channels of a real barrier test the start with the record costs 0.5 to 0.7 mm of crush
/// by what zero level and noise do before the event.
///
/// # Errors
/// An impact speed that is negative or no number; fewer than two samples at or after time zero; a record that starts
/// more than one interval after it; sums that leave the range of numbers.
pub fn integrate(acceleration: &Signal<Acceleration>, settings: &Settings) -> Result<Motion, IntegrateError> {
    integrate_reporting(acceleration, settings, |_| ())
}

/// [`integrate`] with a report of progress, in samples. Memory: velocity and displacement; the acceleration is shared.
pub fn integrate_reporting(
    acceleration: &Signal<Acceleration>,
    settings: &Settings,
    report: impl FnMut(u64),
) -> Result<Motion, IntegrateError> {
    integrate_from(acceleration, settings, Late::Refused, report)
}

/// What happens to a record that starts more than one interval after time zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Late {
    /// It is refused: its velocity at the first sample is not known.
    Refused,
    /// The impact speed is held until the first sample.
    Held,
}

/// [`integrate_reporting`] with a choice of what happens to a late record.
pub(crate) fn integrate_from(
    acceleration: &Signal<Acceleration>,
    settings: &Settings,
    late: Late,
    report: impl FnMut(u64),
) -> Result<Motion, IntegrateError> {
    let &Settings { rule, time_zero_s, impact_speed_m_per_s: v0, .. } = settings;
    if !(v0.is_finite() && v0 >= 0.0) {
        return Err(IntegrateError::ImpactSpeed(v0));
    }
    let dt_s = acceleration.dt_s();
    let zero = acceleration.index_at_or_after(time_zero_s);
    // Time from time zero to the sample at or after it.
    let gap_s = acceleration.time_s(zero) - time_zero_s;
    let gap_s = if gap_s < ON_GRID * dt_s { 0.0 } else { gap_s };
    let too_late = gap_s > dt_s * (1.0 + ON_GRID) && (late == Late::Refused || gap_s.is_infinite());
    if zero + 2 > acceleration.len() || gap_s.is_nan() || too_late {
        let (first_s, last_s) = (acceleration.t0_s(), acceleration.end_s());
        return Err(IntegrateError::TimeZero { time_zero_s, first_s, last_s });
    }

    let falls = falls_before_event(acceleration);
    let start = settings.start.resolve(settings.low_pass_filtered, zero, falls);
    let from = match start {
        UsedStart::TimeZero => zero,
        UsedStart::RecordStart => 0,
    };
    let part = acceleration.slice(from, acceleration.len());
    let a = part.samples();
    let (mut velocity, mut displacement) = (Vec::new(), Vec::new());
    let outputs = (&mut velocity, &mut displacement);
    if from == zero {
        integrate_twice_into(a, dt_s, rule, first_step(acceleration, zero, gap_s, settings), outputs, report);
    } else {
        integrate_twice_into(a, dt_s, rule, [v0, 0.0], outputs, report);
        let (v, x) = (&velocity, &mut displacement);
        // Displacement at time zero, the velocity taken as linear between the samples around it.
        let v_zero = v[zero] - (v[zero] - v[zero - 1]) * gap_s / dt_s;
        let x_zero = x[zero] - gap_s * (v[zero] + v_zero) / 2.0;
        x.iter_mut().for_each(|x| *x -= x_zero);
    }
    let (t0_s, dt_s) = (part.t0_s(), part.dt_s());
    Ok(Motion {
        velocity: Signal::new(t0_s, dt_s, velocity)?,
        displacement: Signal::new(t0_s, dt_s, displacement)?,
        acceleration: part.into(),
        start,
    })
}

/// Velocity (m/s) and displacement (m) at the first sample at or after time zero, `gap_s` after it.
///
/// The acceleration at time zero is interpolated between the samples around it, and the step of `gap_s` goes by the
/// rule; Simpson's takes the trapezoid for it. Without a sample before time zero the speed is held: `[v0, v0·gap_s]`.
fn first_step(acceleration: &Signal<Acceleration>, zero: usize, gap_s: f64, settings: &Settings) -> [f64; 2] {
    let v0 = settings.impact_speed_m_per_s;
    if gap_s == 0.0 || zero == 0 {
        return [v0, v0 * gap_s];
    }
    let (before, after) = (acceleration.samples()[zero - 1], acceleration.samples()[zero]);
    let at_zero = after - (after - before) * gap_s / acceleration.dt_s();
    match settings.rule {
        // One interval in part is too little for a parabola.
        Rule::Trapezoid | Rule::Simpson => {
            let v = v0 + gap_s * (at_zero + after) / 2.0;
            [v, gap_s * (v0 + v) / 2.0]
        }
        Rule::ForwardEuler => [v0 + gap_s * at_zero, gap_s * v0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(start: Start, time_zero_s: f64) -> Settings {
        Settings { rule: Rule::Trapezoid, start, time_zero_s, impact_speed_m_per_s: 4.0, low_pass_filtered: true }
    }

    fn constant(t0_s: f64) -> Signal<Acceleration> {
        Signal::new(t0_s, 0.5, vec![-2.0; 6]).unwrap()
    }

    #[test]
    fn from_time_zero_the_motion_starts_there_on_the_record_s_grid() {
        let motion = integrate(&constant(-1.0), &settings(Start::TimeZero, 0.0)).unwrap();
        assert_eq!((motion.velocity.t0_s(), motion.start), (0.0, UsedStart::TimeZero));
        assert_eq!(motion.velocity.samples(), [4.0, 3.0, 2.0, 1.0]);
        assert_eq!(motion.displacement.samples(), [0.0, 1.75, 3.0, 3.75]);
        assert_eq!(motion.acceleration.len(), 4);
    }

    #[test]
    fn from_the_record_s_start_the_displacement_is_zero_at_time_zero() {
        let motion = integrate(&constant(-1.0), &settings(Start::Auto, 0.0)).unwrap();
        assert_eq!((motion.velocity.t0_s(), motion.start), (-1.0, UsedStart::RecordStart));
        assert_eq!(motion.velocity.samples()[..3], [4.0, 3.0, 2.0]);
        assert_eq!(motion.displacement.samples()[..4], [-3.0, -1.25, 0.0, 0.75]);
    }

    #[test]
    fn a_time_zero_between_samples_is_met_exactly_by_a_constant_acceleration() {
        // v = 4 - 2τ, x = 4τ - τ², τ from time zero at -0.25 s; binary values throughout.
        let motion = integrate(&constant(-1.0), &settings(Start::TimeZero, -0.25)).unwrap();
        assert_eq!((motion.velocity.t0_s(), motion.velocity.samples()[0]), (0.0, 3.5));
        assert_eq!(motion.displacement.samples()[0], 0.9375);
        // From the record's start the speed is 4 there, 2.5 at time zero, and x = 0 there.
        let motion = integrate(&constant(-1.0), &settings(Start::RecordStart, -0.25)).unwrap();
        assert_eq!(motion.displacement.samples()[2], 0.25 * (2.5 + 2.0) / 2.0);
    }

    #[test]
    fn a_record_that_starts_one_sample_late_holds_the_speed_until_then() {
        let motion = integrate(&constant(0.5), &settings(Start::Auto, 0.0)).unwrap();
        assert_eq!((motion.velocity.samples()[0], motion.displacement.samples()[0]), (4.0, 2.0));
    }

    #[test]
    fn refuses_a_record_without_time_zero() {
        for (t0_s, time_zero_s) in [(0.75, 0.0), (0.0, 2.25), (0.0, 99.0), (0.0, f64::NAN)] {
            let result = integrate(&constant(t0_s), &settings(Start::TimeZero, time_zero_s));
            assert!(matches!(result, Err(IntegrateError::TimeZero { .. })), "{t0_s} {time_zero_s}: {result:?}");
        }
        let empty = Signal::new(0.0, 0.5, vec![]).unwrap();
        assert!(integrate(&empty, &settings(Start::RecordStart, 0.0)).is_err());
    }

    #[test]
    fn a_motion_from_rest_is_its_change_of_velocity() {
        let from_rest = Settings { impact_speed_m_per_s: 0.0, ..settings(Start::TimeZero, 0.0) };
        let motion = integrate(&constant(-1.0), &from_rest).unwrap();
        assert_eq!(motion.velocity.samples(), [0.0, -1.0, -2.0, -3.0]);
    }

    #[test]
    fn refuses_an_impact_speed_that_is_none() {
        for v0 in [-4.0, f64::NAN, f64::INFINITY] {
            let settings = Settings { impact_speed_m_per_s: v0, ..settings(Start::Auto, 0.0) };
            assert!(matches!(integrate(&constant(-1.0), &settings), Err(IntegrateError::ImpactSpeed(_))));
        }
    }
}
