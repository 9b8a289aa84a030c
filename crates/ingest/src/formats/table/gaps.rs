//! Columns with gaps: several rates in one table, where a slower channel is blank between its samples.

use crumple_signal::{Axis, Notes, QuantityKind};

use crate::formats::remarks::{ColumnsOfWords, LateColumns};
use crate::formats::table::header::TableHeader;
use crate::formats::table::numbers::{GAPS, Rows};
use crate::formats::table::remarks::{ColumnsWithGaps, RowsWithGaps};
use crate::formats::table::time_axis::is_time_column;
use crate::formats::table::{columns, layout::Cells};
use crate::formats::text::column_names::{Unit, axis, names_acceleration};
use crate::formats::text::lines::ParsedNumber;
use crate::recording::content::LineNumbers;
use crate::{IngestError, IngestSettings, Place, Result};

/// Leaves out columns of words, and those with gaps that are not needed. The column asked for must be whole, without
/// one the accelerations and velocities, and the times: where one has no number in a tenth of the rows and more, it is
/// a slower channel, and the rows without it go; an uneven step of time that this leaves is refused as any other.
pub fn settle(
    file: &str,
    header: &TableHeader,
    rows: &mut Rows,
    settings: &IngestSettings,
    notes: &mut Notes,
) -> Result<()> {
    let count = header.columns.len();
    let words: Vec<usize> = (0..count).filter(|k| rows.cells[*k] == Cells::Words).collect();
    words.iter().for_each(|k| rows.columns[*k] = Vec::new());
    if !words.is_empty() {
        notes.push(ColumnsOfWords { columns: columns::titles(header, &words), table: None, with_words: 0 });
    }
    if rows.begins_late {
        notes.push(LateColumns { names: None });
    }
    let with_gaps = |rows: &Rows| (0..count).filter(|k| rows.gap(*k).is_some()).collect::<Vec<_>>();
    let gaps = with_gaps(rows);
    if gaps.is_empty() {
        return Ok(());
    }
    let data: Vec<usize> = (0..count).filter(|k| !rows.is_left_out(*k)).collect();
    let ids = columns::ids(header, &data);
    let asked = settings.channel.as_deref().and_then(|wanted| columns::select(file, wanted, header, &data, &ids).ok());
    let is_motion = |k: usize| {
        let column = &header.columns[k];
        names_acceleration(&column.title)
            || matches!(column.unit, Unit::Signal(QuantityKind::Acceleration | QuantityKind::Velocity, _))
    };
    let is_time = |k: usize| is_time_column(header, rows, k) || (!header.named && k == 0);
    let is_slower = |k: usize| {
        let missing = rows.columns[k].iter().filter(|x| x.is_nan()).count();
        missing * 10 >= rows.lines.len() && settings.sample_time.is_none() && settings.resample.is_none()
    };
    // One that has a number in every row is the pulse rather than a slower one, unless it is along y or z.
    let is_along_x = |k: usize| matches!(axis(&header.columns[k].title), None | Some(Axis::X));
    let is_one_whole = data.iter().any(|k| is_motion(*k) && is_along_x(*k) && !gaps.contains(k));
    let is_needed = |k: usize| asked.map_or(is_motion(k) && !(is_one_whole && is_slower(k)), |asked| asked == k);
    let needed: Vec<usize> = gaps.iter().copied().filter(|k| is_time(*k) || is_needed(*k)).collect();
    for &k in &needed {
        if let Some(row) = rows.gap(k).filter(|_| !settings.listing && (is_time(k) || !is_slower(k))) {
            return Err(rows.refuse_gap(file, k, &header.columns[k].title, row));
        }
    }
    if !needed.is_empty() && !settings.listing {
        let before = rows.lines.len();
        rows.keep_filled(&needed);
        let (left_out, columns) = (before - rows.lines.len(), columns::titles(header, &needed));
        notes.push(RowsWithGaps { rows: left_out, of: before, columns });
    }
    let gaps = with_gaps(rows);
    if !gaps.is_empty() {
        notes.push(ColumnsWithGaps { columns: columns::titles(header, &gaps) });
    }
    gaps.into_iter().for_each(|k| rows.columns[k] = Vec::new());
    Ok(())
}

impl Rows {
    /// Whether a row goes on where the last one ended, so many lines between, as the times or counts of a damaged table
    /// do: in some column it is a step or a few further.
    pub fn go_on_in(&self, row: &[ParsedNumber], lines: usize) -> bool {
        self.columns.iter().zip(row).any(|(column, next)| {
            let [first, .., before, last] = column[..] else { return false };
            let step = (last - first) / (column.len() - 1) as f64;
            let steps = (next.value - last) / step;
            ((last - before) / step - 1.0).abs() < 0.5 && (0.5..lines as f64 + 1.5).contains(&steps)
        })
    }

    pub fn is_left_out(&self, k: usize) -> bool {
        self.columns[k].is_empty()
    }

    /// The first row of a column without a number.
    fn gap(&self, k: usize) -> Option<usize> {
        self.columns[k].iter().position(|x| x.is_nan())
    }

    /// The refusal of a gap in a column that is needed.
    fn refuse_gap(&self, file: &str, k: usize, title: &str, row: usize) -> IngestError {
        let place = Place::line(file, self.lines.of_row(row)).in_nth_column(k, title);
        IngestError::content(place, "no number in a column that is needed", "a finite number in every row", GAPS)
    }

    /// Keeps the rows in which all of these columns have a number.
    pub fn keep_filled(&mut self, columns: &[usize]) {
        let is_kept: Vec<bool> =
            (0..self.lines.len()).map(|row| columns.iter().all(|k| !self.columns[*k][row].is_nan())).collect();
        let mut lines = LineNumbers::default();
        (0..is_kept.len()).filter(|row| is_kept[*row]).for_each(|row| lines.push(self.lines.of_row(row)));
        for column in self.columns.iter_mut().filter(|column| !column.is_empty()) {
            let mut kept = is_kept.iter();
            column.retain(|_| kept.next() == Some(&true));
        }
        self.lines = lines;
    }
}
