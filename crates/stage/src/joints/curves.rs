//! What rows compute from curves: values between samples, running integrals, delays.

use crumple_signal::Sampled;

/// Samples that a comparison looks at: more tell no more of a pulse, and a long record costs no more than a short one.
const LOOKED_AT: usize = 4096;

/// The value of a curve at a time, straight between samples; `None` outside of it.
pub(crate) fn value_at(curve: &Sampled, time_s: f64) -> Option<f64> {
    between(curve.t0_s(), curve.dt_s(), curve.samples(), time_s)
}

fn between(t0_s: f64, dt_s: f64, samples: &[f64], time_s: f64) -> Option<f64> {
    let place = (time_s - t0_s) / dt_s;
    // A time that is a sample's may lie a rounding beside it.
    let last = samples.len().checked_sub(1)? as f64;
    if !(-1e-6..=last + 1e-6).contains(&place) {
        return None;
    }
    let place = place.clamp(0.0, last);
    let (index, share) = (place.floor() as usize, place.fract());
    let next = samples.get(index + 1).copied().unwrap_or(samples[index]);
    Some(samples[index] + share * (next - samples[index]))
}

/// The end of a curve, s.
pub(crate) fn end_of(curve: &Sampled) -> f64 {
    curve.time_s(curve.len().saturating_sub(1))
}

/// Knots that an integral keeps at most: of ten million samples one every 150, between which a pulse is straight.
const KNOTS: usize = 1 << 16;

/// The integral of a curve from its start to each of its knots, by the trapezoidal rule over all samples. Of a curve of
/// up to [`KNOTS`] samples each is a knot.
pub(crate) struct Running {
    t0_s: f64,
    /// From knot to knot.
    dt_s: f64,
    sums: Vec<f64>,
    /// The last sample, which may lie behind the last knot: its time and the whole integral.
    end: (f64, f64),
}

impl Running {
    pub(crate) fn of(curve: &Sampled) -> Self {
        let stride = curve.len().div_ceil(KNOTS).max(1);
        let (samples, dt_s) = (curve.samples(), curve.dt_s());
        let (mut sum, mut sums) = (0.0, vec![0.0]);
        for (index, pair) in samples.windows(2).enumerate() {
            sum += (pair[0] + pair[1]) / 2.0 * dt_s;
            if (index + 1) % stride == 0 {
                sums.push(sum);
            }
        }
        Self { t0_s: curve.t0_s(), dt_s: stride as f64 * dt_s, sums, end: (end_of(curve), sum) }
    }

    /// The integral of a function from the first knot to each of these, by the trapezoidal rule.
    fn of_function(&self, function: impl Fn(f64) -> Option<f64>) -> Option<Self> {
        let (mut sum, mut sums, mut before) = (0.0, Vec::with_capacity(self.sums.len()), None);
        for index in 0..self.sums.len() {
            let value = function(self.time_of(index))?;
            sum += before.map_or(0.0, |before| (before + value) / 2.0 * self.dt_s);
            sums.push(sum);
            before = Some(value);
        }
        let (end_s, last_s) = (self.end.0, self.time_of(self.sums.len() - 1));
        let of_rest = (before? + function(end_s)?) / 2.0 * (end_s - last_s).max(0.0);
        Some(Self { t0_s: self.t0_s, dt_s: self.dt_s, sums, end: (end_s, sum + of_rest) })
    }

    fn time_of(&self, knot: usize) -> f64 {
        self.t0_s + knot as f64 * self.dt_s
    }

    fn at(&self, time_s: f64) -> Option<f64> {
        between(self.t0_s, self.dt_s, &self.sums, time_s).or_else(|| {
            let (last_s, last) = (self.time_of(self.sums.len() - 1), *self.sums.last()?);
            let ((end_s, end), share) = (self.end, (time_s - last_s) / (self.end.0 - last_s));
            (last_s < time_s && time_s <= end_s + 1e-6 * self.dt_s).then_some(last + share.min(1.0) * (end - last))
        })
    }

    /// The integral from `from_s` to `to_s`; `None` where the curve does not reach that far.
    pub(crate) fn over(&self, from_s: f64, to_s: f64) -> Option<f64> {
        Some(self.at(to_s)? - self.at(from_s)?)
    }
}

/// Times on the grid of a curve from `from_s` to `to_s`, not more than are looked at.
pub(crate) fn times(curve: &Sampled, from_s: f64, to_s: f64) -> impl Iterator<Item = f64> {
    let index = |time_s: f64| ((time_s - curve.t0_s()) / curve.dt_s()).clamp(0.0, curve.len() as f64);
    let (first, end) = (index(from_s).ceil() as usize, index(to_s).floor() as usize + 1);
    let end = end.min(curve.len());
    let stride = (end.saturating_sub(first)).div_ceil(LOOKED_AT).max(1);
    (first..end).step_by(stride).map(|index| curve.time_s(index))
}

