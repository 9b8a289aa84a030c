//! Notes on the quality of the channels: each check with its figure, none a correction.
//!
//! | check | figure | noted when |
//! |---|---|---|
//! | zero level | mean from -50 to -10 ms | less than 10 ms of it is there |
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

use crumple_signal::{About, Notes, QuantityKind, STANDARD_GRAVITY_M_PER_S2 as G, Weight, is_gravity};

use crate::pulse::polarity::{self, Polarity};
use crate::recording::wave::Wave;
use crate::time::time_zero;

/// Noise before the event that is too much, m/s^2.
const NOISE_M_PER_S2: f64 = G;
/// Mean after separation that is too much, m/s^2.
const DRIFT_M_PER_S2: f64 = 0.5 * G;
/// From this time on the vehicle has left the barrier, s.
const SEPARATED_S: f64 = 0.100;
/// Shortest run of equal samples that counts as a dropout, and its duration, s.
const DROPOUT: (u64, f64) = (5, 0.000_5);
/// Below this rate CFC 60 cannot be applied: ten times the class (SAE J211-1), Hz.
const CFC60_RATE_HZ: f64 = 600.0;
/// Distance of a stamp from the grid worth a note, intervals.
const JITTER: f64 = 0.01;
/// Channels named in a shared note.
const NAMED: usize = 12;

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
    let accelerations = || others().filter(|w| w.quantity == QuantityKind::Acceleration);
    note_channels(
        accelerations().filter(|w| muted_samples(w).is_some()),
        "a muted start (exact zeros), not counted in the zero level,",
        notes,
    );
    note_channels(others().filter(|w| is_clipped(w)), "equal samples in a row at an extreme (clipped?)", notes);
    note_channels(
        accelerations().filter(|w| is_too_slow(w)),
        "less than 600 samples a second, too few for CFC 60,",
        notes,
    );
    note_channels(accelerations().filter(|w| excess_noise(w).is_some()), "noise before the event above 1 g", notes);
    note_channels(
        accelerations().filter(|w| dropout(w).is_some()),
        "equal samples in a row inside the pulse (dropout?)",
        notes,
    );
    note_channels(
        accelerations().filter(|w| drift(w).is_some()),
        "mean over the last 20 ms above 0.5 g (drift, or still moving)",
        notes,
    );
}

fn check_pulse(pulse: &Wave, speed_m_per_s: Option<f64>, polarity: Polarity, notes: &mut Notes) {
    let quality = &pulse.quality;
    let before_contact = quality.pre_event.map(|p| p.zero_level);
    if let Some(level) = before_contact {
        note_fall(pulse, level, notes);
    } else {
        notes.concern(
            About::Pulse,
            Weight::Marked,
            "the pulse has less than 10 ms of data between -50 ms and -10 ms: its zero level and noise floor are not \
             known",
        );
    }
    if let Some(muted) = muted_samples(pulse) {
        notes.info(format!(
            "the first {muted} samples of the pulse are exactly 0: the recorder was muted, and the zero level is \
             that of the other samples"
        ));
    }
    polarity::check(&pulse.samples, quality.zero_level(), speed_m_per_s, polarity, notes);
    time_zero::check(&pulse.samples, before_contact, notes);
    if is_too_slow(pulse) {
        notes.concern(
            About::Pulse,
            Weight::Decisive,
            format!(
                "the pulse has {:.1} samples a second: CFC 60 needs {CFC60_RATE_HZ} at least, a crash pulse is not \
             resolved",
                quality.record.sample_rate_hz
            ),
        );
    }
    if is_clipped(pulse) {
        notes.concern(
            About::Pulse,
            Weight::Marked,
            format!(
                "the pulse may be clipped: {} equal samples in a row at an extreme ({:.3} to {:.3} {})",
                quality.record.clipped_run,
                quality.record.minimum,
                quality.record.maximum,
                pulse.quantity.si_unit()
            ),
        );
    }
    if let Some(noise) = excess_noise(pulse) {
        notes.concern(
            About::Pulse,
            Weight::Marked,
            format!(
                "the pulse is noisy before the event: standard deviation {:.2} g, at most 1 g is usual: the sensor may \
             have failed",
                noise / G
            ),
        );
    }
    if let Some((run, from_s)) = dropout(pulse) {
        notes.concern(About::Pulse, Weight::Marked, format!(
            "the pulse may have dropouts: {run} equal samples in a row from {:.2} ms on, while the signal is active",
            from_s * 1e3
        ));
    }
    if let Some(level) = drift(pulse) {
        notes.concern(
            About::Pulse,
            Weight::Slight,
            format!(
                "the mean of the pulse over its last 20 ms is {:.2} g: the sensor drifted, or the vehicle still moves",
                level / G
            ),
        );
    }
    if quality.record.time_jitter > JITTER {
        notes.info(format!(
            "time stamps of the pulse lie up to {:.3} sampling intervals off the uniform grid",
            quality.record.time_jitter
        ));
    }
}

