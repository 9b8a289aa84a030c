//! Whether an impact speed and a pulse can belong together, and what may have been exchanged where they cannot.
//!
//! Against a rigid barrier the change of velocity is 1 to 1.3 times the impact speed. A unit, a speed, a time or a sign
//! that was taken for another one changes that ratio by a known factor, and no two of these factors are nearer to each
//! other than 1.6: at most one exchange brings the ratio back. Crush, peak and duration of a car must fit beside it.

use std::ops::RangeInclusive;

use crumple_signal::{STANDARD_GRAVITY_M_PER_S2, Sampled, SignalError, pre_event as level_before};

/// Miles per hour and kilometres per hour.
const KM_PER_MILE: f64 = 1.609_344;
/// Kilometres per hour and metres per second.
const KM_PER_H_PER_M_PER_S: f64 = 3.6;

/// What may have been taken for something else. A factor turns what was read into what is meant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exchange {
    /// The unit of the acceleration: g and m/s².
    Unit(f64),
    /// The unit of the impact speed: km/h, mph and m/s.
    Speed(f64),
    /// The unit of the time: s and ms.
    Time(f64),
    /// The sign of the acceleration.
    Polarity,
}

/// The exchanges that are tried.
pub const EXCHANGES: [Exchange; 9] = [
    Exchange::Unit(STANDARD_GRAVITY_M_PER_S2),
    Exchange::Unit(1.0 / STANDARD_GRAVITY_M_PER_S2),
    Exchange::Speed(KM_PER_MILE),
    Exchange::Speed(1.0 / KM_PER_MILE),
    Exchange::Speed(KM_PER_H_PER_M_PER_S),
    Exchange::Speed(1.0 / KM_PER_H_PER_M_PER_S),
    Exchange::Time(1e-3),
    Exchange::Time(1e3),
    Exchange::Polarity,
];

impl Exchange {
    fn of_acceleration(self) -> f64 {
        match self {
            Self::Unit(factor) => factor,
            Self::Polarity => -1.0,
            Self::Speed(_) | Self::Time(_) => 1.0,
        }
    }

    fn of_speed(self) -> f64 {
        if let Self::Speed(factor) = self { factor } else { 1.0 }
    }

    fn of_time(self) -> f64 {
        if let Self::Time(factor) = self { factor } else { 1.0 }
    }
}

/// An impact as a pulse and an impact speed show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// Impact speed, m/s.
    pub impact_speed_m_per_s: f64,
    /// Change of velocity over impact speed: 1 and the coefficient of restitution where the vehicle stops.
    pub change: f64,
    /// Dynamic crush, or the displacement at the lowest velocity, m.
    pub crush_m: f64,
    /// Largest deceleration, mean of 4.4 ms, m/s².
    pub peak_m_per_s2: f64,
    /// Time in which 98 % of the change of velocity happens, s.
    pub duration_s: f64,
    /// The acceleration is small where the velocity is lowest: the record shows the whole pulse.
    pub is_whole: bool,
}

/// What an impact speed and a pulse say together.
#[derive(Debug, Clone, PartialEq)]
pub enum Plausibility {
    /// The pulse stops the vehicle from the impact speed, and it rebounds as vehicles do.
    Consistent,
    /// It does so after one exchange alone, with the impact that this gives.
    After(Exchange, Impact),
    /// It does so after any of several.
    AfterAnyOf(Vec<Exchange>),
    /// It does not, and no exchange helps.
    Inconsistent,
}

/// Largest coefficient of restitution of a vehicle against a barrier at [`AT_M_PER_S`] and above.
const LARGEST: f64 = 0.3;
/// 50 km/h.
const AT_M_PER_S: f64 = 50.0 / 3.6;

/// The largest coefficient of restitution that a vehicle is believed at an impact speed: 0.3 at 50 km/h and above, more
/// at lower speeds, where less of the structure yields: `0.3·sqrt(50 km/h / v0)`, at most 1. A rule of thumb: 0.36 at
/// 35 km/h, 0.67 at 10 km/h.
pub fn largest_restitution(impact_speed_m_per_s: f64) -> f64 {
    (LARGEST * (AT_M_PER_S / impact_speed_m_per_s).sqrt().max(1.0)).min(1.0)
}

/// What a rounded speed and a zero level do to the ratio of change of velocity and impact speed.
const SLACK: f64 = 0.05;
/// Crush of cars, m, at 50 km/h and above; less at lower speeds, in proportion.
const CRUSH_M: RangeInclusive<f64> = 0.2..=1.2;
/// Peaks of cars behind CFC 60, m/s², likewise.
const PEAK_M_PER_S2: RangeInclusive<f64> = 10.0 * STANDARD_GRAVITY_M_PER_S2..=80.0 * STANDARD_GRAVITY_M_PER_S2;
/// Largest crush over impact speed of cars, s: 0.95 m at 56 km/h; of 581 tests at that speed half lie between 0.626 and
/// 0.708 m (NHTSA, full frontal, 2010 to 2023).
const LONGEST_CRUSH_S: f64 = 0.061;
/// Durations of pulses of cars, s. A half sine shows 91 % of its own as that of 98 % of the change.
const DURATION_S: RangeInclusive<f64> = 0.045..=0.2;

