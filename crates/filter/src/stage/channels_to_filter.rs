//! Which channels are filtered, and by which class.

use std::collections::BTreeMap;

use crumple_signal::{
    About, BARRIER, Cfc, Channel, ChannelStatus, Class, FilterSettings, QuantityKind, TestDescription, Weight,
    ZeroLevel, criterion_of, part_of, remarks,
};
use crumple_stage::records::QualityV1;
use crumple_stage::{Inputs, RefuseExt, Refused, Wave, flag, program};

use crate::stage::filtering::{Remarks, first_of};
use crate::stage::options::StageSettings;

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
        selected => {
            selected.refuse_with_hint(format!("name the channels to filter with {}", flag("filter", "channels")))?
        }
    };
    if settings.channels.is_empty() {
        note_occupants_left(settings, pass, test, &selected, remarks);
    }
    let pulse = test.pulse_channel().ok();
    let mut channels = Vec::new();
    for channel in selected.into_iter().filter(|channel| !pass.contains(&channel.id)) {
        let mut channel_settings = settings.filter;
        if test.source.is_simulated() {
            channel_settings.zero_level = ZeroLevel::None;
        }
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
        if let Some(class) = class_of_body(channel)
            && channel_settings.class != Class::None
            && (channel_settings.butterworth.is_none() || for_criteria(settings, channel, pulse))
        {
            let asked = settings.occupant_cfc.unwrap_or(Class::Cfc(class));
            (channel_settings.class, channel_settings.butterworth) = (asked, None);
            if asked != Class::Cfc(class) {
                remarks.add(&channel.id, AnotherClass { asked: asked.to_string(), class: class.number() });
            } else if channel.cfc.is_none() {
                remarks.add(&channel.id, ClassOfBody { class: class.number() });
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
    // Of one channel nothing is an input.
    let first = if ids.len() == 1 { "none" } else { ids.first().map_or("COLUMN", String::as_str) };
    let last = ids.last().map_or("COLUMN", String::as_str);
    Refused::new(format!(
        "the record is no crash: no pulse is named and no channel is an acceleration \
        ({})",
        first_of(&ids)
    ))
    .expected("accelerations to filter, or channels named with --channels")
    .hint(format!(
        "inputs and outputs are identified from the artifact of ingest as they are: {} 1-ingest.mcap --methods n4sid \
         --inputs {first} --outputs {last} -o 4-identify.mcap",
        program("identify")
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
    settings.channels.is_empty() && criterion_of(channel).is_some() && !pulse.is_some_and(with_the_pulse)
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
    remarks.of_test(OccupantsLeftOut {
        count: left.len(),
        places: first_of(&places),
        channels: format!("{pulse}{}", example.id),
        class: class.to_string(),
    });
}

remarks! {
    /// Remarks of the choice of channels and classes.
    pub REMARKS;

    /// A channel of a dummy was filtered to another class than its criteria ask for.
    CR223 AnotherClass { asked: String, class: u16 }
    bears on (About::Pulse, Weight::Slight)
    decided "SAE J211-1, table 1: head CFC 1000, chest 180; --occupant-cfc asks for another one."
    means "HIC and the 3 ms clip are not those of the regulation: a lower class lowers both."
    remedy "leave --occupant-cfc out"
    says format!(
        "of a dummy, filtered to CFC {asked} as asked for: its criteria ask for CFC {class} (SAE J211-1)"
    );

    /// A channel of a dummy was filtered to the class of its part of the body.
    CR224 ClassOfBody { class: u16 }
    bears on (About::Pulse, Weight::None)
    decided "SAE J211-1, table 1, by the part of the body that the channel states."
    means "Its class differs from that of the structure, as its criteria ask for."
    remedy "nothing; --occupant-cfc changes the class"
    says format!("of a dummy, filtered to CFC {class} (SAE J211-1); --occupant-cfc changes the class");

    /// Channels of occupants that no criterion uses are left out.
    CR225 OccupantsLeftOut { count: usize, places: String, channels: String, class: String }
    bears on (About::Occupants, Weight::None)
    decided "Criteria are made from heads and chests; other channels of dummies are not filtered."
    means "They are in the record, and in no later file."
    remedy "nothing; filter.channels adds those that are wanted"
    says format!(
        "{count} occupant channels are left out, because no criterion uses them: {places}. --set \
         filter.channels='{channels}' adds one, at CFC {class}"
    );
}

/// Why a list of channels cannot be filtered.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SelectionError {
    /// A named channel is not in the test.
    #[error("the test has no channel {id:?}, it has {known}")]
    Unknown {
        /// What was asked for.
        id: String,
        /// What there is.
        known: String,
    },
    /// A named channel has no samples.
    #[error("channel {id:?} has no data: {status}")]
    NoData {
        /// What was asked for.
        id: String,
        /// Why there is none.
        status: ChannelStatus,
    },
    /// Nothing to filter.
    #[error("the test has no acceleration channel on the vehicle structure with data that is not marked failed")]
    None,
}

/// The ids that names, codes and patterns such as `1?VEHC*X?` mean, each once. A pattern leaves out channels without
/// data.
pub fn resolve_ids(test: &TestDescription, asked: &[String]) -> Result<Vec<String>, SelectionError> {
    let mut ids: Vec<String> = Vec::new();
    for wanted in asked {
        let meant = test.resolve_channels(wanted);
        let Some(first) = meant.first() else {
            return Err(SelectionError::Unknown { id: wanted.clone(), known: known(test) });
        };
        let with_data: Vec<&&Channel> = meant.iter().filter(|channel| channel.status.has_data()).collect();
        if with_data.is_empty() {
            return Err(SelectionError::NoData { id: first.id.clone(), status: first.status });
        }
        for channel in with_data {
            if !ids.contains(&channel.id) {
                ids.push(channel.id.clone());
            }
        }
    }
    Ok(ids)
}

/// The channels to filter, in the order of the test.
///
/// With `asked`, exactly those ([`resolve_ids`]), whatever they measure. Without: every acceleration channel with data
/// that is not marked failed and whose location does not begin with an occupant or the barrier ("driver, head"; an
/// unknown location counts as structure); the pulse in any case; the accelerometers in heads and chests of occupants,
/// along all axes, because criteria are made of them; and the load cells of the barrier ([`is_barrier_force`]), failed
/// ones too, because whoever sums them has to name what is left out.
fn select<'a>(test: &'a TestDescription, asked: &[String]) -> Result<Vec<&'a Channel>, SelectionError> {
    let asked = resolve_ids(test, asked)?;
    let pulse = test.pulse_channel().ok().map(|channel| channel.id.as_str());
    let taken = |channel: &&Channel| match asked.as_slice() {
        [] => {
            let usable = channel.quantity == QuantityKind::Acceleration && channel.status.has_data();
            (usable && (Some(channel.id.as_str()) == pulse || on_structure(channel) || is_of_body(channel)))
                || is_barrier_force(channel)
        }
        _ => asked.contains(&channel.id),
    };
    let channels: Vec<&Channel> = test.channels.iter().filter(taken).collect();
    // Load cells alone are no motion.
    if channels.iter().all(|channel| asked.is_empty() && is_barrier_force(channel)) {
        return Err(SelectionError::None);
    }
    Ok(channels)
}

/// Whether a criterion of an occupant takes a channel ([`criterion_of`]), with data and not marked failed.
fn is_of_body(channel: &Channel) -> bool {
    criterion_of(channel).is_some() && channel.status.has_data() && channel.status != ChannelStatus::Failed
}

/// Channels with data in or on occupants that are not among the `taken`, in the order of the test: neck, pelvis, femur
/// and the like, of which a note tells that they were measured and not filtered.
fn occupants_left<'a>(test: &'a TestDescription, taken: &[&Channel]) -> Vec<&'a Channel> {
    let of_occupant = |channel: &Channel| {
        let barrier = channel.location.trim().to_lowercase().starts_with(BARRIER);
        channel.status.has_data() && ((!channel.may_be_on_vehicle() && !barrier) || part_of(channel).is_some())
    };
    let left = |channel: &&Channel| of_occupant(channel) && !taken.iter().any(|other| other.id == channel.id);
    test.channels.iter().filter(left).collect()
}

