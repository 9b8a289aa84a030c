//! Sled pulses of standards: the corridor, velocity, stroke and peak that each demands, and whether a pulse has them.

use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Signal};

use crate::Metric;
use crate::metric::definitions::{CORRIDOR_EXCESS, OUTSIDE_CORRIDOR, SLED_PULSE_MET};

/// Corners of a limit, (s from contact, g), times rising.
type Limit = &'static [(f64, f64)];

/// A peak that must be reached in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastPeak {
    /// The least peak, g.
    pub g: f64,
    /// When it must have been at the latest, s from contact.
    pub by_s: f64,
}

/// What a standard demands of the pulse of a sled. Deceleration of a braked sled and acceleration of a pushed one are
/// positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SledPulse {
    /// Name in options.
    pub name: &'static str,
    /// Standard and clause.
    pub source: &'static str,
    /// The pulse may not be below these, between their first and last corner.
    pub lower: &'static [Limit],
    /// The pulse may not be above these, between their first and last corner.
    pub upper: &'static [Limit],
    /// Least and largest speed before a brake, m/s.
    pub speed_m_per_s: Option<[f64; 2]>,
    /// Least change of velocity, m/s.
    pub least_change_m_per_s: Option<f64>,
    /// Least and largest way to the stop, m.
    pub stroke_m: Option<[f64; 2]>,
    /// The peak.
    pub peak: Option<LeastPeak>,
}

/// Points A to F of the R16 curve.
const R16_LOWER: Limit = &[(0.010, 15.0), (0.015, 20.0), (0.025, 26.0), (0.045, 26.0), (0.055, 20.0), (0.060, 0.0)];
/// Points G to I.
const R16_UPPER: Limit = &[(0.018, 32.0), (0.060, 32.0), (0.080, 0.0)];
const KM_PER_H: f64 = 1.0 / 3.6;
const FT_PER_S: f64 = 0.3048;

/// The sled pulses whose numbers were seen in the text of their standard, or in one that repeats it.
///
/// UN R16 annex 8 is annex IX of directive 77/541/EEC, whose table of corners was read; speed, stopping distance and
/// the segment of an accelerated sled are those of R16 7.7. 14 CFR is quoted from its text. Not here, since no text
/// with their numbers was found: UN R44 and R129 (annex 7), ISO 7176-19, FMVSS 213, 14 CFR 23.562 (b)(2).
pub const SLED_PULSES: &[SledPulse] = &[
    SledPulse {
        name: "ece-r16",
        source: "UN R16 7.7 and annex 8, decelerated sled",
        lower: &[R16_LOWER],
        upper: &[R16_UPPER],
        speed_m_per_s: Some([49.0 * KM_PER_H, 51.0 * KM_PER_H]),
        least_change_m_per_s: None,
        stroke_m: Some([0.35, 0.45]),
        peak: None,
    },
    SledPulse {
        name: "ece-r16-acceleration",
        source: "UN R16 7.7 and annex 8, accelerated sled, without its velocity",
        lower: &[R16_LOWER, &[(0.005, 10.0), (0.010, 20.0)]],
        upper: &[R16_UPPER],
        speed_m_per_s: None,
        least_change_m_per_s: None,
        stroke_m: None,
        peak: None,
    },
    class("14cfr-25.562-forward", "14 CFR 25.562 (b)(2)", 44.0, LeastPeak { g: 16.0, by_s: 0.09 }),
    class("14cfr-25.562-down", "14 CFR 25.562 (b)(1)", 35.0, LeastPeak { g: 14.0, by_s: 0.08 }),
    class("14cfr-23.562-down", "14 CFR 23.562 (b)(1)", 31.0, LeastPeak { g: 15.0, by_s: 0.06 }),
    class("14cfr-23.562-down-first-row", "14 CFR 23.562 (b)(1), first row", 31.0, LeastPeak { g: 19.0, by_s: 0.05 }),
];

/// A class of pulses: a least change of velocity, and a peak.
const fn class(name: &'static str, source: &'static str, least_ft_per_s: f64, peak: LeastPeak) -> SledPulse {
    SledPulse {
        name,
        source,
        lower: &[],
        upper: &[],
        speed_m_per_s: None,
        least_change_m_per_s: Some(least_ft_per_s * FT_PER_S),
        stroke_m: None,
        peak: Some(peak),
    }
}

