//! The time column of a table.

use crumple_signal::value::Frequency;
use crumple_signal::{About, Notes, Weight};

use crate::formats::table::header::TableHeader;
use crate::formats::table::rows::Rows;
use crate::formats::text::column_names::{Unit, is_time_name};
use crate::recording::details::Stated;
use crate::time::grid::{self, Grid, GridError};
use crate::time::{resampling, time_unit};
use crate::{IngestError, IngestSettings, Place};

/// The time column and its grid.
#[derive(Debug, Clone)]
pub struct TimeAxis {
    /// Index of the column; past all columns where there is none.
    pub column: usize,
    /// The grid of its stamps, s.
    pub grid: Grid,
}

/// The grid of a table without a time column: the first row at 0 s.
pub fn stated(file: &str, header: &TableHeader, interval_s: f64) -> Result<TimeAxis, IngestError> {
    let refuse = |found: String, hint: &str| {
        Err(IngestError::content(Place::file(file), found, "an interval for a table without time column", hint))
    };
    if !(interval_s > 0.0 && interval_s.is_finite()) {
        return refuse(format!("--sample-time is {interval_s} s"), "give a positive time, such as --sample-time 100us");
    }
    if let Some(column) = header.columns.iter().find(|c| header.named && is_time_name(&c.title)) {
        return refuse(format!("column {} is named as time", column.title), "leave --sample-time away");
    }
    Ok(TimeAxis { column: usize::MAX, grid: Grid { t0_s: 0.0, dt_s: interval_s, jitter: 0.0 } })
}

/// Finds the time column (by name, else by unit, else the first), its unit and its grid. The stamps are taken out of
/// `rows`.
pub fn find(
    file: &str,
    header: &TableHeader,
    rows: &mut Rows,
    settings: &IngestSettings,
    comment: Option<&Stated<String>>,
    notes: &mut Notes,
) -> Result<TimeAxis, IngestError> {
    let named = header.columns.iter().position(|c| header.named && is_time_name(&c.title));
    let with_unit = header.columns.iter().position(|c| matches!(c.unit, Unit::Time(_)));
    let is_named = named.or(with_unit).is_some();
    let column = named.or(with_unit).unwrap_or(0);
    let title = format!("{} ({})", column + 1, header.columns[column].title);
    let mut times = std::mem::take(&mut rows.columns[column]);
    let place = |index: usize| Place::line(file, rows.lines.of_row(index)).in_column(title.clone());

    if let Some(k) = times.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(order(place(k + 1), is_named, times[k], times[k + 1], rows.lines.of_row(k)));
    }
    let unit = unit(file, &title, &header.columns[column].unit, &times, settings, comment, notes)?;
    // The printed resolution: the last digit of the most finely printed stamp, seen from the largest.
    let largest = times[0].abs().max(times[times.len() - 1].abs());
    let resolution = 10_f64.powf(largest.log10().floor() - f64::from(rows.digits[column].max(1)) + 1.0) * unit;
    scale(&mut times, unit);
    if let Some(rate) = settings.resample {
        let grid = resampled(&place(0), &times, rate, rows, column, notes)?;
        return Ok(TimeAxis { column, grid });
    }
    let grid = grid::fit(&times, resolution).map_err(|error| match error {
        GridError::Repeated { index } | GridError::Backwards { index } => {
            order(place(index), is_named, times[index - 1], times[index], rows.lines.of_row(index - 1))
        }
        GridError::Uneven { index, step_s, dt_s } => IngestError::content(
            place(index),
            format!(
                "a step of {step_s:.9} s, where the median is {dt_s:.9} s (jitter, max|dt - median|/median: {:.3})",
                resampling::step_jitter(&times, dt_s)
            ),
            format!("equal steps within {} of the interval", grid::STEP_TOLERANCE),
            format!(
                "a gap is better exported again; for uneven sampling --resample {}Hz brings it to a uniform rate by \
                 linear interpolation",
                resampling::rate_to_type(dt_s)
            ),
        ),
    })?;
    Ok(TimeAxis { column, grid })
}

/// The data columns on a uniform grid from the first time on, by linear interpolation.
fn resampled(
    place: &Place,
    times: &[f64],
    rate: Frequency,
    rows: &mut Rows,
    column: usize,
    notes: &mut Notes,
) -> Result<Grid, IngestError> {
    let interpolation = resampling::resample(times, rate.si()).ok_or_else(|| {
        IngestError::content(
            place.clone(),
            format!("--resample {rate} gives no usable number of samples"),
            "a rate near that of the rows",
            format!("give --resample {}Hz", resampling::rate_to_type(grid::median_step(times))),
        )
    })?;
    let median_s = grid::median_step(times);
    for (_, samples) in rows.columns.iter_mut().enumerate().filter(|(k, _)| *k != column) {
        *samples = interpolation.apply(samples.len(), |k| samples[k]);
    }
    notes.warning(format!(
        "{} rows with a jitter of {:.3} (max|dt - median|/median, median {:.6} s) are resampled to {rate} by linear \
         interpolation, \
         as asked: {} samples",
        times.len(),
        resampling::step_jitter(times, median_s),
        median_s,
        interpolation.len()
    ));
    Ok(Grid { t0_s: times[0], dt_s: 1.0 / rate.si(), jitter: resampling::jitter(times) })
}

/// `x * factor`, by division where that is exact: 20 ms are 0.02 s to the last bit.
fn scale(times: &mut [f64], factor: f64) {
    let inverse = (1.0 / factor).round();
    for time in times {
        if factor < 1.0 { *time /= inverse } else { *time *= factor }
    }
}

fn order(place: Place, named: bool, before: f64, now: f64, line_before: usize) -> IngestError {
    let found = if now == before {
        format!("time {now} again, as in line {line_before}")
    } else {
        format!("time {now} after {before} in line {line_before}")
    };
    let hint = if named {
        "remove the repeated rows, or export with more decimals in the time column"
    } else {
        "no column is named as time, so the first is taken for it: name it time_s, or state --sample-time if there is \
         none; \
         inputs and outputs that are no crash also take --allow-missing, and then crumple-identify"
    };
    IngestError::content(place, found, "times that increase from row to row", hint)
}

/// The factor of the time unit to s: flag, header, comment, else taken from the interval.
fn unit(
    file: &str,
    title: &str,
    header: &Unit,
    times: &[f64],
    settings: &IngestSettings,
    comment: Option<&Stated<String>>,
    notes: &mut Notes,
) -> Result<f64, IngestError> {
    let place = || Place::file(file).in_column(title);
    if let Some(symbol) = &settings.time_unit {
        let flag = time_unit::stated_unit(place(), symbol, "--time-unit")?;
        if matches!(header, Unit::Time(of_header) if *of_header != flag) {
            notes.concern(
                About::Time,
                Weight::Marked,
                format!("--time-unit {symbol} is not the unit that the header of column {title} states"),
            );
        }
        return Ok(flag);
    }
    match header {
        Unit::Time(factor) => return Ok(*factor),
        Unit::Unstated => {}
        Unit::Unknown(_) | Unit::Signal(..) => {
            return Err(time_unit::unit_error(place(), "the unit in the header of the time column is no unit of time"));
        }
    }
    if let Some(stated) = comment {
        return time_unit::stated_unit(place(), &stated.value, &stated.from);
    }
    time_unit::unit_from_steps(file, &format!("column {title}"), "a unit in the header, such as time_s", times, notes)
}
