//! A free fall, or braking, before contact: what is the level before contact then is no zero.

use crate::{PreEvent, STANDARD_GRAVITY_M_PER_S2, Sampled, pre_event};

/// How far a change of level may be from 1 g and still be that of gravity, m/s²: sensors are calibrated to 2 %, gravity
/// differs by 0.3 % on the ground, and a fall is braked by the air and by rails.
const SLACK_M_PER_S2: f64 = 0.05 * STANDARD_GRAVITY_M_PER_S2;

/// Length of the first part of a record, s, that may show the rest before the fall.
const FIRST_S: f64 = 0.02;

/// Length of the last part of a record, s, that may show the rest after the event.
const LAST_S: f64 = 0.1;

/// The last part is this long after contact at least, s: an impact is over by then.
const OVER_S: f64 = 0.05;

/// Noise that a level at rest has at most, as a factor of that in the fall: what moves is noisier.
const QUIET: f64 = 1.5;

/// Resolution of a record, m/s²: noise below it is none.
const RESOLUTION_M_PER_S2: f64 = 0.02 * STANDARD_GRAVITY_M_PER_S2;

/// Least deceleration that is braking, m/s²: the usual error of a zero level, 0.05 g. What is less is in its interval.
const BRAKING_M_PER_S2: f64 = 0.05 * STANDARD_GRAVITY_M_PER_S2;

/// Most deceleration that is braking, m/s²: a change of 1.13 g is an impact (49 CFR 563.5), and noise moves the mean.
const MOST_BRAKING_M_PER_S2: f64 = 1.2 * STANDARD_GRAVITY_M_PER_S2;

/// The pulse shows its sign up to so long after contact, s: that of a frontal impact lasts longer.
const PULSE_S: f64 = 0.02;

/// What moves the body before contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Moving {
    /// It falls freely.
    Falls,
    /// It brakes, or is pulled.
    Brakes,
}

/// A body that is accelerated before contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingStart {
    /// By what.
    pub by: Moving,
    /// Level at rest, the zero of the motion, m/s².
    pub rest_level: f64,
    /// Level before contact, m/s².
    pub level: f64,
}

/// Whether a level is that of gravity, of either sign.
pub fn is_gravity(level_m_per_s2: f64) -> bool {
    (level_m_per_s2.abs() - STANDARD_GRAVITY_M_PER_S2).abs() <= SLACK_M_PER_S2
}

/// Whether an acceleration, its zero level removed, is that of a body that falls or brakes before contact.
pub fn moves_before_contact(acceleration: &Sampled) -> bool {
    let before = pre_event(acceleration);
    before.is_some_and(|before| before.zero_level.abs() >= BRAKING_M_PER_S2)
}

/// The free fall or the braking before contact, if the level of an acceleration before it, `before`, is not that at
/// rest.
///
/// Braking: 0.05 g to 1.2 g off a steady level at the start of the record, and more than noise makes of it. 1 g against
/// the pulse is a fall, 1 g along it a tyre that brakes at its limit.
///
/// A sensor that feels gravity reads 0 in a fall and 1 g at rest; one that was zeroed at rest reads 1 g in a fall. Of
/// both, what the body accelerates is the reading less the level at rest. The rest is looked for at the start of the
/// record (20 ms, before the motion) and at its end (100 ms, 50 ms after contact at least); it is steady and no noisier
/// than the motion. `None` where no rest shows, or is the level before contact: an offset stays.
pub fn moving_start(samples: &Sampled, before: &PreEvent) -> Option<MovingStart> {
    let (start_s, end_s) = (samples.t0_s(), samples.end_s());
    let first = (start_s + 2.0 * FIRST_S < before.from_s).then_some((start_s, start_s + FIRST_S));
    let last = (end_s - LAST_S > OVER_S).then_some((end_s - LAST_S, end_s));
    let quiet_m_per_s2 = QUIET * before.noise_floor + RESOLUTION_M_PER_S2;
    let steady = |part: Option<(f64, f64)>| steady_level(samples, part?.0, part?.1, quiet_m_per_s2);
    let (first, last) = (steady(first), steady(last));
    let start = |by: Moving, rest_level: f64| MovingStart { by, rest_level, level: before.zero_level };
    let (contact, shown) = (samples.index_at_or_after(0.0), samples.index_at_or_after(PULSE_S));
    let pulse: f64 = samples.samples()[contact..shown].iter().map(|x| x - before.zero_level).sum();
    let is_fall = |level: &f64| is_gravity(level - before.zero_level) && (level - before.zero_level) * pulse >= 0.0;
    let falls = [first, last].into_iter().flatten().find(is_fall);
    let brakes = || {
        // A level that stays after the event is an offset, whatever came before it.
        let stays = last.is_some_and(|level| (level - before.zero_level).abs() < BRAKING_M_PER_S2);
        let off = |level: &f64| (level - before.zero_level).abs();
        // Three deviations of the difference of two means.
        let samples = [before.samples as f64, (FIRST_S / samples.dt_s()).max(1.0)];
        let scatter = 3.0 * before.noise_floor * samples.map(f64::recip).iter().sum::<f64>().sqrt();
        let least = BRAKING_M_PER_S2.max(scatter);
        first.filter(|level| (least..MOST_BRAKING_M_PER_S2).contains(&off(level)) && !stays)
    };
    falls.map(|level| start(Moving::Falls, level)).or_else(|| brakes().map(|level| start(Moving::Brakes, level)))
}

