//! A channel file as a channel in SI on its time grid.

use crumple_signal::iso13499::IsoCode;
use crumple_signal::unit::{signal_unit, without_brackets};
use crumple_signal::{About, Axis, Channel, ChannelStatus, Notes, QuantityKind, Sampled, Weight, remarks};

use crate::formats::iso_mme::channel_file::{ChannelFile, Header};
use crate::formats::iso13499::describe_by_code;
use crate::formats::remarks::{CodeAgainstUnit, LineNotRead, MissingAtEnds, SampleCount, UnitNotStated};
use crate::recording::content::{Ids, ReadChannel};
use crate::time::Grid;
use crate::{IngestError, IngestSettings, Place, Result, refuse, time};

/// Keywords that have a place of their own in a channel, or are checked here.
const READ: &str = "channel code|name of the channel|laboratory channel code|customer channel code|unit|\
    sampling interval|time of first sample|number of samples|reference channel|reference channel name|\
    channel frequency class|data status|transducer type|transducer id|first global maximum value|\
    first global minimum value|time of maximum value|time of minimum value|test object number|direction|dimension|\
    location|bit resolution|channel amplitude class|cut off frequency|pre-filter type";

/// Makes the channel of one file. `all` are the files of the test, for explicit time channels.
pub fn channel_of_file(
    name: &str,
    file: &ChannelFile,
    all: &[(&str, ChannelFile)],
    settings: &IngestSettings,
    ids: &mut Ids,
    notes: &mut Notes,
) -> Result<ReadChannel> {
    let header = &file.header;
    let number = name.rsplit_once('.').map_or(name, |(_, e)| e);
    let code = header.text("channel code").and_then(|text| match IsoCode::parse(text) {
        Ok((code, remarks)) => {
            remarks.into_iter().for_each(|reason| notes.push(CodeTaken { file: name.to_owned(), reason }));
            Some(code)
        }
        Err(error) => {
            notes.push(CodeNotRead { file: name.to_owned(), reason: error.to_string() });
            None
        }
    });
    let id = unique_id(code.as_ref().map_or(number, IsoCode::as_str), ids);
    let mut channel = match &code {
        Some(code) => channel_of_code(code, id),
        None => Channel::new(id, QuantityKind::Other),
    };
    describe(&mut channel, header, code.as_ref(), name, notes);
    let factor = apply_unit(&mut channel, header, code.as_ref(), settings, name, notes);
    let grid = grid(name, file, all, notes)?;
    note_oddities(name, file, notes);
    check_extremes(name, file, &grid, notes);

    // Left-off gaps move the first sample.
    let t0_s = if file.gaps_before == 0 { grid.t0_s } else { grid.t0_s + file.gaps_before as f64 * grid.dt_s };
    let samples = file.samples.iter().map(|x| x * factor).collect();
    let wave = Sampled::new(t0_s, grid.dt_s, samples).map_err(|error| {
        IngestError::content(name, error.to_string(), "finite samples at a positive interval", "export the test again")
    })?;
    let mut aliases = vec![number.to_owned(), number.trim_start_matches('0').to_owned(), name.to_owned()];
    for keyword in ["channel code", "name of the channel", "laboratory channel code", "customer channel code"] {
        aliases.extend(header.text(keyword).map(str::to_owned));
    }
    Ok(ReadChannel { wave: Some(wave), jitter: grid.jitter, aliases, ..ReadChannel::new(channel) })
}

/// What the code alone says.
pub fn channel_of_code(code: &IsoCode, id: String) -> Channel {
    let (quantity, _) = code.quantity();
    let mut channel = Channel::new(id, quantity.unwrap_or(QuantityKind::Other));
    describe_by_code(&mut channel, code);
    channel
}

/// An id fit for a topic, each once.
pub fn unique_id(text: &str, ids: &mut Ids) -> String {
    ids.unique(&text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect::<String>())
}

