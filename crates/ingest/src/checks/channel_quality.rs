//! What is noted of channels: clipping, dropouts, drift; sensors of one place that disagree.
//!
//! Notes on the quality of the channels: each check with its figure, none a correction.
//!
//! | check | figure | noted when |
//! |---|---|---|
//! | zero level | mean from -50 to -10 ms | less than 10 ms of it is there |
//! | offset | the same mean | above 0.5 g |
//! | free fall | level from -50 to -10 ms against that at rest | 1 g apart, or 1 g where no rest shows |
//! | muted start | exact zeros at the start of the record | more than ten before the end of the window |
//! | noise before the event | standard deviation of the same window | above 1 g |
//! | polarity | change of velocity in 150 ms | positive and more than 5 % of the impact speed; not of an occupant |
//! | clipping | equal samples in a row at an extreme | 3 and more |
//! | dropouts | equal samples in a row while the signal is active | 5 and more, over at least 0.5 ms |
//! | drift | mean over the last 20 ms, zero level removed | above 0.5 g, 100 ms and more after contact |
//! | sampling rate | samples a second | below 600 Hz, ten times CFC 60 |
//! | resampling need | channels on another grid than the pulse | any |
//! | time jitter | largest distance of a stamp from the grid | above 1 % of an interval |
//!
//! The pulse is warned about, the other accelerations share one note a check.

use std::collections::BTreeMap;

use crumple_signal::iso13499::IsoCode;
use crumple_signal::{
    Channel, Moving, MovingStart, Note, Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G, Sampled, is_gravity,
};

use crumple_metrics::{SMOOTHING_S, held_crossing, moving_mean};

use crate::pulse;
use crate::pulse::Polarity;
use crate::recording::content::{Wave, list};

mod remarks;

pub use remarks::REMARKS;
use remarks::{
    CoarseTimes, Drifted, FallOrOffset, ImplausibleLevel, LevelOff, MovesBefore, OtherRate, OthersFaulty, OthersMuted,
    OthersSlow, PairDiffers, PairDisagrees, PairNotCompared, PairsLeft, PulseClipped, PulseLost, PulseMuted,
    PulseNoisy, PulseSlow, ZeroLevelUnknown,
};

/// Noise before the event that is too much, m/s^2.
const NOISE_M_PER_S2: f64 = G;
/// Mean after separation that is too much, m/s^2.
const DRIFT_M_PER_S2: f64 = 0.5 * G;
/// From this time on the vehicle has left the barrier, s.
const SEPARATED_S: f64 = 0.100;
/// Below this rate CFC 60 cannot be applied: ten times the class (SAE J211-1), Hz.
const CFC60_RATE_HZ: f64 = 600.0;
/// Distance of a stamp from the grid worth a note, intervals.
const JITTER: f64 = 0.01;

/// The remark on channels, and on which.
type Check = (fn(String) -> Note, fn(&Wave) -> bool);

/// Notes on all accelerations, the pulse first.
pub fn check(
    waves: &[Wave],
    pulse_id: Option<&str>,
    speed_m_per_s: Option<f64>,
    polarity: Polarity,
    notes: &mut Notes,
) {
    if let Some(pulse) = waves.iter().find(|w| Some(w.id.as_str()) == pulse_id) {
        check_pulse(pulse, speed_m_per_s, polarity, notes);
        note_other_rates(waves, pulse, notes);
    }
    let others = || waves.iter().filter(|w| Some(w.id.as_str()) != pulse_id);
    let checks: [Check; 6] = [
        (|channels| OthersMuted { channels }.into(), |w| muted_samples(w).is_some()),
        (|channels| faulty("equal samples in a row at an extreme (clipped?)", channels), is_clipped),
        (|channels| OthersSlow { channels }.into(), is_too_slow),
        (|channels| faulty("noise before the event above 1 g", channels), |w| excess_noise(w).is_some()),
        (|channels| faulty("equal samples in a row inside the pulse (dropout?)", channels), |w| dropout(w).is_some()),
        (
            |channels| faulty("mean over the last 20 ms above 0.5 g (drift, or a force still acts)", channels),
            |w| drift(w).is_some(),
        ),
    ];
    for (k, (remark, is_noted)) in checks.into_iter().enumerate() {
        // Any channel may be clipped.
        let of_kind = others().filter(|w| k == 1 || w.quantity == QuantityKind::Acceleration);
        if let Some(channels) = names(of_kind.filter(|w| is_noted(w))) {
            notes.push(remark(channels));
        }
    }
}

