//! NHTSA vehicle tests: an EV5 specification file and ASCII signal files `.001`, `.002`, ... beside it.

mod channels;
mod code;
mod fields;
pub mod records;
pub mod sensor;
mod signal_file;
mod specification;
pub mod test_details;

use std::collections::BTreeMap;

use crumple_artifact::records::VehicleV1;
use crumple_signal::unit::signal_unit;
use crumple_signal::{About, ChannelStatus, Notes, QuantityKind, Weight};

use crate::formats::ev5::records::Vehicle;
use crate::formats::reader::{Bundle, Reader, stem};
use crate::recording::content::{PulseRule, Recording};
use crate::recording::details::Details;
use crate::recording::read_channel::ReadChannel;
use crate::{IngestError, IngestSettings, Place};
use specification::Specification;

/// Reader of EV5 sets.
pub struct Ev5;

impl Reader for Ev5 {
    fn format(&self) -> &'static str {
        "nhtsa-ev5"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        specification::recognises(head)
    }

    fn companion(&self, main: &str, name: &str) -> bool {
        stem(name).eq_ignore_ascii_case(stem(main)) && curve_number(name).is_some()
    }

    fn relevant_flags(&self) -> &'static [&'static str] {
        &["--vehicle-number"]
    }

    fn read(&self, bundle: &Bundle, settings: &IngestSettings) -> Result<Recording, IngestError> {
        read(&bundle.main.name, &bundle.main.bytes, &bundle.companions, settings)
    }
}

/// The curve a signal file holds: `v10146.093` is 93.
fn curve_number(name: &str) -> Option<u32> {
    let (_, extension) = name.rsplit_once('.')?;
    (2..=5).contains(&extension.len()).then_some(())?;
    extension.bytes().all(|b| b.is_ascii_digit()).then(|| extension.parse().ok())?
}

/// Reads a test from its EV5 text and its signal files by name.
pub fn read(
    file: &str,
    bytes: &[u8],
    companions: &BTreeMap<String, Vec<u8>>,
    settings: &IngestSettings,
) -> Result<Recording, IngestError> {
    let specification = specification::parse(file, bytes)?;
    let number = settings.vehicle_number.unwrap_or(1);
    let vehicle = specification.vehicles.iter().find(|v| v.number == number).ok_or_else(|| {
        let known: Vec<String> = specification.vehicles.iter().map(|v| v.number.to_string()).collect();
        IngestError::content(
            Place::file(file),
            format!("no vehicle {number} in the section VEHICLE"),
            format!("one of {}", known.join(", ")),
            "give its number by --vehicle-number",
        )
    })?;
    let files: BTreeMap<u32, (&str, &[u8])> = companions
        .iter()
        .filter_map(|(name, bytes)| Some((curve_number(name)?, (name.as_str(), bytes.as_slice()))))
        .collect();
    if !specification.curves.iter().any(|curve| files.contains_key(&curve.number)) {
        return Err(no_files(file, &specification));
    }
    let mut notes = Notes::new();
    for (line, reason) in specification.unread_lines.iter().take(5) {
        notes.warning(format!("{file}, line {line}, is left out: {reason}"));
    }
    if !specification.is_complete {
        notes.warning(format!(
            "{file} does not end with ----- END -----: it may be cut short, and channels be missing; download it again"
        ));
    }
    let asked_for = |number: u32| settings.channel.as_deref().is_some_and(|c| c.trim().parse() == Ok(number));
    let channels = specification
        .curves
        .iter()
        .map(|curve| channels::channel(curve, &files, number, asked_for(curve.number), &mut notes))
        .collect::<Result<Vec<ReadChannel>, _>>()?;
    channel_notes(&channels, &mut notes);
    unit_note(&specification, &mut notes);
    Ok(Recording {
        details: Details {
            vehicles: vehicles(&specification, &channels),
            ..test_details::details(
                &specification.test,
                specification.barrier.as_ref(),
                vehicle,
                &specification.vehicles,
            )
        },
        channels,
        pulse_rule: PulseRule::Fittest,
        contact_at_zero: true,
        notes,
    })
}

