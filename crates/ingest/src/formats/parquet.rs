//! Parquet files: a table whose flat columns of numbers and times are columns. Names carry the units, as in CSV; a null
//! is a blank cell.
//!
//! The bytes are read by the crate `parquet`. What a file states of its size is held against the memory that is left
//! before anything is read; what a page states, against the budget of the process.

use ::parquet::basic::{LogicalType, TimeUnit};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use ::parquet::data_type::DataType;
use ::parquet::errors::ParquetError;
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::schema::types::ColumnDescriptor;
use bytes::Bytes;
use crumple_signal::Notes;

use crate::formats::reader::{Bundle, Reader, guarded};
use crate::formats::table::layout::{COLUMN_LIMIT, Cells, KEPT};
use crate::formats::table::numbers::Rows;
use crate::formats::table::{FLAGS_OF_ROWS, channels_of, header, recording};
use crate::recording::content::{LineNumbers, Recording, list};
use crate::recording::details::Details;
use crate::time::stamps::Instant;
use crate::{IngestError, IngestSettings, Result};

pub const PARQUET: Reader = Reader::of_one_file("parquet", |head| head.starts_with(b"PAR1"), FLAGS_OF_ROWS, read);

/// Most numbers of all columns together: 256 MiB.
const NUMBER_LIMIT: u64 = 1 << 25;
/// What a number takes while it is read: as a page, as a column and as a wave.
const BYTES_A_NUMBER: u64 = 24;
/// Rows read at a time.
const CHUNK: usize = 1 << 14;

fn read(bundle: &Bundle, settings: &IngestSettings) -> Result<Recording> {
    let file = bundle.main.name.as_str();
    let found = guarded(|| Found::of(bundle.main.bytes.clone().into()));
    let hint = "the file may be cut short: write it again, or write the channels as CSV";
    let found = found.map_err(|what| IngestError::content(file, what, "a whole Parquet file", hint))?;
    let mut notes = Notes::new();
    if !found.unread.is_empty() {
        notes.info(format!("columns that are not read: {}", list(&found.unread)));
    }
    let count = found.names.len();
    let header = header::of_lines(vec![(1, found.names)], count);
    let channels = channels_of(file, &header, found.rows, settings, (None, None), &mut notes)?;
    Ok(recording(channels, Details::default(), settings, notes))
}

struct Found {
    names: Vec<String>,
    rows: Rows,
    /// Columns that are none of numbers, with the reason.
    unread: Vec<String>,
}

/// How the whole numbers of a column are read.
#[derive(Debug, Clone, Copy)]
enum Whole {
    /// By a factor, that of a decimal.
    Scaled(f64),
    /// Of 32 bits without a sign.
    Unsigned,
    /// As they are, or from the first one on where a number of 64 bits does not keep its digits.
    Plain,
    /// From this one on.
    From(i64),
    /// Instants, so many units to the second, from the first one on.
    Instants { per_second: i64, first: Option<i64> },
}

/// A column while it is read.
struct Column {
    values: Vec<f64>,
    whole: Whole,
}

impl Found {
    fn of(bytes: Bytes) -> Result<Self, String> {
        let words = |error: ParquetError| error.to_string();
        let reader = SerializedFileReader::new(bytes).map_err(words)?;
        let schema = reader.metadata().file_metadata().schema_descr_ptr();
        let stated = reader.metadata().file_metadata().num_rows();
        let rows = u64::try_from(stated).map_err(|_| format!("{stated} rows"))?;
        let mut unread = Vec::new();
        let mut columns: Vec<(usize, String, Column)> = Vec::new();
        for (k, descriptor) in schema.columns().iter().enumerate() {
            let name = descriptor.path().string();
            match Column::new(descriptor) {
                Ok(column) => columns.push((k, name, column)),
                Err(reason) => unread.push(format!("{name} ({reason})")),
            }
        }
        if columns.len() > COLUMN_LIMIT {
            return Err(format!("{} columns of numbers, at most {COLUMN_LIMIT} are read", columns.len()));
        }
        let most = NUMBER_LIMIT.min(crumple_memory::left() / BYTES_A_NUMBER) / (columns.len() as u64).max(1);
        if rows > most {
            return Err(format!("{rows} rows of {} numbers, of which there is room for {most}", columns.len()));
        }
        for group in 0..reader.num_row_groups() {
            let group = reader.get_row_group(group).map_err(words)?;
            for (k, name, column) in &mut columns {
                let descriptor = schema.column(*k);
                let from = group.get_column_reader(*k).map_err(words)?;
                column.read(from, &descriptor, most).map_err(|error| format!("column {name}: {error}"))?;
            }
        }
        if let Some((_, name, column)) = columns.iter().find(|(.., column)| column.values.len() as u64 != rows) {
            return Err(format!("{} values in column {name}, where {rows} rows are stated", column.values.len()));
        }
        let rows = Rows {
            cells: columns.iter().map(|(.., column)| column.cells()).collect(),
            digits: vec![17; columns.len()],
            lines: LineNumbers::of_rows(columns.first().map_or(0, |(.., column)| column.values.len())),
            left_out: Vec::new(),
            begins_late: false,
            columns: columns.iter_mut().map(|(.., column)| std::mem::take(&mut column.values)).collect(),
        };
        Ok(Self { names: columns.into_iter().map(|(_, name, _)| name).collect(), rows, unread })
    }
}