/// What was measured beside the samples.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measured {
    /// Change of velocity with its sign, m/s: it says which way is positive.
    pub change_m_per_s: f64,
    /// The record goes on beyond the end of the impact; else the change is a lower bound.
    pub is_whole: bool,
    /// Speed before the brake, where the sled had one, m/s.
    pub speed_m_per_s: Option<f64>,
    /// Way to the stop, m.
    pub stroke_m: Option<f64>,
}

/// A sample outside of a corridor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Excursion {
    /// Its time, s from contact.
    pub time_s: f64,
    /// Its value, m/s².
    pub value_m_per_s2: f64,
    /// The limit there, m/s².
    pub limit_m_per_s2: f64,
    /// It is below a lower limit, else above an upper one.
    pub is_below: bool,
}

impl Excursion {
    /// How far outside it is, m/s².
    pub fn excess_m_per_s2(&self) -> f64 {
        (self.value_m_per_s2 - self.limit_m_per_s2).abs()
    }

    fn words(&self) -> String {
        let g = |a: f64| a / STANDARD_GRAVITY_M_PER_S2;
        let (value, limit) = (g(self.value_m_per_s2), g(self.limit_m_per_s2));
        let bound = if self.is_below { "at least" } else { "at most" };
        format!("{value:.1} g at {:.1} ms ({bound} {limit:.1} g)", 1e3 * self.time_s)
    }
}

/// One thing that is demanded, in words, and whether it is met; `None`: not known from this record.
#[derive(Debug, Clone, PartialEq)]
pub struct Demand {
    /// `corridor: inside`, `velocity 49.2 km/h, expected 49.0 to 51.0 km/h`.
    pub words: String,
    /// Whether it is met.
    pub is_met: Option<bool>,
}

/// A pulse beside what a standard demands.
#[derive(Debug, Clone, PartialEq)]
pub struct SledCheck {
    /// The standard.
    pub pulse: SledPulse,
    /// First sample outside of the corridor.
    pub first: Option<Excursion>,
    /// Sample that is furthest outside.
    pub furthest: Option<Excursion>,
    /// Everything that is demanded.
    pub demands: Vec<Demand>,
}

impl SledCheck {
    /// Whether everything is met; `None`: nothing is violated, and not everything is known.
    pub fn is_met(&self) -> Option<bool> {
        let all = || self.demands.iter().map(|demand| demand.is_met);
        if all().any(|is_met| is_met == Some(false)) {
            Some(false)
        } else {
            all().collect::<Option<Vec<_>>>().map(|_| true)
        }
    }

    /// `sled pulse ece-r16 (UN R16 ...) is not met: corridor outside first ...; velocity ...`
    pub fn words(&self) -> String {
        let met = match self.is_met() {
            Some(true) => "is met",
            Some(false) => "is not met",
            None => "is met as far as this record shows",
        };
        let demands: Vec<&str> = self.demands.iter().map(|demand| demand.words.as_str()).collect();
        format!("sled pulse {} ({}) {met}: {}", self.pulse.name, self.pulse.source, demands.join("; "))
    }

    /// Whether it is met, and how far and from when on the pulse is outside of its corridor.
    pub fn metrics(&self) -> [Metric; 3] {
        let has_corridor = !(self.pulse.lower.is_empty() && self.pulse.upper.is_empty());
        let met = self.is_met().map(|is_met| f64::from(u8::from(is_met)));
        let excess = self.furthest.map_or(0.0, |furthest| furthest.excess_m_per_s2());
        let at = |metric: Metric, time_s: Option<f64>| {
            let time_s = time_s.unwrap_or(0.0);
            metric.over(time_s, time_s).remarked(self.pulse.name)
        };
        let no_corridor = "the sled pulse has no corridor";
        let inside = if has_corridor { "the pulse is inside of the corridor" } else { no_corridor };
        [
            at(Metric::of(&SLED_PULSE_MET, met, "the record does not show all that is demanded"), None),
            at(
                Metric::of(&CORRIDOR_EXCESS, has_corridor.then_some(excess), no_corridor),
                self.furthest.map(|furthest| furthest.time_s),
            ),
            at(
                Metric::of(&OUTSIDE_CORRIDOR, self.first.map(|first| first.time_s), inside),
                self.first.map(|first| first.time_s),
            ),
        ]
    }
}

