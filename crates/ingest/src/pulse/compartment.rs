//! Whether a channel moves with the passenger compartment, as the pulse of a vehicle has to.
//!
//! An engine stops in half the time of the car, and a head moves by itself: crush, force and models of such a channel
//! are not those of the vehicle. It is taken only where a person names it or the file has nothing else, with a warning.

use crumple_signal::iso13499::IsoCode;
use crumple_signal::{Axis, Channel};

use crate::pulse::place_rank;
use crate::recording::content::PulseRule;
use crate::recording::read_channel::ReadChannel;

/// Words in an id, a location or a remark that speak of a place elsewhere.
const ELSEWHERE: [&str; 24] = [
    "barrier",
    "belt",
    "brake",
    "bumper",
    "caliper",
    "chest",
    "dummy",
    "engine",
    "femur",
    "gearbox",
    "head",
    "knee",
    "motor",
    "neck",
    "occupant",
    "pelvis",
    "radiator",
    "spine",
    "steering",
    "thorax",
    "tibia",
    "transmission",
    "wheel",
    "wrist",
];

/// Why the channel may not stand for the compartment, in words; `None` if nothing speaks against it.
pub fn doubt(read: &ReadChannel, rule: PulseRule) -> Option<String> {
    let channel = &read.channel;
    if let Some(axis) = channel.axis.filter(|axis| *axis != Axis::X) {
        return Some(format!("it measures along {axis}, not along x"));
    }
    if let Some(word) = word_for_another_place(channel) {
        return Some(format!("it sits elsewhere ({word})"));
    }
    if let Some((code, _)) = channel.code.as_deref().and_then(|code| IsoCode::parse(code).ok()) {
        let vehicle = code.object().to_digit(10).unwrap_or(1);
        if place_rank::fitness(&code, vehicle).is_none() {
            return Some(format!("its code says {}", code.location()));
        }
    }
    (rule == PulseRule::Fittest && read.fitness.is_none())
        .then(|| "its place is none of rear-seat crossmember, rear floor, sill, B-pillar, centre of gravity".to_owned())
}

fn word_for_another_place(channel: &Channel) -> Option<&'static str> {
    let text = format!("{} {}", channel.id, channel.location).to_lowercase();
    text.split(|c: char| !c.is_alphabetic()).find_map(|word| ELSEWHERE.iter().copied().find(|other| *other == word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::QuantityKind;

    fn channel(id: &str, code: Option<&str>, axis: Option<Axis>) -> ReadChannel {
        let mut channel = Channel::new(id, QuantityKind::Acceleration);
        channel.code = code.map(str::to_owned);
        channel.axis = axis;
        ReadChannel::new(channel)
    }

    #[test]
    fn what_speaks_against_a_channel_is_said() {
        let doubt_of = |id, code, axis| doubt(&channel(id, code, axis), PulseRule::OnlyOne);
        assert_eq!(doubt_of("accel_g", None, None), None);
        assert_eq!(doubt_of("Header_g", None, Some(Axis::X)), None);
        assert_eq!(doubt_of("a", Some("10FORALERE00ACXP"), Some(Axis::X)), None);
        assert_eq!(doubt_of("a", Some("20VEHCCG0000ACXP"), Some(Axis::X)), None);
        assert_eq!(doubt_of("accel_z", None, Some(Axis::Z)).unwrap(), "it measures along z, not along x");
        assert_eq!(doubt_of("Head_x_g", None, Some(Axis::X)).unwrap(), "it sits elsewhere (head)");
        assert!(doubt_of("a", Some("10ENGN000000ACXP"), Some(Axis::X)).unwrap().contains("engine"));
        assert!(doubt(&channel("a", None, None), PulseRule::Fittest).unwrap().contains("rear floor"));
    }
}
