//! Which accelerometers are integrated beside the pulse.

use crumple_signal::{Axis, Channel, ChannelStatus, Notes, QuantityKind, TestDescription, part_of};
use crumple_stage::{Inputs, Refused};

/// Parts of the vehicle that move apart from its compartment, lower case.
const PARTS: [&str; 10] =
    ["engine", "caliper", "brake", "wheel", "steering", "dashboard", "bumper", "radiator", "subframe", "firewall"];

/// Places of the compartment that have a front of their own: elsewhere "front" is that of the vehicle.
const WITH_A_FRONT: [&str; 10] =
    ["seat", "sill", "rocker", "floor", "pillar", "door", "tunnel", "console", "passenger", "gravity"];

/// The channels of a list, or with `all` every x acceleration with data, not marked failed, whose location names
/// nothing that moves apart from the compartment, and those the list names beside it.
pub fn other_channels<'a>(
    asked: &[String],
    test: &'a TestDescription,
    pulse: &str,
    input: &Inputs,
    notes: &mut Notes,
) -> anyhow::Result<Vec<&'a Channel>> {
    let everything = asked.iter().any(|id| id == "all");
    let mut ids: Vec<String> = Vec::new();
    for name in asked.iter().filter(|name| *name != "all") {
        ids.extend(channels_named(test, name, "channels", input)?);
    }
    ids.retain(|id| id != pulse);
    if everything {
        let candidates = test.channels.iter().filter(|channel| {
            channel.id != pulse
                && channel.quantity == QuantityKind::Acceleration
                && channel.axis.is_none_or(|axis| axis == Axis::X)
                && input.wave_if(&channel.id).is_some()
        });
        for id in &ids {
            input.wave(id)?;
        }
        let named = |channel: &Channel| ids.contains(&channel.id);
        let (mut taken, mut left): (Vec<&Channel>, Vec<&Channel>) =
            candidates.partition(|channel| is_of_compartment(channel) || named(channel));
        // Heads and chests are here for their criteria.
        left.retain(|channel| part_of(channel).is_none());
        if !left.is_empty() {
            let ids: Vec<&str> = left.iter().map(|channel| channel.id.as_str()).collect();
            notes.info(format!(
                "not integrated, because failed or not of the compartment: channels {} (crumple-integrate --channels \
                 all,ID names one)",
                ids.join(", ")
            ));
        }
        // What was named is integrated, along whatever axis.
        for id in &ids {
            taken.extend(test.channel(id).filter(|channel| !taken.iter().any(|other| other.id == channel.id)));
        }
        return Ok(taken);
    }
    let mut channels: Vec<&Channel> = Vec::new();
    for id in &ids {
        input.wave(id)?;
        channels.extend(test.channel(id).filter(|channel| !channels.iter().any(|other| other.id == channel.id)));
    }
    Ok(channels)
}

/// Accelerometers that a refusal lists.
const SHOWN: usize = 12;

/// The ids that a name, a code or a pattern means, given under an option. A pattern leaves out what cannot be
/// integrated: other quantities, and channels that are not in the inputs.
pub fn channels_named(test: &TestDescription, name: &str, key: &str, input: &Inputs) -> anyhow::Result<Vec<String>> {
    let all = test.resolve_channels(name);
    if all.is_empty() {
        let usable_here =
            |channel: &&Channel| channel.quantity == QuantityKind::Acceleration && input.wave_if(&channel.id).is_some();
        let mut usable_here: Vec<&str> =
            test.channels.iter().filter(usable_here).map(|channel| channel.id.as_str()).collect();
        let more = usable_here.len().saturating_sub(SHOWN);
        usable_here.truncate(SHOWN);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        return Err(Refused::new(format!(
            "the test has no channel {name:?}, which {key} of [integrate] or --{key} \
            names"
        ))
        .expected(format!("an accelerometer of the inputs: {}{more}", usable_here.join(", ")))
        .hint(format!(
            "put the id of yours there; in the pipeline two-sensors it stands in channels of [integrate] and in \
                 sensors of [parameter-solve]{}",
            if test.channels.len() > usable_here.len() {
                " (crumple-ingest --list RECORD shows every \
                    channel)"
            } else {
                ""
            }
        ))
        .into());
    }
    let usable =
        |channel: &&&Channel| channel.quantity == QuantityKind::Acceleration && input.wave_if(&channel.id).is_some();
    let ids = |channels: Vec<&Channel>| channels.into_iter().map(|channel| channel.id.clone()).collect::<Vec<_>>();
    let fit: Vec<&Channel> = all.iter().filter(usable).copied().collect();
    // One that was named says itself what it lacks.
    Ok(if all.len() == 1 || fit.is_empty() { ids(all) } else { ids(fit) })
}

/// Whether a channel moves with the compartment, as far as status, code, location and, without a location, its name
/// say.
pub fn is_of_compartment(channel: &Channel) -> bool {
    let place = if channel.location.trim().is_empty() { &channel.id } else { &channel.location };
    let place = place.to_lowercase();
    let is_said = |wanted: &str| place.split(|c: char| !c.is_alphanumeric()).any(|word| word == wanted);
    channel.status != ChannelStatus::Failed
        && channel.may_be_on_vehicle()
        && part_of(channel).is_none()
        && !PARTS.iter().any(|word| place.contains(word))
        && (!is_said("front") || is_said("cg") || WITH_A_FRONT.iter().any(|word| place.contains(word)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sensor_on_the_front_is_not_of_the_compartment() {
        let at = |location: &str| {
            is_of_compartment(&Channel {
                location: location.to_owned(),
                ..Channel::new("a_front", QuantityKind::Acceleration)
            })
        };
        for place in [
            "vehicle, left rear seat crossmember",
            "left front sill",
            "front floor, right",
            "right front door",
            "front rocker",
            "front console",
            "vehicle CG, frontal impact",
            "CG front",
        ] {
            assert!(at(place), "{place}");
        }
        for place in ["", "vehicle, front end", "front crossmember", "bumper beam", "engine top", "firewall, left"] {
            assert!(!at(place), "{place}");
        }
    }
}
