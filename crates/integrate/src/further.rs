//! Which accelerometers are integrated beside the pulse.

use crumple_signal::{Axis, Channel, ChannelStatus, Notes, QuantityKind, TestDescription};
use crumple_stage::{Inputs, Refused};

/// Parts of the vehicle that move apart from its compartment, lower case.
const PARTS: [&str; 6] = ["engine", "caliper", "brake", "wheel", "steering", "dashboard"];

/// The channels of a list, or with `all` every x acceleration with data, not marked failed, whose location names
/// nothing that moves apart from the compartment, and those the list names beside it.
pub fn further<'a>(
    asked: &[String],
    test: &'a TestDescription,
    pulse: &str,
    input: &Inputs,
    notes: &mut Notes,
) -> anyhow::Result<Vec<&'a Channel>> {
    if asked.iter().any(|id| id == "all") {
        let candidates = test.channels.iter().filter(|channel| {
            channel.id != pulse
                && channel.quantity == QuantityKind::Acceleration
                && channel.axis.is_none_or(|axis| axis == Axis::X)
                && input.wave_if(&channel.id).is_some()
        });
        for id in asked.iter().filter(|id| *id != "all" && *id != pulse) {
            known(test, id)?;
            input.wave(id)?;
        }
        let named = |channel: &Channel| asked.contains(&channel.id);
        let (taken, left): (Vec<&Channel>, Vec<&Channel>) =
            candidates.partition(|channel| of_compartment(channel) || named(channel));
        if !left.is_empty() {
            let ids: Vec<&str> = left.iter().map(|channel| channel.id.as_str()).collect();
            notes.info(format!(
                "not integrated, because failed or not of the compartment: channels {} (name them with --channels)",
                ids.join(", ")
            ));
        }
        return Ok(taken);
    }
    let mut channels = Vec::new();
    for id in asked.iter().filter(|id| *id != pulse) {
        let channel = known(test, id)?;
        input.wave(id)?;
        channels.push(channel);
    }
    Ok(channels)
}

fn known<'a>(test: &'a TestDescription, id: &str) -> anyhow::Result<&'a Channel> {
    Ok(test.channel(id).ok_or_else(|| {
        Refused::new(format!("the test has no channel {id:?}"))
            .hint("crumple-artifact show lists the channels of an artifact")
    })?)
}

/// Whether a channel moves with the compartment, as far as status and location say.
pub fn of_compartment(channel: &Channel) -> bool {
    let location = channel.location.to_lowercase();
    channel.status != ChannelStatus::Failed
        && channel.may_be_on_vehicle()
        && !PARTS.iter().any(|word| location.contains(word))
}
