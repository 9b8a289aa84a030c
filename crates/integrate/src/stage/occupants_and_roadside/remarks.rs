//! Remarks of criteria of occupants and of roadside hardware.

use crumple_signal::{About, Weight, remarks};

/// Criteria of heads and chests.
pub const OCCUPANTS: &str = "occupants";
/// Criteria of roadside hardware.
pub const ROADSIDE: &str = "roadside hardware";
/// The criterion that needs a yaw rate.
pub const THIV: &str = "thiv";

/// What roadside metrics take along an axis where no sensor at the centre of gravity measures it.
pub fn assumption(axis: &str, pulse: Option<&str>) -> String {
    match pulse {
        Some(pulse) => format!("{axis} of the pulse {pulse}, not known to be at the centre of gravity"),
        None => format!("{axis} is not measured at the centre of gravity and taken as 0"),
    }
}

/// What is said of a channel whose class is not the one that a definition asks for.
pub fn other_class(channel: &str, class: Option<u16>, asked: u16) -> String {
    let class = class.map_or_else(|| "no class".to_owned(), |class| format!("CFC {class}"));
    format!("channel {channel} is of {class}, the definition asks for CFC {asked}")
}

/// The sentence of heads and chests that the filter left out.
fn body_filtered_out(group: &str, channels: &[String], pulse: &str) -> String {
    let word = if channels.len() == 1 { "channel" } else { "channels" };
    format!(
        "{group}: {word} {} measured it, but the filter left it out: without channels it takes all, or --set \
         filter.channels='{pulse},{}'",
        channels.join(", "),
        channels.join(",")
    )
}