/// Holds a pulse against the sled pulse of a standard. Times count from contact: where a standard counts from 0.5 g, as
/// ISO 17373 does, contact must be settled so.
///
/// Limits are straight between their corners, and nothing is demanded before the first and after the last. Every sample
/// between counts, without a tolerance; a record that ends before the corridor does is not known to be inside. Peaks
/// are of samples: CFC 60 takes 1 % off the tip of a triangle of 180 ms, and 40 % off a shock of 6 ms.
pub fn check_sled_pulse(pulse: SledPulse, acceleration: &Signal<Acceleration>, measured: Measured) -> SledCheck {
    let sign = if measured.change_m_per_s < 0.0 { -1.0 } else { 1.0 };
    let from_contact = acceleration.index_at_or_after(0.0)..acceleration.len();
    let samples = || from_contact.clone().map(|k| (acceleration.time_s(k), sign * acceleration.samples()[k]));
    let limits = || pulse.lower.iter().map(|l| (l, true)).chain(pulse.upper.iter().map(|l| (l, false)));
    let outside = |(time_s, value_m_per_s2): (f64, f64)| {
        let beyond = limits().filter_map(move |(limit, is_below)| {
            let limit_m_per_s2 = STANDARD_GRAVITY_M_PER_S2 * at(limit, time_s)?;
            let is_outside = if is_below { value_m_per_s2 < limit_m_per_s2 } else { value_m_per_s2 > limit_m_per_s2 };
            is_outside.then_some(Excursion { time_s, value_m_per_s2, limit_m_per_s2, is_below })
        });
        beyond.max_by(|a, b| a.excess_m_per_s2().total_cmp(&b.excess_m_per_s2()))
    };
    let first = samples().find_map(outside);
    let furthest = samples().filter_map(outside).max_by(|a, b| a.excess_m_per_s2().total_cmp(&b.excess_m_per_s2()));
    let corridor_ends = limits().filter_map(|(limit, _)| limit.last()).map(|(t, _)| *t).reduce(f64::max);
    let corridor = corridor_ends.map(|end_s| match (first, furthest) {
        (Some(first), Some(furthest)) => Demand {
            words: format!("outside of its corridor first with {}, furthest with {}", first.words(), furthest.words()),
            is_met: Some(false),
        },
        _ if acceleration.end_s() < end_s => Demand {
            words: format!(
                "inside of its corridor up to the end of the record at {:.1} ms",
                1e3 * acceleration.end_s()
            ),
            is_met: None,
        },
        _ => Demand { words: "inside of its corridor".to_owned(), is_met: Some(true) },
    });
    let speed = pulse.speed_m_per_s.map(|range| {
        // A sled that is pushed to a speed and braked by another pulse is no matter of this one.
        let speed = measured.speed_m_per_s.filter(|speed| *speed > 0.0);
        in_range("velocity", speed, range, (3.6, 1, "km/h"))
    });
    let change = pulse.least_change_m_per_s.map(|least| {
        let change = measured.change_m_per_s.abs();
        let demand = in_range("change of velocity", Some(change), [least, f64::INFINITY], (3.6, 1, "km/h"));
        // A record that the impact outlasts shows a part of it.
        Demand { is_met: demand.is_met.filter(|is_met| *is_met || measured.is_whole), ..demand }
    });
    let stroke = pulse.stroke_m.map(|range| in_range("stroke", measured.stroke_m, range, (1e3, 0, "mm")));
    let peak = pulse.peak.map(|LeastPeak { g, by_s }| {
        let up_to = samples().take_while(|(t, _)| *t <= by_s + 1e-9);
        let largest = up_to.map(|(_, a)| a / STANDARD_GRAVITY_M_PER_S2).fold(0.0, f64::max);
        let words = format!("{largest:.2} g within {:.0} ms, expected at least {g:.0} g", 1e3 * by_s);
        Demand { words, is_met: Some(largest >= g * (1.0 - 1e-12)) }
    });
    SledCheck {
        pulse,
        first,
        furthest,
        demands: [corridor, speed, change, stroke, peak].into_iter().flatten().collect(),
    }
}

