//! The time column of a table.

use crumple_signal::Notes;

use crate::error::Question;
use crate::formats::remarks::{Resampled, TimesFromFirst};
use crate::formats::table::header::TableHeader;
use crate::formats::table::layout::Cells;
use crate::formats::table::numbers::Rows;
use crate::formats::table::remarks::{NoChannel, TimesStandStill};
use crate::formats::text::column_names::{Unit, is_counter_name, is_time_name, names_acceleration};
use crate::recording::details::Stated;
use crate::recording::stated_contact::TimeZero;
use crate::time::{CALENDAR_S, Grid, Kind, OnGrid, Timed, Times, median_step, over_midnight};
use crate::{IngestError, IngestSettings, Place, Result, refuse};

#[derive(Debug, Clone)]
pub struct TimeAxis {
    /// Columns that are no channels: that of the time, and those that count the rows.
    pub columns: Vec<usize>,
    pub grid: Grid,
    /// What its times count from, where they are those of a calendar and were too large to keep.
    pub origin_s: Option<f64>,
}

/// What to do where no column is the time.
const STATE_THE_INTERVAL: &str =
    "state the sampling interval, such as --sample-time 100us, or name the column that is the time: time_s";

/// The grid of a table without a time column: the first row at 0 s. A column that counts the rows is left out.
pub fn stated(file: &str, header: &TableHeader, rows: &Rows, interval_s: f64, notes: &mut Notes) -> Result<TimeAxis> {
    let refuse = |found: String, hint: &str| refuse(file, found, "an interval for a table without time column", hint);
    if !(interval_s > 0.0 && interval_s.is_finite()) {
        return refuse(format!("--sample-time is {interval_s} s"), "give a positive time, such as --sample-time 100us");
    }
    let is_time = |k: &usize| {
        let column = &header.columns[*k];
        is_time_column(header, rows, *k) && !(matches!(column.unit, Unit::Unstated) && counts(&rows.columns[*k]))
    };
    let times: Vec<usize> = (0..header.columns.len()).filter(is_time).collect();
    if let Some(&k) = times.iter().find(|k| increases(&rows.columns[**k])) {
        let title = &header.columns[k].title;
        return refuse(format!("column {title} is named as time"), "leave --sample-time away");
    }
    for k in &times {
        notes.push(TimesStandStill { column: header.columns[*k].title.clone() });
    }
    // Without names the first column may count the rows as well.
    let mut columns = counters(header, rows, |k| is_time_column(header, rows, k) || (!header.named && k == 0), notes);
    columns.extend(times);
    Ok(TimeAxis { columns, grid: Grid { t0_s: 0.0, dt_s: interval_s, jitter: 0.0 }, origin_s: None })
}

/// Whether a column is the time by its name, its unit or its cells.
pub fn is_time_column(header: &TableHeader, rows: &Rows, k: usize) -> bool {
    let column = &header.columns[k];
    let is_stated = matches!(column.unit, Unit::Time(_)) || (header.named && is_time_name(&column.title));
    !rows.is_left_out(k) && (is_stated || matches!(rows.cells[k], Cells::Stamps(_)))
}

/// Whether numbers grow from row to row, a clock at midnight aside.
fn increases(times: &[f64]) -> bool {
    times.windows(2).filter(|pair| pair[1] <= pair[0]).count() <= 1
}

/// Whether numbers are whole and grow by one from row to row.
pub fn counts(numbers: &[f64]) -> bool {
    numbers.first().is_some_and(|x| x.fract() == 0.0) && numbers.windows(2).all(|pair| pair[1] - pair[0] == 1.0)
}

/// The columns that count the rows, by name or where `may_count` says so; a note names them.
fn counters(header: &TableHeader, rows: &Rows, may_count: impl Fn(usize) -> bool, notes: &mut Notes) -> Vec<usize> {
    let is_counter = |k: &usize| {
        let named = header.named && is_counter_name(&header.columns[*k].title);
        (named || may_count(*k)) && counts(&rows.columns[*k])
    };
    let counters: Vec<usize> = (0..header.columns.len()).filter(is_counter).collect();
    for k in &counters {
        notes.push(NoChannel { number: k + 1, column: header.columns[*k].title.clone(), times_of: None });
    }
    counters
}

