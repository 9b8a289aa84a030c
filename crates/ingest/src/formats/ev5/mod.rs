//! NHTSA vehicle tests: an EV5 specification file and ASCII signal files `.001`, `.002`, ... beside it.

use std::collections::BTreeMap;

use crumple_artifact::records::VehicleV1;
use crumple_signal::unit::signal_unit;
use crumple_signal::{About, Channel, ChannelStatus, Notes, QuantityKind, Sampled, Weight, remarks};

use crate::formats::ev5::specification::{Curve, Specification, Vehicle};
use crate::formats::reader::{Bundle, Reader, stem};
use crate::formats::remarks::{ChannelLeftOut, ChannelsAbsent, CutShort, LineNotRead, UnitUnknown};
use crate::formats::text::lines::scan;
use crate::recording::content::{PulseRule, ReadChannel, Recording, note_doubts};
use crate::recording::details::Details;
use crate::time::{Grid, GridError};
use crate::{IngestError, IngestSettings, Place, Result, refuse, time};

pub mod sensor;
pub mod specification;

pub const EV5: Reader = Reader {
    companion: |main, name| stem(name).eq_ignore_ascii_case(stem(main)) && curve_number(name).is_some(),
    ..Reader::of_one_file("nhtsa-ev5", specification::recognises, &["--vehicle-number"], read)
};

/// The curve a signal file holds: `v10146.093` is 93.
fn curve_number(name: &str) -> Option<u32> {
    let (_, extension) = name.rsplit_once('.')?;
    (2..=5).contains(&extension.len()).then_some(())?;
    extension.bytes().all(|b| b.is_ascii_digit()).then(|| extension.parse().ok())?
}

