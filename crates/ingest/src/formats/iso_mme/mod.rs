//! ISO/TS 13499 (ISO-MME): a test file `.mme`, a channel list `.chn`, channel files `.001`; or one channel file alone.

mod channel;
mod channel_file;
pub mod file_names;
pub mod header;
mod test_file;

use std::collections::{BTreeMap, BTreeSet};

use crumple_signal::iso13499::IsoCode;
use crumple_signal::{About, Channel, ChannelStatus, Notes, QuantityKind, Weight};

use crate::formats::iso_mme::file_names::{is_channel_name, is_text_part};
use crate::formats::reader::{Bundle, Reader, stem};
use crate::pulse::place_rank;
use crate::recording::content::{PulseRule, Recording};
use crate::recording::details::Details;
use crate::recording::read_channel::{Fitness, ReadChannel};
use crate::recording::unheeded_flags;
use crate::{IngestError, IngestSettings, Place};
use channel_file::ChannelFile;
use header::Header;

/// Reader of ISO-MME tests and single channel files.
pub struct IsoMme;

impl Reader for IsoMme {
    fn format(&self) -> &'static str {
        "iso-mme"
    }

    fn recognises(&self, head: &[u8]) -> bool {
        header::recognises(head)
    }

    fn companion(&self, main: &str, name: &str) -> bool {
        stem(name).eq_ignore_ascii_case(stem(main)) && (is_channel_name(name) || is_text_part(name))
    }

    fn spans_folders(&self) -> bool {
        true
    }

    fn relevant_flags(&self) -> &'static [&'static str] {
        &["--unit", "--vehicle-number"]
    }

    fn read(&self, bundle: &Bundle, settings: &IngestSettings) -> Result<Recording, IngestError> {
        read(bundle, settings)
    }
}

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording, IngestError> {
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
    let details = match part(".mme") {
        Some((name, bytes)) if !header::recognises(bytes) => {
            notes.warning(format!(
                "{name} lacks the line \"Data format edition number\": read as ISO-MME by its name and its keyword \
                 lines"
            ));
            test_file::details(name, &Header::parse(name, bytes)?, settings, &mut notes)
        }
        Some((name, bytes)) => test_file::details(name, &Header::parse(name, bytes)?, settings, &mut notes),
        None => Details::default(),
    };

    let mut channels = Vec::new();
    let mut parsed: Vec<(&str, ChannelFile)> = Vec::new();
    let mut unread: Vec<ReadChannel> = Vec::new();
    for (name, bytes) in
        files.iter().filter(|(name, _)| is_channel_name(name) || main_is_channel && **name == main.name)
    {
        match ChannelFile::parse(name, bytes) {
            Ok(file) => parsed.push((name, file)),
            Err(error) if single && *name == main.name => return Err(error),
            Err(error) if single => notes.info(format!("{name} is not read: {error}")),
            Err(error) => unread.push(unread_channel(name, &error, &mut notes)),
        }
    }
    // By number: names may differ in case.
    parsed.sort_by_key(|(name, _)| name.rsplit_once('.').and_then(|(_, e)| e.parse::<u32>().ok()));
    if parsed.is_empty() {
        return Err(no_channels(bundle, &main.name, unread.len()));
    }
    if settings.unit.is_some() && parsed.iter().all(|(_, file)| channel::states_a_known_unit(&file.header)) {
        unheeded_flags::warn("--unit", "every channel file states a unit that is known", &mut notes);
    }
    let mut taken = BTreeSet::new();
    for (name, file) in &parsed {
        if single && *name != main.name {
            continue;
        }
        match channel::channel_of_file(name, file, &parsed, settings, &mut taken, &mut notes) {
            Ok(read) => channels.push(read),
            Err(error) if single => return Err(error),
            Err(error) => channels.push(unread_channel(name, &error, &mut notes)),
        }
    }
    if single {
        for read in &mut channels {
            if read.channel.quantity == QuantityKind::Acceleration {
                read.fitness = Some(Fitness { redundant: false, place: 0, why: "the only channel of the file" });
            }
        }
    } else {
        let vehicle = settings.vehicle_number.unwrap_or(1);
        for read in channels.iter_mut().filter(|f| f.channel.quantity == QuantityKind::Acceleration) {
            let code = read.channel.code.as_deref().and_then(|c| IsoCode::parse(c).ok());
            read.fitness = code.and_then(|(code, _)| place_rank::fitness(&code, vehicle));
        }
        channels.extend(unread);
        if let Some((name, bytes)) = part(".chn") {
            add_listed_channels(name, &Header::parse(name, bytes)?, &mut channels, &mut taken, &mut notes);
        }
        warn_of_doubtful(&channels, &mut notes);
    }
    let pulse_rule = if single { PulseRule::OnlyOne } else { PulseRule::Fittest };
    Ok(Recording { details, channels, pulse_rule, contact_at_zero: true, notes })
}