/// The column of the time: the one named for it, rather with its unit, else the one with a unit of time. Where no name
/// says so, the first is it if a person states its unit, or if the table has no names and its numbers grow by other
/// steps than one.
fn time_column(file: &str, header: &TableHeader, rows: &Rows, is_unit_stated: bool) -> Result<usize> {
    let mut times: Vec<usize> = (0..header.columns.len()).filter(|k| is_time_column(header, rows, *k)).collect();
    // What stands still is no time where another column runs.
    if times.iter().any(|k| increases(&rows.columns[*k])) {
        times.retain(|k| rows.columns[*k].windows(2).any(|pair| pair[0] != pair[1]));
    }
    let is_named = |k: &usize| header.named && is_time_name(&header.columns[*k].title);
    let says_its_unit =
        |k: &usize| matches!(header.columns[*k].unit, Unit::Time(_)) || matches!(rows.cells[*k], Cells::Stamps(_));
    let found = times
        .iter()
        .find(|k| is_named(k) && says_its_unit(k))
        .or_else(|| times.iter().find(|k| is_named(k)))
        .or_else(|| times.first())
        .copied();
    let column = found.or_else(|| (0..header.columns.len()).find(|k| !rows.is_left_out(*k))).unwrap_or(0);
    let title = &header.columns[column].title;
    let numbers = &rows.columns[column];
    let expected = "times in a column that is named for it, with its unit: time_s";
    let place = || Place::file(file).in_nth_column(column, title);
    let has_unit = is_unit_stated || says_its_unit(&column);
    if found.is_some() {
        if !has_unit && counts(numbers) {
            let found = "whole numbers that grow by one, without a unit: times, or a count of the rows";
            let hint = "if they are times, --time-unit ms (or s, us) says in what; if they count the rows, state the \
                sampling interval, such as --sample-time 100us";
            return Err(IngestError::content(place(), found, expected, hint).asking(Question::UnitOfTime));
        }
        return Ok(column);
    }
    let only_signals =
        header.columns.iter().all(|c| matches!(c.unit, Unit::Signal(..)) || names_acceleration(&c.title));
    if only_signals && header.named {
        let titles: Vec<&str> = header.columns.iter().take(12).map(|c| c.title.as_str()).collect();
        return Err(no_interval(file, format!("no column is the time: {}", titles.join(", ")), expected));
    }
    if (header.named && is_counter_name(title)) || (!is_unit_stated && counts(numbers)) {
        return Err(no_interval(place(), "it counts rows, and no column is named as time".to_owned(), expected));
    }
    let is_increasing = numbers.windows(2).all(|pair| pair[1] > pair[0]);
    if is_unit_stated || (!header.named && is_increasing) {
        return Ok(column);
    }
    let not_a_crash = "; inputs and outputs that are no crash also take --allow-missing, and then the stage identify";
    let is_of_a_crash = header.columns.iter().any(|c| names_acceleration(&c.title));
    let hint = if is_increasing {
        format!("if it is the time, --time-unit s (or ms, us) says so; if there is none, {STATE_THE_INTERVAL}")
    } else {
        STATE_THE_INTERVAL.to_owned()
    };
    let hint = hint + if is_of_a_crash { "" } else { not_a_crash };
    let found = "no column is named as time, nor is the first certain to be it";
    let question = if is_increasing { Question::UnitOfTime } else { Question::Interval };
    Err(IngestError::content(place(), found, expected, hint).asking(question))
}

/// There is no time, and the sampling interval would do.
fn no_interval(at: impl std::fmt::Display, found: String, expected: &str) -> IngestError {
    IngestError::content(at, found, expected, STATE_THE_INTERVAL).asking(Question::Interval)
}

