//! First contact, read off a pulse or a switch: by onset, by threshold, by the recorder's rule, by a switch.

use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Sampled, Signal};

use crate::{EDR_INTERVAL_S, ThresholdRule, time_zero_by_threshold, time_zero_by_velocity_change};

/// First contact as estimated from a record, and how far off it may be. An error δ of it moves the crush by about v0·δ:
/// 9 mm at 50 km/h for 0.65 ms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactEstimate {
    /// On the record's time axis, s.
    pub time_s: f64,
    /// How much earlier (positive) true contact may have been, s.
    pub earlier_by_s: f64,
    /// How much later it may have been, s.
    pub later_by_s: f64,
}

/// Contact by threshold, [`time_zero_by_threshold`], with how late it may be.
///
/// Meant for a signal of CFC 60 without zero level. Lags true contact, by 0.65 ms on a half-sine of 100 ms; it cannot
/// have been before the last change of sign, which is what `earlier_by_s` says (at most the start of the record).
///
/// The rule: the first sample with |a| of 0.5 g or more that stays there for 3 ms, the crossing interpolated linearly,
/// so noise and short spikes are passed over. A soft front can cross zero once more after contact; true contact is then
/// earlier than `earlier_by_s` says. `None` where no stretch of 3 ms holds 0.5 g.
pub fn threshold_crossing(acceleration: &Signal<Acceleration>) -> Option<ContactEstimate> {
    let time_s = time_zero_by_threshold(acceleration, ThresholdRule::default()).value?;
    let a = acceleration.samples();
    let first = acceleration.index_at_or_after(time_s).min(a.len() - 1);
    let sign = a[first].signum();
    let rest = a[..first].iter().rposition(|a| a * sign <= 0.0).unwrap_or(0);
    Some(ContactEstimate { time_s, earlier_by_s: (time_s - acceleration.time_s(rest)).max(0.0), later_by_s: 0.0 })
}

/// Contact by the rule of event data recorders, [`time_zero_by_velocity_change`].
///
/// The interval may begin before contact, by up to its length: that is what `later_by_s` says.
///
/// The rule (49 CFR 563.5): the first sample after which the velocity changes by more than 0.8 km/h within 20 ms,
/// either way. The change is the trapezoid of the acceleration, so no impact speed is needed. `None` for a pulse that
/// never changes the velocity that fast, which is a mean of 1.13 g over 20 ms.
pub fn edr_start(acceleration: &Signal<Acceleration>) -> Option<ContactEstimate> {
    let time_s = time_zero_by_velocity_change(acceleration).value?;
    Some(ContactEstimate { time_s, earlier_by_s: 0.0, later_by_s: EDR_INTERVAL_S })
}

/// Stretch at the start of a contact switch that is taken as open, s.
const OPEN_S: f64 = 0.001;

/// Contact by a switch: where its signal first crosses the middle between its level at the start of the record (mean of
/// the first millisecond) and the level farthest from it, linearly interpolated; right to a sample.
///
/// Either direction counts as closing, whatever the unit of the switch. Bounces after the first crossing are not looked
/// at. A switch that is closed when the record begins is taken as open and found where it opens, so the record has to
/// begin before contact. `None` for a constant or an empty record. This is the first rule to use where there is such a
/// channel: the others infer contact from the pulse.
pub fn contact_edge(switch: &Sampled) -> Option<ContactEstimate> {
    let s = switch.samples();
    let open = ((OPEN_S / switch.dt_s()).round() as usize).clamp(1, s.len().max(1)).min(s.len());
    if open == 0 {
        return None;
    }
    let level = s[..open].iter().sum::<f64>() / open as f64;
    let farthest = s.iter().fold(0.0_f64, |far, x| if (x - level).abs() > far.abs() { x - level } else { far });
    if farthest == 0.0 {
        return None;
    }
    let travelled = |k: usize| (s[k] - level) / farthest;
    let first = (0..s.len()).find(|&k| travelled(k) >= 0.5)?;
    let crossing = match first.checked_sub(1) {
        None => 0.0,
        Some(before) => before as f64 + (0.5 - travelled(before)) / (travelled(first) - travelled(before)),
    };
    let time_s = switch.t0_s() + crossing * switch.dt_s();
    Some(ContactEstimate { time_s, earlier_by_s: switch.dt_s(), later_by_s: switch.dt_s() })
}

