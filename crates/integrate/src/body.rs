//! Accelerometers in the head and chest of occupants: which belong together.

use std::collections::BTreeMap;

use crumple_signal::iso13499::IsoCode;
use crumple_signal::{Axis, Channel, ChannelStatus, QuantityKind, TestDescription};
use crumple_stage::Inputs;

/// A part of the body that a criterion is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    Head,
    /// Free-motion headform, FMVSS 201.
    Headform,
    Chest,
}

/// Accelerometers at one place, one for each axis.
#[derive(Default)]
pub struct Site<'a> {
    /// Along x, y and z.
    pub axes: [Option<&'a Channel>; 3],
    /// A resultant from the source, or a channel whose axis is not known.
    pub whole: Option<&'a Channel>,
}

/// Words of a place near a head that is none.
const NO_HEAD: [&str; 7] = ["restraint", "rest", "liner", "airbag", "lamp", "light", "rail"];

/// The part of the body an accelerometer sits in, by its ISO code, else by the words of its location (of its id where
/// there is no location).
pub fn part_of(channel: &Channel) -> Option<Part> {
    if channel.quantity != QuantityKind::Acceleration {
        return None;
    }
    let said = if channel.location.trim().is_empty() { &channel.id } else { &channel.location };
    let said = said.to_lowercase();
    let words: Vec<&str> = said.split(|c: char| !c.is_alphanumeric()).collect();
    let has = |word: &str| words.contains(&word);
    if has("headform") || has("fmh") {
        return Some(Part::Headform);
    }
    if let Some((code, _)) = channel.code.as_deref().and_then(|code| IsoCode::parse(code).ok()) {
        match code.main_location() {
            "HEAD" => return Some(Part::Head),
            "CHST" => return Some(Part::Chest),
            _ => {}
        }
    }
    if said.starts_with("vehicle") || NO_HEAD.into_iter().any(has) {
        None
    } else if has("head") {
        Some(Part::Head)
    } else {
        (has("chest") || has("thorax")).then_some(Part::Chest)
    }
}

/// The places of heads and chests of which the inputs hold samples; failed channels are left out. In the order of their
/// locations.
pub fn sites<'a>(test: &'a TestDescription, input: &Inputs) -> Vec<(Part, Site<'a>)> {
    let mut sites: BTreeMap<(Part, String), Site<'a>> = BTreeMap::new();
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

/// What channels at one place have in common: location, the code up to its dimension, redundancy. Without location and code
/// the id up to its last separator (`head_x`, `head_y`).
fn place(channel: &Channel) -> String {
    let code = channel.code.as_deref().and_then(|code| code.get(..12)).unwrap_or_default();
    let mut location = channel.location.trim().to_lowercase();
    if location.is_empty() && code.is_empty() {
        let id = channel.id.to_lowercase();
        location = id.rsplit_once(['_', '-', '.', ' ']).map_or(id.clone(), |(stem, _)| stem.to_owned());
    }
    format!("{location}|{code}|{}", channel.redundant)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(location: &str, code: Option<&str>) -> Option<Part> {
        let code = code.map(str::to_owned);
        let location = location.to_owned();
        part_of(&Channel { location, code, ..Channel::new("1", QuantityKind::Acceleration) })
    }

    #[test]
    fn heads_and_chests_are_known_by_code_and_by_words() {
        assert_eq!(at("somewhere", Some("11HEADCG0000ACXP")), Some(Part::Head));
        assert_eq!(at("driver, head", None), Some(Part::Head));
        assert_eq!(at("front passenger, chest", None), Some(Part::Chest));
        assert_eq!(at("free motion headform", None), Some(Part::Headform));
        assert_eq!(at("vehicle, head restraint", None), None);
        assert_eq!(at("driver, pelvis", Some("11PELV000000ACXP")), None);
        assert_eq!(part_of(&Channel::new("head_x", QuantityKind::Acceleration)), Some(Part::Head));
        assert_eq!(part_of(&Channel::new("head_x", QuantityKind::AngularVelocity)), None);
    }
}