/// Finds the time column, its unit and its grid. The stamps are taken out of `rows`.
pub fn find(
    file: &str,
    header: &TableHeader,
    rows: &mut Rows,
    settings: &IngestSettings,
    comment: Option<&Stated<String>>,
    notes: &mut Notes,
) -> Result<TimeAxis> {
    let column = time_column(file, header, rows, settings.time_unit.is_some() || comment.is_some())?;
    // A column without a name beside others with names counts the rows, as pandas and R write them.
    let is_nameless = |k: usize| header.named && header.columns[k].title == format!("column {}", k + 1);
    let mut columns = counters(header, rows, is_nameless, notes);
    columns.retain(|k| *k != column);
    columns.push(column);
    columns.extend(same_times(file, header, rows, column, notes)?);
    let title = format!("{} ({})", column + 1, header.columns[column].title);
    let mut values = std::mem::take(&mut rows.columns[column]);
    if values.len() < 2 {
        let place = Place::file(file).in_column(title);
        return refuse(place, "no times", "a time in every row", STATE_THE_INTERVAL);
    }
    let kind = match rows.cells[column] {
        Cells::Stamps(_) => Kind::Clock,
        Cells::Whole(first) => Kind::From(first),
        Cells::Numbers | Cells::Words => match rows.digits[column] {
            0 => Kind::Binary,
            digits => Kind::Printed(digits),
        },
    };
    if kind == Kind::Clock {
        over_midnight(&mut values);
    }
    let place = |index: usize| Place::line(file, rows.lines.of_row(index)).in_column(title.clone());
    if let Some(k) = values.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(order(place(k + 1), &values, k, rows.lines.of_row(k)));
    }
    let count = values.len();
    let times = Times {
        values,
        kind,
        file,
        title: &title,
        whose: &format!("column {title}"),
        unit: header.columns[column].unit.of_times(),
        comment,
        expected: "a unit in the header, such as time_s",
    };
    let Timed { on_grid, origin_s, is_of_a_clock } = times.timed(settings, place, notes)?;
    let OnGrid { mut grid, interpolation, words, .. } = on_grid;
    if let Some(interpolation) = interpolation {
        notes.push(Resampled { topic: None, times: None, count: Some(count), words });
        for (_, samples) in rows.columns.iter_mut().enumerate().filter(|(k, _)| *k != column) {
            *samples = interpolation.apply(samples.len(), |k| samples[k]);
        }
    }
    // A time zero by the calendar counts on the calendar.
    let is_absolute = settings.time_zero.and_then(TimeZero::stated).is_some_and(|zero| zero.si().abs() > CALENDAR_S);
    match origin_s.filter(|_| is_absolute) {
        Some(origin_s) => grid.t0_s += origin_s,
        None if origin_s.is_some() || is_of_a_clock => {
            notes.push(TimesFromFirst { column: Some(title), since_start_s: None, first_s: None });
        }
        None => {}
    }
    Ok(TimeAxis { columns, grid, origin_s: origin_s.filter(|_| !is_absolute) })
}

/// The refusal of times that do not increase from row `k` to the next.
fn order(place: Place, times: &[f64], k: usize, line_before: usize) -> IngestError {
    let (before, now) = (times[k], times[k + 1]);
    let steps = || times.windows(2).map(|pair| pair[1] - pair[0]);
    let (found, hint) = if now == before {
        // A line that is there twice is a rarity; a time of too few decimals stands still again and again, and to leave
        // its rows out would leave samples out.
        let rarely = steps().filter(|step| *step == 0.0).count() * 20 < times.len();
        let hint = if rarely {
            "remove the row that is there twice"
        } else {
            "the times have too few decimals: export more of them, or leave the column out and state the sampling \
             interval, such as --sample-time 100us"
        };
        (format!("time {now} again, as in line {line_before}"), hint)
    } else {
        let hint = if steps().all(|step| step < 0.0) {
            "the rows run backwards: sort them by time"
        } else {
            "sort the rows by time, or split the file there if another recording begins"
        };
        (format!("time {now} after {before} in line {line_before}"), hint)
    };
    IngestError::content(place, found, "times that increase from row to row", hint)
}

/// Further columns of time, which repeat the first but for where they start, to half a step; others are refused, as
/// their channels have times of their own.
fn same_times(file: &str, header: &TableHeader, rows: &Rows, column: usize, notes: &mut Notes) -> Result<Vec<usize>> {
    let is_other = |k: &usize| *k != column && is_time_column(header, rows, *k);
    let others: Vec<usize> = (0..header.columns.len()).filter(is_other).collect();
    let first = &rows.columns[column];
    let span = |times: &[f64]| times[times.len() - 1] - times[0];
    for &k in &others {
        let (title, of_first, times) = (&header.columns[k].title, &header.columns[column].title, &rows.columns[k]);
        let ratio = match (&header.columns[column].unit, &header.columns[k].unit) {
            (Unit::Time(of_first), Unit::Time(factor)) => factor / of_first,
            _ if span(times) != 0.0 => span(first) / span(times),
            _ => 0.0,
        };
        let is_still = span(times) == 0.0;
        let slack = 0.5 * median_step(first).abs();
        let is_apart = |row: &usize| ((times[*row] - times[0]) * ratio - (first[*row] - first[0])).abs() > slack;
        if let Some(row) = (0..times.len()).find(is_apart).filter(|_| !is_still) {
            return refuse(
                Place::line(file, rows.lines.of_row(row)).in_nth_column(k, title),
                format!("another time than in column {of_first}: which channel has which?"),
                "one column of time for all channels",
                format!("export the channels of {title} into a file of their own, or leave that column out"),
            );
        }
        notes.push(NoChannel { number: k + 1, column: title.clone(), times_of: Some(of_first.clone()) });
    }
    Ok(others)
}
