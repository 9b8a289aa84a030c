//! Tables whose channels have times of their own: each column of times is followed by the channels that it is of.

use crumple_signal::Notes;

use crate::formats::remarks::{LateColumns, TimeChannels};
use crate::formats::table::OfOneTime;
use crate::formats::table::columns::{ids, select};
use crate::formats::table::header::TableHeader;
use crate::formats::table::layout::Cells;
use crate::formats::table::numbers::Rows;
use crate::formats::table::time_axis::is_time_column;
use crate::formats::text::column_names::{Unit, names_acceleration};
use crate::recording::content::ReadChannel;
use crate::time::{Instant, median_step};
use crate::{IngestSettings, Result};

/// A column of times and the channels behind it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    time: usize,
    data: Vec<usize>,
}

/// The groups of a table; `None` where all channels have one time: no second column of times, or one that repeats the
/// first.
pub fn groups(header: &TableHeader, rows: &Rows) -> Option<Vec<Group>> {
    let filled: Vec<usize> = (0..header.columns.len()).filter(|k| !rows.is_left_out(*k)).collect();
    let of_time: Vec<usize> = filled.iter().copied().filter(|k| is_time_column(header, rows, *k)).collect();
    let first = of_time.first().or(filled.first()).copied()?;
    // `X`, `Y`, `X`, `Y` of two curves.
    let is_like_first =
        |k: usize| header.named && bare(header, first).is_some_and(|name| bare(header, k) == Some(name));
    let times: Vec<usize> = filled.iter().copied().filter(|k| of_time.contains(k) || is_like_first(*k)).collect();
    let group = |place: usize| {
        let (time, next) = (times[place], times.get(place + 1).copied().unwrap_or(usize::MAX));
        Group { time, data: filled.iter().copied().filter(|k| (time + 1..next).contains(k)).collect() }
    };
    let groups: Vec<Group> = (0..times.len()).map(group).collect();
    let all_have_data = filled.first() == times.first() && groups.iter().all(|group| !group.data.is_empty());
    let is_apart = |k: &usize| !of_time.contains(k) || differ(header, rows, (first, *k), is_like_first(*k));
    (times.len() > 1 && all_have_data && times[1..].iter().any(is_apart)).then_some(groups)
}

/// The title of a column without its unit and number: `X`, `time[0]` is `time`.
fn bare(header: &TableHeader, k: usize) -> Option<String> {
    let name = header.columns[k].name.to_lowercase();
    let letters: String = name.chars().filter(|c| !c.is_ascii_digit() && !"[]()_-.# ".contains(*c)).collect();
    Some(letters).filter(|letters| header.columns[k].is_named && !letters.is_empty())
}

/// Whether two columns of times are not the same: in their steps, or by the clock in where they start; as numbers of
/// one name also there.
fn differ(header: &TableHeader, rows: &Rows, (a, b): (usize, usize), is_one_name: bool) -> bool {
    let scale = match (&header.columns[a].unit, &header.columns[b].unit) {
        (Unit::Time(of_a), Unit::Time(of_b)) => of_b / of_a,
        _ => 1.0,
    };
    let times = |k: usize, scale: f64| -> Vec<f64> {
        rows.columns[k].iter().filter(|t| !t.is_nan()).map(|t| t * scale).collect()
    };
    let (of_a, of_b) = (times(a, 1.0), times(b, scale));
    let (Some(first_of_a), Some(first_of_b)) = (of_a.first(), of_b.first()) else { return false };
    let slack = 0.5 * median_step(&of_a).abs();
    let starts = match (rows.cells[a], rows.cells[b]) {
        (Cells::Stamps(a), Cells::Stamps(b)) => b.since(a).abs() > slack,
        _ => is_one_name && (first_of_b - first_of_a).abs() > slack,
    };
    let steps = of_a.iter().zip(&of_b).any(|(x, y)| ((y - first_of_b) - (x - first_of_a)).abs() > slack);
    starts || steps || of_a.len() != of_b.len()
}

/// The channels of all groups, each read as a table of its own by `read`, which also says what the times of a group
/// count from, s. A group without the channel that is asked for, or without an acceleration, is not asked about.
pub fn channels(
    file: &str,
    header: &TableHeader,
    rows: &Rows,
    groups: &[Group],
    settings: &IngestSettings,
    notes: &mut Notes,
    mut read: impl FnMut(Rows, &IngestSettings, &mut Notes) -> Result<OfOneTime>,
) -> Result<Vec<ReadChannel>> {
    let data: Vec<usize> = groups.iter().flat_map(|group| group.data.clone()).collect();
    let names = ids(header, &data);
    let asked = settings.channel.as_deref().map(|wanted| select(file, wanted, header, &data, &names)).transpose()?;
    let is_acceleration = |k: &usize| {
        let column = &header.columns[*k];
        names_acceleration(&column.title) || matches!(column.unit, Unit::Signal(kind, _) if kind.is_motion())
    };
    let has_any = groups.iter().any(|group| group.data.iter().any(is_acceleration));
    let is_meant = |group: &Group| match asked {
        Some(asked) => group.data.contains(&asked),
        None => !has_any || group.data.iter().any(is_acceleration),
    };
    if rows.begins_late {
        notes.push(LateColumns { names: None });
    }
    let mut all = Vec::new();
    let mut first_origin = None;
    for group in groups {
        let own = rows.of(group.time, &group.data);
        let of_group = IngestSettings {
            channel: asked.filter(|k| group.data.contains(k)).map(|k| (k + 1).to_string()),
            listing: settings.listing || !is_meant(group),
            ..settings.clone()
        };
        let (channels, origin) = read(own, &of_group, notes)?;
        let origin = match rows.cells[group.time] {
            Cells::Stamps(first) => Some(Origin::Clock(first)),
            _ => origin.map(Origin::Seconds),
        };
        let later_s = first_origin.get_or_insert(origin).zip(origin).map_or(0.0, |(first, own)| own.since(first));
        for (k, mut read) in channels {
            // A list of what cannot be read holds the times too.
            let Some(place) = data.iter().position(|own| *own == k) else { continue };
            names[place].clone_into(&mut read.channel.id);
            let moved = read.wave.as_ref().map(|wave| wave.starting_at(wave.t0_s() + later_s));
            if let Some(Ok(moved)) = moved.filter(|_| later_s != 0.0) {
                read.wave = Some(moved);
            }
            all.push(read);
        }
    }
    let titles: Vec<&str> = groups.iter().map(|group| header.columns[group.time].title.as_str()).collect();
    notes.push(TimeChannels { names: titles.join(", "), pairs: Some(titles.len()) });
    Ok(all)
}

/// What times count from.
#[derive(Debug, Clone, Copy)]
enum Origin {
    Clock(Instant),
    Seconds(f64),
}

impl Origin {
    fn since(self, first: Self) -> f64 {
        match (first, self) {
            (Self::Clock(first), Self::Clock(own)) => own.since(first),
            (Self::Seconds(first), Self::Seconds(own)) => own - first,
            _ => 0.0,
        }
    }
}

impl Rows {
    /// These columns alone, in the rows that have a time.
    fn of(&self, time: usize, data: &[usize]) -> Self {
        let mut own = Self {
            columns: vec![Vec::new(); self.columns.len()],
            cells: self.cells.clone(),
            digits: self.digits.clone(),
            lines: self.lines.clone(),
            ..Self::default()
        };
        for k in data.iter().chain([&time]) {
            own.columns[*k].clone_from(&self.columns[*k]);
        }
        own.keep_filled(&[time]);
        own
    }
}
