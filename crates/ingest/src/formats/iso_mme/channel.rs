//! A channel file as a channel in SI on its time grid.

use crumple_signal::iso13499::IsoCode;
use crumple_signal::unit::{signal_unit, without_brackets};
use crumple_signal::{Axis, Channel, ChannelStatus, Notes, QuantityKind, Sampled};

use crate::formats::iso_mme::channel_file::{ChannelFile, Header};
use crate::formats::iso13499::describe_by_code;
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
            remarks.into_iter().for_each(|remark| notes.warning(format!("{name}: {remark}")));
            Some(code)
        }
        Err(error) => {
            notes.warning(format!("{name}: the channel code is not read: {error}"));
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
        (Some(letter), Some(class)) if letter != class => notes.warning(format!(
            "{name}: the code says CFC {letter}, the line \"Channel frequency class\" says {class}: the code is taken"
        )),
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
        let reason = stated.map_or_else(|| "no unit is stated".to_owned(), |u| format!("unit {u:?} is not known"));
        let hint =
            if of_code == Some(QuantityKind::Acceleration) { "; --unit g or --unit m/s^2 states it" } else { "" };
        notes.warning(format!("{name}: {reason}: kept as read, quantity other{hint}"));
        channel.quantity = QuantityKind::Other;
        return 1.0;
    };
    if let Some(of_code) = of_code.filter(|q| *q != quantity) {
        notes.warning(format!("{name}: the code says {of_code}, the unit is one of {quantity}: the unit is taken"));
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
    match reference.as_deref() {
        Some("implicit") => {}
        Some(other) => notes.warning(format!("{name}: reference channel {other:?} is not known, assumed implicit")),
        None => notes.warning(format!("{name}: reference channel not stated, assumed implicit")),
    }
    let t0_s = header.number("time of first sample").unwrap_or_else(|| {
        notes.warning(format!("{name}: the time of the first sample is not stated, taken as 0 s"));
        0.0
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
    if file.surplus > 0 {
        notes.warning(format!(
            "{name}: the header states {count} samples, the file has {}: the first {count} are used",
            count + file.surplus
        ));
    } else if let Some(stated) = file.header.number("number of samples").filter(|n| *n != count as f64) {
        notes.warning(format!("{name}: the header states {stated} samples, the file has {count}: those are used"));
    }
    if file.gaps_before + file.gaps_after > 0 {
        notes.warning(format!(
            "{name}: NOVALUE at {} samples before and {} after the data: left off",
            file.gaps_before, file.gaps_after
        ));
    }
    if let Some(line) = file.decimal_comma {
        notes.warning(format!("{name}, line {line}: a decimal comma, read as a decimal point"));
    }
    if let Some(line) = file.odd_lines.first() {
        notes.warning(format!(
            "{name}, line {line}: neither a keyword nor a number, left out ({} such lines)",
            file.odd_lines.len()
        ));
    }
}

/// The extremes stated in the header against those of the samples, in the unit of the file. The stated time may be that
/// of any sample of a plateau.
fn check_extremes(name: &str, file: &ChannelFile, grid: &Grid, notes: &mut Notes) {
    let low = file.samples.iter().copied().fold(f64::INFINITY, f64::min);
    let high = file.samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Extremes are printed with five digits and more.
    let slack = 1e-4 * low.abs().max(high.abs());
    for (what, extreme) in [("maximum", high), ("minimum", low)] {
        let Some(stated) = file.header.number(&format!("first global {what} value")) else { continue };
        if (stated - extreme).abs() > slack {
            notes.warning(format!("{name}: the header states the {what} {stated}, the samples have {extreme}"));
            continue;
        }
        let Some(time) = file.header.number(&format!("time of {what} value")) else { continue };
        let t = |k: usize| grid.t0_s + (k + file.gaps_before) as f64 * grid.dt_s;
        let near = |k: &usize| (t(*k) - time).abs() <= 1.5 * grid.dt_s;
        let at: Vec<usize> = (0..file.samples.len()).filter(|k| (file.samples[*k] - extreme).abs() <= slack).collect();
        if !at.iter().any(near) {
            notes.warning(format!(
                "{name}: the header states the {what} at {time} s, the samples have it at {:.6} s: check the time axis",
                at.first().map_or(0.0, |k| t(*k))
            ));
        }
    }
}