fn check_pulse(pulse: &Wave, speed_m_per_s: Option<f64>, polarity: Polarity, notes: &mut Notes) {
    let (quality, record) = (&pulse.quality, &pulse.quality.record);
    let before_contact = quality.pre_event.map(|p| p.zero_level);
    if let Some(level) = before_contact {
        note_fall(pulse, level, notes);
    } else {
        notes.push(ZeroLevelUnknown {});
    }
    if let Some(muted) = muted_samples(pulse) {
        notes.push(PulseMuted { samples: muted });
    }
    pulse::check(&pulse.samples, quality.zero_level(), speed_m_per_s, polarity, notes);
    note_level(&pulse.samples, before_contact, notes);
    if is_too_slow(pulse) {
        notes.push(PulseSlow { rate_hz: record.sample_rate_hz, needed_hz: CFC60_RATE_HZ });
    }
    if is_clipped(pulse) {
        let (low, high, unit) = (record.minimum, record.maximum, pulse.quantity.si_unit());
        notes.push(PulseClipped { samples: record.clipped_run, low, high, unit });
    }
    if let Some(noise) = excess_noise(pulse) {
        notes.push(PulseNoisy { deviation_g: noise / G });
    }
    if let Some((samples, from_s)) = dropout(pulse) {
        notes.push(PulseLost { samples, from_s });
    }
    if let Some(level) = drift(pulse) {
        notes.push(Drifted { level_g: level / G });
    }
    if record.time_jitter > JITTER {
        notes.push(CoarseTimes { off_intervals: record.time_jitter });
    }
}

/// Names a free fall or braking before contact, and a level that may be one: 1 g, in a record that does not show the
/// sensor at rest at another level.
fn note_fall(pulse: &Wave, level: f64, notes: &mut Notes) {
    if let Some(MovingStart { by, rest_level, level }) = pulse.quality.moving {
        let by = match by {
            Moving::Falls => "falls",
            Moving::Brakes => "brakes",
        };
        notes.push(MovesBefore { by, off_g: (level - rest_level) / G });
    } else if pulse.quality.feels_gravity && is_gravity(level) {
        notes.push(FallOrOffset { level_g: level / G });
    } else if level.abs() > 0.5 * G {
        notes.push(LevelOff { level_g: level / G });
    }
}

/// Channels that must be resampled before they can be compared with the pulse sample by sample, or drive one model with
/// it.
fn note_other_rates(waves: &[Wave], pulse: &Wave, notes: &mut Notes) {
    let rate_hz = |w: &Wave| (w.quality.record.sample_rate_hz * 1e3).round() / 1e3;
    // In the order of their texts.
    let mut others: BTreeMap<String, Vec<&Wave>> = BTreeMap::new();
    for wave in waves.iter().filter(|w| (w.samples.dt_s() / pulse.samples.dt_s() - 1.0).abs() > 1e-9) {
        others.entry(format!("{} Hz", rate_hz(wave))).or_default().push(wave);
    }
    for waves in others.into_values() {
        let Some((rate, channels)) = waves.first().map(|w| rate_hz(w)).zip(names(waves.iter().copied())) else {
            continue;
        };
        notes.push(OtherRate { rate_hz: rate, pulse_hz: rate_hz(pulse), channels });
    }
}

fn muted_samples(wave: &Wave) -> Option<usize> {
    wave.quality.pre_event.map(|p| p.muted).filter(|muted| *muted > 0 && wave.quality.moving.is_none())
}

/// Whether the rate is too low for the lowest class.
pub fn is_too_slow(wave: &Wave) -> bool {
    wave.quality.record.sample_rate_hz < CFC60_RATE_HZ * (1.0 - 1e-9)
}

fn is_clipped(wave: &Wave) -> bool {
    wave.quality.record.may_be_clipped()
}

fn excess_noise(wave: &Wave) -> Option<f64> {
    wave.quality.pre_event.map(|p| p.noise_floor).filter(|noise| *noise > NOISE_M_PER_S2)
}

fn dropout(wave: &Wave) -> Option<(u64, f64)> {
    let [from_s, _] = wave.quality.record.lost_s()?;
    Some((wave.quality.record.constant_run?, from_s))
}

