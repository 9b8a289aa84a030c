//! Universal files: data sets 58 in ASCII, functions of time.
//!
//! A data set stands between lines `-1`, its number first. Number 58 has eleven lines of description: the seventh says
//! how many numbers of which precision follow and at which steps, the eighth and ninth name abscissa and ordinate with
//! their units.

use std::collections::BTreeSet;

use crumple_signal::Notes;

use crate::formats::reader::{Bundle, Reader};
use crate::formats::remarks::PartsNotRead;
use crate::formats::text::lines::{Lines, decode, field, without_mark};
use crate::formats::waveform::channel::Waveform;
use crate::formats::waveform::conversion;
use crate::recording::content::{Recording, list};
use crate::recording::details::Details;
use crate::{IngestSettings, Place, Result, refuse};

pub const UNIVERSAL: Reader = Reader::of_one_file("uff", recognises, conversion::FLAGS, read);

fn recognises(head: &[u8]) -> bool {
    let text = without_mark(head);
    let mut lines = text.split(|b| *b == b'\n').map(<[u8]>::trim_ascii).filter(|line| !line.is_empty());
    let is_number = |line: &[u8]| matches!(line, b"58" | b"151" | b"164") || line.starts_with(b"58b");
    lines.next() == Some(b"-1") && lines.next().is_some_and(is_number)
}

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let file = bundle.main.name.as_str();
    let mut notes = Notes::new();
    let waveforms = data_sets(file, &without_mark(&bundle.main.bytes), &mut notes)?;
    conversion::recording(file, waveforms, Details::default(), settings, notes)
}

fn data_sets(file: &str, text: &[u8], notes: &mut Notes) -> Result<Vec<Waveform>> {
    let refuse = |line, found: &str, hint| {
        refuse(Place::line(file, line), found, "whole data sets 58 of real numbers in ASCII", hint)
    };
    let (mut waveforms, mut set): (Vec<Waveform>, Option<(usize, Vec<String>)>) = (Vec::new(), None);
    let mut unread: BTreeSet<String> = BTreeSet::new();
    let mut lines = Lines::new(file, text);
    while let Some(line) = lines.take()? {
        if line.bytes.trim_ascii() != b"-1" {
            if let Some((_, set)) = &mut set {
                // Its numbers may hold bytes of any kind, and its end need not stand on a line of its own.
                if set.is_empty() && line.bytes.trim_ascii().to_ascii_lowercase().starts_with(b"58b") {
                    let hint = "export it in ASCII, as UFF 58";
                    return refuse(line.number, "a binary data set (UFF 58b), which is not read", hint);
                }
                set.push(decode(line.bytes));
            }
            continue;
        }
        let Some((start, of_set)) = set.take() else {
            set = Some((line.number, Vec::new()));
            continue;
        };
        match of_set.first().map_or("", |line| line.trim()) {
            "58" => match waveforms_of(&of_set[1..], waveforms.len()) {
                Ok(of_set) => waveforms.extend(of_set),
                Err(found) => return refuse(start, &found, "the file may be cut short or damaged: export it again"),
            },
            // Header and units.
            "" | "151" | "164" => {}
            other => drop(unread.insert(other.chars().take(20).collect())),
        }
    }
    if let Some((start, of_set)) = set {
        let name = of_set.get(1).map_or("", |line| line.trim());
        let found =
            format!("the file ends before the end (-1) of the data set that begins here, {name:?}: it is cut short");
        return refuse(start, &found, "copy or export the file again");
    }
    if !unread.is_empty() {
        let kinds: Vec<String> = unread.into_iter().collect();
        notes.push(PartsNotRead { parts: "universal data sets", names: list(&kinds) });
    }
    Ok(waveforms)
}

/// The function of a data set; one at uneven times comes with those.
fn waveforms_of(lines: &[String], before: usize) -> Result<Vec<Waveform>, String> {
    let (about, data) = lines.split_at_checked(11).ok_or("a data set 58 without its eleven lines of description")?;
    let [form, abscissa, ordinate] = [&about[6], &about[7], &about[8]];
    let numbers: Vec<&str> = form.split_whitespace().collect();
    let whole = |k: usize| numbers.get(k).and_then(|text| text.parse::<usize>().ok());
    let real = |k: usize| numbers.get(k).and_then(|text| field(text.as_bytes(), b'.')).map(|number| number.value);
    // Label and unit after 25 columns of numbers.
    let words = |line: &str, from: usize, to: usize| {
        let text: String = line.chars().skip(from).take(to - from).collect();
        Some(text.trim().to_owned()).filter(|text| !text.eq_ignore_ascii_case("none")).unwrap_or_default()
    };
    let (name, unit) = (words(ordinate, 26, 46), words(ordinate, 47, 67));
    let name = if name.is_empty() { about[0].trim().to_owned() } else { name };
    let mut waveform = Waveform { unit, ..Waveform::new("", name) };
    let width = match whole(0) {
        Some(2) => 13,
        Some(4) => 20,
        _ => {
            waveform.values = Err("its numbers are not real".to_owned());
            return Ok(vec![waveform]);
        }
    };
    if abscissa.split_whitespace().next() != Some("17") {
        waveform.not_time = Some(format!("its abscissa is {:?}, not time", words(abscissa, 26, 46)));
    }
    let mut values = Vec::new();
    for line in data {
        let cells: Vec<&[u8]> = line.trim_end().as_bytes().chunks(width).collect();
        let fixed: Option<Vec<f64>> = cells.iter().map(|cell| field(cell, b'.').map(|number| number.value)).collect();
        let free = || line.split_whitespace().map(|text| field(text.as_bytes(), b'.').map(|n| n.value)).collect();
        let of_line: Option<Vec<f64>> = fixed.or_else(free);
        values.extend(of_line.ok_or_else(|| format!("{:?} in a data set 58 is no row of numbers", line.trim()))?);
    }
    let announced = whole(1).ok_or("a data set 58 that does not say how many numbers it has")?;
    let unit = words(abscissa, 47, 67);
    if whole(2) == Some(1) {
        let start = real(3).unwrap_or(0.0);
        waveform.set_steps(real(4).filter(|dt| *dt > 0.0).map(|dt| (start, dt)), "Time", &unit);
        waveform.values = Ok(values);
        return check(announced, waveform).map(|waveform| vec![waveform]);
    }
    waveform.group = format!("set {}", before + 1);
    let times = values.iter().step_by(2).copied().collect();
    waveform.values = Ok(values.iter().skip(1).step_by(2).copied().collect());
    let clock = Waveform { unit, values: Ok(times), ..Waveform::new(waveform.group.clone(), "Time") };
    check(announced, waveform).map(|waveform| vec![clock, waveform])
}

fn check(announced: usize, waveform: Waveform) -> Result<Waveform, String> {
    let count = waveform.values.as_ref().map_or(0, Vec::len);
    if count == announced { Ok(waveform) } else { Err(format!("{announced} numbers are announced, {count} are there")) }
}
