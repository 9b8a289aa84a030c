//! Which channels are the force of the wall, where their names, and no code, say so.

use crumple_signal::{BARRIER, QuantityKind};

use crate::recording::content::{ReadChannel, Recording, list};
use crate::recording::settings::select;
use crate::{Result, refuse_channel};

/// Words of names, small letters without signs between; `barr` is that of ISO 13499, too.
const WALL: [&str; 7] = ["wall", "barr", "loadcell", "wand", "kraftmessdose", "murrigide", "muro"];
/// Words of a name whose force is that of all cells.
const WHOLE: [&str; 4] = ["total", "sum", "whole", "gesamt"];

/// Puts the forces of the wall where a load cell of a barrier sits: the channels asked for, else those without a place
/// whose names say so. Where one of them is the sum of all, by its name, the others are none of it.
///
/// # Errors
/// A channel that is asked for and is not there, or is no force with data.
pub fn place(file: &str, recording: &mut Recording, wanted: Option<&str>) -> Result<()> {
    let is_force = |read: &ReadChannel| read.channel.quantity == QuantityKind::Force && read.wave.is_some();
    let channels = &recording.channels;
    let taken: Vec<usize> = match wanted {
        Some(wanted) => {
            let selected = select(channels, wanted);
            if let Some(other) = selected.iter().find(|k| !is_force(&channels[**k])) {
                let found = format!("channel {} is no force with data", channels[*other].channel.id);
                let hint = "name the column of the force, or leave --wall away; --list prints the channels";
                return refuse_channel(file, found, "the force of the wall, with its unit: wall_force_kN", hint);
            }
            if selected.is_empty() {
                let forces: Vec<&str> =
                    channels.iter().filter(|read| is_force(read)).map(|read| read.channel.id.as_str()).collect();
                let expected = if forces.is_empty() {
                    "a force, with its unit: wall_force_kN".to_owned()
                } else {
                    format!("one of {}", list(&forces))
                };
                let hint = "--list prints the channels; without --wall the names decide";
                return refuse_channel(file, format!("channel {wanted} of --wall is not listed"), expected, hint);
            }
            selected
        }
        None => {
            let is_named = |k: &usize| {
                let read = &channels[*k];
                is_force(read) && read.channel.location.is_empty() && says(read, &WALL)
            };
            let named: Vec<usize> = (0..channels.len()).filter(is_named).collect();
            match named.iter().find(|k| named.len() > 1 && says(&channels[**k], &WHOLE)) {
                Some(whole) => vec![*whole],
                None => named,
            }
        }
    };
    for k in &taken {
        recording.channels[*k].channel.location = BARRIER.to_owned();
    }
    if !taken.is_empty() {
        let names: Vec<&str> = taken.iter().map(|k| recording.channels[*k].channel.id.as_str()).collect();
        recording.notes.info(format!("force of the wall: {}", list(&names)));
    }
    Ok(())
}

/// Whether the id or another name of a channel holds one of the words.
fn says(read: &ReadChannel, words: &[&str]) -> bool {
    let names = read.aliases.iter().chain([&read.channel.id]);
    names.into_iter().any(|name| {
        let letters: String = name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
        words.iter().any(|word| letters.contains(word))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::content::PulseRule;
    use crumple_signal::{Channel, Notes, Sampled};

    fn placed(names: &[&str], wanted: Option<&str>) -> Result<Vec<bool>> {
        let read = |name: &&str| ReadChannel {
            wave: Some(Sampled::new(0.0, 1e-3, vec![0.0, 1.0]).unwrap()),
            ..ReadChannel::new(Channel::new(*name, QuantityKind::Force))
        };
        let mut recording = Recording {
            details: crate::recording::details::Details::default(),
            channels: names.iter().map(read).collect(),
            pulse_rule: PulseRule::OnlyOne,
            contact_at_zero: false,
            notes: Notes::new(),
        };
        place("a.csv", &mut recording, wanted)?;
        Ok(recording.channels.iter().map(|read| read.channel.location == BARRIER).collect())
    }

    #[test]
    fn names_and_the_flag_say_which() {
        assert_eq!(placed(&["wall force", "belt force"], None).unwrap(), [true, false]);
        assert_eq!(placed(&["B0BARR0000FOXP", "F2"], None).unwrap(), [true, false]);
        assert_eq!(placed(&["Load cell 1", "Load cell 2"], None).unwrap(), [true, true]);
        assert_eq!(placed(&["barrier A1", "barrier A2", "barrier total"], None).unwrap(), [false, false, true]);
        assert_eq!(placed(&["F1", "F2"], Some("F2")).unwrap(), [false, true]);
        assert_eq!(placed(&["F1", "F2", "G"], Some("F*")).unwrap(), [true, true, false]);
        assert!(placed(&["F1"], Some("F9")).is_err());
    }
}
