//! Which channels are filtered, and to which class.

use std::collections::BTreeMap;

use crumple_signal::{
    Cfc, Channel, ChannelStatus, Class, FilterSettings, QuantityKind, TestDescription, ZeroLevel, part_of,
};
use crumple_stage::records::QualityV1;
use crumple_stage::{Inputs, RefuseExt, Refused, Wave};

use crate::stage::options::StageSettings;
use crate::stage::remarks::{Remarks, first_of};
use crate::stage::selection::{SelectionError, class_of_body, is_barrier_force, occupants_left, select};

/// A channel on its way in.
pub struct ChannelToFilter<'a> {
    pub id: String,
    pub wave: &'a Wave,
    /// The class it carries.
    pub cfc: Option<u16>,
    pub settings: FilterSettings,
}

/// The channels that are filtered, each with its class: those named, or those of the vehicle, of occupants and of the
/// barrier. `pass` are handed on as they are. `may_be_none`: a pulse was derived, so there may be nothing else.
pub fn channels_to_filter<'a>(
    settings: &StageSettings,
    pass: &[String],
    input: &'a Inputs,
    test: &TestDescription,
    may_be_none: bool,
    remarks: &mut Remarks,
) -> anyhow::Result<Vec<ChannelToFilter<'a>>> {
    let selected = match select(test, &settings.channels) {
        Err(SelectionError::None) if may_be_none => Vec::new(),
        Err(SelectionError::None) if test.pulse.is_none() && no_acceleration(test) => {
            return Err(no_crash(test));
        }
        selected => selected.refuse_with_hint("name the channels to filter with --channels")?,
    };
    if settings.channels.is_empty() {
        note_occupants_left(settings, pass, test, &selected, remarks);
    }
    let pulse = test.pulse_channel().ok();
    let mut channels = Vec::new();
    for channel in selected.into_iter().filter(|channel| !pass.contains(&channel.id)) {
        let mut channel_settings = settings.filter;
        let quality = input.record_if::<QualityV1>(&format!("/quality/{}", channel.id))?;
        if let (ZeroLevel::PreEvent(_), Some(rest_level)) =
            (channel_settings.zero_level, quality.and_then(|quality| quality.rest_level))
        {
            channel_settings.zero_level = ZeroLevel::AtRest(rest_level);
        }
        // SAE J211-1 Table 1: barrier force is CFC 60, whatever the structure is filtered to.
        if is_barrier_force(channel) && settings.channels.is_empty() && channel_settings.class != Class::None {
            channel_settings.class = Class::Cfc(Cfc::Cfc60);
        }
        // Nor is a dummy filtered like the structure: head 1000, chest 180.
        let for_criteria = for_criteria(settings, channel, pulse);
        if let Some(class) = class_of_body(channel)
            && let Class::Cfc(asked) = channel_settings.class
            && (asked != class || channel_settings.butterworth.is_some())
            && (channel_settings.butterworth.is_none() || for_criteria)
        {
            if settings.class_for_all && !for_criteria {
                remarks.warning(
                    &channel.id,
                    format!(
                        "of a dummy, filtered to cfc {asked} as asked for: its criteria ask for cfc {class} (SAE \
                        J211-1)"
                    ),
                );
            } else {
                channel_settings.class = Class::Cfc(class);
                channel_settings.butterworth = None;
                if channel.cfc.is_none() {
                    remarks.info(
                        &channel.id,
                        format!(
                            "of a dummy, filtered to cfc {class} (SAE J211-1); another class by --cfc beside --channels"
                        ),
                    );
                }
            }
        }
        channels.push(ChannelToFilter {
            id: channel.id.clone(),
            wave: input.wave(&channel.id)?,
            cfc: channel.cfc,
            settings: channel_settings,
        });
    }
    Ok(channels)
}

fn no_acceleration(test: &TestDescription) -> bool {
    !test.channels.iter().any(|channel| channel.quantity == QuantityKind::Acceleration && channel.status.has_data())
}

/// A record of inputs and outputs: identified as it is.
fn no_crash(test: &TestDescription) -> anyhow::Error {
    let ids: Vec<String> = test.channels.iter().map(|channel| channel.id.clone()).collect();
    let (first, last) = (ids.first().map_or("COLUMN", String::as_str), ids.last().map_or("COLUMN", String::as_str));
    Refused::new(format!(
        "the record is no crash: no pulse is named and no channel is an acceleration \
        ({})",
        first_of(&ids)
    ))
    .expected("accelerations to filter, or channels named with --channels")
    .hint(format!(
        "inputs and outputs are identified from the artifact of crumple-ingest as they are: crumple-identify \
             1-ingest.mcap --methods n4sid --inputs {first} --outputs {last} -o 4-identify.mcap"
    ))
    .into()
}

/// Whether a head or chest is taken by itself: nobody named it, and the pulse is of the vehicle or of another part. It
/// has its own class whatever is done to the structure.
fn for_criteria(settings: &StageSettings, channel: &Channel, pulse: Option<&Channel>) -> bool {
    let with_the_pulse = |pulse: &Channel| {
        pulse.id == channel.id
            || (part_of(pulse).is_some() && !pulse.location.is_empty() && pulse.location == channel.location)
    };
    settings.channels.is_empty() && part_of(channel).is_some() && !pulse.is_some_and(with_the_pulse)
}

/// Names the sensors of occupants that are not taken, by place, with the one thing to do.
fn note_occupants_left(
    settings: &StageSettings,
    pass: &[String],
    test: &TestDescription,
    taken: &[&Channel],
    remarks: &mut Remarks,
) {
    let mut left = occupants_left(test, taken);
    left.retain(|channel| !pass.contains(&channel.id));
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for channel in &left {
        let failed = if channel.status == ChannelStatus::Failed { ", failed" } else { "" };
        *places.entry(format!("{}{failed}", channel.location)).or_default() += 1;
    }
    let Some(example) = left.iter().find(|channel| channel.quantity == QuantityKind::Acceleration).or(left.first())
    else {
        return;
    };
    let pulse = test.pulse_channel().map_or_else(|_| String::new(), |channel| format!("{},", channel.id));
    let places: Vec<String> = places.into_iter().map(|(place, n)| format!("{place} ({n})")).collect();
    let class = settings.filter.class;
    remarks.of_test(format!(
        "{} channels of occupants are not filtered, no criterion is made of them: {}; crumple-filter --channels \
         '{pulse}{}' takes one beside the pulse, to cfc {class}",
        left.len(),
        first_of(&places),
        example.id
    ));
}
