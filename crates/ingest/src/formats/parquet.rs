//! Parquet files: each flat column of numbers or times is a column of a table. Names carry the units, as in CSV; a null
//! is a blank cell.
//!
//! The bytes are read by the crate `parquet`. What a file states of its size is held against the memory that is left
//! before anything is read; what a page states, against the budget of the process.

use ::parquet::basic::{ConvertedType, LogicalType, TimeUnit, Type};
use ::parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use ::parquet::data_type::DataType;
use ::parquet::errors::ParquetError;
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::schema::types::ColumnDescriptor;
use bytes::Bytes;
use crumple_signal::Notes;

use crate::formats::reader::{Bundle, Reader, guarded};
use crate::formats::remarks::PartsNotRead;
use crate::formats::table::layout::{COLUMN_LIMIT, Cells, KEPT};
use crate::formats::table::numbers::Rows;
use crate::formats::table::{FLAGS_OF_ROWS, channels_of, header, recording};
use crate::recording::content::{LineNumbers, MINIMUM_SAMPLES, Recording, list};
use crate::recording::details::Details;
use crate::time::Instant;
use crate::{IngestError, IngestSettings, Result, refuse, refuse_size};

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
    let Found { names, rows, unread, room } =
        found.map_err(|what| IngestError::content(file, what, "a whole Parquet file", hint))?;
    if let Some(most) = room {
        let found = format!("{} rows of {} numbers", rows.lines.len(), names.len());
        return refuse_size(file, found, format!("at most {most} rows of them: keep the channels needed"));
    }
    let mut notes = Notes::new();
    if !unread.is_empty() {
        notes.push(PartsNotRead { parts: "columns", names: list(&unread) });
    }
    if names.is_empty() || rows.lines.len() < MINIMUM_SAMPLES {
        let found = format!("{} rows of {} columns of numbers", rows.lines.len(), names.len());
        let expected = format!("a time and an acceleration in {MINIMUM_SAMPLES} rows at least");
        return refuse(file, found, expected, "export the record with all of its samples");
    }
    let header = header::of_lines(vec![(1, names.clone())], names.len());
    let channels = channels_of(file, &header, rows, settings, (None, None), &mut notes)?;
    Ok(recording(channels, Details::default(), settings, notes))
}

struct Found {
    names: Vec<String>,
    rows: Rows,
    /// Columns without numbers, with the reason.
    unread: Vec<String>,
    /// For how many rows there is room, where that is too few: none is read.
    room: Option<u64>,
}

/// How the whole numbers of a column are read.
#[derive(Debug, Clone, Copy)]
enum Whole {
    /// By a factor, that of a decimal.
    Scaled(f64),
    /// Without a sign: the bits that count.
    Unsigned(u64),
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
        let room = (rows > most).then_some(most);
        for group in 0..if room.is_some() { 0 } else { reader.num_row_groups() } {
            let group = reader.get_row_group(group).map_err(words)?;
            for (k, name, column) in &mut columns {
                let descriptor = schema.column(*k);
                let from = group.get_column_reader(*k).map_err(words)?;
                column.read(from, &descriptor, rows).map_err(|error| format!("column {name}: {error}"))?;
            }
        }
        let is_short = |(.., column): &&(usize, String, Column)| column.values.len() as u64 != rows;
        if let Some((_, name, column)) = columns.iter().find(is_short).filter(|_| room.is_none()) {
            return Err(format!("{} values in column {name}, where {rows} rows are stated", column.values.len()));
        }
        let rows = Rows {
            cells: columns.iter().map(|(.., column)| column.cells()).collect(),
            digits: vec![0; columns.len()],
            lines: LineNumbers::of_rows(usize::try_from(rows).unwrap_or(usize::MAX)),
            left_out: Vec::new(),
            begins_late: false,
            columns: columns.iter_mut().map(|(.., column)| std::mem::take(&mut column.values)).collect(),
        };
        Ok(Self { names: columns.into_iter().map(|(_, name, _)| name).collect(), rows, unread, room })
    }
}