/// The vehicles of a test with several, each with its channels and the best of them as its pulse.
fn vehicles(specification: &Specification, channels: &[ReadChannel]) -> Vec<VehicleV1> {
    let Specification { test, vehicles, curves, .. } = specification;
    if vehicles.len() < 2 {
        return Vec::new();
    }
    let of = |vehicle: &Vehicle| {
        let own = || curves.iter().zip(channels).filter(|(curve, _)| curve.vehicle == vehicle.number);
        let candidates = own().filter(|(_, read)| read.wave.is_some() && read.channel.status.has_data());
        let is_sound = |read: &ReadChannel| {
            matches!(read.channel.status, ChannelStatus::Valid | ChannelStatus::Computed)
                && read.channel.quantity == QuantityKind::Acceleration
        };
        let pulse = candidates
            .filter(|(_, read)| is_sound(read))
            .filter_map(|(curve, read)| Some((sensor::fitness(curve, vehicle.number)?, &read.channel.id)))
            .min_by_key(|(fitness, _)| *fitness);
        VehicleV1 {
            number: vehicle.number,
            description: test_details::vehicle_words(test, vehicle),
            mass_kg: vehicle.test_mass_kg,
            impact_speed_m_per_s: test_details::speed_km_per_h(test, vehicle, vehicles).map(|(v, _)| v / 3.6),
            pulse: pulse.map(|(_, id)| id.clone()),
            channels: own().map(|(_, read)| read.channel.id.clone()).collect(),
        }
    };
    vehicles.iter().map(of).collect()
}

fn no_files(file: &str, specification: &Specification) -> IngestError {
    let example = specification.curves.iter().find(|c| c.channel_status() != ChannelStatus::NotInstalled);
    let number = example.map_or(1, |c| c.number);
    IngestError::content(
        Place::file(file),
        format!("none of the {} listed channels has its signal file here", specification.curves.len()),
        format!("files such as {}.{number:03} beside it", stem(file)),
        "unpack the whole \"EV5 ASCII X-Y\" archive of the test, or give the .zip itself",
    )
}

/// One note for all files that are missing, one for each channel with data that the laboratory doubts.
fn channel_notes(channels: &[ReadChannel], notes: &mut Notes) {
    let with = |status| -> Vec<u32> {
        channels.iter().filter(|f| f.channel.status == status).filter_map(|f| f.channel.id.parse().ok()).collect()
    };
    let (absent, not_installed) = (with(ChannelStatus::Absent), with(ChannelStatus::NotInstalled));
    let unread = |id: &u32| channels.iter().any(|f| f.channel.id == id.to_string() && f.unread.is_some());
    let absent: Vec<u32> = absent.into_iter().filter(|id| !unread(id)).collect();
    if !absent.is_empty() {
        notes.info(format!(
            "{} of {} listed channels have no file here: {}",
            absent.len(),
            channels.len(),
            ranges(&absent)
        ));
    }
    if !not_installed.is_empty() {
        notes.info(format!("{} listed channels were not installed: {}", not_installed.len(), ranges(&not_installed)));
    }
    for read in channels.iter().filter(|f| f.wave.is_some()) {
        let channel = &read.channel;
        if matches!(channel.status, ChannelStatus::Questionable | ChannelStatus::Failed) {
            let comment = channel.comment.as_deref().unwrap_or("without a comment");
            let text = format!("channel {} is {} by its laboratory: {comment}", channel.id, channel.status);
            notes.concern(About::Channel(channel.id.clone()), Weight::Slight, text);
        }
    }
}

fn unit_note(specification: &Specification, notes: &mut Notes) {
    let mut unknown: BTreeMap<&str, Vec<u32>> = BTreeMap::new();
    for curve in specification.curves.iter().filter(|c| signal_unit(&c.y_unit).is_none()) {
        unknown.entry(&curve.y_unit).or_default().push(curve.number);
    }
    for (unit, numbers) in unknown {
        notes.info(format!(
            "unit {unit:?} is not known: channels {} are kept as read, quantity other",
            ranges(&numbers)
        ));
    }
}

/// `2-12, 14, 15`: ascending numbers, runs of three and more joined; at most 20 items.
fn ranges(numbers: &[u32]) -> String {
    let mut numbers = numbers.to_vec();
    numbers.sort_unstable();
    numbers.dedup();
    let mut items: Vec<String> = Vec::new();
    let mut rest = numbers.as_slice();
    while let Some(first) = rest.first() {
        let run = rest.iter().zip(0..).take_while(|(n, k)| **n == first.saturating_add(*k)).count();
        if run >= 3 {
            items.push(format!("{first}-{}", rest[run - 1]));
            rest = &rest[run..];
        } else {
            items.push(first.to_string());
            rest = &rest[1..];
        }
    }
    if items.len() > 20 {
        items.truncate(20);
        items.push("...".to_owned());
    }
    items.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_numbers_are_short() {
        assert_eq!(ranges(&[2, 3, 4, 5, 7, 8, 10]), "2-5, 7, 8, 10");
        assert_eq!(ranges(&[u32::MAX]), "4294967295");
    }

    #[test]
    fn companions_are_signal_files_of_the_same_test() {
        for (name, belongs) in [
            ("v10146.093", true),
            ("V10146.001", true),
            ("v10146.EV5", false),
            ("v10147.001", false),
            ("v10146.1", false),
            ("v10146", false),
        ] {
            assert_eq!(Ev5.companion("v10146.EV5", name), belongs, "{name}");
        }
    }
}
