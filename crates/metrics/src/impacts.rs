//! The impacts of a record: where a force begins and where it ends, one after the other.

use crumple_signal::{STANDARD_GRAVITY_M_PER_S2, Signal, Velocity};

/// An impact: from where its force begins to where it ends. Times are in s from contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PulseImpact {
    /// Start, s: contact for the first, for a later one where its rise, taken back to the level before it, begins.
    pub start_s: f64,
    /// End, s: the acceleration is back at the level that it has after the impact.
    pub end_s: f64,
    /// Velocity at the start, m/s.
    pub start_velocity_m_per_s: f64,
    /// Largest change of velocity from the start up to the end, m/s; negative: the vehicle loses speed.
    pub change_m_per_s: f64,
    /// Mean acceleration of the strongest 4.4 ms, m/s², with its sign.
    pub peak_m_per_s2: f64,
    /// Middle of these, s.
    pub time_of_peak_s: f64,
    /// The record goes on beyond the end; else the change is a lower bound.
    pub is_whole: bool,
    /// Samples of start and end.
    pub(crate) samples: [usize; 2],
}

impl PulseImpact {
    /// Whether an event data recorder would call it an event: 8 km/h (49 CFR 563.5, "trigger threshold").
    pub fn is_event(&self) -> bool {
        self.change_m_per_s.abs() >= EVENT_M_PER_S
    }

    /// Sample of its lowest velocity.
    pub(crate) fn lowest(&self, v: &[f64]) -> usize {
        lowest_in(v, self.samples[0], self.samples[1])
    }

    /// `impact 1 takes 20.0 km/h from 0 to 98 ms`.
    pub fn words(&self, number: usize) -> String {
        let does = if self.change_m_per_s < 0.0 { "takes" } else { "adds" };
        let bound = if self.is_whole { "" } else { "at least " };
        format!(
            "impact {number} {does} {bound}{:.1} km/h from {:.0} to {:.0} ms",
            3.6 * self.change_m_per_s.abs(),
            1e3 * self.start_s,
            1e3 * self.end_s
        )
    }

    /// The same with its peak: `... (peak 11.3 g at 50 ms)`.
    pub fn words_with_peak(&self, number: usize) -> String {
        let peak_g = self.peak_m_per_s2.abs() / STANDARD_GRAVITY_M_PER_S2;
        format!("{} (peak {peak_g:.1} g at {:.0} ms)", self.words(number), 1e3 * self.time_of_peak_s)
    }
}

/// Window of the mean acceleration, s: it lets through what CFC 60 does (-3 dB at 0.443/4.4 ms = 100 Hz).
const MEAN_S: f64 = 0.0044;
/// A force below this is none, m/s²: 1 g. In 138 sound records |a| behind CFC 60 is below it for 3.1 ms at most
/// between contact and stop, between two hits for 40 to 65 ms.
const NO_FORCE_M_PER_S2: f64 = STANDARD_GRAVITY_M_PER_S2;
/// It is never more than this part of the peak, so that a weak pulse has a force, too: a half sine is below a fifth of
/// its peak for 6 % of its length at either end.
const NO_FORCE_OF_PEAK: f64 = 0.2;
/// Time without a force that separates two impacts, s: five times what sound records show, and less than half of what
/// double hits do.
const PAUSE_S: f64 = 0.015;
/// The end of an impact is where the acceleration is this near to its level after it, as a part of `NO_FORCE`: 0.05 g,
/// what the zero level is known to.
const NEAR_LEVEL: f64 = 0.05;
/// The rise of a later impact is looked at where it first reaches this part of its peak: near enough to the edge of a
/// step, that the mean of 4.4 ms smears, and a half sine bends its rise by 2 % there.
const RISE: f64 = 0.3;
/// A rise is a power of time, of this order at most: a step is 0, a spring 1, a haversine 2.
const HIGHEST_POWER: f64 = 3.0;
/// Longest stretch beside an impact that its level is read from, s: the window of a zero level is 40 ms, and an impact
/// may fade within 20 ms.
const LEVEL_S: f64 = 0.06;
/// Standard deviations of the noise that the acceleration may be away from its level: one of 370 samples is farther.
const NOISE_SIGMAS: f64 = 3.0;
/// Standard deviation over median absolute deviation of normal noise.
const SIGMA_PER_MAD: f64 = 1.482_6;
/// Less is no impact, m/s: 0.8 km/h, with which an event begins (49 CFR 563.5).
const LEAST_M_PER_S: f64 = 0.8 / 3.6;
/// Less than this part of the strongest is a bounce of the same impact.
const LEAST_OF_STRONGEST: f64 = 0.05;
/// Change of velocity of an event, m/s: 8 km/h.
const EVENT_M_PER_S: f64 = 8.0 / 3.6;