/// Names a free fall before contact, and a level that may be one: 1 g, in a record that does not show the sensor at
/// rest at another level.
fn note_fall(pulse: &Wave, level: f64, notes: &mut Notes) {
    if let Some(fall) = pulse.quality.fall {
        notes.concern(
            About::Pulse,
            Weight::Slight,
            format!(
                "free fall before contact: the level there is {:+.2} g off the level at rest",
                (fall.fall_level - fall.rest_level) / G
            ),
        );
    } else if pulse.quality.feels_gravity && is_gravity(level) {
        notes.concern(
            About::Pulse,
            Weight::Marked,
            format!(
                "the level before contact is {:+.2} g: an offset, or a free fall. A fall is no offset to remove: if it \
                 is one, add --set filter.zero-level=none",
                level / G
            ),
        );
    }
}

/// Channels that must be resampled before they can be compared with the pulse sample by sample, or drive one model with
/// it.
fn note_other_rates(waves: &[Wave], pulse: &Wave, notes: &mut Notes) {
    let rate = |w: &Wave| format!("{} Hz", (w.quality.record.sample_rate_hz * 1e3).round() / 1e3);
    let mut others: BTreeMap<String, Vec<&Wave>> = BTreeMap::new();
    for wave in waves.iter().filter(|w| (w.samples.dt_s() / pulse.samples.dt_s() - 1.0).abs() > 1e-9) {
        others.entry(rate(wave)).or_default().push(wave);
    }
    for (other, waves) in others {
        let what = format!(
            "another sampling rate than the pulse ({other} against {}; crumple-filter --resample brings them together)",
            rate(pulse)
        );
        note_channels(waves.into_iter(), &what, notes);
    }
}

fn muted_samples(wave: &Wave) -> Option<usize> {
    wave.quality.pre_event.map(|p| p.muted).filter(|muted| *muted > 0 && wave.quality.fall.is_none())
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
    let run = wave.quality.record.constant_run?;
    let long = run >= DROPOUT.0 && (run - 1) as f64 * wave.samples.dt_s() >= DROPOUT.1;
    wave.quality.record.constant_run_from_s.filter(|_| long).map(|from_s| (run, from_s))
}

fn drift(wave: &Wave) -> Option<f64> {
    let over = wave.samples.end_s() >= SEPARATED_S;
    wave.quality.record.end_level.filter(|level| over && level.abs() > DRIFT_M_PER_S2)
}

fn note_channels<'a>(waves: impl Iterator<Item = &'a Wave>, what: &str, notes: &mut Notes) {
    let ids: Vec<&str> = waves.map(|w| w.id.as_str()).collect();
    if ids.is_empty() {
        return;
    }
    let more = ids.len().saturating_sub(NAMED);
    let tail = if more > 0 { format!(" and {more} more") } else { String::new() };
    notes.info(format!("{what} in {}{tail}", ids[..ids.len() - more].join(", ")));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::quality::measure;
    use crumple_signal::Sampled;

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
}
