//! What an event data recorder kept of an impact: the largest changes of velocity, the energy that went into
//! deformation, the crush. Intervals are those of the steps in which the recorder keeps value and time, and of the
//! instrument.

use crumple_signal::{HALF_OF_90_PERCENT, Sampled, Signal, printed_step_m_per_s};

use crate::metric::definitions::{
    ABSORBED_SHARE, MAXIMUM_DELTA_V, MAXIMUM_LATERAL_DELTA_V, RECORDED_CRUSH, RECORDED_EES, TIME_OF_MAXIMUM_DELTA_V,
};
use crate::two_axes::{LAST_S, row_at_contact, total_and_direction};
use crate::{Definition, Interval, IntervalBy, Metric, PulseImpact, impacts, largest_restitution};

/// Standard deviation of a recorder's change of velocity over the change: 60 records of sled tests from 12 to 74 km/h
/// (Accuracy of an Electronic Crash Recorder, wbldb 10095243: no bias, 1.9 %). 49 CFR 563.8 allows 10 %.
const INSTRUMENT: f64 = 0.019;

/// Half width, m/s, of the 90 % interval of a change of velocity, m/s, that was rounded by up to `half_step`, m/s: the
/// rounding and the instrument are independent.
fn half_width(half_step: f64, change: f64) -> f64 {
    half_step.hypot(HALF_OF_90_PERCENT * INSTRUMENT * change)
}

/// Maximum delta-V and the time to it, of a cumulative change of velocity along one axis (49 CFR 563.5).
///
/// The sample of largest magnitude from contact, t = 0, to 300 ms after it, less the value at contact where the table
/// begins before it (one that begins at contact or later counts from there, whatever its first row), and its time;
/// the first of equals. The value keeps its sign: a frontal impact is negative. Its 90 % interval is that of the
/// instrument, and half of the step in which the recorder prints, twice that where a row before it is subtracted; that
/// of the time is half a sampling interval. A lower bound has none, nor has a value whose step is not known. The
/// trapezoid of an acceleration derived from the table would lose what the smoothing takes off the peak. Absent without
/// a sample at or after contact.
pub fn maximum_delta_v(change: &Sampled) -> [Metric; 2] {
    let v = change.samples();
    let slack_s = 1e-6 * change.dt_s();
    let (first, start) = row_at_contact(change);
    if first >= v.len() {
        return [&MAXIMUM_DELTA_V, &TIME_OF_MAXIMUM_DELTA_V]
            .map(|definition| Metric::absent(definition, "no sample at or after time zero"));
    }
    let counting = (first..v.len()).take_while(|k| change.time_s(*k) <= LAST_S + slack_s);
    let largest =
        counting.fold(first, |k, other| if (v[other] - start).abs() > (v[k] - start).abs() { other } else { k });
    let time_s = change.time_s(largest);
    let at = |metric: Metric| {
        let metric = metric.over(time_s, time_s);
        if largest + 1 == v.len() {
            metric.as_lower_bound("at the last sample of the table: a lower bound")
        } else {
            metric
        }
    };
    let within = |metric: Metric, half_width: Option<f64>| {
        let interval = metric.value.zip(half_width.filter(|_| largest + 1 < v.len())).map(|(value, half_width)| {
            Interval { low: value - half_width, high: value + half_width, by: IntervalBy::Resolution }
        });
        Metric { interval, ..metric }
    };
    let rounded_values = if start == 0.0 { 1.0 } else { 2.0 };
    let change_m_per_s = v[largest] - start;
    let half = printed_step_m_per_s(v).map(|step| half_width(0.5 * step * rounded_values, change_m_per_s));
    [
        within(at(Metric::with_value(&MAXIMUM_DELTA_V, change_m_per_s)), half),
        within(at(Metric::with_value(&TIME_OF_MAXIMUM_DELTA_V, time_s)), Some(0.5 * change.dt_s())),
    ]
}

/// The impacts of a cumulative change of velocity that a recorder kept: those that are events by themselves (8 km/h, 49
/// CFR 563.5), since in whole km/h every rounding looks like a small one.
pub fn impacts_of_table(change: &Sampled) -> Vec<PulseImpact> {
    let mut impacts = impacts(&Signal::from(change.clone()));
    impacts.retain(PulseImpact::is_event);
    impacts
}

