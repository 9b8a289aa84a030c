//! ISO/TS 13499 (ISO-MME): a test file `.mme`, a channel list `.chn`, channel files `.001`; or one channel file alone.

use std::collections::BTreeMap;

use crumple_signal::iso13499::IsoCode;
use crumple_signal::unit::{Dimension, parse_value};
use crumple_signal::{About, Channel, ChannelStatus, Notes, QuantityKind, Weight, remarks};

use crate::formats::iso_mme::channel_file::{ChannelFile, Header, number};
use crate::formats::reader::{Bundle, Reader, stem};
use crate::formats::remarks::{ChannelLeftOut, ChannelsAbsent, LinesNotUsed};
use crate::recording::content::{Fitness, Ids, PulseRule, ReadChannel, Recording, note_doubts};
use crate::recording::details::{Details, Stated};
use crate::recording::settings;
use crate::{IngestError, IngestSettings, Result, pulse};

pub mod channel;
pub mod channel_file;

/// ISO-MME tests and single channel files.
pub const ISO_MME: Reader = Reader {
    companion: |main, name| {
        stem(name).eq_ignore_ascii_case(stem(main)) && (is_channel_name(name) || is_text_part(name))
    },
    spans_folders: true,
    ..Reader::of_one_file("iso-mme", channel_file::recognises, &["--unit", "--vehicle-number"], read)
};

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let mut notes = Notes::new();
    let main = &bundle.main;
    let main_is_channel = !is_text_part(&main.name);
    // A channel file given by itself is the record; inside a folder or an archive it stands for all.
    let single = main_is_channel && bundle.name == main.name;

    let files: BTreeMap<&str, &[u8]> = std::iter::once((main.name.as_str(), main.bytes.as_slice()))
        .chain(bundle.companions.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())))
        .collect();
    let part = |extension: &str| {
        files
            .iter()
            .find(|(name, _)| name.to_ascii_lowercase().ends_with(extension))
            .map(|(name, bytes)| (*name, *bytes))
    };
    let mut details = Details::default();
    if let Some((name, bytes)) = part(".mme") {
        let header = Header::parse(name, bytes)?;
        if header.entries().next().is_none() {
            notes.push(EmptyTestFile { file: name.to_owned() });
        } else if !channel_file::recognises(bytes) {
            notes.push(NoEdition { file: name.to_owned() });
        }
        details = details_of(name, &header, settings, &mut notes);
    }

    let mut channels = Vec::new();
    let mut parsed: Vec<(&str, ChannelFile)> = Vec::new();
    let mut unread: Vec<ReadChannel> = Vec::new();
    for (name, bytes) in
        files.iter().filter(|(name, _)| is_channel_name(name) || main_is_channel && **name == main.name)
    {
        match ChannelFile::parse(name, bytes) {
            Ok(file) => parsed.push((name, file)),
            Err(error) if single && *name == main.name => return Err(error),
            Err(error) if single => {
                notes.push(OtherFileNotRead { file: (*name).to_owned(), reason: error.to_string() });
            }
            Err(error) => unread.push(unread_channel(name, &error, &mut notes)),
        }
    }
    // By number: names may differ in case.
    parsed.sort_by_key(|(name, _)| name.rsplit_once('.').and_then(|(_, e)| e.parse::<u32>().ok()));
    if parsed.is_empty() {
        return Err(no_channels(bundle, &main.name, unread.len()));
    }
    if settings.unit.is_some() && parsed.iter().all(|(_, file)| channel::states_a_known_unit(&file.header)) {
        settings::warn("--unit", "every channel file states a unit that is known", &mut notes);
    }
    let mut ids = Ids::default();
    for (name, file) in &parsed {
        if single && *name != main.name {
            continue;
        }
        match channel::channel_of_file(name, file, &parsed, settings, &mut ids, &mut notes) {
            Ok(read) => channels.push(read),
            Err(error) if single => return Err(error),
            Err(error) => channels.push(unread_channel(name, &error, &mut notes)),
        }
    }
    if single {
        for read in &mut channels {
            read.fitness = Fitness::of_only(read.channel.quantity, "the only channel of the file");
        }
    } else {
        let vehicle = settings.vehicle_of_code();
        for read in channels.iter_mut().filter(|f| f.channel.quantity == QuantityKind::Acceleration) {
            let code = read.channel.code.as_deref().and_then(|c| IsoCode::parse(c).ok());
            read.fitness = code.and_then(|(code, _)| pulse::fitness(&code, vehicle));
        }
        channels.extend(unread);
        if let Some((name, bytes)) = part(".chn") {
            add_listed_channels(name, &Header::parse(name, bytes)?, &mut channels, &mut ids, &mut notes);
        }
        channels.iter().filter(|f| f.wave.is_some()).for_each(|read| note_doubts(&read.channel, &mut notes));
    }
    let pulse_rule = if single { PulseRule::OnlyOne } else { PulseRule::Fittest };
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: true, notes })
}