/// A value and the range that it should lie in, in a unit with its decimals.
fn in_range(
    what: &str,
    value: Option<f64>,
    [low, high]: [f64; 2],
    (factor, decimals, unit): (f64, usize, &str),
) -> Demand {
    let show = |si: f64| format!("{:.decimals$}", factor * si);
    let range =
        if high.is_finite() { format!("{} to {}", show(low), show(high)) } else { format!("at least {}", show(low)) };
    match value {
        Some(value) => {
            let is_met = (low..=high).contains(&value);
            Demand { words: format!("{what} {} {unit}, expected {range} {unit}", show(value)), is_met: Some(is_met) }
        }
        None => Demand { words: format!("{what} not known, expected {range} {unit}"), is_met: None },
    }
}

/// A limit at a time, g; `None` before its first and after its last corner.
fn at(limit: Limit, time_s: f64) -> Option<f64> {
    let pair = limit.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&time_s))?;
    let [(t0, g0), (t1, g1)] = [pair[0], pair[1]];
    Some(g0 + (g1 - g0) * (time_s - t0) / (t1 - t0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> SledPulse {
        *SLED_PULSES.iter().find(|pulse| pulse.name == name).unwrap()
    }

    /// Straight lines between points (s, g), 20 ms at rest before contact; positive as in the standards.
    fn record(points: &[(f64, f64)], sign: f64, end_s: f64) -> Signal<Acceleration> {
        let value = |t: f64| {
            let pair = points.windows(2).find(|pair| (pair[0].0..=pair[1].0).contains(&t));
            pair.map_or(0.0, |p| p[0].1 + (p[1].1 - p[0].1) * (t - p[0].0) / (p[1].0 - p[0].0))
        };
        let last = (end_s * 1e4).round() as i32;
        let samples = (-200..=last).map(|k| sign * STANDARD_GRAVITY_M_PER_S2 * value(f64::from(k) * 1e-4)).collect();
        Signal::new(-0.02, 1e-4, samples).unwrap()
    }

    /// Between the limits of R16.
    const INSIDE: [(f64, f64); 5] = [(0.0, 0.0), (0.012, 24.0), (0.022, 29.0), (0.052, 28.0), (0.068, 0.0)];
    const MEASURED: Measured =
        Measured { change_m_per_s: -50.0 / 3.6, is_whole: true, speed_m_per_s: Some(50.0 / 3.6), stroke_m: Some(0.4) };

    #[test]
    fn a_pulse_between_the_corners_is_inside_whichever_way_it_acts() {
        for (sign, change_m_per_s) in [(-1.0, -50.0 / 3.6), (1.0, 50.0 / 3.6)] {
            let measured = Measured { change_m_per_s, ..MEASURED };
            let check = check_sled_pulse(named("ece-r16"), &record(&INSIDE, sign, 0.2), measured);
            assert_eq!((check.is_met(), check.first), (Some(true), None), "{}", check.words());
            let [met, excess, outside] = check.metrics();
            assert_eq!((met.value, excess.value, outside.value), (Some(1.0), Some(0.0), None));
        }
        // Cut at 40 ms it is not known to be inside.
        let cut = check_sled_pulse(named("ece-r16"), &record(&INSIDE, -1.0, 0.04), MEASURED);
        assert_eq!(cut.is_met(), None, "{}", cut.words());
    }

    #[test]
    fn a_pulse_that_leaves_the_corridor_says_where_first_and_how_far() {
        // 30 to 40 ms at 33.5 g: 1.5 g above, from where the line from 29 g passes 32 g on.
        let points =
            [(0.0, 0.0), (0.012, 24.0), (0.022, 29.0), (0.031, 33.5), (0.04, 33.5), (0.052, 28.0), (0.068, 0.0)];
        let check = check_sled_pulse(named("ece-r16"), &record(&points, -1.0, 0.2), MEASURED);
        assert_eq!(check.is_met(), Some(false));
        let (first, furthest) = (check.first.unwrap(), check.furthest.unwrap());
        // 29 + 0.5 g/ms is 32 g at 28 ms; the sample there is on the limit, or above it by rounding.
        assert!((first.time_s - 0.0281).abs() < 1.1e-4 && !first.is_below, "{first:?}");
        assert!((furthest.excess_m_per_s2() - 1.5 * STANDARD_GRAVITY_M_PER_S2).abs() < 1e-9, "{furthest:?}");
        let [_, excess, outside] = check.metrics();
        assert_eq!((excess.value, outside.value), (Some(furthest.excess_m_per_s2()), Some(first.time_s)));
        assert!(check.words().contains("33.5 g at") && check.words().contains("(at most 32.0 g)"), "{}", check.words());
        // A wrong speed alone is enough.
        let slow = Measured { speed_m_per_s: Some(48.0 / 3.6), ..MEASURED };
        let check = check_sled_pulse(named("ece-r16"), &record(&INSIDE, -1.0, 0.2), slow);
        assert_eq!((check.is_met(), check.first), (Some(false), None));
        assert!(check.words().contains("velocity 48.0 km/h, expected 49.0 to 51.0 km/h"), "{}", check.words());
    }

    #[test]
    fn an_accelerated_sled_must_stay_above_its_segment_too() {
        // 24 g at 12 ms is 10 g at 5 ms and 20 g at 10 ms: on the segment; a little slower is below it.
        let faster = [(0.0, 1.0), (0.012, 25.0), (0.022, 29.0), (0.052, 28.0), (0.068, 0.0)];
        let slower = [(0.0, 0.0), (0.013, 24.0), (0.022, 29.0), (0.052, 28.0), (0.068, 0.0)];
        let of = |points: &[(f64, f64)]| {
            check_sled_pulse(named("ece-r16-acceleration"), &record(points, 1.0, 0.2), Measured::default())
        };
        assert_eq!(of(&faster).is_met(), Some(true), "{}", of(&faster).words());
        let first = of(&slower).first.unwrap();
        assert!(first.is_below && (first.time_s - 0.005).abs() < 1.1e-4, "{first:?}");
    }

    #[test]
    fn the_triangles_of_14_cfr_meet_their_class_and_one_that_peaks_late_does_not() {
        let forward = named("14cfr-25.562-forward");
        // 16 g·0.18 s/2 = 14.12 m/s, more than 44 ft/s.
        let triangle = record(&[(0.0, 0.0), (0.09, 16.0), (0.18, 0.0)], -1.0, 0.3);
        let measured = Measured { change_m_per_s: -14.1216, is_whole: true, ..Measured::default() };
        let check = check_sled_pulse(forward, &triangle, measured);
        assert_eq!(check.is_met(), Some(true), "{}", check.words());
        assert_eq!(check.metrics()[1].value, None);
        let late = record(&[(0.0, 0.0), (0.1, 16.0), (0.18, 0.0)], -1.0, 0.3);
        assert_eq!(check_sled_pulse(forward, &late, measured).is_met(), Some(false));
        // A triangle of 15 g at 60 ms falls 6.6 % short of 31 ft/s.
        let down = record(&[(0.0, 0.0), (0.06, 15.0), (0.12, 0.0)], -1.0, 0.3);
        let measured = Measured { change_m_per_s: -8.826, is_whole: true, ..Measured::default() };
        assert_eq!(check_sled_pulse(named("14cfr-23.562-down"), &down, measured).is_met(), Some(false));
        // A record that ends before may have missed the rest, and the speed before the impact does not count.
        let cut = Measured { is_whole: false, speed_m_per_s: Some(14.0), ..measured };
        assert_eq!(check_sled_pulse(named("14cfr-23.562-down"), &down, cut).is_met(), None);
    }

    #[test]
    fn names_are_unique_and_times_rise() {
        for (k, pulse) in SLED_PULSES.iter().enumerate() {
            assert!(SLED_PULSES[..k].iter().all(|other| other.name != pulse.name));
            for limit in pulse.lower.iter().chain(pulse.upper) {
                assert!(limit.windows(2).all(|pair| pair[0].0 < pair[1].0), "{}", pulse.name);
            }
        }
    }
}