impl Impact {
    /// Whether the pulse stops the vehicle, and it rebounds no faster than vehicles do.
    pub fn stops(&self) -> bool {
        (1.0..=1.0 + largest_restitution(self.impact_speed_m_per_s)).contains(&self.change)
    }

    /// Whether it is an impact of a car at a rigid barrier, by its restitution, crush, peak and duration. What is
    /// proportional to speed has lower limits below 50 km/h.
    pub fn is_of_a_car(&self) -> bool {
        let slower = (self.impact_speed_m_per_s / AT_M_PER_S).min(1.0);
        let is_in = |range: &RangeInclusive<f64>, x: f64| (slower * range.start()..=*range.end()).contains(&x);
        let rebound = 1.0 + largest_restitution(self.impact_speed_m_per_s) + SLACK;
        (1.0 - SLACK..=rebound).contains(&self.change)
            && is_in(&CRUSH_M, self.crush_m)
            && is_in(&PEAK_M_PER_S2, self.peak_m_per_s2)
            && DURATION_S.contains(&self.duration_s)
            && self.is_whole
    }
}

/// Holds an impact speed against a pulse, deceleration negative, and tries every [exchange](EXCHANGES) where they do
/// not fit. `zero_level`: what the sensor shows at rest, unit of the pulse. `None`: a speed that is none.
///
/// A speed is exchanged only if the number that would have been typed is a short one: 35 km/h is 35, and 21.7 mph.
pub fn plausibility(pulse: &Sampled, zero_level: f64, impact_speed_m_per_s: f64) -> Option<Plausibility> {
    if impact_speed_m_per_s.is_nan() || impact_speed_m_per_s <= 0.0 {
        return None;
    }
    let as_read = view(pulse, None, zero_level).and_then(|pulse| impact(&pulse, impact_speed_m_per_s));
    if as_read.is_some_and(|impact| impact.stops()) {
        return Some(Plausibility::Consistent);
    }
    let found: Vec<(Exchange, Impact)> = EXCHANGES
        .into_iter()
        .filter(|exchange| number_typed(*exchange, impact_speed_m_per_s).is_none_or(is_short))
        .filter_map(|exchange| {
            let pulse = view(pulse, Some(exchange), zero_level)?;
            let impact = impact(&pulse, exchange.of_speed() * impact_speed_m_per_s)?;
            // An elastic model springs back at 0.5 to 1 of its speed, and that is no exchange of km/h and mph.
            let springs_back =
                exchange == Exchange::Speed(KM_PER_MILE) && as_read.is_some_and(|impact| impact.change <= 2.0);
            let is_soft = impact.crush_m > LONGEST_CRUSH_S * impact.impact_speed_m_per_s;
            (impact.is_of_a_car() && !(springs_back && is_soft)).then_some((exchange, impact))
        })
        .collect();
    Some(match found.as_slice() {
        [] => Plausibility::Inconsistent,
        [(exchange, impact)] => Plausibility::After(*exchange, *impact),
        several => Plausibility::AfterAnyOf(several.iter().map(|(exchange, _)| *exchange).collect()),
    })
}

/// The number that was typed for a speed if its unit was exchanged: of 15.6 m/s read as km/h it is 15.6.
pub fn number_typed(exchange: Exchange, impact_speed_m_per_s: f64) -> Option<f64> {
    let Exchange::Speed(factor) = exchange else { return None };
    let km_per_h = KM_PER_H_PER_M_PER_S * impact_speed_m_per_s;
    Some(match factor {
        KM_PER_MILE | KM_PER_H_PER_M_PER_S => km_per_h,
        _ if factor > 0.5 => km_per_h / KM_PER_MILE,
        _ => impact_speed_m_per_s,
    })
}

/// Whether a number has three decimals at most, but for rounding.
fn is_short(number: f64) -> bool {
    let rounded = (number * 1e3).round() / 1e3;
    (number - rounded).abs() <= 1e-9 * number.abs()
}