fn drift(wave: &Wave) -> Option<f64> {
    let over = wave.samples.end_s() >= SEPARATED_S;
    wave.quality.record.end_level.filter(|level| over && level.abs() > DRIFT_M_PER_S2)
}

/// The ids of channels; `None` where there are none.
fn names<'a>(waves: impl Iterator<Item = &'a Wave>) -> Option<String> {
    let ids: Vec<&str> = waves.map(|w| w.id.as_str()).collect();
    (!ids.is_empty()).then(|| list(&ids))
}

fn faulty(what: &'static str, channels: String) -> Note {
    OthersFaulty { what, channels }.into()
}

/// Velocities and displacements are compared up to this time, s.
const WINDOW_S: f64 = 0.150;
/// A difference of crush above this part is a warning: two channels are then not averaged either.
const TOO_MUCH: f64 = 0.05;
/// Pairs that get a note of their own.
const PAIR_LIMIT: usize = 20;

/// How far two accelerometers differ from contact to 150 ms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disagreement {
    /// Largest difference of the accelerations, each a 4.4 ms moving mean (about CFC 60), m/s^2.
    pub acceleration_m_per_s2: f64,
    /// Largest difference of the velocities, m/s.
    pub velocity_m_per_s: f64,
    /// Largest displacements of the two, where the speed at contact is known and both are reached, m.
    pub crush_m: Option<[f64; 2]>,
}

/// Compares two records on one grid, each without its zero level. `None` where the grids differ or there is no sample
/// after contact.
///
/// Velocity and displacement by the trapezoidal rule of the unfiltered samples. A difference of zero level of 0.1 g
/// alone is 0.1 m/s and 5 mm after 0.1 s.
fn compare(one: &Sampled, other: &Sampled, zeros: [f64; 2], v0_m_per_s: Option<f64>) -> Option<Disagreement> {
    let dt = one.dt_s();
    let shift = (other.t0_s() - one.t0_s()) / dt;
    if (other.dt_s() / dt - 1.0).abs() > 1e-9 || (shift - shift.round()).abs() > 1e-3 {
        return None;
    }
    let mut acceleration: f64 = 0.0;
    let half = (SMOOTHING_S / dt / 2.0) as usize;
    let smooth = [moving_mean(one.samples(), half), moving_mean(other.samples(), half)];
    let start = [one.index_at_or_after(0.0), other.index_at_or_after(0.0)];
    let n = (0..2)
        .map(|c| [one, other][c].index_at_or_after(WINDOW_S).saturating_sub(start[c]))
        .min()
        .filter(|n| *n >= 2)?;
    for k in 0..n {
        let at = |c: usize| smooth[c][start[c] + k] - zeros[c];
        acceleration = acceleration.max((at(0) - at(1)).abs());
    }
    let raw = |c: usize, k: usize| [one, other][c].samples()[start[c] + k] - zeros[c];
    let mut velocity: f64 = 0.0;
    let mut v = [v0_m_per_s.unwrap_or(0.0); 2];
    let mut x = [0.0_f64; 2];
    let mut crush: [Option<f64>; 2] = [None; 2];
    for k in 1..n {
        for c in 0..2 {
            let before = v[c];
            v[c] += 0.5 * dt * (raw(c, k - 1) + raw(c, k));
            x[c] += 0.5 * dt * (before + v[c]);
            if crush[c].is_none() && v[c] <= 0.0 {
                crush[c] = Some(x[c]);
            }
        }
        velocity = velocity.max((v[0] - v[1]).abs());
    }
    let crush_m = v0_m_per_s.and(crush[0].zip(crush[1]).map(|(a, b)| [a, b]));
    Some(Disagreement { acceleration_m_per_s2: acceleration, velocity_m_per_s: velocity, crush_m })
}

