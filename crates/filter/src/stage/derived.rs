//! The pulse of an event data recorder: an acceleration derived from its velocity change.

use crumple_filter::{Class, Settings, ZeroLevel, acceleration_of_velocity_change, derivative_note, filter};
use crumple_signal::{Channel, ChannelStatus, QuantityKind, TestDescription};
use crumple_stage::{Inputs, RefuseExt};

use crate::stage::filtered_channel::{Extra, FilteredChannel};
use crate::stage::remarks::Remarks;

/// The acceleration of a pulse that is a velocity change, which becomes the pulse in its place; nothing for any other. A filter that
/// takes the place of a class is run, a class is not: the recorder has filtered, nobody says how.
pub fn derived(
    settings: &Settings,
    input: &Inputs,
    test: &mut TestDescription,
    remarks: &mut Remarks,
) -> anyhow::Result<Option<FilteredChannel>> {
    let change = |channel: &&Channel| channel.quantity == QuantityKind::VelocityChange && channel.status.has_data();
    let Some(of) = test.pulse_channel().ok().filter(change).cloned() else { return Ok(None) };
    let wave = &input.wave(&of.id)?.sampled;
    let acceleration =
        acceleration_of_velocity_change(wave).refuse_with_hint("check the steps of the velocity change")?;
    let of_derived = Settings { class: Class::None, zero_level: ZeroLevel::None, ..*settings };
    let mut filtered = filter(&acceleration, None, &of_derived).refuse_with_hint("leave the filter out")?;
    derivative_note(wave, &of.id, &mut filtered.notes);
    let mut id = format!("{}_derivative", of.id);
    while test.channel(&id).is_some() {
        id.push('_');
    }
    for note in filtered.notes.iter() {
        remarks.add(&id, note.clone());
    }
    test.pulse = Some(id.clone());
    test.channels.push(Channel {
        location: of.location,
        axis: of.axis,
        status: ChannelStatus::Computed,
        comment: Some(format!("derived from the velocity change {}, central differences", of.id)),
        filter_state: Some("not stated by the recorder".to_owned()),
        polarity: of.polarity,
        sensor: of.sensor,
        ..Channel::new(id.clone(), QuantityKind::Acceleration)
    });
    Ok(Some(FilteredChannel {
        id,
        quantity: QuantityKind::Acceleration,
        filtered,
        extra: Extra::default(),
        for_criteria: false,
    }))
}