/// The onset of a pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Onset {
    /// Where the rise, extrapolated back, meets the level before it, s on the record's time axis.
    pub time_s: f64,
    /// Standard deviation of that, s.
    pub deviation_s: f64,
}

/// A pulse whose beginning is not in the record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutRise {
    /// The first sample, m/s².
    pub first_m_per_s2: f64,
    /// How long before it the rise of the first 5 ms, extrapolated back, is zero, s; 0 where they do not rise.
    pub lead_s: f64,
}

/// What the beginning of a record says of the onset of its pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Beginning {
    /// The rise is in the record.
    Rises(Onset),
    /// The record begins inside the pulse.
    Inside(CutRise),
    /// Nothing reaches 0.5 g for 3 ms.
    Quiet,
}

/// Level before a rise: the mean of so long a stretch, s, as the zero level is ([`PreEventWindow`]).
///
/// [`PreEventWindow`]: crumple_signal::PreEventWindow
const LEVEL_S: f64 = 0.05;
/// Mean change of acceleration over 20 ms that makes an impact, m/s²: 0.8 km/h, the rule of 49 CFR 563.5 (1.13 g). A
/// tyre brakes with 1 g at most, and a fall begins with 1 g.
const IMPACT_M_PER_S2: f64 = 0.8 / 3.6 / EDR_INTERVAL_S;
/// Part of the record before the threshold that the rise is looked for in, s: a haversine of 100 ms and 28 g reaches
/// 0.5 g after 6.6 ms, and the stretch of the rule above begins 20 ms before contact at most.
const SEARCH_S: f64 = 0.03;
/// The local peak is the largest value of so long a stretch, s: half of a short barrier pulse (80 ms).
const PEAK_S: f64 = 0.04;
/// The rise is extrapolated from what lies below this share of the local peak: up to there sine, haversine and triangle
/// are powers of time to 7 % at the top (sin²x = x²(1 - x²/3): x² = 0.2), 1 % in the mean.
const SHARE: f64 = 0.2;
/// ... and below so many times the noise where that is more: a line through less is not determined.
const NOISES: f64 = 8.0;
/// Powers of time that a rise is made of, from 0: a jump, a ramp, a haversine, and the front of a car, whose first
/// parts are soft (Camry, NHTSA 10146: 0.5 g at 3.8 ms, 2 g at 5.3, 8 g at 6.8).
const POWERS: usize = 4;
/// Two powers count as one below this share of the product of their sums of squares: eight of the sixteen digits.
const SINGULAR: f64 = 1e-8;
/// Samples of a rise that are looked at, at most: the search costs their number times that of its steps.
const MOST_SAMPLES: usize = 1000;
/// Steps of the search in samples, at least.
const LEAST_STEP: f64 = 0.05;
/// Steps of the search, s.
const STEP_S: f64 = 5e-5;
/// No onset is known better than this share of a sampling interval: a jump lies anywhere in one, and 90 % of a normal
/// distribution then reach its ends (0.5/1.645, and a step of the search).
const LEAST_STEP_SHARE: f64 = 0.33;
/// What the powers miss of a rise, as a share of its top: a sine up to a fifth of its peak is straight to 0.7 %.
const SHAPE_ERROR: f64 = 0.01;
/// Independent samples of that error: it bends a few times over the rise.
const SHAPE_SAMPLES: f64 = 6.0;
/// A first sample this far from rest is inside the pulse, m/s²: 138 sound records reach 1.1 g at most (survey of
/// November 2026).
const INSIDE_M_PER_S2: f64 = 1.5 * STANDARD_GRAVITY_M_PER_S2;