/// A channel whose file cannot be read: listed without data, the reason in its comment.
fn unread_channel(name: &str, error: &IngestError, notes: &mut Notes) -> ReadChannel {
    let (file, reason) = (Some(name.to_owned()), Some(error.to_string()));
    notes.push(ChannelLeftOut { channel: None, file, more: None, reason });
    let id = name.rsplit_once('.').map_or(name, |(_, number)| number);
    let channel = Channel::new(format!("file-{id}"), QuantityKind::Other);
    ReadChannel { aliases: vec![id.to_owned()], ..ReadChannel::without_readable_file(channel, error.to_string()) }
}

/// Channels of the list that have no file. The list's numbers are not reliable, its codes are compared.
fn add_listed_channels(name: &str, list: &Header, channels: &mut Vec<ReadChannel>, ids: &mut Ids, notes: &mut Notes) {
    let mut absent = 0;
    let mut listed = 0_usize;
    for (keyword, value) in list.entries().filter(|(keyword, _)| keyword.starts_with("name of channel")) {
        listed += 1;
        let code = value.split(['/', ' ', '\t']).next().unwrap_or_default();
        let Ok((code, _)) = IsoCode::parse(code) else {
            let (keyword, value) = (keyword.to_owned(), value.to_owned());
            notes.push(NoCodeInList { list: name.to_owned(), keyword, value });
            continue;
        };
        if channels.iter().any(|f| f.channel.code.as_deref() == Some(code.as_str())) {
            continue;
        }
        let mut channel = channel::channel_of_code(&code, channel::unique_id(code.as_str(), ids));
        channel.status = ChannelStatus::Absent;
        channels.push(ReadChannel::new(channel));
        absent += 1;
    }
    if listed == 0 {
        notes.push(ListedCount { list: name.to_owned(), stated: None, listed });
    }
    if absent > 0 {
        let (listed, list) = (Some(listed), Some(name.to_owned()));
        notes.push(ChannelsAbsent { count: absent, listed, list, channels: None });
    }
    if let Some(stated) = list.number("number of channels").filter(|n| *n != listed as f64) {
        notes.push(ListedCount { list: name.to_owned(), stated: Some(stated), listed });
    }
}

fn no_channels(bundle: &Bundle, main: &str, unread: usize) -> IngestError {
    let found = match unread {
        0 => format!("none of the channel files of {main} is here"),
        n => format!("none of the {n} channel files can be read"),
    };
    IngestError::content(
        &bundle.name,
        found,
        format!("files such as {}.001 beside it or in the folder Channel", stem(main)),
        "give the folder of the whole test, or its zip archive",
    )
}

/// A bare speed above this, m/s (162 km/h), is not taken: it may be in km/h.
const FASTEST_BARE_M_PER_S: f64 = 45.0;
/// Facts carried along at most.
const FACT_LIMIT: usize = 100;

/// Title, vehicle, mass and speed of the test object asked for, everything else as facts. Mass and speed are found by
/// words in the keyword, since keywords differ between laboratories; what was taken is noted.
fn details_of(file: &str, header: &Header, settings: &IngestSettings, notes: &mut Notes) -> Details {
    let object = settings.vehicle_of_code();
    let words = |keyword: &str| {
        header.text(keyword).map(|v| Stated { value: v.to_owned(), from: format!("{file}, {keyword}") })
    };
    let mass_kg = quantity(file, header, object, &["mass", "weight"], Dimension::Mass, notes);
    let speed =
        quantity(file, header, object, &["velocity", "speed"], Dimension::Signal(QuantityKind::Velocity), notes);
    let mut speed_not_taken = None;
    let impact_speed_m_per_s = speed.filter(|stated| {
        let taken = stated.value.abs() <= FASTEST_BARE_M_PER_S;
        if !taken {
            speed_not_taken =
                Some(format!("{} is {} without a unit, in m/s faster than a crash test", stated.from, stated.value));
            notes.push(TooFast { from: stated.from.clone(), speed_m_per_s: stated.value });
        }
        taken
    });
    let impact_speed_m_per_s = impact_speed_m_per_s.map(|s| Stated { value: s.value.abs(), ..s });
    let mut facts = header.others(&["title"]);
    if facts.len() > FACT_LIMIT {
        let count = facts.len() - FACT_LIMIT;
        notes.push(LinesNotUsed { count, file: Some(file.to_owned()), line: None });
        facts.truncate(FACT_LIMIT);
    }
    Details {
        title: words("title"),
        vehicle: words(&format!("name of test object {object}")).or_else(|| words("name of test object")),
        barrier: words("barrier").or_else(|| words("type of barrier")),
        mass_kg,
        impact_speed_m_per_s,
        speed_not_taken,
        facts,
        ..Details::default()
    }
}

