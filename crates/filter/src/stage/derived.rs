//! The pulse of a record without acceleration: derived from a velocity, or the velocity change of a recorder.

use crumple_signal::{
    Channel, ChannelStatus, Class, FilterSettings, QuantityKind, TestDescription, ZeroLevel,
    acceleration_of_velocity_change, derivative_note, filter,
};
use crumple_stage::{Inputs, RefuseExt};

use crate::stage::filtered_channel::{Extra, FilteredChannel};
use crate::stage::remarks::Remarks;

/// The acceleration of a pulse that is a velocity or a change of it, which becomes the pulse in its place; nothing for
/// any other. What a recorder kept is not filtered to a class: the recorder has filtered, nobody says how. A velocity
/// is where it is sampled fast enough for the class.
pub fn derived(
    settings: &FilterSettings,
    input: &Inputs,
    test: &mut TestDescription,
    remarks: &mut Remarks,
) -> anyhow::Result<Option<FilteredChannel>> {
    let change = |channel: &&Channel| {
        matches!(channel.quantity, QuantityKind::VelocityChange | QuantityKind::Velocity) && channel.status.has_data()
    };
    let Some(of) = test.pulse_channel().ok().filter(change).cloned() else { return Ok(None) };
    let wave = &input.wave(&of.id)?.sampled;
    let acceleration =
        acceleration_of_velocity_change(wave).refuse_with_hint("check the steps of the velocity change")?;
    let is_recorder = of.quantity == QuantityKind::VelocityChange;
    let class = match settings.class {
        Class::Cfc(cfc) if !is_recorder && wave.rate_hz() >= 10.0 * f64::from(cfc.number()) => settings.class,
        _ => Class::None,
    };
    let of_derived = FilterSettings { class, zero_level: ZeroLevel::None, ..*settings };
    let mut filtered = filter(&acceleration, None, &of_derived).refuse_with_hint("leave the filter out")?;
    if is_recorder {
        derivative_note(wave, &of.id, &mut filtered.notes);
    } else {
        filtered.notes.warning(format!(
            "derived from the velocity {} by central differences over {:.3} ms, not measured: noise of the velocity is \
             amplified in it",
            of.id,
            2e3 * wave.dt_s()
        ));
    }
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
        comment: Some(format!(
            "derived from the velocity {}{}, central differences",
            if is_recorder { "change " } else { "" },
            of.id
        )),
        filter_state: is_recorder.then(|| "not stated by the recorder".to_owned()),
        polarity: of.polarity,
        sensor: of.sensor,
        ..Channel::new(id.clone(), QuantityKind::Acceleration)
    });
    Ok(Some(FilteredChannel { id, quantity: QuantityKind::Acceleration, filtered, extra: Extra::default() }))
}