/// Reads a test from its EV5 text and its signal files by name.
fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let (file, bytes, companions) = (bundle.main.name.as_str(), &bundle.main.bytes, &bundle.companions);
    let specification = specification::parse(file, bytes)?;
    let number = settings.vehicle_of(|channel| {
        let curve = specification.curves.iter().find(|curve| channel.parse() == Ok(curve.number))?;
        Some(curve.vehicle).filter(|vehicle| *vehicle > 0)
    });
    let vehicle = specification.vehicles.iter().find(|v| v.number == number).ok_or_else(|| {
        let known: Vec<String> = specification.vehicles.iter().map(|v| v.number.to_string()).collect();
        IngestError::content(
            file,
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
        let (file, lines, reason) = (file.to_owned(), specification.unread_lines.len(), Some(reason.clone()));
        notes.push(LineNotRead { file, line: *line, lines, reason });
    }
    if !specification.is_complete {
        notes.push(CutShort { file: Some(file.to_owned()), ..CutShort::SOMEWHERE });
    }
    let asked_for = |number: u32| settings.channel.as_deref().is_some_and(|c| c.trim().parse() == Ok(number));
    let channels = specification
        .curves
        .iter()
        .map(|curve| channel(curve, &files, number, asked_for(curve.number), &mut notes))
        .collect::<Result<Vec<ReadChannel>, _>>()?;
    channel_notes(&channels, &mut notes);
    unit_note(&specification, &mut notes);
    Ok(Recording {
        details: Details {
            vehicles: vehicles(&specification, &channels),
            ..specification::details(
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
            description: specification::vehicle_words(test, vehicle),
            mass_kg: vehicle.test_mass_kg,
            impact_speed_m_per_s: specification::speed_km_per_h(test, vehicle, vehicles).map(|(v, _)| v / 3.6),
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
        file,
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
        let (listed, channels) = (Some(channels.len()), Some(ranges(&absent)));
        notes.push(ChannelsAbsent { count: absent.len(), listed, list: None, channels });
    }
    if !not_installed.is_empty() {
        let (count, channels) = (not_installed.len(), Some(ranges(&not_installed)));
        notes.push(ChannelsAbsent { count, listed: None, list: None, channels });
    }
    channels.iter().filter(|f| f.wave.is_some()).for_each(|read| note_doubts(&read.channel, notes));
}

fn unit_note(specification: &Specification, notes: &mut Notes) {
    let mut unknown: BTreeMap<&str, Vec<u32>> = BTreeMap::new();
    for curve in specification.curves.iter().filter(|c| signal_unit(&c.y_unit).is_none()) {
        unknown.entry(&curve.y_unit).or_default().push(curve.number);
    }
    for (unit, numbers) in unknown {
        notes.push(UnitUnknown { unit: Some(unit.to_owned()), channels: ranges(&numbers) });
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

/// A curve as a channel, with its samples if `files` has them.
///
/// A file that cannot be read makes the channel absent with a warning; it is an error only for the channel asked for.
pub fn channel(
    curve: &Curve,
    files: &BTreeMap<u32, (&str, &[u8])>,
    vehicle: u32,
    wanted: bool,
    notes: &mut Notes,
) -> Result<ReadChannel> {
    let (quantity, factor) = signal_unit(&curve.y_unit).unwrap_or((QuantityKind::Other, 1.0));
    let id = curve.number.to_string();
    let mut channel = Channel::new(id.clone(), quantity);
    channel.location = sensor::location(curve);
    channel.axis = sensor::axis(curve);
    channel.status = curve.channel_status();
    channel.redundant = curve.channel_status == "R";
    // Division, not a product with 1/3.6: 57.09 km/h is then the nearest number to 15.858333... m/s.
    channel.initial_velocity_m_per_s = curve.initial_velocity_km_per_h.map(|v| v / 3.6);
    channel.comment = curve.comment.clone();
    channel.code = sensor::code(curve).map(|code| code.to_string());
    channel.filter_state = curve.prefilter_hz.map(|hz| format!("low-pass {hz} Hz"));
    channel.sensor = sensor::words(curve);

    // Two digits and three name the file; people copy either.
    let mut aliases = vec![format!("{:03}", curve.number), format!("{:02}", curve.number)];
    aliases.extend(channel.code.clone());
    aliases.extend([curve.attachment.clone(), format!("{} {}", curve.attachment, curve.axis)]);
    let fitness = sensor::fitness(curve, vehicle).filter(|_| quantity == QuantityKind::Acceleration);
    let read = match files.get(&curve.number) {
        None => {
            if channel.status != ChannelStatus::NotInstalled {
                channel.status = ChannelStatus::Absent;
            }
            ReadChannel::new(channel)
        }
        Some((file, bytes)) => match samples(curve, file, bytes, factor, notes) {
            Ok((samples, jitter)) => {
                if channel.status == ChannelStatus::NotInstalled {
                    notes.push(NotInstalled { channel: id, file: (*file).to_owned() });
                    channel.status = ChannelStatus::Questionable;
                }
                ReadChannel { wave: Some(samples), jitter, ..ReadChannel::new(channel) }
            }
            Err(error) if wanted => return Err(error),
            Err(error) => {
                let (channel_id, reason) = (Some(id), Some(error.to_string()));
                notes.push(ChannelLeftOut { channel: channel_id, file: None, more: None, reason });
                let remark = channel.comment.take().map_or_else(String::new, |comment| format!("; {comment}"));
                ReadChannel::without_readable_file(channel, format!("{error}{remark}"))
            }
        },
    };
    let attachment = Some(curve.attachment.clone()).filter(|code| !code.is_empty());
    Ok(ReadChannel { fitness, aliases, attachment, ..read })
}

fn samples(curve: &Curve, file: &str, bytes: &[u8], factor: f64, notes: &mut Notes) -> Result<(Sampled, f64)> {
    let refuse = |place: Place, found: String| {
        IngestError::content(
            place,
            found,
            "samples at a uniform rate",
            "the file may be damaged: download the test again",
        )
    };
    let unit_s = match curve.x_unit.as_str() {
        "" | "SEC" | "S" | "SECS" => 1.0,
        "MS" | "MSEC" => 1e3,
        other => return Err(refuse(Place::file(file), format!("its X axis is in {other}, not in time"))),
    };
    let signal = parse(file, bytes)?;
    let n = signal.y.len();
    if let (Some(first), Some(last)) = (curve.first, curve.last)
        && last.checked_sub(first).and_then(|d| d.checked_add(1)) != i64::try_from(n).ok()
    {
        notes.push(ListedSamples { file: file.to_owned(), samples: n, first, last });
    }
    let listed = curve.interval_us.zip(curve.first).map(|(us, first)| Grid {
        t0_s: first as f64 * us / 1e6,
        dt_s: us / 1e6,
        jitter: 0.0,
    });
    let grid = if signal.x.is_empty() {
        listed.ok_or_else(|| {
            refuse(Place::file(file), "no time column, and its entry lists no DELT and NFP".to_owned())
        })?
    } else {
        let times: Vec<f64> = signal.x.iter().map(|x| x / unit_s).collect();
        let largest = signal.x[0].abs().max(signal.x[n - 1].abs());
        let resolution = 10_f64.powf(largest.log10().floor() - f64::from(signal.x_digits.max(1)) + 1.0) / unit_s;
        let printed = time::fit(&times, resolution).map_err(|error| match error {
            GridError::Repeated { index } => refuse(Place::line(file, index + 1), "a repeated time".to_owned()),
            GridError::Backwards { index } => refuse(Place::line(file, index + 1), "time runs backwards".to_owned()),
            GridError::Uneven { index, step_s, dt_s } => refuse(
                Place::line(file, index + 1),
                format!("a step of {step_s:.9} s, where the others are {dt_s:.9} s"),
            ),
        })?;
        reconcile(curve.number, listed, printed, &times, resolution, notes)
    };
    let samples = signal.y.into_iter().map(|y| y * factor).collect();
    let sampled =
        Sampled::new(grid.t0_s, grid.dt_s, samples).map_err(|error| refuse(Place::file(file), error.to_string()))?;
    Ok((sampled, grid.jitter))
}

/// The listed grid where the printed times agree with it, else the printed one: DELT is rounded to whole microseconds
/// by the guide, so 16 kHz cannot be listed.
fn reconcile(
    number: u32,
    listed: Option<Grid>,
    printed: Grid,
    times: &[f64],
    resolution: f64,
    notes: &mut Notes,
) -> Grid {
    let Some(listed) = listed else { return printed };
    let end = |grid: &Grid| grid.t0_s + (times.len() - 1) as f64 * grid.dt_s;
    let slack = resolution + time::STEP_TOLERANCE * printed.dt_s;
    if (listed.t0_s - times[0]).abs() <= slack && (end(&listed) - times[times.len() - 1]).abs() <= slack {
        return Grid { jitter: printed.jitter, ..listed };
    }
    let [(listed_interval_s, listed_start_s), (interval_s, start_s)] =
        [&listed, &printed].map(|grid| (grid.dt_s, grid.t0_s));
    notes.push(ListedInterval { channel: number, listed_interval_s, listed_start_s, interval_s, start_s });
    printed
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct SignalFile {
    /// X column, empty where the file has none.
    pub x: Vec<f64>,
    /// Most significant digits printed in it.
    pub x_digits: u32,
    pub y: Vec<f64>,
}

/// Reads the file. The first line decides whether there is an X column.
pub fn parse(file: &str, bytes: &[u8]) -> Result<SignalFile> {
    let mut signal = SignalFile { y: Vec::with_capacity(bytes.len() / 16), ..SignalFile::default() };
    for (index, line) in bytes.split(|b| *b == b'\n').enumerate() {
        let line = line.trim_ascii();
        if line.is_empty() || line == [0x1A] {
            continue;
        }
        let refuse = |found: String| {
            IngestError::content(
                Place::line(file, index + 1),
                found,
                "one sample a line: its value, or its time and its value",
                "the file may be damaged: download the test again",
            )
        };
        let not_a_number = |rest: &[u8]| {
            let word: String = String::from_utf8_lossy(&rest[..rest.len().min(30)]).into_owned();
            refuse(format!("{word:?} is not a finite number"))
        };
        let (first, length) = scan(line, b'.').ok_or_else(|| not_a_number(line))?;
        let rest = &line[length..];
        let second = rest.trim_ascii_start();
        let second = second.strip_prefix(b",").unwrap_or(second).trim_ascii_start();
        let has_x = !second.is_empty();
        if has_x && second.len() == rest.len() {
            return Err(not_a_number(line));
        }
        if !signal.y.is_empty() && has_x == signal.x.is_empty() {
            return Err(refuse(format!(
                "{} numbers, the lines above have {}",
                1 + usize::from(has_x),
                2 - usize::from(has_x)
            )));
        }
        if has_x {
            let (value, length) = scan(second, b'.').ok_or_else(|| not_a_number(second))?;
            if length != second.len() {
                return Err(not_a_number(second));
            }
            signal.x.push(first.value);
            signal.x_digits = signal.x_digits.max(first.digits);
            signal.y.push(value.value);
        } else {
            signal.y.push(first.value);
        }
    }
    if signal.y.len() < 2 {
        return refuse(
            file,
            format!("{} samples", signal.y.len()),
            "one sample a line",
            "the file may be cut short: download the test again",
        );
    }
    Ok(signal)
}

remarks! {
    /// Remarks of NHTSA tests.
    pub REMARKS;

    /// A channel that is listed as not installed has a file of samples.
    CR018 NotInstalled { channel: String, file: String }
    bears on (About::Record, Weight::Slight)
    decided "DASTAT of its entry is NO, and its signal file is there and can be read."
    means "Its status is questionable, so that it is not chosen as the pulse."
    remedy "look at its plot before it is used"
    says format!("channel {channel} is listed as not installed, but {file} is here: taken as questionable");

    /// A signal file has another number of samples than its entry lists.
    CR019 ListedSamples { file: String, samples: usize, first: i64, last: i64 }
    bears on (About::Record, Weight::Slight)
    decided "The first and the last sample of the entry are compared with the samples of the file."
    means "The file may be cut short. If it has no column of times, its start may be wrong."
    remedy "download the test again, or compare its end with that of other channels"
    says format!("{file} has {samples} samples, its entry lists {first} to {last}: the samples of the file are used");

    /// A signal file has other times than its entry lists.
    CR020 ListedInterval {
        channel: u32, listed_interval_s: f64, listed_start_s: f64, interval_s: f64, start_s: f64
    }
    bears on (About::Record, Weight::Slight)
    decided "Start and end of both are compared; 1e-3 of the interval and the last printed digit are left. DELT of the \
             entry is rounded to whole microseconds."
    means "The times of the file are used. If the entry is right, velocity and crush are wrong by the ratio of both."
    remedy "compare the duration with that of other channels of the test"
    says format!(
        "channel {channel}: its entry lists samples every {listed_interval_s} s from {listed_start_s} s, the times in \
         its file say every {interval_s} s from {start_s} s: those are used"
    );
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
            assert_eq!((EV5.companion)("v10146.EV5", name), belongs, "{name}");
        }
    }

    #[test]
    fn both_kinds_and_fortran_numbers() {
        let xy = parse("v.001", b"-0.050000\t0.114681\r\n-0.049900\t-.306171E+00\r\n").unwrap();
        assert_eq!((xy.x, xy.y, xy.x_digits), (vec![-0.05, -0.0499], vec![0.114_681, -0.306_171], 5));
        let y = parse("v.001", b"  -.206786E-02\n0.285321E-01\n").unwrap();
        assert_eq!((y.x, y.y), (vec![], vec![-0.002_067_86, 0.028_532_1]));
    }

    #[test]
    fn errors_name_the_line() {
        let error = |bytes: &[u8]| parse("v.001", bytes).unwrap_err().to_string();
        assert_eq!(error(b"0 1\n1 x\n"), "v.001, line 2: \"x\" is not a finite number");
        assert_eq!(error(b"0 1\n1\n"), "v.001, line 2: 1 numbers, the lines above have 2");
        assert_eq!(error(b"0 1 2\n"), "v.001, line 1: \"1 2\" is not a finite number");
        assert_eq!(error(b""), "v.001: 0 samples");
    }
}