/// Notes on all pairs of accelerations with data whose codes differ by redundancy alone, or by left and right along x
/// on the vehicle. `same_place` tells the ids that serve as the pulse.
pub fn check_redundant_sensors(
    channels: &[Channel],
    waves: &[Wave],
    same_place: &[String],
    speed_m_per_s: Option<f64>,
    notes: &mut Notes,
) {
    let mut groups: BTreeMap<String, Vec<(&Channel, &Wave)>> = BTreeMap::new();
    for wave in waves.iter().filter(|w| w.quantity == QuantityKind::Acceleration) {
        let Some(channel) = channels.iter().find(|c| c.id == wave.id) else { continue };
        let Some((code, _)) = channel.code.as_deref().and_then(|c| IsoCode::parse(c).ok()) else { continue };
        groups.entry(place_key(&code, same_place.contains(&wave.id))).or_default().push((channel, wave));
    }
    let mut pairs = 0;
    for members in groups.values() {
        let Some(((first, wave), others)) = members.split_first() else { continue };
        for (other, other_wave) in others {
            pairs += 1;
            if pairs <= PAIR_LIMIT {
                let speed = first.initial_velocity_m_per_s.map(f64::abs).filter(|v| *v > 0.0).or(speed_m_per_s);
                let speed = speed.filter(|_| same_place.contains(&first.id));
                note_pair([first, other], [wave, other_wave], speed, notes);
            }
        }
    }
    if pairs > PAIR_LIMIT {
        notes.push(PairsLeft { pairs: pairs - PAIR_LIMIT });
    }
}

/// The code without redundancy, filter class, and, at places that serve as the pulse, without its side.
fn place_key(code: &IsoCode, as_pulse: bool) -> String {
    let fine = code.fine_locations().map(|part| match part {
        "RD" | "__" => "00",
        "LE" | "RI" if as_pulse => "00",
        part => part,
    });
    let axis = code.axis().map_or_else(|| "0".to_owned(), |a| a.to_string());
    format!("{}{}{}{}{axis}", code.object(), code.position(), code.main_location(), fine.concat())
}

fn note_pair(channels: [&Channel; 2], waves: [&Wave; 2], speed: Option<f64>, notes: &mut Notes) {
    let zeros = waves.map(|w| w.quality.pre_event.map_or(0.0, |p| p.zero_level));
    let [one, other] = channels.map(|channel| channel.id.clone());
    let what = if channels[0].redundant == channels[1].redundant { "left and right" } else { "redundant" };
    let Some(difference) = compare(&waves[0].samples, &waves[1].samples, zeros, speed) else {
        notes.push(PairNotCompared { one, other, what });
        return;
    };
    let (by_g, by_m_per_s) = (difference.acceleration_m_per_s2 / G, difference.velocity_m_per_s);
    let share = |[a, b]: [f64; 2]| (a - b).abs() / a.abs().max(b.abs()).max(f64::MIN_POSITIVE);
    match difference.crush_m.map(|crush| (crush, share(crush))) {
        Some(([crush_m, other_crush_m], by_share)) if by_share > TOO_MUCH => {
            notes.push(PairDisagrees { one, other, what, by_g, by_m_per_s, by_share, crush_m, other_crush_m });
        }
        found => {
            let (crush, by_share) = found.unzip();
            let [crush_m, other_crush_m] = crush.map_or([None; 2], |crush| crush.map(Some));
            notes.push(PairDiffers { one, other, what, by_g, by_m_per_s, by_share, crush_m, other_crush_m });
        }
    }
}

/// Level of the threshold rule, m/s^2 (0.5 g).
const THRESHOLD_M_PER_S2: f64 = 0.5 * G;
/// Held for 3 ms it changes the velocity by 106 km/h, over a crush of 44 mm: no structure of a vehicle does.
const IMPLAUSIBLE_M_PER_S2: f64 = 1e3 * G;