/// A change of velocity along x, and where there is one along y, kept while a vehicle hit an object that does not give
/// way.
#[derive(Debug, Clone, Copy)]
pub struct RecordedImpact<'a> {
    /// Along x; a frontal impact is negative.
    pub along: &'a Sampled,
    /// Along y.
    pub across: Option<&'a Sampled>,
    /// Speed at contact, m/s, taken as exact; `None`: not known.
    pub impact_speed_m_per_s: Option<f64>,
}

/// Why a number is one.
const OF_A_BOUND: &str = "of a change that is a lower bound";

impl RecordedImpact<'_> {
    /// The largest change along y, the total of both axes and its direction; and where the recorder kept a loss of
    /// speed along x the energy-equivalent speed, with the impact speed the share of the kinetic energy and the
    /// crush.
    ///
    /// With the speed `v0`, the loss `D` and the change `y` across at the same time the energy-equivalent speed is
    /// `sqrt(v0² - (v0 - D)² - y²)`: rotation is left out. Without it `v0 = D/(1 + e)` makes `D·sqrt((1 - e)/(1 + e))`
    /// of it for a restitution `e`: the interval goes from the largest that is believed to none, the value is its
    /// middle.
    pub fn metrics(&self) -> Vec<Metric> {
        let mut metrics: Vec<Metric> = self.across.map(|y| self.lateral(y)).into_iter().collect();
        metrics.extend(self.across.into_iter().flat_map(|y| self.in_the_plane(y)));
        let [change, time] = maximum_delta_v(self.along);
        let Some((loss, time_s)) = change.value.map(|v| -v).zip(time.value).filter(|(loss, _)| *loss > 0.0) else {
            return metrics;
        };
        let bounded = |metric: Metric| if change.is_lower_bound { metric.as_lower_bound(OF_A_BOUND) } else { metric };
        let loss_range = change.interval.map(|i| [-i.high, -i.low]);
        match self.impact_speed_m_per_s {
            Some(v0) if v0 > 0.0 => {
                let energy = self.energy(v0, loss, loss_range, time_s);
                metrics.extend(energy.map(bounded));
                metrics.push(self.crush(v0));
            }
            _ => {
                let most = largest_restitution(loss / (1.0 + largest_restitution(loss)));
                let [low, high] = loss_range.unwrap_or([loss; 2]);
                let low = low * ((1.0 - most) / (1.0 + most)).sqrt();
                let interval = Some(Interval { low, high, by: IntervalBy::Restitution });
                let ees = Metric::with_value(&RECORDED_EES, (low + high) / 2.0).over(0.0, time_s);
                let interval = interval.filter(|_| !change.is_lower_bound);
                metrics.push(bounded(Metric { interval, ..ees }));
            }
        }
        metrics
    }

    /// The total of both axes and its direction; each of a table in steps is half of its step off, a difference of two
    /// rows the whole, and what the instrument adds to the largest change of its axis.
    fn in_the_plane(&self, across: &Sampled) -> [Metric; 3] {
        let half = |wave: &Sampled, other: &Sampled| {
            let step = printed_step_m_per_s(wave.samples()).or_else(|| printed_step_m_per_s(other.samples()))?;
            let half_step = if row_at_contact(wave).1 == 0.0 { 0.5 * step } else { step };
            Some(half_width(half_step, maximum_delta_v(wave)[0].value.unwrap_or_default()))
        };
        let half_steps = half(self.along, across).zip(half(across, self.along));
        total_and_direction(self.along, across, LAST_S, half_steps.map(|(x, y)| [x, y]))
    }

    fn lateral(&self, across: &Sampled) -> Metric {
        let [Metric { value, window, interval, is_lower_bound, .. }, _] = maximum_delta_v(across);
        let metric = Metric::of(&MAXIMUM_LATERAL_DELTA_V, value, "no sample at or after time zero");
        Metric { window, interval, is_lower_bound, ..metric }
    }

    /// What went into deformation up to the largest change, and its share of the kinetic energy.
    fn energy(&self, v0: f64, loss: f64, loss_range: Option<[f64; 2]>, time_s: f64) -> [Metric; 2] {
        let across = self.across.and_then(|y| {
            let (_, start) = row_at_contact(y);
            Some((y, y.at(time_s)? - start, if start == 0.0 { 0.5 } else { 1.0 }))
        });
        let y = across.map_or(0.0, |(_, y, _)| y.abs());
        // A column of zeros was printed as the other one.
        let step = |across: &Sampled| {
            printed_step_m_per_s(across.samples()).or_else(|| printed_step_m_per_s(self.along.samples()))
        };
        let half = across.map_or(Some(0.0), |(across, y, part)| step(across).map(|step| half_width(part * step, y)));
        let speed2 = |loss: f64, y: f64| v0 * v0 - (v0 - loss) * (v0 - loss) - y * y;
        // The square rises with the loss up to v0, and falls beyond.
        let range = loss_range.zip(half).map(|([low, high], half)| {
            let least = speed2(low, y + half).min(speed2(high, y + half)).max(0.0);
            [least, speed2(v0.clamp(low, high), (y - half).max(0.0)).max(0.0)]
        });
        let speed2 = Some(speed2(loss, y)).filter(|square| *square > 0.0);
        let metric = |definition: &Definition, of: &dyn Fn(f64) -> f64| {
            let reason = "more speed is left than there was: the impact speed does not belong to this table";
            let metric = Metric::of(definition, speed2.map(of), reason).over(0.0, time_s);
            let ends = metric.value.and(range).map(|ends| ends.map(of));
            let interval = ends.map(|[low, high]| Interval { low, high, by: IntervalBy::Resolution });
            Metric { interval, ..metric }
        };
        [metric(&RECORDED_EES, &f64::sqrt), metric(&ABSORBED_SHARE, &|square| square / (v0 * v0))]
    }

    /// The way from contact to the first zero of the velocity. Values that are half a step off all along move it by
    /// that times the duration, an instrument by its share of the way that the change took, a contact half a sampling
    /// interval off by that times the speed.
    fn crush(&self, v0: f64) -> Metric {
        let dt = self.along.dt_s();
        let (first, start) = row_at_contact(self.along);
        let samples = self.along.samples().get(first..).unwrap_or_default();
        let velocity: Vec<f64> = samples.iter().map(|change| v0 + change - start).collect();
        let is_moving = velocity.first().is_some_and(|v| *v > 0.0);
        // A table that begins after contact: its vehicle went on at its speed until then.
        let before_s = self.along.t0_s().max(0.0);
        let mut crush = v0 * before_s;
        for (k, pair) in velocity.windows(2).enumerate().take_while(|_| is_moving) {
            if pair[1] > 0.0 {
                crush += 0.5 * (pair[0] + pair[1]) * dt;
                continue;
            }
            let part = pair[0] / (pair[0] - pair[1]);
            crush += 0.5 * pair[0] * part * dt;
            let time_s = before_s + (k as f64 + part) * dt;
            let metric = Metric::with_value(&RECORDED_CRUSH, crush).over(0.0, time_s);
            let half = printed_step_m_per_s(samples)
                .map(|step| half_width(0.5 * step * time_s, v0 * time_s - crush) + 0.5 * dt * v0);
            let ends = half.map(|half| Interval {
                low: (crush - half).max(0.0),
                high: crush + half,
                by: IntervalBy::Resolution,
            });
            return Metric { interval: ends, ..metric };
        }
        Metric::absent(&RECORDED_CRUSH, "the velocity does not reach zero in the table")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(v: &[f64]) -> (Option<f64>, Option<f64>) {
        let [dv, time] = maximum_delta_v(&Sampled::new(-0.01, 0.01, v.to_vec()).unwrap());
        // Time stamps are sums of decimal fractions.
        (dv.value, time.value.map(|t| (1e9 * t).round() / 1e9))
    }

    #[test]
    fn the_interval_is_that_of_the_step_and_of_the_instrument() {
        let table = |km_per_h: &[f64]| -> Vec<f64> { km_per_h.iter().map(|v| v / 3.6).collect() };
        let interval = |km_per_h: &[f64]| {
            let wave = Sampled::new(-0.01, 0.01, table(km_per_h)).unwrap();
            maximum_delta_v(&wave).map(|metric| metric.interval.map(|i| (i.low, i.high)))
        };
        let near = |found: Option<(f64, f64)>, low: f64, high: f64| {
            let (a, b) = found.unwrap();
            assert!((a - low).abs() < 1e-9 && (b - high).abs() < 1e-9, "{a} to {b}");
        };
        let [change, time] = interval(&[0.0, 0.0, -3.0, -41.0, -40.0]);
        // Half a step and 1.645 times 1.9 % of the value.
        let ends = |km_per_h: f64, half_step: f64| {
            let half = half_step.hypot(1.644_853_627 * 0.019 * km_per_h) / 3.6;
            [km_per_h / 3.6 - half, km_per_h / 3.6 + half]
        };
        let [low, high] = ends(-41.0, 0.5);
        near(change, low, high);
        // 90 % of 1.9 %: 3.1 % to either side at least.
        assert!((high - low) / 2.0 > 0.031 * 41.0 / 3.6, "{low} to {high}");
        near(time, 0.015, 0.025);
        // Two rounded values.
        let [low, high] = ends(-40.0, 1.0);
        near(interval(&[0.0, -1.0, -3.0, -41.0, -40.0])[0], low, high);
        // Whole mph are no whole km/h.
        let mph = [0.0, 0.0, -7.0, -25.0, -24.0].map(|v| v * 1.609_344);
        let [low, high] = ends(-25.0 * 1.609_344, 0.5 * 1.609_344);
        near(interval(&mph)[0], low, high);
        assert_eq!(interval(&[0.0, 0.0, -3.151_592, -40.0])[0], None, "no step that is known");
        assert_eq!(interval(&[0.0, 0.0, -3.0, -40.0]), [None, None], "a lower bound");
    }

    #[test]
    fn the_first_sample_of_largest_magnitude_from_time_zero_on_counts() {
        assert_eq!(of(&[9.0, 0.0, -3.0, -5.0, -5.0, -4.0]), (Some(-5.0), Some(0.02)));
        assert_eq!(of(&[0.0, -1.0, -3.0, 4.0]).0, Some(5.0), "against the value at time zero");
        assert_eq!(of(&[0.0]), (None, None));
        // A table whose first row is 10 ms after contact has lost something by then.
        let [dv, _] = maximum_delta_v(&Sampled::new(0.01, 0.01, vec![-3.0, -40.5, -40.0]).unwrap());
        assert_eq!(dv.value, Some(-40.5));
        let late: Vec<f64> = (0..60).map(f64::from).collect();
        // Sample 1 is contact, sample 31 is 300 ms.
        let (dv, time) = of(&late);
        assert_eq!(dv, Some(30.0));
        assert!((time.unwrap() - 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_table_that_ends_while_the_velocity_changes_gives_a_bound() {
        let [dv, _] = maximum_delta_v(&Sampled::new(0.0, 0.01, vec![0.0, -1.0, -2.0]).unwrap());
        assert!(dv.definition.ends_with("a lower bound"), "{}", dv.definition);
    }

    #[test]
    fn two_impacts_of_a_table_are_two_whatever_its_step() {
        // 20 km/h within 100 ms, 250 ms of rest, 35 km/h within 120 ms: haversines of acceleration.
        let lost = |t: f64, length: f64| {
            let x = (t / length).clamp(0.0, 1.0);
            x - (std::f64::consts::TAU * x).sin() / std::f64::consts::TAU
        };
        for step in [1.0, 0.1, 0.01, 1.609_344] {
            for dt_s in [0.01, 0.005] {
                let at = |k: usize| {
                    let t = k as f64 * dt_s;
                    let change: f64 = -20.0 * lost(t, 0.1) - 35.0 * lost(t - 0.35, 0.12);
                    (change / step).round() * step / 3.6
                };
                let change = Sampled::new(0.0, dt_s, (0..(0.7 / dt_s) as usize).map(at).collect()).unwrap();
                let found = impacts_of_table(&change);
                let [one, two] = found.as_slice() else { panic!("{step} {dt_s}: {found:?}") };
                let near = |impact: &PulseImpact, km_per_h: f64| (3.6 * impact.change_m_per_s + km_per_h).abs() < 1.7;
                assert!(near(one, 20.0) && near(two, 35.0) && one.is_whole && two.is_whole, "{step} {dt_s}: {found:?}");
                assert!((two.start_s - 0.35).abs() < 0.05 && two.end_s < 0.5, "{step} {dt_s}: {found:?}");
                let [most, _] = maximum_delta_v(&change);
                assert!((3.6 * most.value.unwrap() + 20.0).abs() < 1.0, "within 300 ms");
            }
        }
    }

    /// A table in whole km/h every 10 ms.
    fn table(km_per_h: &[f64]) -> Sampled {
        Sampled::new(0.0, 0.01, km_per_h.iter().map(|v| v / 3.6).collect()).unwrap()
    }

    fn find<'a>(metrics: &'a [Metric], name: &str) -> &'a Metric {
        metrics.iter().find(|metric| metric.name == name).unwrap()
    }

    #[test]
    fn energy_and_crush_of_a_constant_deceleration() {
        // 36 km/h are lost in 100 ms, then 4 km/h of rebound: 10 m/s on average half of it, 0.5 m.
        let loss: Vec<f64> = (0..=15).map(|k| -(4.0 * f64::from(k)).min(40.0)).collect();
        let along = table(&loss);
        let across = table(&(0..=15).map(|k| f64::from(k.min(10))).collect::<Vec<f64>>());
        let impact = RecordedImpact { along: &along, across: Some(&across), impact_speed_m_per_s: Some(10.0) };
        let metrics = impact.metrics();
        let crush = find(&metrics, "recorded_crush");
        // v0²/(2a) with 40 km/h in 100 ms.
        assert!((crush.value.unwrap() - 100.0 / (2.0 * 40.0 / 3.6 / 0.1)).abs() < 1e-3, "{crush:?}");
        // Half a km/h for 90 ms, the instrument's share of the 0.45 m by which 90 ms of 10 m/s are more than the
        // crush, and 5 ms of 10 m/s.
        let half = 0.5 * (crush.interval.unwrap().high - crush.interval.unwrap().low);
        let of_90_percent = 1.644_853_627 * 0.019;
        let of_change = of_90_percent * (0.9 - crush.value.unwrap());
        assert!((half - ((0.5 / 3.6 * 0.09_f64).hypot(of_change) + 0.05)).abs() < 1e-9, "{half}");
        let ees = find(&metrics, "recorded_ees");
        let exact = |loss: f64, y: f64| (36.0 * 36.0 - (36.0 - loss) * (36.0 - loss) - y * y).sqrt() / 3.6;
        assert!((ees.value.unwrap() - exact(40.0, 10.0)).abs() < 1e-9, "{ees:?}");
        let ends = ees.interval.unwrap();
        // Beyond the 36 km/h that there were, less loss is more energy.
        let [x, y] = [40.0, 10.0].map(|km_per_h| 0.5_f64.hypot(of_90_percent * km_per_h));
        let wanted = [exact(40.0 + x, 10.0 + y), exact(40.0 - x, 10.0 - y)];
        assert!((ends.low - wanted[0]).abs() < 1e-9 && (ends.high - wanted[1]).abs() < 1e-9, "{ends:?} {wanted:?}");
        let share = find(&metrics, "absorbed_energy_share").value.unwrap();
        assert!((share - (ees.value.unwrap() / 10.0).powi(2)).abs() < 1e-12);
        assert!((find(&metrics, "maximum_lateral_delta_v").value.unwrap() - 10.0 / 3.6).abs() < 1e-12);
        // Every true speed of such a wall test lies between the ends.
        let metrics = RecordedImpact { across: None, impact_speed_m_per_s: None, ..impact }.metrics();
        let ends = find(&metrics, "recorded_ees").interval.unwrap();
        for e in [0.0, 0.1, 0.2, 0.3] {
            let v0 = 40.0 / 3.6 / (1.0 + e);
            assert!((ends.low..=ends.high).contains(&(v0 * f64::sqrt(1.0 - e * e))), "{e}: {ends:?}");
        }
    }

    #[test]
    fn a_speed_that_does_not_belong_to_the_table_is_said() {
        let along = table(&[0.0, -10.0, -30.0, -50.0, -50.0]);
        let of = |speed| RecordedImpact { along: &along, across: None, impact_speed_m_per_s: Some(speed) }.metrics();
        // More than twice the speed is lost.
        assert_eq!(find(&of(20.0 / 3.6), "recorded_ees").value, None);
        assert_eq!(find(&of(90.0 / 3.6), "recorded_crush").value, None);
        let pushed = table(&[0.0, 5.0, 9.0, 9.0]);
        assert!(RecordedImpact { along: &pushed, across: None, impact_speed_m_per_s: Some(9.0) }.metrics().is_empty());
    }
}
