//! `--drive` and its companions: what moves the models, checked, and found in the inputs.

use std::fmt;

use crate::Excitation;
use clap::ValueEnum;
use crumple_lumped::CrashPulse;
use crumple_signal::QuantityKind;
use crumple_signal::value::{Acceleration, Time};
use crumple_stage::{Inputs, Refused, Usage, nearest, option, program};
use serde::{Deserialize, Serialize};

/// What is to be typed.
const EXPECTED: &str = "half-sine or haversine PEAK DURATION, as in \"half-sine 20g 90ms\", or triangle PEAK \
                        TIME-OF-PEAK DURATION, as in \"triangle 24g 35ms 100ms\"";

/// The pulse of the barrier that a text names, positive in the direction of crush; `None` where its first word is no
/// family, so that it is the id of a waveform. Errors: values without unit, missing or without meaning.
pub fn pulse_of(text: &str) -> anyhow::Result<Option<CrashPulse>> {
    let mut words = text.split_whitespace();
    let family = words.next().unwrap_or_default();
    let values: Vec<&str> = words.collect();
    let refused = |problem: String| Usage::new(format!("pulse {text:?}: {problem}")).hint(EXPECTED);
    let peak = |word: &str| word.parse::<Acceleration>().map(Acceleration::si).map_err(|e| refused(e.to_string()));
    let time = |word: &str| word.parse::<Time>().map(Time::si).map_err(|e| refused(e.to_string()));
    let pulse = match (family, values.as_slice()) {
        ("half-sine", [of, lasting]) => CrashPulse::HalfSine { peak_m_per_s2: peak(of)?, duration_s: time(lasting)? },
        ("haversine", [of, lasting]) => CrashPulse::Haversine { peak_m_per_s2: peak(of)?, duration_s: time(lasting)? },
        ("triangle", [of, at, lasting]) => CrashPulse::triangle(peak(of)?, time(at)?, time(lasting)?)
            .map_err(|_| refused("its peak is not between its start and its end".to_owned()))?,
        ("half-sine" | "haversine" | "triangle", _) => return Err(refused(format!("{} values", values.len())).into()),
        _ => return Ok(None),
    };
    pulse.check().map_err(|error| refused(error.to_string()))?;
    Ok(Some(pulse))
}

/// Waveforms that a refusal lists.
const SHOWN: usize = 12;

/// How far the comparison with the test holds where models start from rest. Of a pulse given back as a force
/// [`Driven::words`] say all.
pub const CAUTION: &str = "fits and errors still compare with the test as recorded: they assess and rank no model \
    unless the test was driven in the same way, and under a displacement fit of 50 % no model is called the best";

/// What moves models, by name.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Drive {
    #[default]
    Impact,
    Force,
    Base,
    PulseAsForce,
}

impl fmt::Display for Drive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.to_possible_value().as_ref().map_or("", |value| value.get_name()))
    }
}

/// What moves models, with the waveform that it takes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Driven {
    pub drive: Drive,
    drive_wave: Option<String>,
    drive_mass: usize,
    /// The pulse that `drive_wave` names; `None` where that is a waveform.
    #[serde(skip)]
    pulse: Option<CrashPulse>,
}

impl Driven {
    /// Checks values against each other; `place` stands before a message.
    pub fn new(place: &str, drive: Drive, drive_wave: Option<String>, drive_mass: usize) -> anyhow::Result<Self> {
        let takes_a_wave = matches!(drive, Drive::Force | Drive::Base);
        if takes_a_wave != drive_wave.is_some() {
            return Err(if takes_a_wave {
                Usage::new(format!("{place}drive {drive} needs a waveform")).hint(
                    "--drive-wave barrier/force, or drive_wave in a pipeline file; base also \"half-sine 20g 90ms\"",
                )
            } else {
                Usage::new(format!("{place}drive {drive} takes no drive-wave")).hint("force and base do")
            }
            .into());
        }
        if drive_mass == 0 {
            return Err(Usage::new("drive-mass is 0, expected 1 for the mass next to the barrier, or more").into());
        }
        let pulse = drive_wave.as_deref().map(pulse_of).transpose()?.flatten();
        if pulse.is_some() && drive != Drive::Base {
            let problem = format!("{place}drive {drive} takes a waveform of the inputs, no pulse of a family");
            return Err(Usage::new(problem).hint("drive base moves the barrier by it").into());
        }
        Ok(Self { drive, drive_wave, drive_mass, pulse })
    }