impl Column {
    /// Errors: why a column is none of numbers.
    fn new(descriptor: &ColumnDescriptor) -> Result<Self, String> {
        use ::parquet::basic::Type;
        if descriptor.max_rep_level() > 0 {
            return Err("a list".to_owned());
        }
        let instants = |unit: &TimeUnit| {
            let per_second = match unit {
                TimeUnit::MILLIS => 1_000,
                TimeUnit::MICROS => 1_000_000,
                TimeUnit::NANOS => 1_000_000_000,
            };
            Whole::Instants { per_second, first: None }
        };
        let whole = match (descriptor.physical_type(), descriptor.logical_type_ref()) {
            (Type::INT64, Some(LogicalType::Timestamp(stamp))) => instants(&stamp.unit),
            (Type::INT32 | Type::INT64, Some(LogicalType::Time(time))) => instants(&time.unit),
            (Type::INT32 | Type::INT64, Some(LogicalType::Decimal(decimal))) => {
                Whole::Scaled(10_f64.powi(decimal.scale.saturating_neg()))
            }
            (Type::INT96, _) => instants(&TimeUnit::NANOS),
            (Type::INT32, Some(LogicalType::Integer(kind))) if !kind.is_signed => Whole::Unsigned,
            (Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE, _) => Whole::Plain,
            (Type::BOOLEAN, _) => return Err("yes and no".to_owned()),
            (Type::BYTE_ARRAY, _) => return Err("texts".to_owned()),
            (Type::FIXED_LEN_BYTE_ARRAY, _) => return Err("numbers of a fixed number of bytes".to_owned()),
        };
        Ok(Self { values: Vec::new(), whole })
    }

    /// Reads what a group of rows has of the column, `most` values at most.
    fn read(&mut self, from: ColumnReader, descriptor: &ColumnDescriptor, most: u64) -> Result<(), String> {
        let read = match from {
            ColumnReader::DoubleColumnReader(from) => self.take(from, descriptor, most, |_, x| *x),
            ColumnReader::FloatColumnReader(from) => self.take(from, descriptor, most, |_, x| f64::from(*x)),
            ColumnReader::Int64ColumnReader(from) => self.take(from, descriptor, most, |column, x| column.whole(*x)),
            ColumnReader::Int32ColumnReader(from) => {
                self.take(from, descriptor, most, |column, x| column.whole(i64::from(*x)))
            }
            ColumnReader::Int96ColumnReader(from) => {
                self.take(from, descriptor, most, |column, x| column.whole(x.to_nanos()))
            }
            _ => return Err("another type than its schema states".to_owned()),
        };
        read.map_err(|error| error.to_string())
    }

    fn take<T: DataType>(
        &mut self,
        mut from: ColumnReaderImpl<T>,
        descriptor: &ColumnDescriptor,
        most: u64,
        number: impl Fn(&mut Self, &T::T) -> f64,
    ) -> Result<(), ParquetError> {
        let (mut values, mut levels) = (Vec::new(), Vec::new());
        loop {
            values.clear();
            levels.clear();
            let (records, _, _) = from.read_records(CHUNK, Some(&mut levels), None, &mut values)?;
            if records == 0 {
                return Ok(());
            }
            if (self.values.len() + records) as u64 > most {
                return Err(ParquetError::General("more values than the file states rows".to_owned()));
            }
            let mut values = values.iter();
            for row in 0..records {
                let is_there = levels.get(row).is_none_or(|level| *level == descriptor.max_def_level());
                let value = if is_there { values.next() } else { None };
                let value = value.map_or(f64::NAN, |x| number(self, x));
                self.values.push(value);
            }
        }
    }

    /// A whole number as it is read.
    fn whole(&mut self, x: i64) -> f64 {
        let is_first = matches!(self.whole, Whole::Plain) && self.values.iter().all(|x| x.is_nan());
        if is_first {
            self.whole = if x.unsigned_abs() > KEPT { Whole::From(x) } else { Whole::Scaled(1.0) };
        }
        match &mut self.whole {
            Whole::Scaled(factor) => x as f64 * *factor,
            Whole::Unsigned => f64::from(x as u32),
            Whole::Plain => x as f64,
            Whole::From(first) => x.wrapping_sub(*first) as f64,
            Whole::Instants { per_second, first } => {
                x.wrapping_sub(*first.get_or_insert(x)) as f64 / *per_second as f64
            }
        }
    }

    fn cells(&self) -> Cells {
        match self.whole {
            Whole::From(first) => Cells::Whole(first),
            Whole::Instants { per_second, first: Some(first) } => Cells::Stamps(Instant {
                seconds: first.div_euclid(per_second),
                fraction_s: first.rem_euclid(per_second) as f64 / per_second as f64,
            }),
            _ => Cells::Numbers,
        }
    }
}
