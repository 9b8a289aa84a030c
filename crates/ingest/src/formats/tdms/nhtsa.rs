//! TDMS files of the NHTSA database: the fields of the EV5 guide as properties `INST_SENTYP`, `VEH_VEHTWT`,
//! `TEST_CLSSPD`.
//!
//! Written after descriptions of such files; none was at hand. Hence tolerant: a field may stand at the channel, its
//! group or the file, with any prefix, as a text or as a number.

use crumple_signal::{About, Notes, QuantityKind, Weight};

use crate::formats::ev5::records::{Barrier, Curve, Test, Vehicle, says_nothing};
use crate::formats::ev5::sensor;
use crate::formats::ev5::test_details::details;
use crate::formats::tdms::metadata::{Properties, Property};
use crate::recording::details::Details;
use crate::recording::read_channel::ReadChannel;

/// A field by its name in the guide, in any of `layers`; what is empty or `NA` counts as absent.
fn words(layers: &[&Properties], field: &str) -> Option<String> {
    let matches = |name: &str| {
        let name = name.trim();
        name.len().checked_sub(field.len()).is_some_and(|at| {
            let tail = name.get(at..).is_some_and(|tail| tail.eq_ignore_ascii_case(field));
            tail && (at == 0 || name[..at].ends_with(['_', '.', ' ', '[']))
        })
    };
    layers.iter().flat_map(|layer| layer.iter()).find_map(|(name, value)| {
        let text = match value {
            Property::Text(text) => text.trim().to_owned(),
            Property::Number(x) if x.is_finite() => x.to_string(),
            _ => return None,
        };
        (matches(name) && !text.is_empty()).then_some(text)
    })
}

/// A field that is a number.
fn number(layers: &[&Properties], field: &str) -> Option<f64> {
    words(layers, field)?.replace(',', ".").parse().ok().filter(|x: &f64| x.is_finite())
}

/// A field that is a number; 0 stands for nothing recorded.
fn positive(layers: &[&Properties], field: &str) -> Option<f64> {
    number(layers, field).filter(|x| *x > 0.0)
}

fn vehicle_number(layers: &[&Properties]) -> Option<u32> {
    number(layers, "VEHNO").map(|n| n as u32)
}

/// The unit of a channel, YUNITS.
pub fn unit(channel: &Properties) -> Option<String> {
    words(&[channel], "YUNITS")
}

/// The instrumentation record of a channel, if it has one.
pub fn curve(channel: &Properties) -> Option<Curve> {
    let layers = [channel];
    let sensor = words(&layers, "SENTYP")?.to_ascii_uppercase();
    // Codes may be followed by their meaning: `XG - X GLOBAL`.
    let code = |field: &str| {
        let text = words(&layers, field).unwrap_or_default().to_ascii_uppercase();
        text.split([' ', '-']).next().unwrap_or_default().to_owned()
    };
    Some(Curve {
        vehicle: vehicle_number(&layers).unwrap_or(1),
        number: number(&layers, "CURNO").map_or(0, |n| n as u32),
        sensor: if sensor.starts_with("AC") { "AC".to_owned() } else { sensor },
        location: code("SENLOC"),
        attachment: code("SENATT"),
        axis: code("AXIS"),
        y_unit: unit(channel).unwrap_or_default(),
        initial_velocity_km_per_h: number(&layers, "INIVEL"),
        status: code("DASTAT"),
        channel_status: code("CHSTAT"),
        comment: words(&layers, "INSCOM"),
        ..Curve::default()
    })
}

/// Identity, status and fitness of a channel from its record.
pub fn describe(read: &mut ReadChannel, curve: &Curve, vehicle: u32, notes: &mut Notes) {
    let channel = &mut read.channel;
    channel.location = sensor::location(curve);
    channel.axis = sensor::axis(curve).or(channel.axis);
    channel.status = curve.channel_status();
    channel.redundant = curve.channel_status == "R";
    channel.initial_velocity_m_per_s = curve.initial_velocity_km_per_h.map(|v| v / 3.6);
    channel.comment = curve.comment.clone().or(channel.comment.take());
    read.fitness = sensor::fitness(curve, vehicle).filter(|_| channel.quantity == QuantityKind::Acceleration);
    if curve.number > 0 {
        read.aliases.push(curve.number.to_string());
    }
    if matches!(channel.status, crumple_signal::ChannelStatus::Questionable | crumple_signal::ChannelStatus::Failed) {
        let comment = channel.comment.as_deref().unwrap_or("without a comment");
        let text = format!("channel {} is {} by its laboratory: {comment}", channel.id, channel.status);
        notes.concern(About::Channel(channel.id.clone()), Weight::Slight, text);
    }
}

/// What the properties say of test and vehicle; `None` if they say nothing.
pub fn test(all: &[&Properties], vehicle: u32) -> Option<Details> {
    let of_vehicle: Vec<&Properties> =
        all.iter().copied().filter(|p| vehicle_number(&[p]).is_none_or(|n| n == vehicle)).collect();
    let of_vehicle = of_vehicle.as_slice();
    let test = Test {
        title: words(of_vehicle, "TITLE"),
        date: words(of_vehicle, "TSTDAT"),
        laboratory: words(of_vehicle, "TSTPRF"),
        reference: words(of_vehicle, "TSTREF"),
        configuration: words(of_vehicle, "TSTCFN")
            .map(|c| c.split([' ', '-']).next().unwrap_or_default().to_ascii_uppercase()),
        closing_speed_km_per_h: positive(of_vehicle, "CLSSPD"),
        impact_angle_deg: number(of_vehicle, "IMPANG"),
        offset_mm: number(of_vehicle, "OFFSET"),
        comment: words(of_vehicle, "TSTCOM"),
    };
    let vehicle = Vehicle {
        number: vehicle,
        make_and_model: [words(of_vehicle, "MAKE"), words(of_vehicle, "MODEL")],
        year: words(of_vehicle, "YEAR"),
        test_mass_kg: positive(of_vehicle, "VEHTWT"),
        speed_km_per_h: number(of_vehicle, "VEHSPD").filter(|v| *v >= 0.0),
        width_mm: positive(of_vehicle, "VEHWID"),
        crush_profile_mm: (1..=6).filter_map(|k| number(of_vehicle, &format!("DPD{k}"))).collect(),
        damage_classification: words(of_vehicle, "VDI"),
        crab_angle_deg: number(of_vehicle, "CRBANG").filter(|a| *a != 0.0),
        principal_direction_deg: number(of_vehicle, "PDOF").filter(|a| *a != 0.0),
        damage_offset_mm: number(of_vehicle, "DAMDST").filter(|x| *x != 0.0),
        damage_width_mm: positive(of_vehicle, "LENCNT"),
        static_crush_mm: positive(of_vehicle, "CRHDST"),
        comment: words(of_vehicle, "VEHCOM").filter(|c| c != "0" && !says_nothing(c)),
    };
    let barrier = Barrier {
        rigidity: words(of_vehicle, "BARRIG"),
        shape: words(of_vehicle, "BARSHP"),
        angle_deg: positive(of_vehicle, "BARANG"),
        diameter_mm: positive(of_vehicle, "BARDIA"),
        comment: words(of_vehicle, "BARCOM"),
    };
    Some(details(&test, Some(&barrier), &vehicle, std::slice::from_ref(&vehicle)))
}
