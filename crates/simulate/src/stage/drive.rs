//! `--drive` and its companions: what moves the models, checked, and found in the inputs.

use crumple_lumped::CrashPulse;
use crumple_signal::QuantityKind;
use crumple_simulate::Excitation;
use crumple_stage::{Inputs, Refused, Usage, nearest, unknown_name};
use serde::Serialize;

use crate::stage::pulse::pulse_of;

/// Waveforms that a refusal lists.
const SHOWN: usize = 12;

const DRIVES: [&str; 4] = ["impact", "force", "base", "pulse-as-force"];

/// What moves models, by name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Driven {
    pub drive: &'static str,
    drive_wave: Option<String>,
    drive_mass: usize,
    /// The pulse that `drive_wave` names; `None` where that is a waveform.
    #[serde(skip)]
    pulse: Option<CrashPulse>,
}

impl Driven {
    /// Checks names against each other; `place` stands before a message.
    pub fn new(place: &str, name: &str, drive_wave: Option<String>, drive_mass: usize) -> anyhow::Result<Self> {
        let Some(drive) = DRIVES.into_iter().find(|drive| *drive == name) else {
            return Err(unknown_name(&format!("{place}unknown drive {name:?}"), name, &DRIVES));
        };
        let takes_a_wave = matches!(drive, "force" | "base");
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
        if pulse.is_some() && drive != "base" {
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
                let wanted = if self.drive == "force" { QuantityKind::Force } else { QuantityKind::Acceleration };
                let Some(wave) = input.wave_if(id) else { return Err(not_there(input, id, wanted)) };
                if wave.quantity != wanted {
                    return Err(Refused::new(format!("waveform {id} is {}", wave.quantity))
                        .expected(format!("{wanted}, to drive models by"))
                        .hint("crumple-artifact show lists the waveforms")
                        .into());
                }
                Some(&wave.sampled)
            }
            None if self.drive == "pulse-as-force" => Some(&input.wave(pulse)?.sampled),
            None => None,
        };
        Ok(match (self.drive, record) {
            ("force", Some(record)) => Excitation::Force { record, mass: self.drive_mass - 1 },
            ("base", Some(record)) => Excitation::Base { record },
            ("pulse-as-force", Some(record)) => Excitation::PulseAsForce { record },
            _ => Excitation::Impact,
        })
    }

    /// Whether models start from rest.
    pub fn starts_from_rest(&self) -> bool {
        matches!(self.drive, "force" | "base")
    }

    /// How far the comparison with the test holds where it is not the impact that moves the models. Of a pulse given
    /// back as a force [`Driven::words`] say all.
    pub fn caution(&self) -> Option<&'static str> {
        self.starts_from_rest().then_some(
            "fits and errors still compare with the test as recorded: they assess and rank no model unless the test \
             was driven in the same way, and under a displacement fit of 50 % no model is called the best",
        )
    }

    /// What moves the models where it is not the impact alone.
    pub fn words(&self) -> Option<String> {
        let wave = self.drive_wave.as_deref().unwrap_or("the pulse");
        match self.drive {
            "force" => Some(format!("the force {wave} on mass {}, from rest", self.drive_mass)),
            "base" => Some(format!("the acceleration {wave} of the barrier, from rest; displacements are absolute")),
            "pulse-as-force" => Some(
                "the impact speed and the mass times the measured acceleration as a force on the front mass: circular, \
                 since the measured motion goes in and a model that is nearly one rigid mass gives it back; agreement \
                 is no evidence"
                    .to_owned(),
            ),
            _ => None,
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
            "filtering drops it unless it is passed on: pass = [{channel:?}] in [filter], or crumple-filter --pass \
             {channel}{also}"
        )
    } else if let Some(near) = nearest(id, channels().chain(ids.iter().copied())) {
        format!("did you mean {near:?}?")
    } else {
        "crumple-artifact show 1-ingest.mcap lists the channels of the test".to_owned()
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