fn describe(channel: &mut Channel, header: &Header, code: Option<&IsoCode>, name: &str, notes: &mut Notes) {
    let written: Vec<&str> = ["location", "name of the channel"].into_iter().filter_map(|k| header.text(k)).collect();
    if code.is_none() {
        channel.location = written.first().map_or_else(String::new, |w| (*w).to_owned());
        channel.axis = header.text("direction").and_then(axis_of_words);
    }
    let transducer: Vec<&str> =
        ["transducer type", "transducer id"].into_iter().filter_map(|k| header.text(k)).collect();
    channel.sensor = (!transducer.is_empty()).then(|| transducer.join(", "));
    let stated = header.text("channel frequency class").and_then(class_of_words);
    match (channel.cfc, stated) {
        (Some(of_code), Some(of_line)) if of_code != of_line => {
            notes.push(TwoClasses { file: name.to_owned(), of_code, of_line });
        }
        (None, Some(class)) if code.is_none_or(|c| matches!(c.as_str().as_bytes()[15], b'?' | b'_')) => {
            channel.cfc = Some(class);
            channel.filter_state = Some(format!("CFC {class}"));
        }
        _ => {}
    }
    let status = header.text("data status").unwrap_or_default().to_lowercase();
    let source = header.text("data source").unwrap_or_default().to_lowercase();
    let errors = header.text("errors occurred").is_some_and(|e| e.eq_ignore_ascii_case("yes"));
    channel.status = match status.as_str() {
        "channel failed" | "system failed" | "meaningless data" | "no data" => ChannelStatus::Failed,
        "questionable data" => ChannelStatus::Questionable,
        _ if errors => ChannelStatus::Questionable,
        _ if matches!(source.as_str(), "calculation" | "simulation" | "parameter") => ChannelStatus::Computed,
        _ => ChannelStatus::Valid,
    };
    let mut comment: Vec<String> = written.into_iter().map(str::to_owned).collect();
    comment.extend(
        header.text("data status").filter(|s| !s.eq_ignore_ascii_case("ok")).map(|s| format!("data status: {s}")),
    );
    comment.extend(header.others(&READ.split('|').collect::<Vec<_>>()));
    channel.comment = (!comment.is_empty()).then(|| comment.join("; "));
}

/// `Longitudinal`, `X`, `lateral`.
fn axis_of_words(words: &str) -> Option<Axis> {
    match words.to_lowercase().chars().next()? {
        'x' => Some(Axis::X),
        'y' => Some(Axis::Y),
        'z' => Some(Axis::Z),
        'l' if words.to_lowercase().starts_with("long") => Some(Axis::X),
        'l' if words.to_lowercase().starts_with("lat") => Some(Axis::Y),
        'v' => Some(Axis::Z),
        'r' => Some(Axis::Resultant),
        _ => None,
    }
}

/// `1000`, `CFC1000`, `CFC 60`.
fn class_of_words(words: &str) -> Option<u16> {
    let digits: String = words.chars().filter(char::is_ascii_digit).collect();
    digits.parse().ok().filter(|class| matches!(class, 60 | 180 | 600 | 1000))
}

/// The factor to SI. Values are in engineering units: amplitude class and resolution scale nothing.
fn apply_unit(
    channel: &mut Channel,
    header: &Header,
    code: Option<&IsoCode>,
    settings: &IngestSettings,
    name: &str,
    notes: &mut Notes,
) -> f64 {
    let of_code = code.and_then(|c| c.quantity().0);
    let stated = stated_unit(header);
    let acceleration = |symbol: &str| signal_unit(symbol).filter(|(kind, _)| *kind == QuantityKind::Acceleration);
    let may_be_acceleration = of_code.is_none_or(|q| q == QuantityKind::Acceleration);
    let known = stated.as_deref().and_then(signal_unit).map(|(kind, factor)| match (kind, of_code) {
        // A distance and a velocity change are told by the code, not by the unit.
        (QuantityKind::Velocity, Some(QuantityKind::VelocityChange)) => (QuantityKind::VelocityChange, factor),
        other => (other.0, factor),
    });
    let by_flag = settings.unit.as_deref().and_then(acceleration).filter(|_| may_be_acceleration);
    let Some((quantity, factor)) = known.or(by_flag) else {
        let quantity = of_code.map(|quantity| quantity.to_string());
        notes.push(UnitNotStated { file: Some(name.to_owned()), unit: stated, quantity });
        channel.quantity = QuantityKind::Other;
        return 1.0;
    };
    if let Some(of_code) = of_code.filter(|q| *q != quantity) {
        let (of_code, of_unit) = (of_code.to_string(), quantity.to_string());
        notes.push(CodeAgainstUnit { place: name.to_owned(), of_code, of_unit });
    }
    channel.quantity = quantity;
    factor
}

/// The symbol in the line `Unit`.
fn stated_unit(header: &Header) -> Option<String> {
    header.text("unit").map(|u| without_brackets(u).to_owned())
}

pub fn states_a_known_unit(header: &Header) -> bool {
    stated_unit(header).as_deref().and_then(signal_unit).is_some()
}