/// Largest less least value of a curve over a part of it.
pub(crate) fn range(curve: &Sampled, from_s: f64, to_s: f64) -> f64 {
    let values = times(curve, from_s, to_s).filter_map(|time_s| value_at(curve, time_s));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    (high - low).max(0.0)
}

/// Largest difference of two courses over a part of a curve's time, with its place and both values there.
pub(crate) fn farthest(
    times: impl Iterator<Item = f64>,
    course: impl Fn(f64) -> Option<f64>,
    other: impl Fn(f64) -> Option<f64>,
) -> Option<(f64, f64, f64)> {
    let pairs = times.filter_map(|time_s| Some((time_s, course(time_s)?, other(time_s)?)));
    pairs.max_by(|a, b| (a.1 - a.2).abs().total_cmp(&(b.1 - b.2).abs()))
}

/// Time from contact up to which a pulse is compared for its delay, s: that of most frontal pulses.
const PULSE_S: f64 = 0.15;

/// Before this time, s, a filter has not spread the contact: the samples show the zero level.
const QUIET_S: f64 = -0.01;

/// What lies before this time, s, is no pulse, and none that a filter made of it: a fall or a brake of a second would
/// add its own way, and errors of the zero level with the square of the time.
const LEAD_S: f64 = -0.05;

/// Share of its largest change of velocity that a pulse must have kept at the end for its moment to tell a delay.
const KEPT: f64 = 0.2;

/// Integral of `(to_s - t)` times a curve less its level, by the trapezoidal rule: the way that it adds until `to_s`.
fn moment(curve: &Sampled, from_s: f64, to_s: f64, level: f64) -> f64 {
    let dt_s = curve.dt_s();
    let value = |(index, x): (usize, &f64)| (to_s - curve.time_s(index)) * (x - level);
    let inside = |(index, _): &(usize, &f64)| (from_s..=to_s).contains(&curve.time_s(*index));
    curve.samples().iter().enumerate().filter(inside).map(value).sum::<f64>() * dt_s
}

/// Mean of a curve before the contact is spread, and the deviation of that mean; zeros where few samples show it. Of
/// all samples: noise of some thousand is a level of its own.
fn level_of(curve: &Sampled) -> (f64, f64) {
    let quiet = ((QUIET_S - curve.t0_s()) / curve.dt_s() + 1.0).clamp(0.0, curve.len() as f64);
    mean_and_deviation(&curve.samples()[..quiet as usize])
}

/// The level that a curve made of another is without. A low-pass filter keeps the mean of what lies before the contact,
/// braking too, so that the difference of both means was taken out. What is taken out brings the mean nearer to zero: a
/// wide filter that spreads the pulse to before the contact moves it away from zero, and took nothing out.
fn level_taken_out(curve: &Sampled, made: &Sampled) -> f64 {
    let ((own, _), (of_made, _)) = (level_of(curve), level_of(made));
    (own - of_made).clamp(own.min(0.0), own.max(0.0))
}

/// The ways that two pulses move a vehicle, m, where they are farthest apart, and the largest of the first.
pub(crate) struct Ways {
    pub time_s: f64,
    pub of_filtered_m: f64,
    pub of_recorded_m: f64,
    pub largest_m: f64,
    /// What three deviations of the zero level add until then.
    pub by_zero_level_m: f64,
}

/// The ways of a record and of what was made of it, from contact to the largest of the record. Both start with this
/// speed, m/s.
pub(crate) fn ways(recorded: &Sampled, filtered: &Sampled, speed: f64) -> Option<Ways> {
    let to_s = PULSE_S.min(end_of(recorded)).min(end_of(filtered));
    let from_s = recorded.t0_s().max(filtered.t0_s()).max(0.0);
    let way = |curve: &Sampled, level: f64| {
        let velocity = Running::of(curve);
        velocity.of_function(|t| Some(speed + velocity.over(curve.t0_s(), t)? - level * (t - curve.t0_s())))
    };
    let (of_recorded, of_filtered) = (way(recorded, level_taken_out(recorded, filtered))?, way(filtered, 0.0)?);
    let at = |way: &Running, t| way.over(from_s, t);
    let largest = times(recorded, from_s, to_s).filter_map(|t| Some((t, at(&of_recorded, t)?)));
    let (end_s, largest_m) = largest.max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (time_s, of_filtered_m, of_recorded_m) =
        farthest(times(recorded, from_s, end_s), |t| at(&of_filtered, t), |t| at(&of_recorded, t))?;
    let by_zero_level_m = 1.5 * level_of(recorded).1 * (time_s - from_s).powi(2);
    Some(Ways { time_s, of_filtered_m, of_recorded_m, largest_m, by_zero_level_m })
}

/// Fewest samples that show a zero level.
const OF_A_LEVEL: usize = 8;

/// Mean of samples and the deviation of it, none of few.
pub(crate) fn mean_and_deviation(samples: &[f64]) -> (f64, f64) {
    if samples.len() < OF_A_LEVEL {
        return (0.0, 0.0);
    }
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let variance = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    (mean, (variance / count).sqrt())
}

