//! Columns of a table as channels: quantity, unit, identity.

use std::collections::BTreeMap;
use std::sync::Arc;

use crumple_metrics::cumulative;
use crumple_signal::iso13499::wildcard;
use crumple_signal::unit::near;
use crumple_signal::{Channel, Notes, QuantityKind, Sampled, SignalError};

use crate::formats::iso13499;
use crate::formats::remarks::{UnitReplaced, UnitUnknown};
use crate::formats::table::header::{Column, TableHeader};
use crate::formats::table::numbers::Rows;
use crate::formats::table::remarks::{Integrated, SameTitles};
use crate::formats::table::time_axis::TimeAxis;
use crate::formats::text::column_names::{
    ACCELERATION, Unit, axis, cfc, names_acceleration, names_velocity_change, stated_unit,
};
use crate::formats::waveform::channel;
use crate::recording::content::{Fitness, Ids, ReadChannel, list};
use crate::recording::details::Stated;
use crate::recording::scale::of_sensor;
use crate::recording::settings::{self, is_pattern};
use crate::{IngestError, IngestSettings, Place, Profile, Result, pulse, refuse_channel};

/// Turns every column but the time into a channel in SI, each with the index of its column.
pub fn channels(
    file: &str,
    header: &TableHeader,
    rows: Rows,
    time: &TimeAxis,
    settings: &IngestSettings,
    comment: Option<&Stated<String>>,
    notes: &mut Notes,
) -> Result<Vec<(usize, ReadChannel)>> {
    let is_data = |k: &usize| !time.columns.contains(k) && !rows.is_left_out(*k);
    let data: Vec<usize> = (0..header.columns.len()).filter(is_data).collect();
    let ids = ids(header, &data);
    same_titles(header, &data, &ids, notes);
    let edr = settings.profile == Some(Profile::Edr);
    let selected = settings.channel.as_deref().map(|wanted| select(file, wanted, header, &data, &ids)).transpose()?;
    let stated = match (&settings.unit, comment) {
        (Some(symbol), _) => Some((symbol.as_str(), "--unit or the sidecar", true)),
        (None, Some(stated)) => Some((stated.value.as_str(), stated.from.as_str(), false)),
        (None, None) => None,
    };
    let stated = stated.map(|(symbol, from, forced)| stated_unit(file, symbol, from, edr).map(|unit| (unit, forced)));
    let stated = stated.transpose()?;

    let kinds = kinds(header, &data, selected, stated, settings, notes);
    if let Some(((of_unit, factor), true)) = stated
        && !kinds.iter().any(|(kind, f)| (*kind == of_unit || edr && *kind != QuantityKind::Other) && *f == factor)
    {
        settings::warn("--unit", "the columns state units of their own; --channel names the one that is meant", notes);
    }
    // A record of other quantities is welcome where mass and speed may be missing; a sole column without a unit, or one
    // named as acceleration, is asked about all the same.
    let is_unknown = |k: usize| kinds[k].0 == QuantityKind::Other;
    let sole = kinds.len() == 1 && is_unknown(0) && settings.sample_time.is_none();
    let position = |wanted: usize| data.iter().position(|k| *k == wanted);
    let others_are_welcome = settings.allow_missing.unwrap_or(false)
        && !selected.and_then(position).is_some_and(is_unknown)
        && !sole
        && !data.iter().any(|k| header.named && names_acceleration(&header.columns[*k].title));
    if settings.listing || settings.scale.is_some() {
        // Nothing is asked back for a list; what is scaled is judged with all channels.
    } else if edr {
        check_for_velocity(file, header, &data, &kinds)?;
    } else if !others_are_welcome {
        check_for_acceleration(file, header, &data, &kinds, selected, settings.unit.is_some())?;
    }

    // The recorder may keep accelerations (49 CFR 563, table II); their integral is what is read of it.
    let is_integrated = edr && !kinds.iter().any(|(kind, _)| *kind == QuantityKind::VelocityChange);
    let lines = Arc::new(rows.lines);
    let mut columns = rows.columns;
    let mut channels = Vec::with_capacity(data.len());
    for ((&k, id), &(quantity, factor)) in data.iter().zip(ids).zip(&kinds) {
        let mut samples = std::mem::take(&mut columns[k]);
        samples.iter_mut().for_each(|x| *x *= factor);
        let quantity = match quantity {
            QuantityKind::Acceleration if is_integrated => {
                samples = cumulative(&samples, time.grid.dt_s);
                notes.push(Integrated { column: header.columns[k].title.clone() });
                QuantityKind::VelocityChange
            }
            other => other,
        };
        let wave = Sampled::new(time.grid.t0_s, time.grid.dt_s, samples).map_err(|error| {
            let place = match error {
                SignalError::NotFinite { index, .. } => Place::line(file, lines.of_row(index)),
                _ => Place::file(file),
            };
            let column = format!("{} ({})", k + 1, header.columns[k].title);
            IngestError::content(place.in_column(column), error.to_string(), "finite numbers", "correct the row")
        })?;
        let Column { name, title, .. } = &header.columns[k];
        let acceleration = quantity == QuantityKind::Acceleration;
        let mut channel = Channel::new(id, quantity);
        channel.axis = axis(title).filter(|_| !is_ordinate(header, &data, k));
        channel.cfc = cfc(title).filter(|_| acceleration);
        iso13499::describe_by_name(&mut channel, name, notes);
        channels.push((
            k,
            ReadChannel {
                wave: Some(wave),
                jitter: time.grid.jitter,
                fitness: Fitness::of_only(quantity, "the only acceleration column"),
                aliases: vec![name.clone(), title.clone(), channel::clean(title), (k + 1).to_string()],
                lines: Some(Arc::clone(&lines)),
                ..ReadChannel::new(channel)
            },
        ));
    }
    Ok(channels)
}