fn grid(name: &str, file: &ChannelFile, all: &[(&str, ChannelFile)], notes: &mut Notes) -> Result<Grid> {
    let header = &file.header;
    let reference = header.text("reference channel").map(str::to_lowercase);
    if reference.as_deref() == Some("explicit") {
        return explicit(name, file, all);
    }
    let Some(dt_s) = header.number("sampling interval") else {
        let place = header.line("sampling interval").map_or_else(|| Place::file(name), |line| Place::line(name, line));
        return refuse(
            place,
            "no sampling interval is stated, and no time channel",
            "a line such as \"Sampling interval           :0.0001\"",
            "add the line with the interval in seconds: a sample number is not taken for time",
        );
    };
    if dt_s <= 0.0 {
        let line = header.line("sampling interval").unwrap_or(1);
        return refuse(
            Place::line(name, line),
            format!("sampling interval {dt_s} s"),
            "a positive number of seconds",
            "correct the line",
        );
    }
    if reference.as_deref() != Some("implicit") {
        notes.push(TimeNotStated { file: name.to_owned(), reference, taken_s: None });
    }
    let t0_s = header.number("time of first sample").unwrap_or_else(|| {
        let taken_s = 0.0;
        notes.push(TimeNotStated { file: name.to_owned(), reference: None, taken_s: Some(taken_s) });
        taken_s
    });
    Ok(Grid { t0_s, dt_s, jitter: 0.0 })
}

/// The grid of the channel whose code is the reference channel's name.
fn explicit(name: &str, file: &ChannelFile, all: &[(&str, ChannelFile)]) -> Result<Grid> {
    let refuse = |found: String, hint: &str| {
        let line = file.header.line("reference channel name").or(file.header.line("reference channel")).unwrap_or(1);
        IngestError::content(Place::line(name, line), found, "the code of a time channel with as many samples", hint)
    };
    let Some(wanted) = file.header.text("reference channel name") else {
        return Err(refuse("the time channel is explicit, its name is not stated".to_owned(), "correct the line"));
    };
    let time = all.iter().find(|(other, f)| {
        *other != name && f.header.text("channel code").is_some_and(|code| code.eq_ignore_ascii_case(wanted))
    });
    let Some((time_name, time)) = time else {
        return Err(refuse(format!("time channel {wanted} is not here"), "give the folder of the whole test"));
    };
    if time.samples.len() != file.samples.len() || time.gaps_before != file.gaps_before || time.samples.len() < 2 {
        return Err(refuse(
            format!(
                "time channel {wanted} ({time_name}) has {} samples, this one {}",
                time.samples.len(),
                file.samples.len()
            ),
            "export the test again",
        ));
    }
    let factor = match time.header.text("unit").map(str::to_lowercase).as_deref() {
        None | Some("s" | "sec") => 1.0,
        Some("ms") => 1e3,
        Some(other) => return Err(refuse(format!("time channel {wanted} is in {other:?}"), "export it in s or ms")),
    };
    let times: Vec<f64> = time.samples.iter().map(|t| t / factor).collect();
    let largest = times[0].abs().max(times[times.len() - 1].abs());
    // Seven digits are what 32-bit recorders print.
    let resolution = 10_f64.powf(largest.log10().floor() - 6.0);
    let fitted = time::fit(&times, resolution).map_err(|error| {
        refuse(
            format!("the times of {wanted} ({time_name}) are no uniform grid: {error:?}"),
            "resample the record to a uniform rate first",
        )
    })?;
    // The caller moves the start past left-off gaps; the time channel is already cut.
    Ok(Grid { t0_s: fitted.t0_s - file.gaps_before as f64 * fitted.dt_s, ..fitted })
}

fn note_oddities(name: &str, file: &ChannelFile, notes: &mut Notes) {
    let count = file.samples.len() + file.gaps_before + file.gaps_after;
    let of_name = || Some(name.to_owned());
    if file.surplus > 0 {
        let (stated, found) = (count as f64, count + file.surplus);
        notes.push(SampleCount { file: of_name(), segment: None, channels: None, stated, found, used: count });
    } else if let Some(stated) = file.header.number("number of samples").filter(|n| *n != count as f64) {
        notes.push(SampleCount { file: of_name(), segment: None, channels: None, stated, found: count, used: count });
    }
    let (before, after) = (file.gaps_before, file.gaps_after);
    if before + after > 0 {
        notes.push(MissingAtEnds { file: of_name(), channels: None, before, after });
    }
    if let Some(line) = file.decimal_comma {
        notes.push(DecimalComma { file: name.to_owned(), line });
    }
    if let Some(line) = file.odd_lines.first() {
        let (file, lines) = (name.to_owned(), file.odd_lines.len());
        notes.push(LineNotRead { file, line: *line, lines, reason: None });
    }
}