/// The onset of the first impact of a record.
///
/// The impact is where the mean of 20 ms differs by more than 1.13 g from that of the 50 ms before them; so braking and
/// a free fall before contact do not count. Its rise is `level + c·(t - τ)^p + d·(t - τ)^q` for t > τ with powers from
/// 0 to 3: one of them, or ramp and parabola, not negative. For every τ they are those of least squares over the
/// samples from 30 ms before 0.5 g are held up to a fifth of the local peak (mean of 4.4 ms); the onset is the mean of
/// τ with the weights of Schwarz, `exp(-RSS/2σ²) n^(-k/2)`, its deviation that of the same weights. σ is the noise
/// before, or what the best rise leaves, whichever is larger, and what powers miss of a rise. So a rise that no powers
/// follow, or that noise hides, has a wide deviation.
///
/// Units: s. Sound for rates from 500 Hz.
pub fn onset(acceleration: &Sampled) -> Beginning {
    let (a, dt) = (acceleration.samples(), acceleration.dt_s());
    let Some(change) = first_impact(a, dt) else { return Beginning::Quiet };
    let before = &a[change.saturating_sub(samples_of(LEVEL_S, dt))..change];
    let begins_at_once = before.len() < LEAST_BEFORE;
    let level = if begins_at_once { level_at_start(a, samples_of(START_S, dt).max(2)) } else { mean(before) };
    // A steady offset is its own level, and no pulse.
    if begins_at_once && (a[0] - level).abs() > INSIDE_M_PER_S2 {
        return Beginning::Inside(cut_rise(a, dt));
    }
    let ThresholdRule { threshold_m_per_s2, .. } = ThresholdRule::default();
    let from_impact = acceleration.slice(change, a.len());
    let Some(held_s) = held_crossing(&from_impact, level, threshold_m_per_s2) else { return Beginning::Quiet };
    rise(acceleration, acceleration.index_at_or_after(held_s), level, before)
}

/// Where the force of an impact ends: the [onset] of the reversed record from its strongest instant to 50 ms behind
/// `end_s`, on the record's axis. `None` where its fall is not in the record.
pub fn end_of_force(acceleration: &Sampled, peak_s: f64, end_s: f64) -> Option<Onset> {
    let (first, last) = (acceleration.index_at_or_after(peak_s), acceleration.index_at_or_after(end_s + LEVEL_S));
    let fall = acceleration.slice(first, last);
    let reversed = Sampled::new(0.0, fall.dt_s(), fall.samples().iter().rev().copied().collect()).ok()?;
    match onset(&reversed) {
        Beginning::Rises(onset) => Some(Onset { time_s: fall.end_s() - onset.time_s, ..onset }),
        _ => None,
    }
}

/// Stretch whose rise is extrapolated back to the beginning of a pulse that a record cuts, s: that of a half sine of
/// 100 ms is straight to 2 % up to there.
const FIRST_RISE_S: f64 = 0.005;

fn cut_rise(a: &[f64], dt_s: f64) -> CutRise {
    let first = a[0];
    let part = &a[..(samples_of(FIRST_RISE_S, dt_s) + 1).clamp(2, a.len().max(2)).min(a.len())];
    let (middle, level) = ((part.len() - 1) as f64 / 2.0, mean(part));
    let moment =
        |of: &dyn Fn(f64, f64) -> f64| part.iter().enumerate().map(|(k, a)| of(k as f64 - middle, *a)).sum::<f64>();
    let slope = moment(&|k, a| k * (a - level)) / moment(&|k, _| k * k) / dt_s;
    let lead_s = (first / slope).max(0.0);
    CutRise { first_m_per_s2: first, lead_s: if lead_s.is_finite() { lead_s } else { 0.0 } }
}

/// Samples before an impact that make a level.
const LEAST_BEFORE: usize = 3;

fn samples_of(s: f64, dt_s: f64) -> usize {
    (s / dt_s).round() as usize
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len().max(1) as f64
}

/// The first sample after which the mean of 20 ms differs by more than 1.13 g from that of the 50 ms before it.
fn first_impact(a: &[f64], dt_s: f64) -> Option<usize> {
    let (after, before) = (samples_of(EDR_INTERVAL_S, dt_s).max(2), samples_of(LEVEL_S, dt_s).max(2));
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(a.iter().scan(0.0, |sum, x| {
            *sum += x;
            Some(*sum)
        }))
        .collect();
    let mean = |from: usize, to: usize| (sums[to] - sums[from]) / (to - from) as f64;
    let start = samples_of(START_S, dt_s).max(LEAST_BEFORE);
    let at_start = level_at_start(a, start);
    (0..a.len().saturating_sub(after)).find(|&k| {
        // The mean of a few samples of a ring is no level.
        let level = if k < start { at_start } else { mean(k.saturating_sub(before), k) };
        (mean(k, k + after) - level).abs() > IMPACT_M_PER_S2
    })
}