    /// The same with its waveform.
    pub fn excitation<'a>(&'a self, input: &'a Inputs, pulse: &str) -> anyhow::Result<Excitation<'a>> {
        if let Some(pulse) = &self.pulse {
            return Ok(Excitation::BasePulse { pulse });
        }
        let record = match &self.drive_wave {
            Some(id) => {
                let wanted = if self.drive == Drive::Force { QuantityKind::Force } else { QuantityKind::Acceleration };
                let Some(wave) = input.wave_if(id) else { return Err(not_there(input, id, wanted)) };
                if wave.quantity != wanted {
                    return Err(Refused::new(format!("waveform {id} is {}", wave.quantity))
                        .expected(format!("{wanted}, to drive models by"))
                        .hint(format!("{} lists the waveforms", program("artifact show")))
                        .into());
                }
                Some(&wave.sampled)
            }
            None if self.drive == Drive::PulseAsForce => Some(&input.wave(pulse)?.sampled),
            None => None,
        };
        Ok(match (self.drive, record) {
            (Drive::Force, Some(record)) => Excitation::Force { record, mass: self.drive_mass - 1 },
            (Drive::Base, Some(record)) => Excitation::Base { record },
            (Drive::PulseAsForce, Some(record)) => Excitation::PulseAsForce { record },
            _ => Excitation::Impact,
        })
    }

    /// Whether models start from rest.
    pub fn starts_from_rest(&self) -> bool {
        matches!(self.drive, Drive::Force | Drive::Base)
    }

    /// What moves the models where it is not the impact alone.
    pub fn words(&self) -> Option<String> {
        let wave = self.drive_wave.as_deref().unwrap_or("the pulse");
        match self.drive {
            Drive::Force => Some(format!("the force {wave} on mass {}, from rest", self.drive_mass)),
            Drive::Base => {
                Some(format!("the acceleration {wave} of the barrier, from rest; displacements are absolute"))
            }
            Drive::PulseAsForce => Some(
                "the impact speed and the mass times the measured acceleration as a force on the front mass: circular, \
                 since the measured motion goes in and a model that is nearly one rigid mass gives it back; agreement \
                 is no evidence"
                    .to_owned(),
            ),
            Drive::Impact => None,
        }
    }
}

/// The refusal of a waveform that no input holds. Filtering drops what is neither an acceleration nor a load cell of
/// the barrier, unless it is told to hand it on.
fn not_there(input: &Inputs, id: &str, wanted: QuantityKind) -> anyhow::Error {
    let mut ids: Vec<&str> = input.waves().filter(|(_, wave)| wave.quantity == wanted).map(|(id, _)| id).collect();
    let all = ids.len();
    ids.truncate(SHOWN);
    let more = if all > SHOWN { format!(" and {} more", all - SHOWN) } else { String::new() };
    let held = if ids.is_empty() { "none".to_owned() } else { format!("{}{more}", ids.join(", ")) };
    let test = input.test().ok();
    let channels = || test.iter().flat_map(|test| &test.channels).map(|channel| channel.id.as_str());
    let similar = input.waves().map(|(id, _)| id).find(|other| same_words(other, id));
    let hint = if let Some(similar) = similar {
        format!("did you mean {similar:?}?")
    } else if let Some(channel) = channels().find(|channel| same_words(channel, id)) {
        let also = if channel == id { String::new() } else { format!(", and drive_wave = {channel:?}") };
        format!(
            "filtering drops it unless it is passed on: pass = [{channel:?}] in [filter], or {}{also}",
            option("filter", "pass", channel)
        )
    } else if let Some(near) = nearest(id, channels().chain(ids.iter().copied())) {
        format!("did you mean {near:?}?")
    } else {
        format!("{} lists the channels of the test", program("artifact show 1-ingest.mcap"))
    };
    Refused::new(format!("the drive wave {id} is in none of the inputs"))
        .expected(format!("a waveform of {wanted} in them: {held}"))
        .hint(hint)
        .into()
}

/// Whether two names differ in case and separators only: a column `Wall force` is the channel `wall_force`.
fn same_words(a: &str, b: &str) -> bool {
    let letters =
        |text: &str| -> String { text.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect() };
    letters(a) == letters(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_read_with_their_units() {
        let half_sine = CrashPulse::HalfSine { peak_m_per_s2: 20.0 * 9.80665, duration_s: 0.09 };
        assert_eq!(pulse_of("half-sine 20g 90ms").unwrap(), Some(half_sine));
        let haversine = CrashPulse::Haversine { peak_m_per_s2: 300.0, duration_s: 0.1 };
        assert_eq!(pulse_of("haversine 300m/s^2 100ms").unwrap(), Some(haversine));
        let triangle = CrashPulse::Lines(vec![(0.0, 0.0), (0.035, 240.0), (0.1, 0.0)]);
        assert_eq!(pulse_of("triangle 240m/s^2 35ms 0.1s").unwrap(), Some(triangle));
        assert_eq!(pulse_of("sled").unwrap(), None);
    }

    #[test]
    fn what_is_no_pulse_is_refused_with_an_example() {
        for text in [
            "half-sine 20g",
            "half-sine 20 90ms",
            "half-sine 20g 0ms",
            "triangle 20g 90ms 40ms",
            "half-sine nan g 1s",
            "haversine 20g",
            "haversine 20g 40ms 90ms",
        ] {
            let error = pulse_of(text).unwrap_err();
            let usage = error.downcast_ref::<Usage>().unwrap();
            assert!(usage.to_string().contains(text), "{usage}");
        }
    }
}