/// The first value, not zero, of a keyword with one of the words that belongs to the test object; a keyword without
/// a number belongs to object 1. A bare number is in SI, as ISO/TS 13499 has it.
fn quantity(
    file: &str,
    header: &Header,
    object: u32,
    words: &[&str],
    dimension: Dimension,
    notes: &mut Notes,
) -> Option<Stated<f64>> {
    let mut fits: Vec<(bool, &str, &str)> = header
        .entries()
        .filter(|(keyword, _)| {
            keyword.split(|c: char| !c.is_alphanumeric()).any(|word| words.contains(&word))
                && !keyword.contains("angular")
        })
        .filter_map(|(keyword, value)| {
            let numbered: Option<u32> =
                keyword.split(|c: char| !c.is_ascii_digit()).find_map(|digits| digits.parse().ok());
            (numbered.unwrap_or(1) == object).then_some((numbered.is_none(), keyword, value))
        })
        .collect();
    fits.sort_by_key(|(unnumbered, ..)| *unnumbered);
    for (_, keyword, value) in fits {
        let (file, keyword, value) = (file.to_owned(), keyword.to_owned(), value.to_owned());
        let (si, unit) = match number(&value) {
            Some(bare) => (bare, Some(dimension.si_unit().to_owned())),
            None => match parse_value(&value, dimension) {
                Ok(si) => (si, None),
                Err(error) => {
                    notes.push(ValueNotTaken { file, keyword, reason: error.to_string() });
                    continue;
                }
            },
        };
        if si == 0.0 {
            continue;
        }
        let from = format!("{file}, {keyword}");
        notes.push(ValueTaken { what: dimension.name().to_owned(), file, keyword, value, unit });
        return Some(Stated { value: si, from });
    }
    None
}

/// `test.001`, `test.1234`: three or four digits.
pub fn is_channel_name(name: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, e)| matches!(e.len(), 3 | 4) && e.bytes().all(|b| b.is_ascii_digit()))
}

/// The test file and the channel list.
fn is_text_part(name: &str) -> bool {
    name.rsplit_once('.').is_some_and(|(_, e)| e.eq_ignore_ascii_case("mme") || e.eq_ignore_ascii_case("chn"))
}

/// The folder of channel files in an ISO-MME test, in any case.
pub fn is_channel_folder(name: &str) -> bool {
    name.eq_ignore_ascii_case("channel") || name.eq_ignore_ascii_case("channels")
}

