//! A report of an event data recorder as a recording: the crash tables become channels, the others are named.

use std::collections::BTreeSet;

use crumple_signal::{About, Notes, QuantityKind, Weight};

use crate::formats::reader::Bundle;
use crate::formats::table::event_data_recorder::tables::{self, ReportTable};
use crate::formats::table::one_table::{OneTable, TextAbove, one_table};
use crate::formats::table::section;
use crate::recording::content::{PulseRule, Recording};
use crate::recording::details::Details;
use crate::recording::read_channel::ReadChannel;
use crate::{IngestError, IngestSettings};

/// Reads a text that holds several tables, or cells in two units. `None`: it is a table like any other.
pub fn read(
    file: &str,
    text: &[u8],
    bundle: &Bundle,
    settings: &IngestSettings,
) -> Result<Option<Recording>, IngestError> {
    let mut sections = tables::report_tables(text, file)?;
    if sections.len() < 2 && !sections.iter().any(|section| section.rewritten) {
        return Ok(None);
    }
    if let Some(wanted) = &settings.skip_to {
        let fold = wanted.trim().to_lowercase();
        let means = |s: &ReportTable| s.heading.iter().any(|line| line.to_lowercase().contains(&fold));
        match sections.iter().position(means) {
            Some(at) => sections = vec![sections.swap_remove(at)],
            // Its refusal says what was not found.
            None => {
                section::cut(text, wanted, file)?;
                return Ok(None);
            }
        }
    }
    // One asked for by its title is read as what it was asked for.
    let is_read = |s: &ReportTable| s.is_pulse || settings.listing || settings.skip_to.is_some();
    if !sections.iter().any(is_read) {
        return Ok(None);
    }
    let mut notes = Notes::new();
    let mut details = Details::default();
    let mut channels: Vec<ReadChannel> = Vec::new();
    let mut ids = BTreeSet::new();
    let mut left_out = Vec::new();
    let table_settings = IngestSettings { channel: None, skip_to: None, ..settings.clone() };
    for (k, section) in sections.iter().enumerate() {
        if !is_read(section) {
            left_out.push(section.name());
            continue;
        }
        let table = match one_table(file, &section.text, &section.text, bundle, &table_settings, TextAbove::Heading) {
            Ok(table) => table,
            // A table that a list cannot read does not hide the others.
            Err(error) if settings.listing || channels.iter().any(is_change) => {
                notes.warning(format!("{} is not read: {error}", section.name()));
                continue;
            }
            Err(error) => return Err(error),
        };
        let OneTable { channels: of_table, details: facts, notes: table_notes } = table;
        if channels.is_empty() {
            details = facts;
        }
        notes.extend(section.notes.clone());
        for note in table_notes.iter() {
            if !notes.iter().any(|before| before == note) {
                notes.push(note.clone());
            }
        }
        for mut read in of_table {
            describe_by_heading(&mut read, section, k, &mut ids);
            channels.push(read);
        }
    }
    if !left_out.is_empty() {
        notes.info(format!("other tables of the report, not read: {}", left_out.join(", ")));
    }
    for line in tables::incompleteness(text, file)? {
        details.facts.push(format!("the recorder says that its file is not complete ({line})"));
        let text = format!("the recorder says that its file is not complete ({line}): the event may be cut off");
        notes.concern(About::Motion, Weight::Decisive, text);
    }
    edr_notes(&channels, &mut details, &mut notes);
    Ok(Some(Recording { details, channels, pulse_rule: PulseRule::OnlyOne, contact_at_zero: false, notes }))
}

fn is_change(read: &ReadChannel) -> bool {
    read.channel.quantity == QuantityKind::VelocityChange
}

/// What the heading of its table says of a channel.
fn describe_by_heading(read: &mut ReadChannel, section: &ReportTable, number: usize, ids: &mut BTreeSet<String>) {
    let channel = &mut read.channel;
    // A speed before the crash is no change of velocity.
    if !section.is_pulse && channel.quantity == QuantityKind::VelocityChange {
        channel.quantity = QuantityKind::Velocity;
    }
    channel.axis = channel.axis.or_else(|| section.axis());
    let base = channel.id.clone();
    let mut copy = 2;
    while !ids.insert(channel.id.clone()) {
        channel.id = format!("{base}-{copy}");
        copy += 1;
    }
    // The number of a column says nothing where there are several tables.
    read.aliases.retain(|alias| alias.parse::<usize>().is_err());
    if !section.title.is_empty() {
        channel.comment = Some(section.title.clone());
        read.aliases.push(section.title.clone());
    }
    read.aliases.push(format!("table {}", number + 1));
}

/// A refusal of a table that is one of a recorder, read without its profile, says so.
pub fn with_profile_hint(file: &str, text: &[u8], error: IngestError) -> IngestError {
    let is_report =
        tables::report_tables(text, file).is_ok_and(|sections| sections.iter().any(|section| section.only_a_change));
    let hint = "a table of an event data recorder (velocity change over time) is read with --profile edr";
    match error {
        IngestError::Content { place, found, expected, .. } if is_report => {
            IngestError::content(*place, found, expected, hint)
        }
        IngestError::Channel { file, found, expected, .. } if is_report => {
            IngestError::channel(&file, found, expected, hint)
        }
        error => error,
    }
}

/// What an event data recorder's table is good for.
pub fn edr_notes(channels: &[ReadChannel], details: &mut Details, notes: &mut Notes) {
    details.no_pulse = !channels.iter().any(|f| f.fitness.is_some());
    details.facts.push(
        "event data recorder (49 CFR 563): time zero is the recorder's, some milliseconds after contact".to_owned(),
    );
    notes.concern(
        About::Motion,
        Weight::Marked,
        "event data recorder table: the velocity change is cumulative and coarse (as a rule 10 ms, whole km/h or mph), \
         and how the recorder \
         filtered it is not stated: peak acceleration and force cannot be taken from it, crush roughly",
    );
}
