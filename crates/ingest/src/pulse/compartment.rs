//! Whether a channel moves with the passenger compartment, as the pulse of a vehicle has to.
//!
//! An engine stops in half the time of the car and a head in a time of its own: crush, force and models of such a
//! channel are not those of the vehicle. It is taken where a person names it, or where nothing else is in the file, and
//! said.

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
pub fn doubt(found: &ReadChannel, rule: PulseRule) -> Option<String> {
    let channel = &found.channel;
    if let Some(axis) = channel.axis.filter(|axis| *axis != Axis::X) {
        return Some(format!("it measures along {axis}, not along x"));
    }
    if let Some(word) = elsewhere(channel) {
        return Some(format!("it sits elsewhere ({word})"));
    }
    if let Some((code, _)) = channel.code.as_deref().and_then(|code| IsoCode::parse(code).ok()) {
        let vehicle = code.object().to_digit(10).unwrap_or(1);
        if place_rank::fitness(&code, vehicle).is_none() {
            return Some(format!("its code says {}", code.location()));
        }
    }
    (rule == PulseRule::Fittest && found.fitness.is_none())
        .then(|| "its place is none of rear-seat crossmember, rear floor, sill, B-pillar, centre of gravity".to_owned())
}

fn elsewhere(channel: &Channel) -> Option<&'static str> {
    let text = format!("{} {}", channel.id, channel.location).to_lowercase();
    text.split(|c: char| !c.is_alphabetic()).find_map(|word| ELSEWHERE.iter().copied().find(|other| *other == word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_signal::QuantityKind;

    fn found(id: &str, code: Option<&str>, axis: Option<Axis>) -> ReadChannel {
        let mut channel = Channel::new(id, QuantityKind::Acceleration);
        channel.code = code.map(str::to_owned);
        channel.axis = axis;
        ReadChannel { channel, wave: None, jitter: 0.0, fitness: None, aliases: Vec::new() }
    }

    #[test]
    fn what_speaks_against_a_channel_is_said() {
        let of = |id, code, axis| doubt(&found(id, code, axis), PulseRule::OnlyOne);
        assert_eq!(of("accel_g", None, None), None);
        assert_eq!(of("Header_g", None, Some(Axis::X)), None);
        assert_eq!(of("a", Some("10FORALERE00ACXP"), Some(Axis::X)), None);
        assert_eq!(of("a", Some("20VEHCCG0000ACXP"), Some(Axis::X)), None);
        assert_eq!(of("accel_z", None, Some(Axis::Z)).unwrap(), "it measures along z, not along x");
        assert_eq!(of("Head_x_g", None, Some(Axis::X)).unwrap(), "it sits elsewhere (head)");
        assert!(of("a", Some("10ENGN000000ACXP"), Some(Axis::X)).unwrap().contains("engine"));
        assert!(doubt(&found("a", None, None), PulseRule::Fittest).unwrap().contains("rear floor"));
    }
}