/// Stretch at the start of a record that shows whether it begins at rest, s: what a zero level needs.
const START_S: f64 = 0.01;

/// The level of a record that begins at rest: the mean of its first samples where their halves agree to 0.15 g, as
/// those of a steady offset do; else 0, as inside a pulse.
fn level_at_start(a: &[f64], samples: usize) -> f64 {
    let (first, second) = a[..samples.min(a.len())].split_at(samples.min(a.len()) / 2);
    let steady = (mean(first) - mean(second)).abs() < 0.1 * INSIDE_M_PER_S2;
    if steady { mean(&a[..samples.min(a.len())]) } else { 0.0 }
}

/// Width of the moving mean of the threshold rule, s: its -3 dB frequency is about 100 Hz, that of CFC 60.
pub const SMOOTHING_S: f64 = 0.0044;
/// Samples smoothed at a time.
const BLOCK: usize = 1 << 18;

/// First time at which the magnitude of the moving mean of 4.4 ms, beside a level, reaches a threshold and stays there
/// for 3 ms, s, by linear interpolation; `None` if it never does. It lags contact by a fraction of a millisecond. Block
/// by block: a long record is not copied.
pub fn held_crossing(pulse: &Sampled, zero_level: f64, threshold_m_per_s2: f64) -> Option<f64> {
    if pulse.is_empty() {
        return None;
    }
    // An interval of next to nothing makes them longer than any record.
    let half = ((SMOOTHING_S / pulse.dt_s() / 2.0) as usize).min(pulse.len());
    // A run that reaches over the start of a block is found again in it.
    let overlap = (ThresholdRule::default().hold_s / pulse.dt_s()).round().clamp(1.0, pulse.len() as f64) as usize + 2;
    (0..pulse.len()).step_by(BLOCK).find_map(|start| {
        let (from, to) = (start.saturating_sub(overlap), (start + BLOCK).min(pulse.len()));
        let (low, high) = (from.saturating_sub(half), (to + half).min(pulse.len()));
        let smooth = moving_mean(&pulse.samples()[low..high], half);
        crossing_of(&pulse.slice(from, to), &smooth[from - low..to - low], zero_level, threshold_m_per_s2)
    })
}