/// A channel whose file cannot be read: listed without data, the reason in its comment.
fn unread_channel(name: &str, error: &IngestError, notes: &mut Notes) -> ReadChannel {
    notes.warning(format!("a channel is left out: {error}"));
    let id = name.rsplit_once('.').map_or(name, |(_, number)| number);
    let channel = Channel::new(format!("file-{id}"), QuantityKind::Other);
    ReadChannel { aliases: vec![id.to_owned()], ..ReadChannel::without_readable_file(channel, error.to_string()) }
}

/// Channels of the list that have no file. The list's numbers are not reliable, its codes are compared.
fn add_listed_channels(
    name: &str,
    list: &Header,
    channels: &mut Vec<ReadChannel>,
    taken: &mut BTreeSet<String>,
    notes: &mut Notes,
) {
    let mut absent = 0;
    let mut listed = 0_usize;
    for (keyword, value) in list.entries().filter(|(keyword, _)| keyword.starts_with("name of channel")) {
        listed += 1;
        let code = value.split(['/', ' ', '\t']).next().unwrap_or_default();
        let Ok((code, _)) = IsoCode::parse(code) else {
            notes.info(format!("{name}: {keyword} is {value:?}, no channel code"));
            continue;
        };
        if channels.iter().any(|f| f.channel.code.as_deref() == Some(code.as_str())) {
            continue;
        }
        let mut channel = channel::channel_of_code(&code, channel::unique_id(code.as_str(), taken));
        channel.status = ChannelStatus::Absent;
        channels.push(ReadChannel::new(channel));
        absent += 1;
    }
    if absent > 0 {
        notes.info(format!("{absent} of {listed} channels listed in {name} have no file here"));
    }
    if let Some(stated) = list.number("number of channels").filter(|n| *n != listed as f64) {
        notes.info(format!("{name} states {stated} channels and lists {listed}"));
    }
}

fn warn_of_doubtful(channels: &[ReadChannel], notes: &mut Notes) {
    for read in channels.iter().filter(|f| f.wave.is_some()) {
        if matches!(read.channel.status, ChannelStatus::Questionable | ChannelStatus::Failed) {
            let comment = read.channel.comment.as_deref().unwrap_or("without a comment");
            let id = read.channel.id.clone();
            let text = format!("channel {id} is {} by its laboratory: {comment}", read.channel.status);
            notes.concern(About::Channel(id), Weight::Slight, text);
        }
    }
}

fn no_channels(bundle: &Bundle, main: &str, unread: usize) -> IngestError {
    let found = match unread {
        0 => format!("none of the channel files of {main} is here"),
        n => format!("none of the {n} channel files can be read"),
    };
    IngestError::content(
        Place::file(&bundle.name),
        found,
        format!("files such as {}.001 beside it or in the folder Channel", stem(main)),
        "give the folder of the whole test, or its zip archive",
    )
}