impl Column {
    /// Errors: why a column has no numbers.
    fn new(descriptor: &ColumnDescriptor) -> Result<Self, String> {
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
        let decimal = |scale: i32| Whole::Scaled(10_f64.powi(scale.saturating_neg()));
        let unsigned = |bits: u32| Whole::Unsigned(u64::MAX >> (64 - bits.clamp(1, 64)));
        let is_whole = matches!(descriptor.physical_type(), Type::INT32 | Type::INT64);
        // Older writers annotate by the second kind alone.
        let whole = match (descriptor.logical_type_ref(), descriptor.converted_type()) {
            (Some(LogicalType::Timestamp(time) | LogicalType::Time(time)), _) if is_whole => instants(&time.unit),
            (None, ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS) if is_whole => {
                instants(&TimeUnit::MILLIS)
            }
            (None, ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS) if is_whole => {
                instants(&TimeUnit::MICROS)
            }
            (Some(LogicalType::Decimal(stated)), _) if is_whole => decimal(stated.scale),
            (None, ConvertedType::DECIMAL) if is_whole => decimal(descriptor.type_scale()),
            (Some(LogicalType::Integer(kind)), _) if is_whole && !kind.is_signed => unsigned(kind.bit_width as u32),
            (None, ConvertedType::UINT_32) if is_whole => unsigned(32),
            (None, ConvertedType::UINT_64) if is_whole => unsigned(64),
            _ => match descriptor.physical_type() {
                Type::INT96 => instants(&TimeUnit::NANOS),
                Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE => Whole::Plain,
                Type::BOOLEAN => return Err("yes and no".to_owned()),
                Type::BYTE_ARRAY => return Err("texts".to_owned()),
                Type::FIXED_LEN_BYTE_ARRAY => return Err("numbers of a fixed number of bytes".to_owned()),
            },
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
            Whole::Unsigned(bits) => (x.cast_unsigned() & *bits) as f64,
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use ::parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
    use ::parquet::file::properties::WriterProperties;
    use ::parquet::file::writer::SerializedFileWriter;
    use ::parquet::schema::parser::parse_message_type;

    use super::*;

    /// A column of a file that is written here.
    enum Written<'a> {
        Whole(&'a [i64]),
        Decimal(&'a [f64]),
        Texts(&'a [&'a str]),
    }

    fn file(schema: &str, columns: &[Written<'_>]) -> Vec<u8> {
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let mut bytes = Vec::new();
        let mut writer =
            SerializedFileWriter::new(&mut bytes, schema, Arc::new(WriterProperties::builder().build())).unwrap();
        let mut group = writer.next_row_group().unwrap();
        for column in columns {
            let mut to = group.next_column().unwrap().unwrap();
            match column {
                Written::Whole(x) => to.typed::<Int64Type>().write_batch(x, None, None).unwrap(),
                Written::Decimal(x) => to.typed::<DoubleType>().write_batch(x, None, None).unwrap(),
                Written::Texts(x) => {
                    let texts: Vec<ByteArray> = x.iter().map(|text| ByteArray::from(*text)).collect();
                    to.typed::<ByteArrayType>().write_batch(&texts, None, None).unwrap()
                }
            };
            to.close().unwrap();
        }
        group.close().unwrap();
        writer.close().unwrap();
        bytes
    }

    #[test]
    fn whole_numbers_are_what_their_annotation_says() {
        let schema = "message m { required int64 t (TIMESTAMP_MICROS); required int64 d (DECIMAL(9,3)); \
                      required int64 u (INTEGER(64,false)); required int64 big; required double a; }";
        let first = 1_700_000_000_500_000;
        let columns = [
            Written::Whole(&[first, first + 100]),
            Written::Whole(&[1234, -5]),
            Written::Whole(&[-1, 7]),
            Written::Whole(&[i64::MAX - 10, i64::MAX]),
            Written::Decimal(&[0.5, f64::NAN]),
        ];
        let found = Found::of(file(schema, &columns).into()).unwrap();
        assert_eq!(found.names, ["t", "d", "u", "big", "a"]);
        let [t, d, u, big, a] = &found.rows.columns[..] else { panic!("{:?}", found.names) };
        assert!(t[0] == 0.0 && (t[1] - 1e-4).abs() < 1e-12 && big[..] == [0.0, 10.0], "{t:?} {big:?}");
        assert!((d[0] - 1.234).abs() < 1e-12 && (d[1] + 0.005).abs() < 1e-15, "{d:?}");
        assert!(u[..] == [18_446_744_073_709_551_615.0, 7.0] && a[0] == 0.5 && a[1].is_nan(), "{u:?} {a:?}");
        let clock = Instant { seconds: 1_700_000_000, fraction_s: 0.5 };
        assert_eq!(found.rows.cells[0], Cells::Stamps(clock));
        assert_eq!(found.rows.cells[3], Cells::Whole(i64::MAX - 10));
    }

    #[test]
    fn a_file_without_numbers_or_with_few_rows_is_refused_with_what_it_has() {
        let words = file("message m { required binary w (STRING); }", &[Written::Texts(&["a", "b"])]);
        let few = file(
            "message m { required double t; required double a; }",
            &[Written::Decimal(&[0.0, 1.0]), Written::Decimal(&[0.0, 1.0])],
        );
        for (bytes, found) in [(words, "2 rows of 0 columns"), (few, "2 rows of 2 columns")] {
            let bundle = Bundle::from_bytes("a.parquet", bytes).unwrap();
            let error = read(&bundle, &IngestSettings::default()).unwrap_err();
            assert!(error.to_string().contains(found) && !error.hint().is_empty(), "{error}");
        }
    }
}