/// The part of a pulse that matters after an exchange, its zero level removed.
fn view(pulse: &Sampled, exchange: Option<Exchange>, zero_level: f64) -> Option<Sampled> {
    const FROM_S: f64 = -0.06;
    const TO_S: f64 = 0.6;
    const RECORDED_S: RangeInclusive<f64> = 1e-7..=0.02;
    let (by, of_time) = exchange.map_or((1.0, 1.0), |exchange| (exchange.of_acceleration(), exchange.of_time()));
    // Intervals of recorders; another one is none that was exchanged.
    if of_time != 1.0 && !RECORDED_S.contains(&(pulse.dt_s() * of_time)) {
        return None;
    }
    let (from, to) = (pulse.index_at_or_after(FROM_S / of_time), pulse.index_at_or_after(TO_S / of_time));
    let part = pulse.slice(from, to.max(from));
    let scaled = |zero: f64| -> Result<Sampled, SignalError> {
        let samples = part.samples().iter().map(|a| by * (a - zero)).collect();
        Sampled::new(part.t0_s() * of_time, part.dt_s() * of_time, samples)
    };
    if of_time == 1.0 {
        return scaled(zero_level).ok();
    }
    // On another axis other samples stand before the event.
    let raw = scaled(0.0).ok()?;
    let level = level_before(&raw).map_or(0.0, |before| before.zero_level);
    scaled(level / by).ok()
}

/// The impact that a pulse without zero level shows from t = 0 on, by the trapezoid. A pulse that begins 20 ms later or
/// more starts there: contact is not at t = 0.
fn impact(pulse: &Sampled, v0: f64) -> Option<Impact> {
    const LATE_S: f64 = 0.02;
    const LONGEST_S: f64 = 0.4;
    const SMOOTHING_S: f64 = 0.0044;
    let dt = pulse.dt_s();
    let zero = pulse.index_at_or_after(0.0);
    let all = changes(pulse.samples().get(zero..)?, dt);
    let largest = all.iter().fold(0.0_f64, |most, change| most.max(-change));
    let late = all.iter().position(|change| -change > 0.01 * largest).unwrap_or(0);
    let late = if late as f64 * dt > LATE_S { late } else { 0 };
    let a = &pulse.samples()[zero + late..];
    let a = &a[..a.len().min((LONGEST_S / dt).min(1e9) as usize + 1)];
    let v: Vec<f64> = changes(a, dt).into_iter().map(|change| v0 + change).collect();
    let lowest = (0..v.len()).min_by(|i, k| v[*i].total_cmp(&v[*k]))?;
    let change = v0 - v[lowest];
    let reaches = |part: f64| v.iter().position(|v| v0 - v >= part * change);
    let at_crush = v.iter().position(|v| *v <= 0.0).unwrap_or(lowest);
    let crush_m = v[..=at_crush].windows(2).map(|pair| dt * (pair[0] + pair[1]) / 2.0).sum();
    let half = (SMOOTHING_S / dt / 2.0).min(a.len() as f64) as usize;
    let sums = running_sums(a.iter().copied());
    let mean = |k: usize| {
        let (from, to) = (k.saturating_sub(half), (k + half + 1).min(a.len()));
        (sums[to] - sums[from]) / (to - from) as f64
    };
    let peak_m_per_s2 = (0..a.len()).map(|k| -mean(k)).fold(0.0, f64::max);
    let is_whole = lowest + 1 < v.len() || mean(lowest).abs() < 0.1 * peak_m_per_s2;
    let duration_s = reaches(0.98)? as f64 * dt;
    let impact = Impact { impact_speed_m_per_s: v0, change: change / v0, crush_m, peak_m_per_s2, duration_s, is_whole };
    (peak_m_per_s2 > 0.0 && impact.change.is_finite()).then_some(impact)
}

/// Changes of velocity since the first sample, m/s, by the trapezoid.
fn changes(a: &[f64], dt_s: f64) -> Vec<f64> {
    running_sums(a.windows(2).map(|pair| dt_s * (pair[0] + pair[1]) / 2.0))
}