/// The impacts of a motion from contact, t = 0, on, in the order of time.
///
/// The acceleration is the mean of 4.4 ms, read off the velocity. An impact is a stretch in which it is never below 1 g
/// for 15 ms, and that changes the velocity by more than 0.8 km/h and 5 % of the strongest. It ends where the
/// acceleration is first as near to its level after the impact as 0.05 g or three standard deviations of the noise
/// there. That level is the median of up to 60 ms, so that neither an error of the zero level nor a drag below 1 g
/// belongs to a contact, whatever their sign. A half sine of 30 g and 100 ms ends 0.05 ms early by this rule and loses
/// 1e-5 of its change, a haversine of 11 g 2 ms and 1e-4.
///
/// In a record that is never quiet for 15 ms everything is one impact, which is not whole.
pub fn impacts(velocity: &Signal<Velocity>) -> Vec<PulseImpact> {
    let from = velocity.index_at_or_after(0.0);
    let means = mean_accelerations(velocity, from);
    let peak = means.iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
    if peak == 0.0 {
        return Vec::new();
    }
    let record = Record { velocity, from, means, no_force: NO_FORCE_M_PER_S2.min(NO_FORCE_OF_PEAK * peak) };
    let runs = record.runs();
    let impact = |k: usize| record.impact(&runs, k);
    let all: Vec<PulseImpact> = (0..runs.len()).map(impact).collect();
    let strongest = all.iter().fold(0.0_f64, |most, impact| most.max(impact.change_m_per_s.abs()));
    let least = LEAST_M_PER_S.max(LEAST_OF_STRONGEST * strongest);
    all.into_iter().filter(|impact| impact.change_m_per_s.abs() > least).collect()
}

/// The impact that the events of a record belong to: the first that a recorder would call an event, where there is none
/// the strongest. A touch before it, by a bumper say, belongs to it.
pub fn first_event(impacts: &[PulseImpact]) -> Option<usize> {
    let change = |k: usize| impacts[k].change_m_per_s.abs();
    let strongest = (0..impacts.len()).reduce(|best, k| if change(k) > change(best) { k } else { best });
    impacts.iter().position(PulseImpact::is_event).or(strongest)
}

/// The first of the lowest of the samples `from` to `to`.
pub(crate) fn lowest_in(v: &[f64], from: usize, to: usize) -> usize {
    (from..=to).fold(from, |low, k| if v[k] < v[low] { k } else { low })
}

/// Mean acceleration about each interval between two samples, from sample `from` on, m/s².
fn mean_accelerations(velocity: &Signal<Velocity>, from: usize) -> Vec<f64> {
    let (v, dt) = (velocity.samples(), velocity.dt_s());
    let Some(last) = v.len().checked_sub(1) else { return Vec::new() };
    // An interval longer than the window is a mean itself.
    let width = (MEAN_S / dt).round().clamp(1.0, v.len() as f64) as usize;
    let mean = |k: usize| {
        let low = k.saturating_sub((width - 1) / 2);
        let high = (low + width).min(last);
        (v[high] - v[low]) / ((high - low) as f64 * dt)
    };
    (from..last).map(mean).collect()
}

/// Intervals of a record, counted from contact: where there is a force, and where not for long.
struct Record<'a> {
    velocity: &'a Signal<Velocity>,
    from: usize,
    means: Vec<f64>,
    no_force: f64,
}