/// Centred mean over `2 half + 1` samples, fewer at the ends.
pub fn moving_mean(samples: &[f64], half: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(samples.len() + 1);
    let mut sum = 0.0;
    sums.push(sum);
    for x in samples {
        sum += x;
        sums.push(sum);
    }
    (0..samples.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(half), (k + half + 1).min(samples.len()));
            (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}

fn crossing_of(times: &Sampled, samples: &[f64], zero_level: f64, threshold_m_per_s2: f64) -> Option<f64> {
    let hold = (ThresholdRule::default().hold_s / times.dt_s()).round().max(1.0) as usize;
    let magnitude = |k: usize| (samples[k] - zero_level).abs();
    let mut run = 0;
    for k in 0..samples.len() {
        run = if magnitude(k) >= threshold_m_per_s2 { run + 1 } else { 0 };
        // `hold` intervals need one sample more.
        if run > hold {
            let first = k - hold;
            if first == 0 {
                return Some(times.time_s(0));
            }
            let (before, after) = (magnitude(first - 1), magnitude(first));
            let part = (threshold_m_per_s2 - before) / (after - before);
            return Some(times.time_s(first - 1) + part * times.dt_s());
        }
    }
    None
}
/// The rise at a threshold crossing beside a level; `before` is what shows the noise.
fn rise(acceleration: &Sampled, start: usize, level: f64, before: &[f64]) -> Beginning {
    let (a, dt) = (acceleration.samples(), acceleration.dt_s());
    let noise = (before.iter().map(|x| (x - level).powi(2)).sum::<f64>() / before.len().max(1) as f64).sqrt();
    let peak_end = (start + samples_of(PEAK_S, dt) + 1).min(a.len());
    let sign = (a[start..peak_end].iter().sum::<f64>() / (peak_end - start) as f64 - level).signum();
    let y: Vec<f64> = a.iter().map(|x| sign * (x - level)).collect();
    let half = (SMOOTHING_S / dt / 2.0) as usize;
    let peak = moving_mean(&y[start..peak_end], half).into_iter().fold(0.0, f64::max);
    let top = (SHARE * peak).max(NOISES * noise);
    let from = start.saturating_sub(samples_of(SEARCH_S, dt));
    // Two samples more than the crossing, so that a jump is more than one sample.
    let crossing = (start..peak_end).find(|k| y[*k] >= top).unwrap_or(start).max(start + 1);
    // Means of neighbours where there are many: the noise of each is less by the root of their number.
    let together = (crossing - from).div_ceil(MOST_SAMPLES).max(1);
    let end = (crossing + 2 * together).min(a.len());
    let from = from + (end - from) % together;
    let part: Vec<f64> = y[from..end].chunks_exact(together).map(mean).collect();
    let (start_s, dt) = (acceleration.time_s(from) + 0.5 * (together - 1) as f64 * dt, together as f64 * dt);
    let noise = noise / (together as f64).sqrt();
    let part = part.as_slice();
    let whole: f64 = part.iter().map(|y| y * y).sum();
    let step = (STEP_S / dt).max(LEAST_STEP);
    let last = part.len().saturating_sub(1) as f64;
    let of_onset = |k: usize| {
        let onset = k as f64 * step;
        // A jump may lie anywhere between two samples: in the middle on average.
        let of_jump = onset.floor() + 0.5;
        let instant = move |is_jump: bool| if is_jump { of_jump } else { onset };
        residuals(part, whole, onset).map(move |(rss, powers, is_jump)| (rss, powers, instant(is_jump) * dt))
    };
    let fits: Vec<(f64, usize, f64)> = (0..(last / step) as usize).flat_map(of_onset).collect();
    let Some(least) = fits.iter().map(|fit| fit.0).reduce(f64::min) else { return Beginning::Quiet };
    let risen = ((end - start) / together).max(1) as f64;
    let of_shape = (SHAPE_ERROR * top).powi(2) * (risen / SHAPE_SAMPLES).max(1.0);
    let variance = (noise * noise).max(least / part.len() as f64) + of_shape.max(f64::MIN_POSITIVE);
    let charge = 0.5 * (part.len() as f64).ln();
    let logarithm = |(rss, n, _): &(f64, usize, f64)| (least - rss) / (2.0 * variance) - charge * *n as f64;
    let weights: Vec<f64> = fits.iter().map(logarithm).collect();
    let most = weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = weights.iter().map(|weight| (weight - most).exp()).collect();
    let total: f64 = weights.iter().sum();
    let middle = fits.iter().zip(&weights).map(|(fit, weight)| weight * fit.2).sum::<f64>() / total;
    let spread = fits.iter().zip(&weights).map(|(fit, weight)| weight * (fit.2 - middle).powi(2)).sum::<f64>() / total;
    let deviation_s = spread.sqrt().max(LEAST_STEP_SHARE * dt);
    Beginning::Rises(Onset { time_s: start_s + middle, deviation_s })
}

/// Sums of squares that rises from τ leave, each with its number of powers and whether it is a jump; empty where no
/// sample lies behind τ.
///
/// Least squares of one power, and of ramp and parabola together, whose coefficients are not negative: a pulse goes one
/// way.
fn residuals(y: &[f64], whole: f64, onset: f64) -> impl Iterator<Item = (f64, usize, bool)> + use<> {
    let first = (onset.floor() as usize + 1).min(y.len());
    // Sums of x^0 to x^6, and of x^p y, x in samples over the length of the stretch.
    let scale = 1.0 / (y.len() - first).max(1) as f64;
    let (mut powers, mut with_y) = ([0.0; 7], [0.0; POWERS]);
    for (k, y) in y.iter().enumerate().skip(first) {
        let (x, mut power) = ((k as f64 - onset) * scale, 1.0);
        for p in 0..powers.len() {
            powers[p] += power;
            if p < POWERS {
                with_y[p] += power * y;
            }
            power *= x;
        }
    }
    let alone = move |p: usize| {
        (powers[2 * p] > 0.0 && with_y[p] > 0.0).then(|| (whole - with_y[p].powi(2) / powers[2 * p], 1, p == 0))
    };
    let both = move |p: usize, q: usize| {
        let (a, b, c) = (powers[2 * p], powers[p + q], powers[2 * q]);
        let determinant = a * c - b * b;
        // Two powers of less than three samples are no fit.
        if determinant <= SINGULAR * a * c {
            return None;
        }
        let of_p = (c * with_y[p] - b * with_y[q]) / determinant;
        let of_q = (a * with_y[q] - b * with_y[p]) / determinant;
        (of_p > 0.0 && of_q > 0.0).then(|| (whole - of_p * with_y[p] - of_q * with_y[q], 2, false))
    };
    let fits = (0..POWERS).filter_map(alone).chain(both(1, 2));
    fits.map(|(rss, count, is_jump)| (rss.max(0.0), count, is_jump))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::event_end_by_velocity_change;
    use crumple_numerics::estimation::random::RandomNumbers;

    const G: f64 = STANDARD_GRAVITY_M_PER_S2;

    fn ramp(slope: f64) -> Signal<Acceleration> {
        // From 5 ms on; before it a little of the other sign.
        let at = |t: f64| if t < 0.005 { 0.1 } else { -slope * (t - 0.005) };
        Signal::new(0.0, 1e-4, (0..600).map(|k| at(f64::from(k) * 1e-4)).collect()).unwrap()
    }

    #[test]
    fn the_threshold_is_interpolated_and_says_how_late_it_may_be() {
        let zero = threshold_crossing(&ramp(2000.0)).unwrap();
        // 0.5 g = 4.903325 m/s² is reached after 2.4517 ms of the ramp; binary rounding only.
        assert!((zero.time_s - 0.005 - 0.5 * G / 2000.0).abs() < 1e-12, "{zero:?}");
        // The last sample at rest is the one at which the ramp starts from zero.
        assert!((zero.earlier_by_s - 0.5 * G / 2000.0).abs() < 1e-4 + 1e-12, "{zero:?}");
    }

    #[test]
    fn a_spike_shorter_than_the_hold_is_passed_over() {
        let mut samples = ramp(2000.0).samples().to_vec();
        samples[10..40].fill(50.0);
        let with_spike = Signal::new(0.0, 1e-4, samples.clone()).unwrap();
        assert!(threshold_crossing(&with_spike).unwrap().time_s > 0.007);
        samples[10..41].fill(50.0);
        let held = Signal::new(0.0, 1e-4, samples).unwrap();
        assert!(threshold_crossing(&held).unwrap().time_s < 0.0011);
        assert_eq!(threshold_crossing(&Signal::new(0.0, 1e-4, vec![0.0; 50]).unwrap()), None);
        assert_eq!(threshold_crossing(&Signal::new(0.0, 1e-4, vec![]).unwrap()), None);
    }

    #[test]
    fn the_recorder_s_interval_begins_before_contact() {
        // 10 m/s² from 30 ms to 80 ms: 0.2222 m/s are gathered after 22.2 ms, so the interval of 20 ms holds less at
        // most 0.2 m/s; with 20 m/s² it takes 11.1 ms.
        let step = |level: f64| {
            let at = |k: i32| if (300..800).contains(&k) { level } else { 0.0 };
            Signal::new(0.0, 1e-4, (0..1200).map(at).collect()).unwrap()
        };
        assert_eq!(edr_start(&step(-10.0)), None);
        let zero = edr_start(&step(-20.0)).unwrap();
        // The last sample of the interval is at 41.1 ms: 111 full steps and half of the first, 0.223 m/s.
        assert!((zero.time_s - 0.0211).abs() < 1.5e-4, "{zero:?}");
        let end = event_end_by_velocity_change(&step(-20.0), zero.time_s).unwrap();
        assert!((end - (0.08 - 0.0111)).abs() < 1.5e-4, "{end}");
        assert_eq!(edr_start(&Signal::new(0.0, 1e-4, vec![]).unwrap()), None);
    }

    #[test]
    fn a_switch_closes_in_the_middle_of_its_edge_whichever_way() {
        for (open, closed) in [(0.0, 5.0), (5.0, 0.0), (1.0, -3.0)] {
            let samples = (0..100).map(|k| if k < 50 { open } else { closed }).collect();
            let zero = contact_edge(&Sampled::new(-0.005, 1e-4, samples).unwrap()).unwrap();
            assert!((zero.time_s + 0.5e-4).abs() < 1e-12, "{zero:?}");
        }
        assert_eq!(contact_edge(&Sampled::new(0.0, 1e-4, vec![5.0; 9]).unwrap()), None);
        assert_eq!(contact_edge(&Sampled::new(0.0, 1e-4, vec![]).unwrap()), None);
    }

    /// Acceleration in g at so many seconds after contact.
    type Shape = fn(f64) -> f64;

    const SHAPES: [(&str, Shape); 5] = [
        ("half sine of 100 ms", |t| if t < 0.1 { -24.5 * (std::f64::consts::PI * t / 0.1).sin() } else { 0.0 }),
        ("half sine of 6 ms", |t| if t < 0.006 { -50.0 * (std::f64::consts::PI * t / 0.006).sin() } else { 0.0 }),
        ("haversine", |t| if t < 0.1 { -28.6 * (std::f64::consts::PI * t / 0.1).sin().powi(2) } else { 0.0 }),
        ("jump", |t| -15.0 * (-t / 0.05).exp()),
        ("pushed ramp", |t| if t < 0.06 { 300.0 * t } else { 0.0 }),
    ];

    /// A record from 0 s on with contact at `zero_s`, a level before it, and noise, both in g.
    fn record(shape: Shape, (zero_s, level, noise): (f64, f64, f64), dt_s: f64, stream: usize) -> Sampled {
        let mut random = RandomNumbers::of_stream(7, stream);
        let at = |k: usize| {
            let t = k as f64 * dt_s - zero_s;
            G * (level + if t < 0.0 { 0.0 } else { shape(t) } + noise * random.normal())
        };
        Sampled::new(0.0, dt_s, (0..(0.3 / dt_s) as usize).map(at).collect()).unwrap()
    }

    fn found(record: &Sampled) -> Onset {
        match onset(record) {
            Beginning::Rises(onset) => onset,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_onset_of_a_clean_rise_is_contact_whatever_its_shape_and_the_level_before_it() {
        for (name, shape) in SHAPES {
            for level in [0.0, -0.8, 1.0, 2.0, -5.0] {
                for zero_s in [0.012, 0.05, 0.13004] {
                    let onset = found(&record(shape, (zero_s, level, 0.0), 1e-4, 0));
                    // A haversine is x² to 1 % only, and no noise says which power it is.
                    let allowed = if name == "haversine" { 1e-3 } else { 1.5e-4 };
                    assert!((onset.time_s - zero_s).abs() < allowed, "{name} {level} {zero_s}: {onset:?}");
                }
            }
        }
    }

    #[test]
    fn a_fast_record_shows_the_same_onset() {
        for dt_s in [1e-5, 1e-6] {
            for (name, shape) in SHAPES {
                let onset = found(&record(shape, (0.05, 0.0, 0.0), dt_s, 0));
                assert!((onset.time_s - 0.05).abs() < 6e-4, "{name} {dt_s}: {onset:?}");
            }
        }
    }

    #[test]
    fn the_deviation_holds_what_noise_does() {
        for (name, shape) in SHAPES {
            let mut inside = 0;
            for stream in 0..60 {
                let onset = found(&record(shape, (0.08, 0.0, 0.2), 2e-4, stream));
                inside += usize::from((onset.time_s - 0.08).abs() <= 1.645 * onset.deviation_s);
            }
            // 90 % of 60 are 54; three standard deviations of the count are 7.
            assert!(inside >= 47, "{name}: {inside} of 60");
        }
    }

    #[test]
    fn a_record_that_begins_inside_the_pulse_and_one_without_a_pulse_say_so() {
        let (_, half_sine) = SHAPES[0];
        let whole = record(half_sine, (0.05, 0.0, 0.02), 1e-4, 0);
        let inside = whole.slice(600, whole.len());
        // 10 ms after contact: sin(0.1 π)/(π/0.1·cos) of the curve, 10.3 ms at its first sample, 12 ms by 5 ms of it.
        let Beginning::Inside(cut) = onset(&inside) else { panic!("{:?}", onset(&inside)) };
        assert!(cut.first_m_per_s2 < -INSIDE_M_PER_S2 && (0.009..0.013).contains(&cut.lead_s), "{cut:?}");
        let quiet = whole.slice(0, 400);
        assert_eq!(onset(&quiet), Beginning::Quiet);
        assert_eq!(onset(&Sampled::new(0.0, 1e-4, vec![]).unwrap()), Beginning::Quiet);
    }
}