/// 0 and the sums of the first, the first two, ... of some numbers.
fn running_sums(numbers: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sums = vec![0.0];
    let mut sum = 0.0;
    sums.extend(numbers.map(|x| {
        sum += x;
        sum
    }));
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    const G: f64 = STANDARD_GRAVITY_M_PER_S2;

    /// A pulse of a shape over its duration (0 to 1), which changes the velocity by `change` in `duration_s`; 5 kHz
    /// from -60 ms, with an offset and a little noise.
    fn pulse(shape: fn(f64) -> f64, change: f64, duration_s: f64) -> Sampled {
        let area: f64 = (0..1000).map(|k| shape((f64::from(k) + 0.5) / 1000.0)).sum::<f64>() / 1000.0;
        let at = |k: i32| {
            let t = f64::from(k) * 2e-4 - 0.06;
            let part = t / duration_s;
            let a = if (0.0..1.0).contains(&part) { -change / (duration_s * area) * shape(part) } else { 0.0 };
            a + 0.3 * G + 0.05 * G * f64::from(k * k % 101 - 50) / 50.0
        };
        Sampled::new(-0.06, 2e-4, (0..1800).map(at).collect()).unwrap()
    }

    fn half_sine(x: f64) -> f64 {
        (std::f64::consts::PI * x).sin()
    }

    fn haversine(x: f64) -> f64 {
        half_sine(x).powi(2)
    }

    /// An early peak, a plateau and a late one.
    fn of_a_car(x: f64) -> f64 {
        half_sine(x) * (1.0 + 0.4 * (9.0 * x).cos()) + 0.3 * half_sine(x).powi(4)
    }

    /// The pulse held against the speed, the level before it taken for zero.
    fn held(pulse: &Sampled, v0: f64) -> Option<Plausibility> {
        let zero_level = level_before(pulse).map_or(0.0, |before| before.zero_level);
        plausibility(pulse, zero_level, v0)
    }

    const SHAPES: [fn(f64) -> f64; 3] = [half_sine, haversine, of_a_car];

    /// The right record, as it is after somebody took one thing for another.
    fn spoilt(right: &Sampled, by: Exchange) -> Sampled {
        let samples = right.samples().iter().map(|a| a / by.of_acceleration()).collect();
        Sampled::new(right.t0_s() / by.of_time(), right.dt_s() / by.of_time(), samples).unwrap()
    }

    #[test]
    fn right_records_raise_no_question() {
        for shape in SHAPES {
            for km_per_h in [25.0, 35.0, 40.0, 50.0, 56.3, 64.0] {
                for restitution in [0.05, 0.1, 0.25] {
                    let v0 = km_per_h / 3.6;
                    let found = held(&pulse(shape, v0 * (1.0 + restitution), 0.1), v0);
                    assert_eq!(found, Some(Plausibility::Consistent), "{km_per_h} km/h, {restitution}");
                }
            }
        }
    }

    #[test]
    fn each_exchange_is_found_and_no_other() {
        for shape in SHAPES {
            for km_per_h in [25.0, 35.0, 40.0, 50.0, 56.0, 64.0] {
                for (restitution, duration_s) in [(0.05, 0.1), (0.1, 0.08), (0.25, 0.11)] {
                    let v0 = km_per_h / 3.6;
                    let right = pulse(shape, v0 * (1.0 + restitution), duration_s);
                    for exchange in EXCHANGES {
                        let stated = v0 / exchange.of_speed();
                        // The number that was typed is that of the right unit.
                        if number_typed(exchange, stated).is_some_and(|number| !is_short(number)) {
                            continue;
                        }
                        let found = held(&spoilt(&right, exchange), stated);
                        let Some(Plausibility::After(named, impact)) = found else {
                            panic!("{exchange:?} at {km_per_h} km/h: {found:?}")
                        };
                        assert_eq!(named, exchange, "{km_per_h} km/h");
                        // What the offset of 0.3 g leaves, and noise.
                        assert!((impact.change - 1.0 - restitution).abs() < 0.02, "{impact:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn every_exchange_of_speeds_is_tried_by_the_test() {
        let typed = [
            (Exchange::Speed(KM_PER_MILE), 56.0 / 3.6, 56.0),
            (Exchange::Speed(1.0 / KM_PER_MILE), 35.0 * KM_PER_MILE / 3.6, 35.0),
            (Exchange::Speed(KM_PER_H_PER_M_PER_S), 15.6 / 3.6, 15.6),
            (Exchange::Speed(1.0 / KM_PER_H_PER_M_PER_S), 50.0, 50.0),
        ];
        for (exchange, stated, number) in typed {
            assert!((number_typed(exchange, stated).unwrap() - number).abs() < 1e-12);
            let v0 = stated * exchange.of_speed();
            let found = held(&pulse(half_sine, 1.1 * v0, 0.09), stated);
            assert!(
                matches!(found, Some(Plausibility::After(named, _)) if named == exchange),
                "{exchange:?}: {found:?}"
            );
        }
    }

    #[test]
    fn what_no_exchange_explains_names_none() {
        let v0 = 50.0 / 3.6;
        // Glancing: 70 % of the speed; 64 km/h would be 39.77 mph, which nobody types.
        assert_eq!(held(&pulse(half_sine, 0.7 * v0, 0.1), v0), Some(Plausibility::Inconsistent));
        // An elastic model at 35 km/h springs back at 0.8: 35 mph would be a crush of 1.02 m.
        let v0 = 35.0 / 3.6;
        assert_eq!(held(&pulse(half_sine, 1.8 * v0, 0.139), v0), Some(Plausibility::Inconsistent));
        // From rest there is nothing to hold against the pulse.
        assert_eq!(held(&pulse(half_sine, 10.0, 0.1), 0.0), None);
    }
}