impl Record<'_> {
    /// Intervals with a force, from the first to the one after the last, of each stretch without a pause.
    fn runs(&self) -> Vec<[usize; 2]> {
        // 1e-6 of an interval: the slack of decimal time stamps.
        let pause = (PAUSE_S / self.velocity.dt_s() - 1e-6).ceil().max(1.0);
        let mut runs: Vec<[usize; 2]> = Vec::new();
        for k in (0..self.means.len()).filter(|k| self.means[*k].abs() >= self.no_force) {
            match runs.last_mut() {
                Some([_, end]) if ((k - *end) as f64) < pause => *end = k + 1,
                _ => runs.push([k, k + 1]),
            }
        }
        runs
    }

    /// The level of a stretch and how near to it counts as at it, m/s².
    fn level(&self, stretch: &[f64]) -> [f64; 2] {
        let median = |mut numbers: Vec<f64>| {
            let middle = numbers.len().saturating_sub(1) / 2;
            if numbers.is_empty() { 0.0 } else { *numbers.select_nth_unstable_by(middle, f64::total_cmp).1 }
        };
        let level = median(stretch.to_vec());
        let noise = SIGMA_PER_MAD * median(stretch.iter().map(|a| (a - level).abs()).collect());
        [level, (NEAR_LEVEL * self.no_force).max(NOISE_SIGMAS * noise)]
    }

    /// Where a later impact begins, in samples after contact: its rise taken back to the level of the pause before
    /// it, which begins at `from` and ends at `first`.
    ///
    /// Where a rise `a = c·t^p` has the change of velocity `D`, the acceleration `a` and its derivative `a'`, it lasts
    /// for `t = (p + 1)·D/a` with `p = q/(1 - q)`, `q = a'·D/a²`. That of a spring is right to 0.5 ms, that of a step,
    /// which the mean smears, to 1 ms.
    fn onset(&self, from: usize, first: usize, strongest: usize) -> f64 {
        let (v, dt) = (self.velocity.samples(), self.velocity.dt_s());
        let [level, near] = self.level(&self.means[from..first]);
        let quiet = (from..first).rfind(|k| (self.means[*k] - level).abs() <= near).unwrap_or(from);
        let rise = |k: usize| self.means[k] - level;
        let risen = (first..=strongest).find(|k| rise(*k).abs() >= RISE * rise(strongest).abs()).unwrap_or(strongest);
        let middle = |k: usize| (v[self.from + k] + v[self.from + k + 1]) / 2.0;
        let lost = middle(risen) - middle(quiet) - level * (risen - quiet) as f64 * dt;
        let half = ((MEAN_S / dt / 2.0).round() as usize).max(1);
        let (low, high) = (risen.saturating_sub(half), (risen + half).min(self.means.len() - 1));
        let slope = (rise(high) - rise(low)) / ((high - low) as f64 * dt);
        let share = (slope * lost / (rise(risen) * rise(risen))).clamp(0.0, HIGHEST_POWER / (1.0 + HIGHEST_POWER));
        let lasts = (lost / rise(risen)).max(0.0) / (1.0 - share);
        // Not before the last quiet moment, but for the width of the mean.
        (risen as f64 + 0.5 - lasts / dt).max(quiet as f64)
    }

    fn impact(&self, runs: &[[usize; 2]], k: usize) -> PulseImpact {
        let [first, last] = runs[k];
        let longest = (LEVEL_S / self.velocity.dt_s()).ceil() as usize;
        let before = k.checked_sub(1).map_or(0, |k| runs[k][1]);
        let after = runs.get(k + 1).map_or(self.means.len(), |run| run[0]);
        let strongest =
            (first..last).fold(first, |best, k| if self.means[k].abs() > self.means[best].abs() { k } else { best });
        // The first begins with contact.
        let start = if k == 0 { 0.0 } else { self.onset(before.max(first.saturating_sub(longest)), first, strongest) };
        let start_s = start * self.velocity.dt_s();
        let start = (start.round() as usize).min(first);
        let pause = &self.means[last..after];
        let is_short = (pause.len() as f64) * self.velocity.dt_s() < PAUSE_S;
        // The record ends soon after: its zero level stands for the level after the impact.
        let [level, near] =
            if is_short { [0.0, NEAR_LEVEL * self.no_force] } else { self.level(&pause[..longest.min(pause.len())]) };
        let side = (self.means[last - 1] - level).signum();
        let ended = pause.iter().position(|a| (a - level) * side <= near);
        let end = ended.map_or(self.means.len(), |k| last + k);
        let v = self.velocity.samples();
        let time_s = |k: usize| self.velocity.time_s(self.from + k);
        // The same as the delta-v of the events, also where the force swings past zero before it ends.
        let changes = v[self.from + start..=self.from + end].iter().map(|velocity| velocity - v[self.from + start]);
        let change_m_per_s =
            changes.fold(0.0_f64, |most, change| if change.abs() > most.abs() { change } else { most });
        PulseImpact {
            start_s: if k == 0 { 0.0 } else { time_s(0) + start_s },
            end_s: time_s(end),
            start_velocity_m_per_s: v[self.from + start],
            change_m_per_s,
            peak_m_per_s2: self.means[strongest],
            time_of_peak_s: time_s(strongest) + 0.5 * self.velocity.dt_s(),
            is_whole: ended.is_some(),
            samples: [self.from + start, self.from + end],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_numerics::estimation::random::RandomNumbers;
    use crumple_signal::{Acceleration, Sampled};

    const G: f64 = STANDARD_GRAVITY_M_PER_S2;
    const DT_S: f64 = 1e-4;

    /// A pulse that takes `loss_m_per_s` off in `length_s`.
    #[derive(Debug, Clone, Copy)]
    enum Shape {
        HalfSine,
        Haversine,
        Triangle,
        Square,
    }

    const SHAPES: [Shape; 4] = [Shape::HalfSine, Shape::Haversine, Shape::Triangle, Shape::Square];

    impl Shape {
        /// Acceleration after the share `x` of the pulse, mean 1.
        fn at(self, x: f64) -> f64 {
            use std::f64::consts::PI;
            match self {
                _ if !(0.0..1.0).contains(&x) => 0.0,
                Self::HalfSine => PI / 2.0 * (PI * x).sin(),
                Self::Haversine => 1.0 - (2.0 * PI * x).cos(),
                Self::Triangle => 2.0 - 4.0 * (x - 0.5).abs(),
                Self::Square => 1.0,
            }
        }
    }

    /// The velocity from 15 m/s under pulses (shape, start, length, loss), a steady `drag` after the last and noise;
    /// 10 kHz from -50 ms on.
    fn motion(pulses: &[(Shape, f64, f64, f64)], drag: f64, noise: f64, seed: u64, end_s: f64) -> Signal<Velocity> {
        let mut random = RandomNumbers::of_stream(seed, 0);
        let over = pulses.iter().fold(0.0_f64, |over, (_, start, length, _)| over.max(start + length));
        let samples = (0..((end_s + 0.05) / DT_S) as usize).map(|k| {
            let t = k as f64 * DT_S - 0.05;
            let of =
                |(shape, start, length, loss): &(Shape, f64, f64, f64)| -loss / length * shape.at((t - start) / length);
            pulses.iter().map(of).sum::<f64>() + noise * random.normal() + if t > over { drag } else { 0.0 }
        });
        let a: Signal<Acceleration> = Sampled::new(-0.05, DT_S, samples.collect()).unwrap().into();
        let from = crate::sums::cumulative(&a.samples()[500..], DT_S);
        let v = vec![15.0; 500].into_iter().chain(from.into_iter().map(|dv| 15.0 + dv)).collect();
        Signal::new(-0.05, DT_S, v).unwrap()
    }

    #[test]
    fn an_impact_ends_with_its_force_whatever_noise_and_drag_follow() {
        for (shape, length_s) in SHAPES.into_iter().flat_map(|shape| [0.05, 0.1, 0.15].map(|length| (shape, length))) {
            // White noise before a filter, m/s²; CFC 60 leaves a seventh of it at 10 kHz.
            for (noise, drag) in
                [0.0, 0.02, 0.1].into_iter().flat_map(|n| [0.0, -0.05, 0.05, -0.3].map(|d| (n * G, d * G)))
            {
                for seed in 0..3 {
                    let v = motion(&[(shape, 0.0, length_s, 12.0)], drag, noise, seed, 0.6);
                    let found = impacts(&v);
                    let case = format!("{shape:?} {length_s} s, noise {noise}, drag {drag}, {seed}: {found:?}");
                    let [impact] = found.as_slice() else { panic!("{case}") };
                    assert!(impact.is_whole && impact.start_s == 0.0, "{case}");
                    // The window is 4.4 ms; a haversine stays below 0.3 g for a tenth of its length.
                    assert!((impact.end_s - length_s).abs() < 0.003 + 0.05 * length_s, "{case}");
                    // Half a sample of a step, and what noise and drag do in 5 ms.
                    let slack = 0.015 + 0.005 * drag.abs() + 3.0 * noise * (DT_S * length_s).sqrt();
                    assert!((impact.change_m_per_s + 12.0).abs() < slack, "{case}");
                }
            }
        }
    }

    #[test]
    fn a_second_pulse_is_a_second_impact() {
        for first in SHAPES {
            for second in SHAPES {
                for pause_s in [0.04, 0.1, 0.3] {
                    let at = 0.06 + pause_s;
                    let v = motion(&[(first, 0.0, 0.06, 3.0), (second, at, 0.09, 11.0)], 0.0, 0.02 * G, 1, 0.7);
                    let found = impacts(&v);
                    let case = format!("{first:?} {second:?} {pause_s}: {found:?}");
                    let [one, two] = found.as_slice() else { panic!("{case}") };
                    assert!(
                        (one.change_m_per_s + 3.0).abs() < 0.02 && (two.change_m_per_s + 11.0).abs() < 0.05,
                        "{case}"
                    );
                    // Nearly half of the 4.4 ms that smear a step; a haversine of 90 ms is no power by 1.6 ms.
                    assert!((two.start_s - at).abs() < 0.0025, "{case}");
                    assert!((two.start_velocity_m_per_s - 12.0).abs() < 0.05, "{case}");
                    assert!((two.time_of_peak_s - at - 0.045).abs() < 0.045, "{case}");
                    assert_eq!((one.is_event(), first_event(&found)), (true, Some(0)));
                }
            }
        }
    }

    #[test]
    fn coasting_of_less_than_a_pause_separates_nothing() {
        let v = motion(&[(Shape::Square, 0.0, 0.05, 5.0), (Shape::Square, 0.06, 0.05, 5.0)], 0.0, 0.0, 1, 0.3);
        assert_eq!(impacts(&v).len(), 1);
    }

    #[test]
    fn a_touch_is_an_impact_but_not_the_event_and_a_bounce_is_neither() {
        let v = motion(&[(Shape::HalfSine, 0.0, 0.03, 1.0), (Shape::HalfSine, 0.1, 0.09, 11.0)], 0.0, 0.0, 1, 0.4);
        let found = impacts(&v);
        assert_eq!((found.len(), first_event(&found)), (2, Some(1)));
        let v = motion(&[(Shape::HalfSine, 0.0, 0.09, 15.0), (Shape::HalfSine, 0.2, 0.03, 0.6)], 0.0, 0.0, 1, 0.4);
        assert_eq!(impacts(&v).len(), 1, "4 % of the strongest");
    }

    #[test]
    fn a_record_cut_in_the_pulse_is_not_whole() {
        for end_s in [0.05, 0.07, 0.09] {
            let found = impacts(&motion(&[(Shape::HalfSine, 0.0, 0.1, 12.0)], 0.0, 0.0, 1, end_s));
            assert!(found.len() == 1 && !found[0].is_whole, "{end_s}: {found:?}");
        }
        assert!(impacts(&motion(&[(Shape::HalfSine, 0.0, 0.1, 12.0)], 0.0, 0.0, 1, 0.105))[0].is_whole);
    }

    #[test]
    fn a_record_in_which_nothing_happens_has_no_impact() {
        assert!(impacts(&motion(&[], 0.0, 0.05 * G, 1, 0.5)).is_empty());
        for samples in [vec![], vec![1.0], vec![1.0; 50]] {
            assert!(impacts(&Signal::new(0.0, 1e-3, samples).unwrap()).is_empty());
        }
        assert_eq!(first_event(&[]), None);
    }
}
