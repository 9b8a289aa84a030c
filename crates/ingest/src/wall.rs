//! Which channels are the force of the wall, where their names, and no code, say so.

use crumple_signal::{About, Axis, BARRIER, QuantityKind, Weight, criterion_of, remarks};

use crate::recording::content::{ReadChannel, Recording, list};
use crate::recording::settings::select;
use crate::{Result, refuse_channel};

/// Words of names; one that begins with `barr` is among them, as in codes like `B0BARR0000FOXP`.
const WALL: [&str; 7] = ["wall", "fwall", "wand", "wandkraft", "mauer", "muro", "rwforc"];
/// Words of names that say the same, `load cell` apart.
const CELL: [&str; 3] = ["loadcell", "loadcells", "kraftmessdose"];
/// Words of forces on occupants and their restraints.
const OCCUPANT: [&str; 22] = [
    "neck",
    "femur",
    "tibia",
    "belt",
    "seat",
    "seatbelt",
    "lap",
    "shoulder",
    "driver",
    "passenger",
    "dummy",
    "head",
    "chest",
    "thorax",
    "pelvis",
    "lumbar",
    "spine",
    "knee",
    "foot",
    "arm",
    "gurt",
    "airbag",
];
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
            let is_along = |read: &ReadChannel| read.channel.axis.is_none_or(|axis| axis == Axis::X);
            if let Some(other) = selected.iter().find(|k| !is_force(&channels[**k]) || !is_along(&channels[**k])) {
                let found = format!("channel {} is no force along x with data", channels[*other].channel.id);
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
                is_force(read) && read.channel.location.is_empty() && names_the_wall(read)
            };
            let named: Vec<usize> = (0..channels.len()).filter(is_named).collect();
            match named
                .iter()
                .find(|k| named.len() > 1 && words_of(&channels[**k]).iter().any(|word| WHOLE.contains(&word.as_str())))
            {
                Some(whole) => vec![*whole],
                None => named,
            }
        }
    };
    if taken.is_empty() {
        let left = channels.iter().filter(|read| {
            let is_of_nothing = read.channel.location.is_empty() && criterion_of(&read.channel).is_none();
            is_force(read) && is_of_nothing && read.channel.code.is_none()
        });
        let left: Vec<&str> = left.map(|read| read.channel.id.as_str()).collect();
        if let [first, ..] = left.as_slice() {
            let (forces, first) = (list(&left), (*first).to_owned());
            recording.notes.push(NoWallForce { forces, first });
        }
    }
    for k in &taken {
        recording.channels[*k].channel.location = BARRIER.to_owned();
    }
    if !taken.is_empty() {
        let names: Vec<&str> = taken.iter().map(|k| recording.channels[*k].channel.id.as_str()).collect();
        let channels = list(&names);
        recording.notes.push(WallForce { channels });
    }
    Ok(())
}

/// The words of the id and of other names of a channel, small letters: `WallForce`, `wall_force` and `Wall force` have
/// two. Digits part words.
fn words_of(read: &ReadChannel) -> Vec<String> {
    let mut words = vec![String::new()];
    for name in read.aliases.iter().chain([&read.channel.id]) {
        let mut before = ' ';
        for c in name.chars().chain([' ']) {
            if !c.is_alphabetic() || (c.is_uppercase() && before.is_lowercase()) {
                words.push(String::new());
            }
            if let Some(word) = words.last_mut().filter(|_| c.is_alphabetic()) {
                word.extend(c.to_lowercase());
            }
            before = c;
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

fn names_the_wall(read: &ReadChannel) -> bool {
    let words = words_of(read);
    let has = |of: &[&str]| words.iter().any(|word| of.contains(&word.as_str()));
    if criterion_of(&read.channel).is_some() || has(&OCCUPANT) {
        return false;
    }
    has(&WALL)
        || has(&CELL)
        || (has(&["load"]) && has(&["cell", "cells"]))
        || words.iter().any(|word| word.starts_with("barr"))
}

remarks! {
    /// Remarks of the force of the wall.
    pub REMARKS;

    /// There are forces, and none is taken for that of the wall.
    CR117 NoWallForce { forces: String, first: String }
    bears on (About::WallForce, Weight::None)
    decided "A force is that of the wall if its name says wall, barrier or load cell and names no part of an occupant. \
             None of these names does."
    means "The forces stay channels. There is no force of the wall among the results."
    remedy "name the load cells of the wall by --wall, if these are some"
    says format!("no force is taken for that of a wall: {forces}; --wall {first}, for example, names it");

    /// These channels are taken for the force of the wall.
    CR118 WallForce { channels: String }
    bears on (About::WallForce, Weight::None)
    decided "--wall names them, or their names say wall, barrier or load cell. A name that says total or sum stands \
             for all."
    means "Their sum is the force on the wall. A load cell that is missing makes it too small."
    remedy "name other channels by --wall if these are not the wall"
    says format!("force of the wall: {channels}");
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
        let others = ["Left femur load cell", "Neck load cell Fz", "firewall", "Wandler", "belt barrier"];
        assert_eq!(placed(&others, None).unwrap(), [false; 5]);
        assert_eq!(placed(&["WallForce", "Loadcell_3"], None).unwrap(), [true, true]);
        assert_eq!(placed(&["F1", "F2"], Some("F2")).unwrap(), [false, true]);
        assert_eq!(placed(&["F1", "F2", "G"], Some("F*")).unwrap(), [true, true, false]);
        assert!(placed(&["F1"], Some("F9")).is_err());
    }
}
