//! Accelerometers in the head and chest of occupants: which belong together.

use std::collections::BTreeMap;

use crumple_signal::{Axis, BodyPart, Channel, ChannelStatus, TestDescription, part_of};
use crumple_stage::Inputs;

/// Accelerometers at one place, one for each axis.
#[derive(Default)]
pub struct Site<'a> {
    /// Along x, y and z.
    pub axes: [Option<&'a Channel>; 3],
    /// A resultant from the source, or a channel whose axis is not known.
    pub whole: Option<&'a Channel>,
}

/// The places of heads and chests of which the inputs hold samples; failed channels are left out. In the order of their
/// locations.
pub fn sites<'a>(test: &'a TestDescription, input: &Inputs) -> Vec<(BodyPart, Site<'a>)> {
    let mut sites: BTreeMap<(BodyPart, String), Site<'a>> = BTreeMap::new();
    for channel in &test.channels {
        let Some(part) = part_of(channel) else { continue };
        if channel.status == ChannelStatus::Failed || input.wave_if(&channel.id).is_none() {
            continue;
        }
        let site = sites.entry((part, place(channel))).or_default();
        let slot = match channel.axis {
            Some(Axis::X) => &mut site.axes[0],
            Some(Axis::Y) => &mut site.axes[1],
            Some(Axis::Z) => &mut site.axes[2],
            Some(Axis::Resultant) | None => &mut site.whole,
        };
        slot.get_or_insert(channel);
    }
    sites.into_iter().map(|((part, _), site)| (part, site)).collect()
}

/// What channels at one place have in common: location, the code up to its dimension, redundancy. Without location and
/// code the id without what says the axis (`head_x_g`, `head_y_g`: `head_g`), else up to its last separator (`head_1`,
/// `head_2`).
fn place(channel: &Channel) -> String {
    let code = channel.code.as_deref().and_then(|code| code.get(..12)).unwrap_or_default();
    let mut location = channel.location.trim().to_lowercase();
    if location.is_empty() && code.is_empty() {
        location = without_axis(&channel.id.to_lowercase());
    }
    format!("{location}|{code}|{}", channel.redundant)
}

fn without_axis(id: &str) -> String {
    const AXES: [&str; 12] = ["x", "y", "z", "r", "ax", "ay", "az", "acx", "acy", "acz", "res", "resultant"];
    let separator = ['_', '-', '.', ' '];
    let words: Vec<&str> = id.split(separator).collect();
    match words.iter().rposition(|word| AXES.contains(word)) {
        Some(axis) => {
            words.iter().enumerate().filter(|(k, _)| *k != axis).map(|(_, word)| *word).collect::<Vec<_>>().join("_")
        }
        None => id.rsplit_once(separator).map_or(id, |(stem, _)| stem).to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axes_of_one_head_have_one_place() {
        for ids in [
            ["head_x_g", "head_y_g", "Head_Z_g"],
            ["driver head x", "driver head y", "driver head z"],
            ["head-ax", "head-ay", "head-az"],
        ] {
            let places = ids.map(|id| place(&Channel::new(id, crumple_signal::QuantityKind::Acceleration)));
            assert!(places.iter().all(|other| *other == places[0]), "{places:?}");
        }
        assert_ne!(without_axis("driver_head_x"), without_axis("passenger_head_x"));
    }
}