remarks! {
    /// Remarks of criteria.
    pub REMARKS;

    /// Criteria of a head or chest are made from one or two axes.
    CR352 CriteriaAreBounds { places: Vec<String> }
    bears on (About::Occupants, Weight::Marked)
    decided "The place has neither three axes with data nor a channel that is their resultant."
    means "The resultant lacks the missing axes. A limit may be exceeded where HIC and the 3 ms clip are below it."
    remedy "use a record with all three axes"
    says format!(
        "criteria are lower bounds, because only one or two axes are in this record: {}",
        places.join("; ")
    );

    /// A channel of a criterion was measured, and the filter left it out.
    CR353 FilteredOut { group: String, channels: Vec<String>, pulse: Option<String> }
    bears on (if group == THIV { About::Motion } else { About::Occupants }, Weight::None)
    decided "The test lists the channel with data, and the filtered record does not hold it."
    means "Its criteria are not in /metrics."
    remedy "leave filter.channels out, which takes heads and chests; filter.pass hands a yaw rate on"
    says match pulse {
        Some(pulse) => body_filtered_out(group, channels, pulse),
        None => format!(
            "{group}: channel{} {} measured the yaw rate, but the filter left it out: --set filter.pass hands it on",
            if channels.len() == 1 { "" } else { "s" },
            channels.join(", ")
        ),
    };

    /// Criteria of a head or chest were asked for, and the filter left its channels out.
    CR354 AskedAndFilteredOut { group: String, channels: Vec<String>, pulse: String }
    bears on (About::Occupants, Weight::Slight)
    decided "integrate.metrics names the group, the test lists the channels with data, and the filtered record does \
             not hold them."
    means "The criteria that were asked for are not in /metrics."
    remedy "leave filter.channels out, or name the channels there too"
    says body_filtered_out(group, channels, pulse);

    /// Criteria of a head or chest were asked for, and no accelerometer is known to be there.
    CR355 NotMeasured { group: String, unplaced: Vec<String> }
    bears on (About::Occupants, Weight::Slight)
    decided "integrate.metrics names the group. A channel belongs to it by its location, its code (ISO 13499), or a \
             name that begins with the part of the body."
    means "The criteria that were asked for are not in /metrics."
    remedy "name the columns head_x_g, chest_x_g and so on, or leave the group out of integrate.metrics"
    says match unplaced.as_slice() {
        [] => format!("{group}: no accelerometer of it has data in the inputs"),
        ids => format!(
            "{group}: no accelerometer of it has data in the inputs, and nothing says where channel{} {} sit{}: the \
             name of a column that begins with {group}, such as {group}_x_g, or a code of ISO 13499 does",
            if ids.len() == 1 { "" } else { "s" },
            ids.join(", "),
            if ids.len() == 1 { "s" } else { "" },
        ),
    };

    /// The axes of a head or chest have different time grids.
    CR356 AxesOnOtherGrids { place: String }
    bears on (About::Occupants, Weight::Slight)
    decided "A resultant needs samples at the same times; no axis is interpolated."
    means "There are no criteria of this place."
    remedy "bring its channels to one sampling rate: filter.resample"
    says format!("{place}: its axes are on different time grids, no criteria");

    /// Ride-down was not computed.
    CR357 RideDownMissing { pulse: Option<String>, chest: Option<String>, reason: Option<String> }
    bears on (About::Occupants, Weight::Slight)
    decided "It needs a pulse of the vehicle and a chest acceleration along x, both on one time grid from contact on."
    means "The share of the occupant's energy that the crush of the vehicle takes is not in /metrics."
    remedy "name a pulse of the vehicle, and let the filter take the chest; filter.resample brings both to one grid"
    says match (pulse, chest.as_ref().zip(reason.as_ref())) {
        (_, Some((chest, reason))) => format!("ride-down of channel {chest}: {reason}"),
        (Some(_), None) => "ride-down: the pulse is no accelerometer of the vehicle".to_owned(),
        (None, None) => "ride-down: no chest acceleration along x has data in the inputs".to_owned(),
    };

    /// Roadside metrics are made without a sensor at the centre of gravity along an axis.
    CR358 RoadsideAssumes { axis: String, pulse: Option<String> }
    bears on (About::Motion, Weight::None)
    decided "Code or location of the channels names the centre of gravity; else x is the pulse, y and z are 0."
    means "Elsewhere than at the centre of gravity a yawing vehicle has other accelerations. An axis that is taken as \
           0 makes ASI too small."
    remedy "nothing, or use a record with sensors at the centre of gravity"
    says format!("roadside metrics: {}", assumption(axis, pulse.as_deref()));

    /// Channels of roadside metrics have different time grids.
    CR359 RoadsideOnOtherGrids { reason: Option<String> }
    bears on (About::Motion, Weight::Slight)
    decided "Accelerations and yaw rate must have samples at the same times; none is interpolated."
    means "ASI, OIV and the ridedown acceleration, or THIV and PHD, are not in /metrics."
    remedy "bring the channels to one sampling rate: filter.resample"
    says match reason {
        Some(reason) => format!("{THIV}: {reason}"),
        None => "roadside metrics: x, y and z are on different time grids, none computed".to_owned(),
    };

    /// A channel has another class than the definition of its criterion asks for.
    CR360 OtherClass {
        criteria: String, place: String, channel: String, class: Option<u16>, asked_class: u16, channels: String
    }
    bears on (if criteria == ROADSIDE { About::Motion } else { About::Occupants }, Weight::Slight)
    decided "Head CFC 1000, chest 180 (SAE J211-1 Table 1; FMVSS 208); criteria of roadside hardware 180."
    means "A lower class lowers HIC and the 3 ms clip; a higher one, or none, raises them."
    remedy "filter the channels to the class that is asked for: --set filter.cfc; a lower class cannot be taken back"
    says {
        let way_out = match class {
            Some(class) if class < asked_class => {
                "what the lower class took away cannot be had back: the criterion reads low".to_owned()
            }
            _ => format!("--set filter.cfc={asked_class} --set filter.channels='{channels}'"),
        };
        format!("{place}: {} ({way_out})", other_class(channel, *class, *asked_class))
    };
}