remarks! {
    /// Remarks of ISO-MME tests.
    pub REMARKS;

    /// The test file states nothing.
    CR029 EmptyTestFile { file: String }
    bears on (About::Record, Weight::Slight)
    decided "No keyword of the .mme file has a value."
    means "Mass, impact speed and vehicle are not known from it."
    remedy "state --mass and --impact-speed, or give the test file that belongs to the channels"
    says format!("{file} states nothing of the test: vehicle, mass and speed are not known from it");

    /// The test file does not say its edition.
    CR030 NoEdition { file: String }
    bears on (About::Record, Weight::Slight)
    decided "A test file of ISO-MME has the line \"Data format edition number\"; this one is known by its name and its \
             keyword lines."
    means "Keywords may mean something else than in ISO/TS 13499. Mass and speed that are taken are remarked (CR036)."
    remedy "check what is taken from it, or add the line"
    says format!(
        "{file} lacks the line \"Data format edition number\": read as ISO-MME by its name and its keyword lines"
    );

    /// Another channel file beside the one that was given is not read.
    CR031 OtherFileNotRead { file: String, reason: String }
    bears on (About::Record, Weight::None)
    decided "One channel file was given. Those beside it are read only for a channel of times; the sentence says what \
             is wrong with this one."
    means "Nothing for the channel that was given."
    remedy "nothing"
    says format!("{file} is not read: {reason}");

    /// An entry of the list of channels is no channel code.
    CR032 NoCodeInList { list: String, keyword: String, value: String }
    bears on (About::Record, Weight::None)
    decided "The .chn file lists channels by their codes; files and list are compared by code."
    means "If no file has this channel, it is missing from the list of channels."
    remedy "nothing"
    says format!("{list}: {keyword} is {value:?}, no channel code");

    /// The list of channels has another number of channels than it states, or none.
    CR033 ListedCount { list: String, stated: Option<f64>, listed: usize }
    bears on (About::Record, Weight::None)
    decided "The entries of the .chn file are counted and compared with its line \"Number of channels\"."
    means "Channels with a file are read. Which others the test had is not known for certain."
    remedy "nothing; compare with the report of the test if a channel is missed"
    says match stated {
        Some(stated) => format!("{list} states {stated} channels and lists {listed}"),
        None => format!("{list} lists no channels"),
    };

    /// The speed that the test file states is faster than a crash test.
    CR034 TooFast { from: String, speed_m_per_s: f64 }
    bears on (About::Record, Weight::Slight)
    decided "A speed above 45 m/s (162 km/h) is not taken: without a unit it is in m/s, and may be meant in km/h."
    means "The impact speed is not known from the file."
    remedy "state --impact-speed with its unit, such as 50km/h"
    says format!("{from} is {speed_m_per_s} m/s, faster than a crash test: not taken, state --impact-speed");

    /// A mass or speed of the test file is no value with a unit of its kind.
    CR035 ValueNotTaken { file: String, keyword: String, reason: String }
    bears on (About::Record, Weight::None)
    decided "A keyword with the word mass, weight, velocity or speed has a number, or a number and a unit that fits."
    means "The value is not used. The next keyword of its kind is tried."
    remedy "nothing; state --mass or --impact-speed where it is missed"
    says format!("{file}, {keyword}: {reason}: not taken");

    /// Mass or impact speed are taken from the test file.
    CR036 ValueTaken { what: String, file: String, keyword: String, value: String, unit: Option<String> }
    bears on (About::Record, Weight::None)
    decided "The first keyword of the test object with the word mass or weight, velocity or speed, whose value is not \
             zero. A bare number is in SI, as ISO/TS 13499 has it."
    means "Force, energy, crush and models are made from it."
    remedy "check keyword and value; --mass and --impact-speed state others"
    says {
        let how = unit.as_ref().map_or_else(String::new, |unit| format!(" (no unit: taken as {unit})"));
        format!("{what} is taken from {file}, {keyword:?}: {value}{how}")
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Details, Vec<String>) {
        let mut notes = Notes::new();
        let header = Header::parse("t.mme", text.as_bytes()).unwrap();
        (details_of("t.mme", &header, &IngestSettings::default(), &mut notes), notes.to_texts())
    }

    #[test]
    fn mass_and_speed_of_the_first_object_are_found_by_words() {
        let (details, notes) = read(
            "Title :frontal\nMass test object 2 :900\nMass test object 1 :1719\nVelocity test object 1 :57.09 \
             km/h\nName of test object 1 :car\nOdd key :kept\n",
        );
        assert_eq!((details.mass_kg.unwrap().value, details.vehicle.unwrap().value.as_str()), (1719.0, "car"));
        assert!((details.impact_speed_m_per_s.unwrap().value - 57.09 / 3.6).abs() < 1e-12);
        assert!(details.facts.contains(&"Odd key: kept".to_owned()));
        assert_eq!(notes[0], "mass is taken from t.mme, \"mass test object 1\": 1719 (no unit: taken as kg)");
    }

    #[test]
    fn a_bare_speed_that_may_be_in_km_per_h_is_not_taken() {
        let (details, notes) = read("Velocity test object 1 :57.09\n");
        assert_eq!(details.impact_speed_m_per_s, None);
        assert!(notes.iter().any(|n| n.contains("state --impact-speed")), "{notes:?}");
        assert_eq!(read("Velocity test object 1 :-15.6\n").0.impact_speed_m_per_s.unwrap().value, 15.6);
        assert_eq!(
            read("Velocity test object 1 :NOVALUE\nAngular velocity :3\nFilter speedup :3\n").0.impact_speed_m_per_s,
            None
        );
    }
}