/// The mean of a stretch that is steady: its halves agree, and it has little noise.
fn steady_level(samples: &Sampled, from_s: f64, to_s: f64, quiet_m_per_s2: f64) -> Option<f64> {
    let (from, to) = (samples.index_at_or_after(from_s), samples.index_at_or_after(to_s));
    let part = samples.samples().get(from..to).filter(|part| part.len() >= 4)?;
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    let (level, halves) = (mean(part), part.split_at(part.len() / 2));
    let noise = (part.iter().map(|x| (x - level).powi(2)).sum::<f64>() / part.len() as f64).sqrt();
    // A mean of few noisy samples is no level.
    let is_known = noise <= RESOLUTION_M_PER_S2 * (part.len() as f64).sqrt();
    let is_steady = (mean(halves.0) - mean(halves.1)).abs() <= SLACK_M_PER_S2;
    (noise <= quiet_m_per_s2 && is_known && is_steady).then_some(level)
}

#[cfg(test)]
mod tests {
    use super::*;

    const G: f64 = STANDARD_GRAVITY_M_PER_S2;

    /// Rest until -0.5 s where `rest_first`, a fall until 0, a half sine of 50 g and 20 ms, rest; in g.
    fn drop(rest: f64, fall: f64, rest_first: bool, noise_g: f64) -> Sampled {
        let at = |k: u32| {
            let t = f64::from(k) * 1e-3 - 0.7;
            // A noise that repeats itself after many samples.
            let noise = noise_g * (f64::from(k * 7919 % 1009) / 504.0 - 1.0);
            let level = if t < -0.5 && rest_first || t >= 0.0 { rest } else { fall };
            let pulse = if (0.0..0.02).contains(&t) { 50.0 * (std::f64::consts::PI * t / 0.02).sin() } else { 0.0 };
            G * (level + pulse + noise)
        };
        Sampled::new(-0.7, 1e-3, (0..1500).map(at).collect()).unwrap()
    }

    fn of(samples: &Sampled) -> Option<MovingStart> {
        moving_start(samples, &pre_event(samples)?)
    }

    #[test]
    fn the_level_at_rest_is_found_for_any_sign_offset_and_sensor() {
        for (rest, fall) in [(0.0, -1.0), (1.0, 0.0), (-4.0, -5.0), (0.03, -0.99)] {
            for (rest_first, noise) in [(true, 0.0), (false, 0.0), (true, 0.05), (false, 0.05)] {
                let record = drop(rest, fall, rest_first, noise);
                let turned = record.samples().iter().map(|a| -a).collect();
                let turned = Sampled::new(record.t0_s(), record.dt_s(), turned).unwrap();
                for (record, sign) in [(record, 1.0), (turned, -1.0)] {
                    let found = of(&record).unwrap();
                    assert_eq!(found.by, Moving::Falls);
                    // A mean over 20 samples of a noise of 0.03 g.
                    let off = (found.rest_level / G - sign * rest).abs();
                    assert!(off < 0.02, "{rest} {fall} {rest_first} {noise}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn an_offset_that_stays_and_other_steps_are_no_fall() {
        for (rest, fall) in [(-5.0, -5.0), (1.0, 1.0), (0.0, 0.9), (0.0, 2.0), (0.0, 0.5)] {
            assert_eq!(of(&drop(rest, fall, false, 0.01)), None, "{rest} {fall}");
        }
        // What shakes after the event does not rest.
        let shaken = drop(0.0, -1.0, false, 0.0);
        let shake = |(k, a): (usize, &f64)| if k > 750 { a + 3.0 * (k as f64).sin() } else { *a };
        let shaken = Sampled::new(-0.7, 1e-3, shaken.samples().iter().enumerate().map(shake).collect()).unwrap();
        assert_eq!(of(&shaken), None);
    }

    #[test]
    fn braking_is_no_zero_level_where_the_record_shows_the_rest_before_it() {
        for (rest, level) in [(0.0, 0.8), (0.0, 0.07), (0.1, 0.6), (0.0, 1.0), (0.0, 1.1), (0.0, -0.5)] {
            let found = of(&drop(rest, level, true, 0.02)).unwrap();
            assert_eq!(found.by, Moving::Brakes);
            assert!((found.rest_level / G - rest).abs() < 0.02, "{rest} {level}: {found:?}");
        }
        // Within the error of a zero level, and a level that stays after the event.
        assert_eq!(of(&drop(0.0, 0.04, true, 0.0)), None);
        let at = |k: u32| if k < 200 { 0.0 } else { 0.5 * G };
        assert_eq!(of(&Sampled::new(-0.7, 1e-3, (0..1500).map(at).collect()).unwrap()), None);
    }
}