/// Notes a pulse that is stronger than any vehicle makes, or that no threshold finds.
fn note_level(pulse: &Sampled, zero_level: Option<f64>, notes: &mut Notes) {
    let zero_level = zero_level.unwrap_or(0.0);
    let crossing = |m_per_s2: f64| held_crossing(pulse, zero_level, m_per_s2);
    let largest = pulse.samples().iter().fold(0.0_f64, |largest, a| largest.max((a - zero_level).abs()));
    if largest >= IMPLAUSIBLE_M_PER_S2 && crossing(IMPLAUSIBLE_M_PER_S2).is_some() {
        notes.push(ImplausibleLevel { largest_g: Some(largest / G) });
    }
    if crossing(THRESHOLD_M_PER_S2).is_none() {
        notes.push(ImplausibleLevel { largest_g: None });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::Sampled;

    use crate::recording::content::measure;

    fn texts(at: impl Fn(f64) -> f64) -> Vec<String> {
        texts_with_polarity(at, Polarity::AsRead)
    }

    fn texts_with_polarity(at: impl Fn(f64) -> f64, polarity: Polarity) -> Vec<String> {
        let samples = (0..2500).map(|k| G * at(f64::from(k - 500) * 1e-4)).collect();
        let samples = Sampled::new(-0.05, 1e-4, samples).unwrap();
        let quality = measure(&samples, 0.0, true);
        let wave = Wave { id: "a".to_owned(), quantity: QuantityKind::Acceleration, samples, quality };
        let mut written = Notes::new();
        check(&[wave], Some("a"), Some(15.0), polarity, &mut written);
        written.to_texts()
    }

    fn pulse(t: f64) -> f64 {
        if (0.0..0.09).contains(&t) { -20.0 * (std::f64::consts::PI * t / 0.09).sin() } else { 0.0 }
    }

    #[test]
    fn a_clean_pulse_has_no_remarks() {
        assert_eq!(texts(pulse), Vec::<String>::new());
    }

    #[test]
    fn each_fault_is_named_with_its_figure() {
        let has_one_note = |notes: Vec<String>, words: &str| {
            assert!(notes.len() == 1 && notes[0].contains(words), "{words}: {notes:?}");
        };
        has_one_note(
            texts(|t| if (0.03..0.032).contains(&t) { 0.0 } else { pulse(t) }),
            "20 equal samples in a row from 30.00 ms",
        );
        has_one_note(texts(|t| if t > 0.1 { 0.8 } else { pulse(t) }), "last 20 ms is 0.80 g");
        has_one_note(texts(|t| if t < 0.0 { 3.0 * (t * 3e5).sin() } else { pulse(t) }), "noisy before the event");
        has_one_note(texts(|t| pulse(t).max(-15.0)), "clipped");
        has_one_note(texts(|t| -pulse(t)), "use --sign flip");
    }

    #[test]
    fn turning_the_sign_is_advised_where_it_helps() {
        // 11.2 m/s of 15 m/s; ten times that is a wrong unit.
        let positive = |factor: f64| move |t: f64| -factor * pulse(t);
        assert!(texts_with_polarity(positive(1.0), Polarity::Turned)[0].ends_with("leave --sign out"));
        assert_eq!(texts_with_polarity(positive(1.0), Polarity::OfOccupant), Vec::<String>::new());
        assert!(texts(positive(10.0))[0].contains("check the unit"), "{:?}", texts(positive(10.0)));
        assert!(!texts(positive(10.0))[0].contains("flip"));
    }

    #[test]
    fn a_gain_shows_in_every_figure() {
        // Constant -200 m/s^2 from 15 m/s: t_m = 75 ms, C = v0^2/2a = 0.5625 m; 10 % less gives 0.625 m.
        let wave =
            |a: f64| Sampled::new(-0.01, 1e-4, (0..2000).map(|k| if k < 100 { 0.0 } else { a }).collect()).unwrap();
        let difference = compare(&wave(-200.0), &wave(-180.0), [0.0; 2], Some(15.0)).unwrap();
        assert!((difference.acceleration_m_per_s2 - 20.0).abs() < 1e-9);
        // 20 m/s^2 over 149.9 ms.
        assert!((difference.velocity_m_per_s - 20.0 * 0.1499).abs() < 1e-9);
        let [a, b] = difference.crush_m.unwrap();
        // The maximum is taken at a sample: v there is below 200*1e-4 m/s, so x is short by less than 1e-6 m.
        assert!((a - 0.5625).abs() < 2e-6 && (b - 0.625).abs() < 2e-6, "{a} {b}");
        let offset = compare(&wave(-200.0), &wave(-200.0), [0.0, 0.0], None).unwrap();
        assert_eq!((offset.velocity_m_per_s, offset.crush_m), (0.0, None));
    }

    #[test]
    fn other_grids_are_not_compared() {
        let wave = |t0, dt| Sampled::new(t0, dt, vec![1.0; 100]).unwrap();
        assert!(compare(&wave(0.0, 1e-3), &wave(0.0, 2e-3), [0.0; 2], None).is_none());
        assert!(compare(&wave(0.0, 1e-3), &wave(0.0004, 1e-3), [0.0; 2], None).is_none());
        assert!(compare(&wave(-1.0, 1e-3), &wave(-1.0, 1e-3), [0.0; 2], None).is_none());
        assert!(compare(&wave(0.0, 1e-3), &wave(-0.01, 1e-3), [0.0; 2], None).is_some());
    }
}
