//! `--drive` and its companions: what moves the models, checked, and found in the inputs.

use crumple_signal::QuantityKind;
use crumple_simulate::Excitation;
use crumple_stage::{Inputs, Refused, Usage, unknown_name};
use serde::Serialize;

const DRIVES: [&str; 4] = ["impact", "force", "base", "pulse-as-force"];

/// What moves models, by name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Driven {
    pub drive: &'static str,
    drive_wave: Option<String>,
    drive_mass: usize,
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
                Usage::new(format!("{place}drive {drive} needs a waveform"))
                    .hint("--drive-wave barrier/force, or drive_wave in a pipeline file")
            } else {
                Usage::new(format!("{place}drive {drive} takes no drive-wave")).hint("force and base do")
            }
            .into());
        }
        if drive_mass == 0 {
            return Err(Usage::new("drive-mass is 0, expected 1 for the mass next to the barrier, or more").into());
        }
        Ok(Self { drive, drive_wave, drive_mass })
    }

    /// The same with its waveform.
    pub fn excitation<'a>(&self, input: &'a Inputs, pulse: &str) -> anyhow::Result<Excitation<'a>> {
        let record = match &self.drive_wave {
            Some(id) => {
                let wave = input.wave(id)?;
                let wanted = if self.drive == "force" { QuantityKind::Force } else { QuantityKind::Acceleration };
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

    /// What moves the models where it is not the impact alone.
    pub fn words(&self) -> Option<String> {
        let wave = self.drive_wave.as_deref().unwrap_or("the pulse");
        match self.drive {
            "force" => Some(format!("the force {wave} on mass {}, from rest", self.drive_mass)),
            "base" => Some(format!("the acceleration {wave} of the barrier, from rest; displacements are absolute")),
            "pulse-as-force" => Some(
                "the impact speed and the mass times the measured acceleration as a force on the front mass: circular, since \
                 the measured motion goes in and a model that is nearly one rigid mass gives it back; agreement is no evidence"
                    .to_owned(),
            ),
            _ => None,
        }
    }
}