/// By how much `late` lies behind `curve`, s: the difference of the ways that both add, each over its change of
/// velocity.
///
/// A delay of `τ` takes `τ Δv` off the way. A filter without phase keeps the moment of a pulse, whatever its width, a
/// gain changes way and velocity alike, and what the end of a record cuts off has added no way yet. `None` where a
/// change of velocity is small.
pub(crate) fn delay_s(curve: &Sampled, late: &Sampled) -> Option<f64> {
    let start = |curve: &Sampled| curve.t0_s().max(LEAD_S);
    let to_s = PULSE_S.min(end_of(curve)).min(end_of(late));
    let running = Running::of(curve);
    let change = running.over(start(curve), to_s)?;
    let largest = times(curve, start(curve), to_s).filter_map(|t| running.over(start(curve), t));
    let largest = largest.fold(0.0_f64, |largest, change| largest.max(change.abs()));
    let of_late = Running::of(late).over(start(late), to_s)?;
    if !(to_s > 0.0 && change.abs() > KEPT * largest && of_late.abs() > KEPT * largest) {
        return None;
    }
    // A zero level that was taken out is no delay.
    let level = level_taken_out(curve, late);
    let own = moment(curve, start(curve), to_s, level) / (change - level * (to_s - start(curve)));
    Some(own - moment(late, start(late), to_s, 0.0) / of_late)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 20_000.0;

    #[test]
    fn a_long_curve_has_the_integral_of_all_its_samples_at_few_knots() {
        // Two and a half knots' worth of samples and a rest: a ramp of 1/s, whose integral is t^2/2.
        let count = 5 * KNOTS / 2 + 7;
        let dt_s = 1e-6;
        let ramp = Sampled::new(-0.01, dt_s, (0..count).map(|k| k as f64 * dt_s).collect()).unwrap();
        let running = Running::of(&ramp);
        assert!(running.sums.len() <= KNOTS);
        let length_s = (count - 1) as f64 * dt_s;
        for share in [0.0, 0.123, 0.5, 0.999_99, 1.0] {
            let t = share * length_s;
            let found = running.over(-0.01, -0.01 + t).unwrap();
            // Straight between knots three samples apart: an eighth of the square of that.
            assert!((found - t * t / 2.0).abs() < (3.0 * dt_s).powi(2) / 8.0 + 1e-14, "{share}: {found}");
        }
        assert!(running.over(-0.01, -0.01 + length_s + dt_s).is_none());
        let twice = running.of_function(|t| Some(t + 0.01)).unwrap();
        assert!((twice.over(-0.01, -0.01 + length_s).unwrap() - length_s * length_s / 2.0).abs() < 1e-11);
    }

    /// A second of braking by 7 m/s^2, a half sine of 80 ms, and noise of 20 m/s^2 that is the same each time.
    fn after_braking() -> Sampled {
        let mut state = 1_u64;
        let samples = (0..24_000).map(|index| {
            let t = f64::from(index) / RATE_HZ - 1.0;
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let noise = ((state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 40.0;
            let pulse = if (0.0..0.08).contains(&t) { -250.0 * (std::f64::consts::PI * t / 0.08).sin() } else { 0.0 };
            pulse + noise - if t < 0.0 { 7.0 } else { 0.0 }
        });
        Sampled::new(-1.0, 1.0 / RATE_HZ, samples.collect()).unwrap()
    }

    /// The mean over 4 ms around each sample, put `late` samples behind it.
    fn averaged(curve: &Sampled, late: usize) -> Sampled {
        let (half, samples) = (40, curve.samples());
        let mean = |index: usize| {
            let near = &samples[index.saturating_sub(half)..(index + half + 1).min(samples.len())];
            near.iter().sum::<f64>() / near.len() as f64
        };
        let made = (0..samples.len()).map(|index| mean(index.saturating_sub(late)));
        Sampled::new(curve.t0_s(), curve.dt_s(), made.collect()).unwrap()
    }

    /// A filter without a delay has none whatever lies before the pulse; one of 3 ms is seen. Noise of 20 m/s^2 moves
    /// the moment over 0.2 s by some 0.2 ms, and 0.4 ms is what the limit of CR203 leaves to it.
    #[test]
    fn a_second_of_braking_is_no_delay() {
        let recorded = after_braking();
        for (late, truth_s) in [(0, 0.0), (60, 0.003)] {
            let found = delay_s(&recorded, &averaged(&recorded, late)).unwrap();
            assert!((found - truth_s).abs() < 0.4e-3, "{truth_s} s, found {found}");
        }
    }

    /// The level of a long start is that of all its samples: a mean of 19,800 has a 140th of their deviation.
    #[test]
    fn a_level_is_of_all_samples() {
        let (mean, deviation) = level_of(&after_braking());
        assert!((mean + 7.0).abs() < 4.0 * deviation, "{mean} ± {deviation}");
        assert!((deviation - 40.0 / 12.0_f64.sqrt() / 19_801.0_f64.sqrt()).abs() < 0.002, "{deviation}");
    }
}