/// The extremes stated in the header against those of the samples, in the unit of the file. The stated time may be that
/// of any sample of a plateau.
fn check_extremes(name: &str, file: &ChannelFile, grid: &Grid, notes: &mut Notes) {
    let low = file.samples.iter().copied().fold(f64::INFINITY, f64::min);
    let high = file.samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Extremes are printed with five digits and more.
    let slack = 1e-4 * low.abs().max(high.abs());
    for (what, found) in [("maximum", high), ("minimum", low)] {
        let Some(stated) = file.header.number(&format!("first global {what} value")) else { continue };
        if (stated - found).abs() > slack {
            notes.push(ExtremeDiffers { file: name.to_owned(), extreme: what, stated, found });
            continue;
        }
        let Some(stated_s) = file.header.number(&format!("time of {what} value")) else { continue };
        let t = |k: usize| grid.t0_s + (k + file.gaps_before) as f64 * grid.dt_s;
        let near = |k: &usize| (t(*k) - stated_s).abs() <= 1.5 * grid.dt_s;
        let at: Vec<usize> = (0..file.samples.len()).filter(|k| (file.samples[*k] - found).abs() <= slack).collect();
        if !at.iter().any(near) {
            let found_s = at.first().map_or(0.0, |k| t(*k));
            notes.push(ExtremeElsewhere { file: name.to_owned(), extreme: what, stated_s, found_s });
        }
    }
}

remarks! {
    /// Remarks of channel files.
    pub REMARKS;

    /// A channel code breaks the rule of ISO/TS 13499 in a known way.
    CR022 CodeTaken { file: String, reason: String }
    bears on (About::Record, Weight::Slight)
    decided "A code has sixteen characters: letters, digits and ?. Codes with a suffix, with open places, and without \
             test object and position or filter class are met, and are read as the sentence says."
    means "What the code leaves open is not known: place, direction or filter class of the channel."
    remedy "compare the code with the list of channels of the test"
    says format!("{file}: {reason}");

    /// A channel code is no code of ISO/TS 13499.
    CR023 CodeNotRead { file: String, reason: String }
    bears on (About::Record, Weight::Slight)
    decided "A code has sixteen characters: letters, digits and ?. Shorter ones of 13 to 15 are completed."
    means "Place, axis and filter class are not known from it, and the channel is not chosen as the pulse."
    remedy "correct the line \"Channel code\", or name the channel by --channel"
    says format!("{file}: the channel code is not read: {reason}");

    /// The code of a channel and its header state different filter classes.
    CR024 TwoClasses { file: String, of_code: u16, of_line: u16 }
    bears on (About::Record, Weight::Slight)
    decided "The last letter of the code is compared with the line \"Channel frequency class\"; the code is taken."
    means "The filter goes by the code. If the line is right, the channel is filtered twice or too little, and its \
           peaks differ."
    remedy "ask the laboratory for the class; --cfc filters to another one"
    says format!(
        "{file}: the code says CFC {of_code}, the line \"Channel frequency class\" says {of_line}: the code is taken"
    );

    /// The header does not say how a channel is timed.
    CR025 TimeNotStated { file: String, reference: Option<String>, taken_s: Option<f64> }
    bears on (About::Record, Weight::Slight)
    decided "An implicit time has the lines \"Reference channel\", \"Time of first sample\" and \"Sampling interval\". \
             Without the first it is taken as implicit, without the second it starts at 0 s."
    means "If the record starts before contact, contact and every other time are late by as much."
    remedy "add the lines to the channel file, or state contact by --time-zero"
    says match (taken_s, reference) {
        (Some(taken), _) => format!("{file}: the time of the first sample is not stated, taken as {taken} s"),
        (None, Some(other)) => format!("{file}: reference channel {other:?} is not known, assumed implicit"),
        (None, None) => format!("{file}: reference channel not stated, assumed implicit"),
    };

    /// Numbers have a decimal comma.
    CR026 DecimalComma { file: String, line: usize }
    bears on (About::Record, Weight::Slight)
    decided "A sample is a number with a comma in the place of the decimal point. The first line is named."
    means "It is read as a decimal point. If the comma separates thousands, values are too small by 1000."
    remedy "check the line, or export the test with decimal points"
    says format!("{file}, line {line}: a decimal comma, read as a decimal point");

    /// The header states another extreme than the samples have.
    CR027 ExtremeDiffers { file: String, extreme: &'static str, stated: f64, found: f64 }
    bears on (About::Record, Weight::Slight)
    decided "Both are compared in the unit of the file; 1e-4 of the largest sample is left, since extremes are printed \
             with five digits and more."
    means "Header and samples are not of one state of the data: another filter, zero level, unit or sign."
    remedy "ask the laboratory which of both is right, or export the test again"
    says format!("{file}: the header states the {extreme} {stated}, the samples have {found}");

    /// The header states another time of an extreme than the samples have.
    CR028 ExtremeElsewhere { file: String, extreme: &'static str, stated_s: f64, found_s: f64 }
    bears on (About::Record, Weight::Slight)
    decided "The stated time may be that of any sample of a plateau; one and a half sampling intervals are left."
    means "The time axis may start elsewhere or have another interval: contact, velocity and crush go with it."
    remedy "check the lines \"Time of first sample\" and \"Sampling interval\" of the file"
    says format!(
        "{file}: the header states the {extreme} at {stated_s} s, the samples have it at {found_s:.6} s: check the \
         time axis"
    );
}
