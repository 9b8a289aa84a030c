//! The part of a dummy that an accelerometer sits in, and the channel frequency class it asks for.

use crate::iso13499::IsoCode;
use crate::{Channel, QuantityKind};

/// A part of the body that a criterion is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum BodyPart {
    /// Head of a dummy.
    Head,
    /// Free-motion headform, FMVSS 201.
    Headform,
    /// Chest of a dummy.
    Chest,
}

impl BodyPart {
    /// The class of its linear acceleration: head 1000, chest 180 (SAE J211-1 Table 1; FMVSS 208).
    pub const fn cfc(self) -> u16 {
        match self {
            Self::Head | Self::Headform => 1000,
            Self::Chest => 180,
        }
    }
}

/// Words of a place near a head that is none.
const NO_HEAD: [&str; 11] =
    ["restraint", "rest", "liner", "airbag", "lamp", "light", "rail", "cylinder", "engine", "motor", "bulk"];

/// The part of the body an accelerometer sits in, by its ISO code, else by the words of its location (of its id where
/// there is no location).
pub fn part_of(channel: &Channel) -> Option<BodyPart> {
    if channel.quantity != QuantityKind::Acceleration {
        return None;
    }
    let place = if channel.location.trim().is_empty() { &channel.id } else { &channel.location };
    let place = place.to_lowercase();
    let words: Vec<&str> = place.split(|c: char| !c.is_alphanumeric()).collect();
    let has = |word: &str| words.contains(&word);
    if has("headform") || has("fmh") {
        return Some(BodyPart::Headform);
    }
    if let Some((code, _)) = channel.code.as_deref().and_then(|code| IsoCode::parse(code).ok()) {
        match code.main_location() {
            "HEAD" => return Some(BodyPart::Head),
            "CHST" => return Some(BodyPart::Chest),
            _ => {}
        }
    }
    if place.starts_with("vehicle") || NO_HEAD.into_iter().any(has) {
        None
    } else if has("head") {
        Some(BodyPart::Head)
    } else {
        (has("chest") || has("thorax")).then_some(BodyPart::Chest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(location: &str, code: Option<&str>) -> Option<BodyPart> {
        let code = code.map(str::to_owned);
        let location = location.to_owned();
        part_of(&Channel { location, code, ..Channel::new("1", QuantityKind::Acceleration) })
    }

    #[test]
    fn heads_and_chests_are_known_by_code_and_by_words() {
        assert_eq!(at("somewhere", Some("11HEADCG0000ACXP")), Some(BodyPart::Head));
        assert_eq!(at("driver, head", None), Some(BodyPart::Head));
        assert_eq!(at("front passenger, chest", None), Some(BodyPart::Chest));
        assert_eq!(at("free motion headform", None), Some(BodyPart::Headform));
        assert_eq!(at("vehicle, head restraint", None), None);
        assert_eq!(at("engine, cylinder head", None), None);
        assert_eq!(at("driver, pelvis", Some("11PELV000000ACXP")), None);
        assert_eq!(part_of(&Channel::new("head_x", QuantityKind::Acceleration)), Some(BodyPart::Head));
        assert_eq!(part_of(&Channel::new("head_x", QuantityKind::AngularVelocity)), None);
    }
}