/// The columns of a table whose times cannot be read, for a list: without samples, the reason as their comment.
pub fn without_time(header: &TableHeader, rows: &Rows, error: &IngestError) -> Vec<(usize, ReadChannel)> {
    let data: Vec<usize> = (0..header.columns.len()).filter(|k| !rows.is_left_out(*k)).collect();
    let channel = |(k, id): (&usize, String)| {
        let quantity = match header.columns[*k].unit {
            Unit::Signal(quantity, _) => quantity,
            _ => QuantityKind::Other,
        };
        (*k, ReadChannel::without_readable_file(Channel::new(id, quantity), error.to_string()))
    };
    data.iter().zip(ids(header, &data)).map(channel).collect()
}

/// Quantity and factor to SI of every data column; [`QuantityKind::Other`] and 1 where no unit is known.
fn kinds(
    header: &TableHeader,
    data: &[usize],
    selected: Option<usize>,
    stated: Option<((QuantityKind, f64), bool)>,
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Vec<(QuantityKind, f64)> {
    let edr = settings.profile == Some(Profile::Edr);
    let names_any = header.named && data.iter().any(|k| names_acceleration(&header.columns[*k].title));
    // Of an occupant `Head X` is an acceleration, where no other column is named as one.
    let is_of_body = |title: &str| settings.place.is_some() && !names_any && axis(title).is_some();
    let accelerations =
        data.iter().filter(|k| matches!(header.columns[**k].unit, Unit::Signal(QuantityKind::Acceleration, _))).count();
    // A unit of speed is that of one column.
    let serves_alone = |k: usize| selected.map_or(data.len() == 1, |selected| selected == k);
    let mut kinds = Vec::new();
    let mut unknown = Vec::new();
    for &k in data {
        let Column { title, unit, .. } = &header.columns[k];
        // The flag is for the column asked for, and for all that are named as accelerations.
        let is_target = header.named && (names_acceleration(title) || is_of_body(title))
            || selected.map_or(data.len() == 1 || !header.named, |s| s == k);
        let kind = match (unit, stated) {
            (Unit::Signal(QuantityKind::Acceleration, f), Some(((QuantityKind::Acceleration, over), true)))
                if *f != over && (selected == Some(k) || accelerations == 1) =>
            {
                let (column, stated_m_per_s2, used_m_per_s2) = (Some(title.clone()), *f, over);
                notes.push(UnitReplaced { channel: None, column, stated_m_per_s2, used_m_per_s2 });
                (QuantityKind::Acceleration, over)
            }
            (Unit::Signal(QuantityKind::Velocity, f), _) if edr => (QuantityKind::VelocityChange, *f),
            (Unit::Signal(kind, f), _) => (*kind, *f),
            (_, Some(((_, f), _))) if edr && (data.len() == 1 || names_velocity_change(title)) => {
                (QuantityKind::VelocityChange, f)
            }
            (_, Some((unit, _))) if !edr && is_target && (unit.0 == QuantityKind::Acceleration || serves_alone(k)) => {
                unit
            }
            _ => {
                unknown.push(title.as_str());
                (QuantityKind::Other, 1.0)
            }
        };
        kinds.push(kind);
    }
    if !unknown.is_empty() {
        notes.push(UnitUnknown { unit: None, channels: unknown.join(", ") });
    }
    kinds
}

/// Whether a column is the ordinate of a plot or the values of a waveform, `Y` beside `X` or the time, and no axis: the
/// letter alone, without another axis among the data.
fn is_ordinate(header: &TableHeader, data: &[usize], k: usize) -> bool {
    let letter = |k: usize| {
        let name = header.columns[k].name.to_lowercase();
        let letters: String = name.chars().filter(|c| !c.is_ascii_digit() && !"[]()_-.# ".contains(*c)).collect();
        ["x", "y", "z"].into_iter().find(|axis| *axis == letters)
    };
    letter(k) == Some("y") && !data.iter().any(|other| matches!(letter(*other), Some("x" | "z")))
}

/// What to do about a unit that is not known.
fn of_unknown(symbol: &str) -> String {
    match near(symbol, ACCELERATION).as_slice() {
        [] => "export the column in one of these; if it is one of them by another name, --unit g, for example, says so"
            .to_owned(),
        near => format!("if {symbol:?} is that, add --unit {}", near.join(" or --unit ")),
    }
}

/// An acceleration there must be, and the column asked for must be one.
fn check_for_acceleration(
    file: &str,
    header: &TableHeader,
    data: &[usize],
    kinds: &[(QuantityKind, f64)],
    selected: Option<usize>,
    is_unit_stated: bool,
) -> Result<()> {
    let is_named_as_acceleration = |k: &usize| names_acceleration(&header.columns[*k].title);
    let no_unit = |k: usize| {
        let Column { title, unit, .. } = &header.columns[k];
        let place = Place::file(file).in_nth_column(k, title);
        let is_curve =
            file.rsplit_once('.').is_some_and(|(_, e)| e.len() == 3 && e.bytes().all(|b| b.is_ascii_digit()));
        let hint = if is_curve {
            "a signal file of an NHTSA test is read by giving its .EV5 file; else add --unit g"
        } else if selected.is_none() && data.len() > 1 && !data.iter().any(is_named_as_acceleration) {
            "if it is a crash, add --unit g or --unit m/s^2 (or mm/ms^2), whichever it is; inputs and outputs that are \
             no crash need none: --allow-missing, and then the stage identify"
        } else {
            "add --unit g or --unit m/s^2 (or mm/ms^2), whichever it is: a unit is never guessed from the numbers"
        };
        let id = ids(header, &[k]).remove(0);
        match unit {
            Unit::Unknown(symbol) => unit.refuse(place, &id, &of_unknown(symbol)),
            _ => unit.refuse(place, &id, hint),
        }
    };
    if let Some(selected) = selected {
        let kind = data.iter().zip(kinds).find(|(k, _)| **k == selected).map(|(_, kind)| kind.0);
        return match kind {
            Some(QuantityKind::Other) => Err(no_unit(selected)),
            _ => Ok(()),
        };
    }
    if kinds.iter().any(|(kind, _)| *kind == QuantityKind::Acceleration) {
        return Ok(());
    }
    let of_kind = |of| data.iter().zip(kinds).filter(move |(_, kind)| kind.0 == of).map(|(k, _)| *k);
    let is_velocity = |k: usize| !names_velocity_change(&header.columns[k].title);
    if of_kind(QuantityKind::Velocity).any(is_velocity) && !data.iter().any(is_named_as_acceleration) {
        return Ok(());
    }
    let unknown: Vec<usize> = of_kind(QuantityKind::Other).collect();
    // The unit that is stated serves the column that is named.
    if let Some(first) = unknown.first().filter(|_| is_unit_stated) {
        let found = format!("no column is named as an acceleration: {}", titles(header, data));
        if header.lacks_names() {
            let (names, fields) = (header.names, header.columns.len());
            let found = format!("{fields} fields in a row, {names} names above them, and {found}");
            let hint = format!("the names may stand above other columns: give the number, such as --channel {fields}");
            return refuse_channel(file, found, "the column with the crash pulse", hint);
        }
        let id = ids(header, &[*first]).remove(0);
        return Err(pulse::which(file, found, &id, unknown.len()));
    }
    match unknown.iter().find(|k| is_named_as_acceleration(k)).or(unknown.first()) {
        Some(k) => Err(no_unit(*k)),
        None => {
            let export = "export the acceleration of the vehicle, or its velocity with its unit: velocity_km_per_h";
            let hint = match of_kind(QuantityKind::Voltage).next() {
                Some(k) => format!("{}; else {export}", of_sensor(&ids(header, &[k]).remove(0))),
                None => export.to_owned(),
            };
            let found = format!("no column is an acceleration: {}", titles(header, data));
            refuse_channel(file, found, "an acceleration column, or the volts or counts of its sensor", hint)
        }
    }
}

/// An event data recorder's table has a change of velocity.
fn check_for_velocity(file: &str, header: &TableHeader, data: &[usize], kinds: &[(QuantityKind, f64)]) -> Result<()> {
    if kinds.iter().any(|(kind, _)| matches!(kind, QuantityKind::VelocityChange | QuantityKind::Acceleration)) {
        return Ok(());
    }
    let found = format!("no column is a change of velocity with its unit: {}", titles(header, data));
    let hint = "add --unit km/h or --unit mph, and --skip-to with the title of the crash table if there are several";
    refuse_channel(file, found, "a column such as \"Delta-V (km/h)\"", hint)
}

/// The column a person means by its id, its name with or without unit, or its number from 1.
pub fn select(file: &str, wanted: &str, header: &TableHeader, data: &[usize], ids: &[String]) -> Result<usize> {
    let wanted = wanted.trim();
    let matches = |k: usize, id: &str, fold: bool| {
        let same = |name: &str| if fold { name.to_lowercase() == wanted.to_lowercase() } else { name == wanted };
        let Column { name, title, .. } = &header.columns[k];
        same(id) || same(name) || same(title) || same(&channel::clean(title))
    };
    let all = |fold: bool| -> Vec<usize> {
        data.iter().zip(ids).filter(|(k, id)| matches(**k, id, fold)).map(|(k, _)| *k).collect()
    };
    let named = Some(all(false)).filter(|exact| !exact.is_empty()).unwrap_or_else(|| all(true));
    if let [first, _, ..] = named.as_slice() {
        let numbers: Vec<String> = named.iter().map(|k| (k + 1).to_string()).collect();
        let found = format!("columns {} are all named {wanted:?}", numbers.join(", "));
        let hint = format!("give its number, such as --channel {}", first + 1);
        return refuse_channel(file, found, "one column as the crash pulse", hint);
    }
    let by_number = || wanted.parse::<usize>().ok().and_then(|n| n.checked_sub(1)).filter(|k| data.contains(k));
    if is_pattern(wanted) && named.is_empty() {
        let fits: Vec<usize> = data
            .iter()
            .zip(ids)
            .filter(|(k, id)| {
                let Column { name, title, .. } = &header.columns[**k];
                [id.as_str(), name, title].into_iter().any(|text| wildcard(wanted, text))
            })
            .map(|(k, _)| *k)
            .collect();
        if let [first, _, ..] = fits.as_slice() {
            let found = format!("--channel {wanted} means {} columns: {}", fits.len(), titles(header, &fits));
            let hint = format!("give the name of one, such as --channel {:?}", header.columns[*first].title);
            return refuse_channel(file, found, "one column as the crash pulse", hint);
        }
        if let [one] = fits.as_slice() {
            return Ok(*one);
        }
    }
    named.first().copied().or_else(by_number).map_or_else(
        || {
            let hint = "give --channel a name from the header, or the number of the column";
            refuse_channel(file, format!("no column {wanted:?}"), format!("one of {}", titles(header, data)), hint)
        },
        Ok,
    )
}

pub fn titles(header: &TableHeader, data: &[usize]) -> String {
    list(&data.iter().map(|k| header.columns[*k].title.as_str()).collect::<Vec<_>>())
}

fn same_titles(header: &TableHeader, data: &[usize], ids: &[String], notes: &mut Notes) {
    let mut by_title: BTreeMap<&str, Vec<(usize, &str)>> = BTreeMap::new();
    for (k, id) in data.iter().zip(ids) {
        by_title.entry(header.columns[*k].title.as_str()).or_default().push((k + 1, id));
    }
    for (title, columns) in by_title.into_iter().filter(|(_, columns)| columns.len() > 1) {
        let named = columns.iter().map(|(number, id)| format!("column {number} is {id}")).collect();
        notes.push(SameTitles { count: columns.len(), title: title.to_owned(), columns: named });
    }
}

/// Names fit for topics and file names, each once.
pub fn ids(header: &TableHeader, data: &[usize]) -> Vec<String> {
    let mut ids = Ids::default();
    let id = |k: &usize| {
        let clean = channel::clean(&header.columns[*k].name);
        ids.unique(&if clean.is_empty() { format!("column_{}", k + 1) } else { clean })
    };
    data.iter().map(id).collect()
}