/// Whether a channel is a force of the barrier with data. SAE J211-1 Table 1 asks for CFC 60 for barrier force.
fn is_barrier_force(channel: &Channel) -> bool {
    channel.is_wall_force() && channel.status.has_data()
}

/// The class that the criterion of an occupant asks for; `None` where there is none.
fn class_of_body(channel: &Channel) -> Option<Cfc> {
    Some(match criterion_of(channel)?.1 {
        60 => Cfc::Cfc60,
        180 => Cfc::Cfc180,
        600 => Cfc::Cfc600,
        _ => Cfc::Cfc1000,
    })
}

/// Whether a channel may be of the vehicle's structure and is not marked failed. An unknown location counts as
/// structure: a plain table states none.
fn on_structure(channel: &Channel) -> bool {
    channel.status != ChannelStatus::Failed && channel.may_be_on_vehicle()
}

/// The first channels by name: a list of hundreds helps nobody.
fn known(test: &TestDescription) -> String {
    const SHOWN: usize = 12;
    let names: Vec<&str> = test.channels.iter().take(SHOWN).map(|channel| channel.id.as_str()).collect();
    match test.channels.len().saturating_sub(SHOWN) {
        0 => names.join(", "),
        more => format!("{} and {more} more", names.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test_with(channels: &[(&str, &str, QuantityKind, ChannelStatus)]) -> TestDescription {
        let channels = channels
            .iter()
            .map(|&(id, location, quantity, status)| Channel {
                location: location.to_owned(),
                status,
                ..Channel::new(id, quantity)
            })
            .collect();
        TestDescription { channels, ..TestDescription::default() }
    }

    fn camry() -> TestDescription {
        use ChannelStatus::{Failed, NotInstalled, Questionable, Valid};
        use QuantityKind::{Acceleration, Force};
        test_with(&[
            ("001", "Driver, head", Acceleration, Valid),
            ("045", "driver, belt", Force, NotInstalled),
            ("093", "vehicle, rear floor, left", Acceleration, Valid),
            ("095", "vehicle, top of engine", Acceleration, Questionable),
            ("096", "vehicle, bottom of engine", Acceleration, Failed),
            ("347", "barrier, load cell", Force, Valid),
            ("348", "barrier", Acceleration, Valid),
            ("349", "front passenger, chest", Acceleration, Valid),
        ])
    }

    fn ids<'a>(channels: &[&'a Channel]) -> Vec<&'a str> {
        channels.iter().map(|channel| channel.id.as_str()).collect()
    }

    #[test]
    fn takes_structure_load_cells_heads_and_chests_and_leaves_other_parts_belts_and_failed_channels() {
        let mut test = camry();
        let pelvis =
            Channel { id: "007".to_owned(), location: "driver, pelvis".to_owned(), ..test.channels[0].clone() };
        let failed = Channel { id: "008".to_owned(), status: ChannelStatus::Failed, ..test.channels[0].clone() };
        test.channels.extend([pelvis, failed]);
        let taken = select(&test, &[]).unwrap();
        assert_eq!(ids(&taken), ["001", "093", "095", "347", "349"]);
        assert_eq!(ids(&occupants_left(&test, &taken)), ["007", "008"], "045 has no data");
    }

    #[test]
    fn the_pulse_is_taken_wherever_it_sits() {
        let test = TestDescription { pulse: Some("096".to_owned()), ..camry() };
        assert_eq!(ids(&select(&test, &[]).unwrap()), ["001", "093", "095", "096", "347", "349"]);
    }

    #[test]
    fn a_failed_load_cell_is_taken_and_one_across_the_barrier_is_not() {
        let mut test = camry();
        test.channels[5].status = ChannelStatus::Failed;
        assert!(ids(&select(&test, &[]).unwrap()).contains(&"347"));
        test.channels[5].axis = Some(crumple_signal::Axis::Y);
        assert!(!ids(&select(&test, &[]).unwrap()).contains(&"347"));
    }

    #[test]
    fn load_cells_alone_are_no_motion() {
        let mut test = camry();
        test.channels.retain(|channel| channel.id == "347");
        assert_eq!(select(&test, &[]), Err(SelectionError::None));
        assert_eq!(ids(&select(&test, &["347".to_owned()]).unwrap()), ["347"]);
    }

    #[test]
    fn a_head_comes_with_its_axes_and_each_part_has_its_class() {
        let mut test = camry();
        test.channels.push(Channel { id: "002".to_owned(), ..test.channels[0].clone() });
        test.pulse = Some("001".to_owned());
        assert_eq!(ids(&select(&test, &[]).unwrap()), ["001", "093", "095", "347", "349", "002"]);
        assert_eq!(class_of_body(&test.channels[0]), Some(Cfc::Cfc1000));
        assert_eq!(class_of_body(&test.channels[7]), Some(Cfc::Cfc180));
        assert_eq!(class_of_body(&test.channels[2]), None);
    }

    #[test]
    fn a_list_is_taken_as_it_is() {
        assert_eq!(ids(&select(&camry(), &["347".to_owned(), "001".to_owned()]).unwrap()), ["001", "347"]);
    }

    #[test]
    fn names_what_is_missing() {
        let error = |id: &str| select(&camry(), &[id.to_owned()]).unwrap_err().to_string();
        assert_eq!(error("94"), "the test has no channel \"94\", it has 001, 045, 093, 095, 096, 347, 348, 349");
        assert_eq!(error("045"), "channel \"045\" has no data: not installed");
        assert_eq!(resolve_ids(&camry(), &["09?".to_owned(), "093".to_owned()]).unwrap(), ["093", "095", "096"]);
        assert_eq!(resolve_ids(&camry(), &["0*5".to_owned()]).unwrap(), ["095"], "045 has no data");
        assert_eq!(select(&test_with(&[]), &[]), Err(SelectionError::None));
    }
}
